"""What a study says, in sentences: which setting for which accuracy, and what else is worth choosing."""

import math

import numpy as np

from lammps_inputs import Problem
from workflow.studies.trade.points import WELL_ABOVE, Findings, Point, cheapest, pareto
from workflow.studies.trade.settings import LAMMPS, RANKS, REFERENCE, WINDOW
from workflow.studies.trade.truth import Truth

ACCURACIES = (1e-2, 1e-4, 1e-6, 1e-8)


def sentences(study: Findings) -> list[str]:
    """Everything that was found, one sentence a line."""
    if study.truth is None:
        return list(study.notes)
    found = [uncertainty(study.truth)]
    found += left_out(study)
    found += [advice(study, study.truth, accuracy) for accuracy in ACCURACIES]
    return found + suzuki(study) + beside(study) + frames(study) + study.notes


def uncertainty(truth: Truth) -> str:
    """The uncertainty of the reference, and which errors are well above it."""
    floor = truth.floors["velocity"]
    return (
        f"Uncertainty of the reference: {floor:.1e} V and {truth.floors['arrival']:.1e} T; errors of velocities below "
        f"{WELL_ABOVE * floor:.1e} V are not well known."
    )


def left_out(study: Findings) -> list[str]:
    """What was not measured, and why, a sentence for each method."""
    said = []
    for name, several in study.by_method().items():
        points = [point for point in several if point.left_out]
        if points:
            more = f", and {len(points) - 1} more" if len(points) > 1 else ""
            said.append(f"Left out: {name}, {points[0].setting.label} ({points[0].left_out}){more}.")
    return said


def advice(study: Findings, truth: Truth, accuracy: float) -> str:
    """Which engine and settings are the fastest that keep an accuracy of all velocities; and in LAMMPS."""
    points = study.comparable
    if not points:
        return f"{accuracy:.0e}: nothing was measured."
    own = [point for point in points if point.setting.method != REFERENCE]
    best, lammps = (cheapest(group, accuracy, truth.floors["velocity"]) for group in (points, own))
    if best is None:
        return f"{accuracy:.0e}: nothing measured reaches it; the nearest is {_says(_nearest(points), study.problem)}."
    said = f"{accuracy:.0e}: {_says(best, study.problem)}"
    if lammps is best or not own:
        return f"{said}."
    if lammps is None:
        nearest = _says(_nearest(own), study.problem)
        return f"{said}; no measured time step of LAMMPS reaches it, the nearest is {nearest}."
    return f"{said}; with LAMMPS {_says(lammps, study.problem)}."


def _nearest(points: list[Point]) -> Point:
    return min(points, key=lambda point: point.errors["velocity"])


def _says(point: Point, problem: Problem) -> str:
    """A setting as a user would ask for it, its error, and its cost."""
    own, scale, ranks = point.setting.problem, problem.scale, point.setting.ranks
    step = f"{_dividing(own.timestep * scale.time, own.steps_per_frame)}"
    if point.setting.method == REFERENCE:
        how = f"{REFERENCE} at a step of {step}{scale.after('time')}"
    else:
        scheme = "" if own.scheme == "verlet" else f"scheme: {own.scheme}, "
        how = f"`{scheme}timestep: {step}`{scale.after('time')}" + (f" on {ranks} ranks" if ranks > 1 else "")
    if own.every > problem.every * (1.0 + 1e-9):
        how += f" and frames {own.every * scale.time:.6g} apart"
    return f"{how} ({point.errors['velocity']:.1e} V, {point.seconds:.2g} s)"


def _dividing(step: float, count: int) -> str:
    """A time step in as few digits as divide the time between frames well enough for a scene."""
    if count == 1:
        return f"{step:.6g}"
    texts = (f"{step:.{digits}g}" for digits in range(2, 17))
    return next((text for text in texts if abs(float(text) / step - 1.0) < 5e-10), repr(step))


def suzuki(study: Findings) -> list[str]:
    """From which error on suzuki4 is faster than Verlet in LAMMPS, as a line through Verlet's points has it."""
    several = study.by_method()
    verlet, suzuki4 = (pareto(several.get(LAMMPS + name, []), "velocity") for name in ("verlet", "suzuki4"))
    x, y = (np.log([(point.errors["velocity"], point.seconds) for point in verlet[::-1]] or [(1.0, 1.0)])).T
    common = [point for point in suzuki4 if x[0] <= math.log(point.errors["velocity"]) <= x[-1]]
    if not common:
        return []
    faster = [math.log(point.seconds) < np.interp(math.log(point.errors["velocity"]), x, y) for point in common]
    count = [*faster[::-1], False].index(False)
    if count:
        found = f"beats Verlet from an error of {common[-count].errors['velocity']:.1e} V on"
    else:
        least = common[-1].errors["velocity"]
        found = f"does not beat Verlet down to an error of {least:.1e} V, the least that both reach here"
    return [f"In LAMMPS suzuki4 {found}, for the {study.problem.chains * study.problem.beads} beads of this scene."]


def beside(study: Findings) -> list[str]:
    """What more ranks and windows gain, and lose."""
    own = [one for one in study.comparable if one.setting.method == f"{LAMMPS}verlet"]
    scene = next((one for one in own if one.setting.problem == study.problem), None)
    said = []
    for method, where in ((RANKS, ""), (WINDOW, " near the front")):
        points = [one for one in study.by_method().get(method, []) if one.measured]
        if not points or scene is None:
            continue
        best = min(points, key=lambda point: point.seconds)
        worse = [name for name, error in best.errors.items() if error > 1.01 * scene.errors[name]]
        errors = "different errors" if best.errors != scene.errors else "the same errors"
        errors = f"larger errors of {', '.join(worse)}" if worse else "no larger errors" if where else errors
        share = best.seconds / scene.seconds
        said.append(f"{best.setting.label} take {share:.2g} of the time of the scene as it is, with {errors}{where}.")
    return said


def frames(study: Findings) -> list[str]:
    """What seldom frames lose."""
    said = []
    for accuracy in (1e-2, 1e-4) if study.frames else ():
        good = [one for one in study.frames if max(one.amplitude_error, one.arrival_error) <= accuracy]
        if good:
            widest = max(good, key=lambda one: one.every)
            said.append(
                f"Frames {widest.every * study.problem.scale.time:.4g} apart show amplitudes and arrivals to "
                f"{accuracy:.0e} ({widest.megabytes:.2g} MB)."
            )
        else:
            said.append(f"No frames measured show amplitudes and arrivals of all beads to {accuracy:.0e}.")
    return said
