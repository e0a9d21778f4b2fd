"""What a study says, in sentences: which setting for which accuracy, and what else is worth choosing."""

import math

from lammps_inputs import Problem
from workflow.runs.engines import LAMMPS, REFERENCE
from workflow.studies.trade import settings, work_precision
from workflow.studies.trade.study import WELL_ABOVE, Findings
from workflow.studies.trade.truth import Truth
from workflow.studies.trade.work_precision import Point, Points

ACCURACIES = (1e-2, 1e-4, 1e-6, 1e-8)


def sentences(study: Findings) -> list[str]:
    """Everything that was found, one sentence a line."""
    truth = study.truth
    if truth is None:
        return list(study.notes)
    found = [uncertainty(study, truth)]
    found += left_out(study)
    found += [advice(study, truth, accuracy) for accuracy in ACCURACIES]
    found += suzuki(study, truth) + ranks(study) + windows(study) + rigid(study) + frames(study)
    return found + study.notes


def uncertainty(study: Findings, truth: Truth) -> str:
    """The uncertainty of the reference, and which errors are not well above it."""
    floor = truth.floors["velocity"]
    near = [point for point in study.engines if point.measured and point.errors["velocity"] < WELL_ABOVE * floor]
    said = f"Uncertainty of the reference: {floor:.1e} V and {truth.floors['arrival']:.1e} T"
    if not near:
        return f"{said}, less than a tenth of every error of velocities."
    return f"{said}; errors of velocities below ten times that, which are not well known, are marked ~."


def advice(study: Findings, truth: Truth, accuracy: float) -> str:
    """Which engine and settings are the cheapest that keep an accuracy of all velocities; and in LAMMPS."""
    floor = truth.floors["velocity"]
    points = study.comparable
    own = [point for point in points if point.setting.curve.startswith(settings.LAMMPS)]
    best, lammps = (
        work_precision.cheapest(group, accuracy, "velocity", "seconds", floor=floor) for group in (points, own)
    )
    if best is None:
        nearest = min(points, key=lambda point: point.errors["velocity"], default=None)
        if nearest is None:
            return f"{accuracy:.0e}: nothing was measured."
        return f"{accuracy:.0e}: nothing measured reaches it; the nearest is {_says(nearest, study.problem)}."
    said = f"{accuracy:.0e}: {_says(best, study.problem)}"
    if lammps is None:
        nearest = min(own, key=lambda point: point.errors["velocity"], default=None)
        least = "" if nearest is None else f", the nearest is {_says(nearest, study.problem)}"
        return f"{said}; no measured time step of LAMMPS reaches it{least}."
    return f"{said}." if lammps is best else f"{said}; with LAMMPS {_says(lammps, study.problem)}."


def _says(point: Point, problem: Problem) -> str:
    """A setting as a user would ask for it, its error, and its cost."""
    job, scale = point.setting.what, problem.scale
    unit = scale.after("time")
    step = _dividing(job.problem.timestep * scale.time, job.problem.steps_per_frame)
    if job.engine == LAMMPS.name:
        scheme = "" if job.problem.scheme == "verlet" else f"scheme: {job.problem.scheme}, "
        how = f"`{scheme}timestep: {step}`{unit}"
        how += f" on {job.ranks} ranks" if job.ranks > 1 else ""
    elif job.engine == REFERENCE.name:
        how = f"reference {job.scheme.name} at a step of {step}{unit}"
    else:
        how = settings.RIGID
    if job.problem.every > problem.every * (1.0 + 1e-9):
        how += f" and frames {job.problem.every * scale.time:.6g} apart"
    return f"{how} ({point.errors['velocity']:.1e} V, {point.cost('seconds'):.2g} s)"


def _dividing(step: float, count: int) -> str:
    """A time step in as few digits as divide the time between frames well enough for a scene."""
    if count == 1:
        return f"{step:.6g}"
    texts = (f"{step:.{digits}g}" for digits in range(2, 17))
    return next((text for text in texts if abs(float(text) / step - 1.0) < 5e-10), repr(step))


def left_out(study: Findings) -> list[str]:
    """What was not measured, and why, a sentence for each method."""
    said = []
    for name, several in study.curves.items():
        points = [point for point in several if point.left_out]
        if points:
            first = points[0]
            more = f", and {len(points) - 1} more" if len(points) > 1 else ""
            said.append(f"Left out: {name}, {first.setting.label} ({first.left_out}){more}.")
    return said


