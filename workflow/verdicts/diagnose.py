"""Likely causes of a difference between a trajectory and its reference, in words.

`analysis.compare.identify` and `analysis.compare.rounding` do the measuring.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from analysis import motion
from analysis.compare import start
from analysis.compare.identify import (
    LEAST_FRAMES,
    NOISE,
    TOO_FAR,
    Departure,
    Identification,
    identify,
    other_parameters,
    time_shift,
)
from analysis.compare.rounding import precision
from analysis.compare.scaled import scale_factor
from analysis.files.recording import rest_positions
from analysis.trajectory import Floats, Trajectory
from lammps_inputs.loads import Motion
from lammps_inputs.system import System
from lammps_inputs.units import Scale
from workflow.verdicts.long_step import long_step

_SHIFTED = 0.97
"""Share of the squared difference that a shift in time must explain."""

_STEADY = 0.1
"""Uncertainty of a shift, or another shift, over the shift, up to which both are the same."""

_MOTION = 1e-6
"""Difference from a prescribed motion over its amplitude, up to which it is rounding."""


@dataclass(frozen=True)
class Diagnosis:
    """Likely causes of a difference.

    Attributes:
        causes: largest effect first; empty if none could be determined.
        remark: why no cause could be determined, else empty.
    """

    causes: tuple[str, ...] = ()
    remark: str = ""


def rounded(trajectory: Trajectory, reference: Trajectory) -> list[str]:
    """Which numbers were rounded when they were written: positions or velocities, of any beads."""
    problem, lines = trajectory.problem, []
    rest = trajectory.beads * problem.layout.spacing if problem.rows.follow else rest_positions(problem)
    moved = trajectory.displacement != 0.0
    for name, values, right in (
        ("positions", trajectory.displacement + rest, reference.displacement + rest),
        ("velocities", trajectory.velocity, reference.velocity),
    ):
        digits = precision(values[moved])
        if digits is not None and precision(right[moved]) is None:
            lines.append(f"{name} have only {digits}; write them with %.17g or in binary")
    return lines


def diagnose(trajectory: Trajectory, reference: Trajectory) -> Diagnosis:
    """Likely causes of the difference between a trajectory and the reference.

    Args:
        trajectory: consecutive frames of all beads.
        reference: the same frames as the scene has them.
    """
    causes = _not_finite(trajectory) or _scaled(trajectory, reference) or _shifted(trajectory, reference)
    departures = [] if causes else _prescribed(trajectory)
    if not causes and not departures and trajectory.time[0] == 0.0:
        causes = start.differences(trajectory) or long_step(trajectory, reference)
    if causes:
        return Diagnosis(tuple(causes))
    reason = _reason_against(trajectory, reference)
    if not reason:
        identification = identify(trajectory, reference)
        departures += identification.departures
        reason = _undetermined(identification, trajectory.problem.system)
    causes = [_sentence(departure, trajectory.problem.scale) for departure in departures]
    return Diagnosis(tuple(causes), "" if causes else f"no cause could be determined: {reason}")


# --- what the momentum equations do not show --------------------------------------------------------------------------


def _not_finite(trajectory: Trajectory) -> list[str]:
    """Whether there are numbers that are not finite."""
    wrong = ~np.all(np.isfinite(trajectory.displacement) & np.isfinite(trajectory.velocity), axis=(1, 2))
    if not wrong.any():
        return []
    time = trajectory.problem.scale.written(trajectory.time[int(np.argmax(wrong))], "time")
    return [f"from t = {time} on, positions or velocities are not finite numbers (a time step too long?)"]


def _scaled(trajectory: Trajectory, reference: Trajectory) -> list[str]:
    """Whether times, displacements or velocities are multiples of the right ones."""
    if _reason_against(trajectory, reference):
        return []
    scaled = scale_factor(trajectory, reference)
    if scaled is None:
        return []
    factor = f"{scaled.factor:.6g} (± {scaled.uncertainty:.1g}) times"
    if scaled.quantity.startswith("times"):
        also = ", and velocities as many times smaller," if "velocities" in scaled.quantity else ""
        return [f"times{also} are {factor} as long as the motion is (another time step, or unit of time?)"]
    return [f"{scaled.quantity} are {factor} as large as the motion says (another unit?)"]


def _shifted(trajectory: Trajectory, reference: Trajectory) -> list[str]:
    """Whether a shift in time, of all numbers or of the velocities alone, explains the difference."""
    problem = trajectory.problem
    of_velocity = time_shift(
        trajectory.velocity - reference.velocity, 0.5 * (_acceleration(trajectory) + _acceleration(reference))
    )
    of_position = time_shift(
        trajectory.displacement - reference.displacement, 0.5 * (trajectory.velocity + reference.velocity)
    )
    limit = _STEADY * abs(of_velocity.time)
    if of_velocity.explained < _SHIFTED or of_velocity.uncertainty > limit:
        return []
    if abs(of_position.time) < limit:
        steps, uncertainty = of_velocity.time / problem.timestep, of_velocity.uncertainty / problem.timestep
        side = "after" if steps > 0.0 else "before"
        return [
            f"velocities are those of {abs(steps):.2g} (± {uncertainty:.1g}) time steps {side} the positions "
            "(half-step velocities?)"
        ]
    alike = max(abs(of_position.time - of_velocity.time), of_position.uncertainty) < limit
    if of_position.explained < _SHIFTED or not alike:
        return []
    time = problem.scale.written(abs(of_position.time), "time", ".2g")
    bound = problem.scale.written(of_position.uncertainty, "time", ".1g")
    direction = "earlier" if of_position.time > 0.0 else "later"
    return [f"all frames are shown {time} (± {bound}) {direction} than they are"]


def _acceleration(trajectory: Trajectory) -> Floats:
    """Acceleration of the beads by the forces of the scene, [frame, chain, bead]."""
    (x, v), problem = trajectory.atoms, trajectory.problem
    return motion.acceleration(problem.system, x, time=trajectory.time, velocity=v)[:, : problem.chains]


def _prescribed(trajectory: Trajectory) -> list[Departure]:
    """What differs of the motion of beads of prescribed motion."""
    departures = []
    for drive in trajectory.problem.system.motions:
        values = trajectory.displacement[:, drive.chain - 1, drive.bead - 1]
        prescribed = drive.displacement(trajectory.time)
        difference, limit = values - prescribed, _MOTION * float(np.max(np.abs(prescribed)))
        if np.max(np.abs(difference)) <= limit:
            continue
        name = f"drive of bead {drive.bead} of chain {drive.chain}"

        def course(*numbers: float, drive: Motion = drive) -> Floats:
            """Displacement [frame] of the bead with these numbers of its drive, in units of L."""
            moved = replace(drive, laws=(drive.laws[0].of(*numbers),))
            return np.asarray(moved.displacement(trajectory.time))

        numbers = drive.laws[0].numbers if len(drive.laws) == 1 else {}
        fitted = numbers and other_parameters(name, numbers, course, values, limit * np.sqrt(trajectory.frames))
        departures += fitted or [Departure(name, "course", np.nan, np.nan, 1.0, 1.0)]
    return departures


# --- what they show ---------------------------------------------------------------------------------------------------


def _reason_against(trajectory: Trajectory, reference: Trajectory) -> str:
    """Why the forces on the beads do not follow from the frames; empty if they do."""
    if not trajectory.problem.forces_known:
        return "forces of contacts that yield depend on their past"
    if not (trajectory.all_lines and reference.all_lines):
        return f"the motion of the {trajectory.problem.system.others} is not recorded"
    if trajectory.frames < LEAST_FRAMES:
        return f"there are {trajectory.frames} frames, of {LEAST_FRAMES} that are needed"
    return ""


def _undetermined(identification: Identification, system: System) -> str:
    """Why the momentum equations show no cause."""
    unexplained, interpolation = identification.unexplained, identification.interpolation
    line, bead = identification.place
    if interpolation >= TOO_FAR:
        return (
            f"frames too far apart: interpolation between them leaves {interpolation:.0%} of the changes of momentum, "
            f"of {TOO_FAR:.0%} that are allowed (a smaller output.every)"
        )
    if unexplained <= NOISE * interpolation:
        return (
            f"between frames all beads follow the forces of the scene, to {unexplained:.1e} of the changes of momentum"
        )
    if identification.ambiguous:
        return "several factors of forces or masses explain the motion alike"
    return (
        f"the forces of the scene leave {unexplained:.2g} of the changes of momentum unexplained, most at bead "
        f"{bead + 1} of chain {system.chain_of_line[line] + 1}, and no factors of one kind explain it"
    )


def _sentence(departure: Departure, scale: Scale) -> str:
    """A departure in words."""
    factor, uncertainty, quantity = departure.factor, departure.uncertainty, departure.quantity
    name = departure.name.replace("_", " ")
    are, do = ("are", "do") if name.split()[0].endswith("s") else ("is", "does")
    if name == "beads":
        name = "all beads"
    elif quantity != "mass" or name.split()[0] not in ("bead", "beads"):
        name = f"the {name}"
    adjective = "heavy" if quantity == "mass" else "strong"
    if departure.count > 1:
        many = f"the strength of {name} differs from the scene's at {departure.count} places"
        if quantity == "mass":
            many = f"the masses of {departure.count} beads differ from the scene's"
        return f"{many}, most of all: {_sentence(replace(departure, count=1), scale)}"
    if departure.place:
        name = f"{name} {departure.place}"
    if quantity == "course":
        return f"{name} has another course over time than the scene says"
    if quantity == "law":
        return f"{name} {do} not follow the law of the scene: the force is another function of the overlap or strain"
    if quantity == "exponent":
        more = "larger" if factor > 0.0 else "smaller"
        return f"the exponent of {name} is {more} by {abs(factor):.3g} (± {uncertainty:.1g}) than the scene says"
    if quantity == "gap":
        more = "larger" if factor > 0.0 else "smaller"
        size, error = scale.written(abs(factor), "length", ".4g"), scale.written(uncertainty, "length", ".1g")
        return f"the gap of {name} is {more} by {size} (± {error}) than the scene says"
    if quantity == "phase":
        angle, bound, scene = (math.degrees(number) for number in (factor, uncertainty, departure.scene))
        return f"{name} has a phase of {angle:.4g} (± {bound:.1g}) instead of {scene:.4g} degrees"
    if quantity not in ("strength", "mass"):
        parameter = "frequency" if quantity == "omega" else quantity
        return f"the {parameter} of {name} is {factor:.4g} (± {uncertainty:.1g}) times that of the scene"
    if departure.scene == 0.0:
        value = f"{factor:.4g} m/T" if name.endswith("damping") else scale.written(factor, "stiffness", ".4g")
        return f"{name} of {value} is not in the scene"
    if abs(factor) <= uncertainty:  # such a number is none
        return f"{name} {are} {'missing' if quantity == 'strength' else 'practically without mass'}"
    return f"{name} {are} {factor:.4g} (± {uncertainty:.1g}) times as {adjective} as the scene says"
