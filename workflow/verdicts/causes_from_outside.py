"""What seems to be wrong with what comes from outside: beads that are moved, and forces on beads; `causes` asks."""

import math
from collections import Counter

import numpy as np

from analysis.against import symptoms
from analysis.trajectory import Floats, Trajectory
from lammps_inputs.laws.in_time import HalfSine, Rectangular, Sine, TimeLaw
from lammps_inputs.loads import Load, Motion
from lammps_inputs.units import Scale

_MOTION_DOUBT = 1e-6
"""Share of the amplitude; the motion is given, to rounding."""

_PUSH_DOUBT = 5e-3
"""Share of the impulse; half a step of a force that ends at a frame may be missing there."""


def driven(own: Trajectory) -> list[str]:
    """Whether beads whose motion is given move by another sine."""
    problem, found = own.problem, []
    scale = problem.scale
    for given in problem.system.motions:
        is_at = _off_its_way(own, given)
        if is_at is None:
            continue
        sine = _sine(own.time, is_at, given.omega, _MOTION_DOUBT)
        if sine is not None:
            omega, along, across = sine
            amplitude, phase = math.hypot(along, across), math.atan2(across, along)
            right = given.amplitude * scale.length, given.omega, given.phase
            said = _other_sine("displacement", (amplitude * scale.length, omega, phase), right, scale, _MOTION_DOUBT)
            found += [f"the drive of bead {given.bead} of chain {given.chain} has {said}"] if said else []
    return found


def moved(own: Trajectory) -> list[str]:
    """Whether beads whose motion is given move otherwise."""
    return [
        f"bead {given.bead} of chain {given.chain} does not move as the drive says"
        for given in own.problem.system.motions
        if _off_its_way(own, given) is not None
    ]


def _off_its_way(own: Trajectory, given: Motion) -> Floats | None:
    """Displacement of a bead whose motion is given; None where it moves so."""
    is_at = own.displacement[:, given.chain - 1, given.bead - 1]
    off = np.max(np.abs(is_at - given.displacement(own.time)))
    return None if off < _MOTION_DOUBT * abs(given.amplitude) else is_at


def _sine(time: Floats, values: Floats, near: float, doubt: float) -> tuple[float, float, float] | None:
    """``a sin(omega t) + b (cos(omega t) - 1)`` as omega, a, b; omega as near to one as explains all but a doubt."""

    def fit(omega: float) -> tuple[float, Floats]:
        basis = np.stack([np.sin(omega * time), np.cos(omega * time) - 1.0], axis=-1)
        factors = np.linalg.lstsq(basis, values, rcond=None)[0]
        return float(np.sum((values - basis @ factors) ** 2)), factors

    tried, best = near * np.geomspace(0.5, 2.0, 401), near
    enough = doubt**2 * float(np.sum(values**2))
    for _ in range(9):
        left, (along, across) = fit(best)
        if left <= enough:
            return best, float(along), float(across)
        best = min(tried.tolist(), key=lambda omega: fit(omega)[0])
        tried = best * (tried / tried[200]) ** 0.05
    return None


def _other_sine(
    what: str, found: tuple[float, float, float], right: tuple[float, float, float], scale: Scale, doubt: float
) -> str:
    """What differs of two sines, each its amplitude, angular frequency and phase."""
    turned = math.pi if right[0] < 0.0 else 0.0
    late = math.remainder(found[2] + turned - right[2], 2.0 * math.pi)
    second = 2.0 * math.pi * scale.time
    size_unit, hertz = scale.after(what.replace("displacement", "length")), scale.after("cycles")
    said = [
        f"a {name} of {here:.4g} instead of {there:.4g}{unit}"
        for name, here, there, size, unit in (
            (what, math.copysign(found[0], right[0]), right[0], abs(right[0]), size_unit),
            ("frequency", found[1] / second, right[1] / second, right[1] / second, hertz),
            ("phase", math.degrees(right[2] + late), math.degrees(right[2]), math.degrees(1.0), " degrees"),
        )
        if abs(here - there) > doubt * size and f"{here:.4g}" != f"{there:.4g}"
    ]
    return " and ".join(said)


def pushes(own: Trajectory, reference: Trajectory) -> list[str]:
    """Whether the beads were given another impulse from outside than the scene says."""
    problem, found = own.problem, []
    system = problem.system
    if own.time[0] != 0.0:
        return []
    places = Counter((load.chain, load.bead) for load in system.loads)
    for load in system.loads:
        if places[load.chain, load.bead] > 1:  # which of them is wrong, nobody can tell
            continue
        right = load.impulse(own.time)
        off, method = (symptoms.impulse_given(one, load) - right for one in (own, reference))
        most, furthest = (float(np.max(np.abs(values))) for values in (right, off))
        felt = right + off - method
        if most == 0.0 or np.max(np.abs(felt - right)) < _PUSH_DOUBT * most or furthest < np.max(np.abs(method)):
            continue  # right, or the reference is further off than this
        what = "drive" if load.endless else "push"
        name = f"the {what}" if len(system.loads) == 1 else f"the {what} on bead {load.bead} of chain {load.chain}"
        found.append(f"{name} {_other_push(load, own.time, felt, problem.scale)}")
    return found


def _other_push(load: Load, time: Floats, felt: Floats, scale: Scale) -> str:
    """What is wrong with a push that gave another impulse over time than it should."""

    def fit(law: TimeLaw) -> tuple[float, float]:
        """Factor on the law that explains most, and what is left, as a share."""
        shape = np.asarray(law.impulse(time, *law))  # type: ignore[misc]
        power, total = float(np.sum(shape * shape)), float(np.sum(felt * felt))
        factor = float(np.sum(felt * shape)) / power if power > 0.0 else 0.0
        return factor, float(np.sum((felt - factor * shape) ** 2)) / total if total > 0.0 else 1.0

    law = load.law
    if np.max(np.abs(felt)) < _PUSH_DOUBT * load.law.total:
        return "is missing"
    if isinstance(law, Sine) and (sine := _sine(time, felt, law.omega, _PUSH_DOUBT)) is not None:
        omega, along, across = sine
        there = law.peak * scale.force, law.omega, law.phase
        here = omega * math.hypot(along, across) * scale.force, omega, math.atan2(along, -across)
        if said := _other_sine("force", here, there, scale, _PUSH_DOUBT):
            return f"has {said}"
    factor, left = fit(law)
    if left < _PUSH_DOUBT**2:
        return f"is {factor:.4g} times as strong as the scene says"
    if isinstance(law, HalfSine | Rectangular):
        durations, best = law.duration * np.geomspace(0.1, 10.0, 101), 0.0
        for _ in range(4):  # ever closer around the best
            lefts = [fit(law._replace(duration=duration))[1] for duration in durations.tolist()]
            best = float(durations[int(np.argmin(lefts))])
            durations = best * (durations / durations[50]) ** 0.05
        factor, left = fit(law._replace(duration=best))
        if left < _PUSH_DOUBT**2:
            lasts, given = (scale.written(time, "time", ".4g") for time in (best, law.duration))
            said = f"lasts {lasts} instead of {given}"
            if abs(factor - 1.0) < _PUSH_DOUBT:
                return said
            found, peak = (scale.written(force, "force", ".4g") for force in (factor * law.peak, law.peak))
            return f"{said}, and its peak is {found} instead of {peak}"
    return "has another course over time than the scene says"