def suzuki(study: Findings, truth: Truth) -> list[str]:
    """From which accuracy on suzuki4 beats Verlet in LAMMPS."""
    floor = WELL_ABOVE * truth.floors["velocity"]
    first, second = (
        work_precision.pairs(study.curves.get(settings.LAMMPS + name, ()), "velocity", "seconds", floor)
        for name in ("suzuki4", "verlet")
    )
    atoms = study.problem.chains * study.problem.beads
    found = _where(work_precision.better_from(first, second))
    return [f"In LAMMPS suzuki4 {found}, for the {atoms} beads of this scene."]


def _where(found: tuple[float, float, float] | None) -> str:
    if found is None:
        return "and Verlet have no error in common here, so it is undetermined which is cheaper"
    start, low, high = found
    if start == 0.0:
        return f"does not beat Verlet down to an error of {low:.1e} V, the least that both reach here"
    if start >= high * (1.0 - 1e-9):
        return f"beats Verlet at all errors that both reach here ({low:.1e} to {high:.1e} V)"
    return f"beats Verlet from an error of {start:.1e} V on downwards"


def ranks(study: Findings) -> list[str]:
    """What more ranks gain."""
    points = _curve(study, f"{settings.LAMMPS}{settings.RANKS}")
    if len(points) < 2:
        return []
    one, best = points[0], min(points, key=lambda point: point.cost("seconds"))
    same = all(point.errors == one.errors for point in points)
    errors = "the errors are the same" if same else "THE ERRORS DIFFER"
    if best is one:
        return [f"More ranks than one make LAMMPS slower here ({_times(points)}); {errors}."]
    return [f"{best.setting.label} take {best.cost('seconds') / one.cost('seconds'):.2g} of the time of one; {errors}."]


def _times(points: Points) -> str:
    return ", ".join(f"{point.setting.label} {point.cost('seconds'):.2g} s" for point in points)


def windows(study: Findings) -> list[str]:
    """What windows gain, and lose, near the front."""
    said = []
    for engine in (settings.LAMMPS, settings.REFERENCE):
        points = _curve(study, f"{engine}{settings.WINDOW}")
        if len(points) < 2 or points[-1].setting.value < study.problem.beads:
            continue
        *narrow, whole = points
        best = min(narrow, key=lambda point: point.cost("seconds"))
        share = best.cost("seconds") / whole.cost("seconds")
        worse = any(best.errors[name] > 1.01 * whole.errors[name] for name in whole.errors)
        lost = f"but leaves an error of {best.errors['velocity']:.1e} V" if worse else "and costs no accuracy"
        said.append(
            f"{engine.strip()}: a window of {best.setting.label} takes {share:.2g} of the time of all "
            f"{study.problem.beads} {lost} near the front."
        )
    return said


def rigid(study: Findings) -> list[str]:
    """What the collision model is worth."""
    points = _curve(study, settings.RIGID)
    if not points:
        return []
    error = points[0].errors
    reached = math.isfinite(error["arrival"])
    late = f"arrivals by {error['arrival']:.2g} T" if reached else "and their pulse does not reach all beads"
    return [
        f"Rigid beads, in {points[0].cost('seconds'):.2g} s, miss velocities by {error['velocity']:.2g} V, amplitudes "
        f"by {error['amplitude']:.2g} V, {late}: another model, not a less accurate one."
    ]


def frames(study: Findings) -> list[str]:
    """What seldom frames lose."""
    said = []
    for accuracy in (1e-2, 1e-4) if study.frames else ():
        good = [one for one in study.frames if max(one.amplitude_error, one.arrival_error) <= accuracy]
        if good:
            widest = max(good, key=lambda one: one.every)
            said.append(
                f"Frames {widest.every * study.problem.scale.time:.4g} apart show amplitudes and arrivals to "
                f"{accuracy:.0e} ({widest.bytes / 1e6:.2g} MB)."
            )
        else:
            said.append(f"No frames measured show amplitudes and arrivals of all beads to {accuracy:.0e}.")
    return said


def _curve(study: Findings, name: str) -> list[Point]:
    return [point for point in study.curves.get(name, ()) if point.measured]
