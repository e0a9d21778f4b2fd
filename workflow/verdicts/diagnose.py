"""Likely causes of a difference between a trajectory and its reference, in words.

`analysis.against.identify` and `analysis.against.rounding` do the measuring.
"""

from dataclasses import dataclass

import numpy as np

from analysis import motion
from analysis.against.identify import LEAST_FRAMES, NOISE, TOO_FAR, Departure, Identification, identify, time_shift
from analysis.against.momentum import HOLDING
from analysis.against.rounding import precision
from analysis.files.recording import rest_positions
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import physics
from lammps_inputs.units import Scale

_SHIFTED = 0.97
"""Share of the squared difference that a shift in time must explain."""

_STEADY = 0.1
"""Uncertainty of a shift, or another shift, over the shift, up to which both are the same."""

_START = 1e-4
"""Difference at the start, in units of V and L, below which it explains nothing that a tolerance does not allow."""

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
    rest = rest_positions(problem) if problem.window is None else trajectory.beads * problem.layout.spacing
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
    causes = _not_finite(trajectory) or _shifted(trajectory, reference)
    if causes:
        return Diagnosis(tuple(causes))
    causes, reason, unexplained = _prescribed(trajectory), _reason_against(trajectory, reference), 0.0
    if not reason:
        identification = identify(trajectory, reference)
        causes += [_sentence(departure, trajectory.problem.scale) for departure in identification.departures]
        reason = _undetermined(identification, trajectory.problem.chains)
        unexplained = 0.0 if identification.departures else identification.unexplained
    causes = _start(trajectory, unexplained) + causes
    return Diagnosis(tuple(causes), "" if causes else f"no cause could be determined: {reason}")


# --- what the momentum equations do not show --------------------------------------------------------------------------


def _not_finite(trajectory: Trajectory) -> list[str]:
    """Whether there are numbers that are not finite."""
    wrong = ~np.all(np.isfinite(trajectory.displacement) & np.isfinite(trajectory.velocity), axis=(1, 2))
    if not wrong.any():
        return []
    time = trajectory.problem.scale.written(trajectory.time[int(np.argmax(wrong))], "time")
    return [f"from t = {time} on, positions or velocities are not finite numbers (a time step too long?)"]


def _shifted(trajectory: Trajectory, reference: Trajectory) -> list[str]:
    """Whether a shift in time, of all numbers or of the velocities alone, explains the difference."""
    problem = trajectory.problem
    accelerations = [_acceleration(each) for each in (trajectory, reference)]
    of_velocity = time_shift(trajectory.velocity - reference.velocity, 0.5 * sum(accelerations))
    of_position = time_shift(
        trajectory.displacement - reference.displacement, 0.5 * (trajectory.velocity + reference.velocity)
    )
    limit = _STEADY * abs(of_velocity.time)
    if of_velocity.explained < _SHIFTED or of_velocity.uncertainty > limit:
        return []
    if abs(of_position.time) < limit:
        steps = of_velocity.time / problem.timestep
        doubt, side = of_velocity.uncertainty / problem.timestep, "after" if steps > 0.0 else "before"
        shift = f"{abs(steps):.2g} (± {doubt:.1g}) time steps {side} the positions"
        return [f"velocities are those of {shift} (half-step velocities?)"]
    alike = max(abs(of_position.time - of_velocity.time), of_position.uncertainty) < limit
    if of_position.explained < _SHIFTED or not alike:
        return []
    shift, doubt = (problem.scale.written(value, "time", ".2g") for value in (abs(of_position.time), of_position.uncertainty))
    return [f"all frames are shown {shift} (± {doubt}) {'earlier' if of_position.time > 0.0 else 'later'} than they are"]


def _acceleration(trajectory: Trajectory) -> Floats:
    """Acceleration of the beads by the forces of the scene, [frame, chain, bead]."""
    (x, v), problem = trajectory.atoms, trajectory.problem
    return motion.acceleration(problem.system, x, time=trajectory.time, velocity=v)[:, : problem.chains]


def _start(trajectory: Trajectory, unexplained: float) -> list[str]:
    """Whether beads start at other places, or velocities, by more than what forces leave of the motion unexplained."""
    system, scale = trajectory.problem.system, trajectory.problem.scale
    if trajectory.time[0] != 0.0:
        return []
    limit, lines = max(_START, unexplained), []
    x, v, right = trajectory.displacement[0], trajectory.velocity[0], physics.initial_velocity(system)
    for values, scene, what, hint in (
        (x, np.zeros_like(x), "length", "at {} from its place at rest (another gap or static load, or other times?)"),
        (v, right, "velocity", "with velocity {} instead of {}"),
    ):
        chain, bead = np.unravel_index(int(np.argmax(np.abs(values - scene))), x.shape)
        if abs(values[chain, bead] - scene[chain, bead]) > limit:
            numbers = (scale.written(each[chain, bead], what) for each in (values, scene))
            lines.append(f"bead {bead + 1} of chain {chain + 1} starts {hint.format(*numbers)}")
    return lines


def _prescribed(trajectory: Trajectory) -> list[str]:
    """Whether beads of prescribed motion move by another factor, or otherwise, than the scene says."""
    lines = []
    for drive in trajectory.problem.system.motions:
        scene, limit = drive.displacement(trajectory.time), _MOTION * abs(drive.amplitude)
        values = trajectory.displacement[:, drive.chain - 1, drive.bead - 1]
        factor = float(np.sum(values * scene) / np.sum(scene * scene))
        name = f"drive of bead {drive.bead} of chain {drive.chain}"
        if np.max(np.abs(values - scene)) <= limit:
            continue
        if np.max(np.abs(values - factor * scene)) <= limit:
            lines.append(f"the {name} is {factor:.4g} times as large as the scene says")
        else:
            lines.append(f"the {name} has another course over time than the scene says")
    return lines


# --- what they show ---------------------------------------------------------------------------------------------------


def _reason_against(trajectory: Trajectory, reference: Trajectory) -> str:
    """Why the forces on the beads do not follow from the frames; empty if they do."""
    if not trajectory.problem.forces_known:
        return "forces of contacts that yield depend on their past"
    if trajectory.problem.system.inner_mass is not None and (trajectory.inner is None or reference.inner is None):
        return "the motion of the resonators is not recorded"
    if trajectory.frames < LEAST_FRAMES:
        return f"there are {trajectory.frames} frames, of {LEAST_FRAMES} that are needed"
    return ""


def _undetermined(identification: Identification, chains: int) -> str:
    """Why the momentum equations show no cause."""
    unexplained, interpolation = identification.unexplained, identification.interpolation
    line, bead = identification.place
    if interpolation >= TOO_FAR:
        return (
            f"frames too far apart: interpolation between them leaves {interpolation:.0%} of the changes of momentum, "
            f"of {TOO_FAR:.0%} that are allowed (a smaller output.every)"
        )
    if unexplained <= NOISE * interpolation:
        return f"between frames all beads follow the forces of the scene, to {unexplained:.1e} of the changes of momentum"
    if identification.ambiguous:
        return "several factors of forces or masses explain the motion alike"
    return (
        f"the forces of the scene leave {unexplained:.2g} of the changes of momentum unexplained, most at bead "
        f"{bead + 1} of chain {line % chains + 1}, and no factors of one kind explain it"
    )


def _sentence(departure: Departure, scale: Scale) -> str:
    """A departure in words."""
    factor, uncertainty, name = departure.factor, departure.uncertainty, departure.name.replace("_", " ")
    noun = name.split()[0]
    are, do = ("are", "do") if noun.endswith("s") else ("is", "does")
    name = {"beads": "all beads"}.get(name, name if departure.what == "mass" and noun != name else f"the {name}")
    if departure.what == "course":
        return f"{name} has another course over time than the scene says"
    if departure.what == "law":
        left = f"{factor:.3g} times its force leaves {departure.effect:.2g} of the impulses unexplained"
        return f"{name} {do} not follow the law of the scene: {left}"
    if departure.scene == 0.0 and departure.name != HOLDING:
        value = f"{factor:.4g} m/T" if name.endswith("damping") else scale.written(factor, "stiffness", ".4g")
        return f"{name} of {value} is not in the scene"
    factor += departure.name == HOLDING
    adjective = "heavy" if departure.what == "mass" else "strong"
    says = f"{name} {are} {factor:.4g} (± {uncertainty:.1g}) times as {adjective} as the scene says"
    if abs(factor) <= uncertainty and departure.what == "strength":
        says = f"{name} {are} missing"
    if departure.count == 1:
        return says
    several = f"masses of {departure.count} beads differ"
    if departure.what == "strength":
        several = f"{name.removeprefix('the ').split(' between ')[0].split(' at ')[0]} differ{'' if are == 'are' else 's'} at {departure.count} places"
    return f"the {several} from the scene, most of all: {says}"
