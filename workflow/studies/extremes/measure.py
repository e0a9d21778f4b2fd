"""Run one cell for real, in a directory of its own, and find out how it ended, as one of `KINDS`.

The true error of a run is found by a reference that is finer than the one the run was checked with: every frame of
every bead is compared. Where the reference would take too long for that, what is left is the leading pulse, which a
window finds, and the invariants: they prove an error of at least so much.
"""

import math
import tempfile
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from analysis.against.common_times import paired
from analysis.against.difference import Difference
from analysis.conservation import Conservation
from analysis.tracking.leading_waves import Waves, leading_waves
from analysis.tracking.peaks import THRESHOLD, PeakFinder
from lammps_inputs import InputError, Problem, library, physics
from lammps_inputs.layout import Layout
from lammps_inputs.scene import DEFAULT_ACCURACY
from workflow.engines.lammps import engine, hosted
from workflow.engines.reference import engine as reference_engine
from workflow.engines.reference.passages import passages, usual_timestep
from workflow.engines.reference.schemes import BLANES_MOAN
from workflow.engines.reference.step_halving import StepHalving
from workflow.errors import RunError
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.studies.extremes.cells import Cell, scaled
from workflow.verdicts.validate import TOLERANCES

# --- true error -------------------------------------------------------------------------------------------------------

LONGEST = 8.0
"""Seconds that a comparison may take, as estimated."""

_BEAD_STAGE = 1.5e-9
_STAGE = 20e-9
"""Seconds of the reference's kernel for a stage of a bead, and of a step beyond its beads."""

_HALVINGS = 4
_WINDOW = 160
_CLEAR = 2.0 * THRESHOLD
_SLOPE = 0.826
"""Steepest slope of a solitary wave's velocity over its peak to the power 1.2: what is late by a time is off by this
times it."""


@dataclass(frozen=True)
class TrueError:
    """The largest error, its uncertainty (units of V), and how it was found."""

    error: float
    uncertainty: float
    by: str


def true_error(directory: RunDirectory, tolerance: float, *, longest: float = LONGEST) -> TrueError:
    """The largest error of any velocity.

    Args:
        directory: a run that came to its end.
        tolerance: wanted uncertainty, in units of V, as far as the time allows.
        longest: seconds that one comparison may take.
    """
    problem = replace(directory.problem, window=None)  # all rows, whatever the run had
    steps = 2 * reference_engine.default_steps_per_frame(problem)
    if _seconds(problem, steps) > longest:
        return _by_leading_pulse(directory)
    for _ in range(_HALVINGS):
        truth = _by_reference(directory, problem, steps)
        if truth.uncertainty <= tolerance or _seconds(problem, 2 * steps) > longest:
            break
        steps *= 2
    return truth


def _seconds(problem: Problem, steps_per_frame: int) -> float:
    """About what two reference runs side by side take, one with half the steps; a pulse passes a bead in T or so."""
    kicked = [bead for _, bead, _ in physics.excitations(problem.system)]
    rows = min(problem.beads, max(kicked) - min(kicked) + 1 + 0.5 * problem.duration)
    steps = 1.5 * problem.frames * steps_per_frame
    return steps * BLANES_MOAN.forces_per_step * (rows * problem.chains * _BEAD_STAGE + _STAGE)


def _by_reference(directory: RunDirectory, problem: Problem, steps_per_frame: int) -> TrueError:
    halving = StepHalving(problem, steps_per_frame=steps_per_frame)
    difference = Difference(dict.fromkeys(("velocity", "displacement", "amplitude", "arrival"), math.inf))
    references = (replace(block, problem=directory.problem) for block in halving.blocks())
    for block, reference in paired(directory.blocks(), references):
        difference.add(block, reference)
    return TrueError(difference.deviations()["velocity"].largest, halving.uncertainty.velocity, "reference")


def _by_leading_pulse(directory: RunDirectory) -> TrueError:
    problem = replace(directory.problem, window=None)
    finder, conservation = PeakFinder(first_only=True), Conservation()
    for block in directory.blocks():
        finder.add(block)
        conservation.add(block)
    own = leading_waves(finder.result())
    right = [_passages(problem, refinement) for refinement in (2.0, 1.0)]
    invariants = (conservation.energy_drift / 2.0, conservation.momentum_drift)  # NaN where not all is recorded
    error = float(np.nanmax([_apart(own, right[0]), *invariants]))
    return TrueError(error, 3.0 * _apart(*right), "leading pulse")


def _passages(problem: Problem, refinement: float) -> Waves:
    kicked = [bead for _, bead, _ in physics.excitations(problem.system)]
    window = min(problem.beads + 30, max(kicked) - min(kicked) + _WINDOW)
    return passages(problem, window=window, timestep=usual_timestep(problem) / refinement).waves


def _apart(one: Waves, other: Waves) -> float:
    """Largest difference of two leading pulses, as one of velocities; inf if they have no bead in common.

    Left out, as in `analysis.against.difference.matched`, are the foremost bead, which may fly off, and the smallest
    pulses.
    """
    place = [
        {
            (int(c), int(b)): k
            for k, (c, b, v) in enumerate(zip(w.chain, w.bead, w.peak_velocity, strict=True))
            if v > _CLEAR
        }
        for w in (one, other)
    ]
    both = sorted(place[0].keys() & place[1].keys())
    foremost = max((bead for _, bead in both), default=0)
    i, j = ([known[key] for key in both if key[1] < foremost] for known in place)
    late = _SLOPE * one.peak_velocity[i] ** 1.2 * np.abs(one.arrival[i] - other.arrival[j])
    peaks = np.abs(one.peak_velocity[i] - other.peak_velocity[j])
    return float(np.max(np.fmax(peaks, late), initial=0.0)) if i else math.inf


# --- measure ----------------------------------------------------------------------------------------------------------

KINDS = ("RIGHT", "REPORTED", "REFUSED", "STOPPED", "WRONG")
"""In words:

- RIGHT: the largest error of any velocity is what was asked for, or less;
- REPORTED: it is more, and the run says so itself;
- REFUSED: nothing was run, and one line says why;
- STOPPED: the run ended itself, and one line says why;
- WRONG: none of these. The run came to its end and let its user believe more than is true, or it crashed.
"""

TRUE_WITHIN = 1.5
"""The error that a run reports is right if the true error is no larger than this times it. A run compares frames 0.4 T
apart, which may miss the largest error of a wave by 7%, and more of a faster mode, of which it meets four phases.
"""

LEAST_ERROR = 1e-8
"""Smaller errors are not distinguished, in units of V."""


@dataclass(frozen=True)
class Reported:
    """What a run says of its velocities, in units of V: their largest error, and its uncertainty."""

    error: float
    uncertainty: float


@dataclass(frozen=True)
class Outcome:
    """One cell of the report.

    Attributes:
        axis, value: which cell.
        kind: one of `KINDS`.
        why: in words, what the kind rests on.
        asked: largest error that was asked for, in units of V.
        error, uncertainty: a `TrueError`; None where no run was completed.
        reported, reported_uncertainty: by the run itself.
        compared_with: "reference", or "leading pulse" where all beads were too many.
        steps: time steps of the run.
        seconds: what running and judging took.
    """

    axis: str
    value: str
    kind: str
    why: str
    asked: float
    error: float | None = None
    uncertainty: float | None = None
    reported: float | None = None
    reported_uncertainty: float | None = None
    compared_with: str | None = None
    steps: int | None = None
    seconds: float = 0.0


def classify(asked: float, reported: Reported | None, truth: TrueError) -> tuple[str, str]:
    """Kind and reason of a run that came to its end. NaN counts as an infinite error.

    Args:
        asked: largest error that was asked for, in units of V.
        reported: by the run itself; None without a check.
        truth: what is true of it.
    """
    if reported is not None:
        most = TRUE_WITHIN * (reported.error + reported.uncertainty) + LEAST_ERROR
        if most < truth.error - truth.uncertainty or (truth.error != truth.error and most == most):
            return (
                "WRONG",
                f"reports {reported.error:.1e} V (uncertainty {reported.uncertainty:.1e}), is {truth.error:.1e} V",
            )
    if truth.error <= asked:
        return "RIGHT", ""
    if reported is not None and not reported.error + reported.uncertainty <= asked:
        return "REPORTED", f"more than {asked:.0e} V, and reports it"
    return "WRONG", f"is {truth.error:.1e} V, more than {asked:.0e} V, and does not report it"


PROMISED = TOLERANCES["velocity"]
"""Largest error, in units of V, that a run with a `timestep` of its own has without a remark."""

SHARPER = 10.0
"""Part of the error asked for, and of that reported, which the uncertainty of the reference must not exceed."""


def computed(**cell: Any) -> dict[str, Any]:
    """`measure` for the worker pool."""
    return asdict(measure(Cell(**cell)))


def measure(cell: Cell) -> Outcome:
    """Run a cell and compare it. Whatever happens, an outcome comes back, unless it is interrupted.

    LAMMPS runs in this process where the cell names a diameter, so such a cell is for a worker process.
    """
    if cell.diameter is None:
        return _measure(cell)
    usual = Layout.diameter
    try:
        # the motion does not depend on the diameter in LAMMPS, the digits of positions do; no scene can ask for it
        Layout.diameter = property(lambda _: cell.diameter)  # type: ignore[assignment, method-assign]
        return _measure(cell)
    finally:
        Layout.diameter = usual  # type: ignore[method-assign]


def _measure(cell: Cell) -> Outcome:
    started = time.perf_counter()
    outcome = Outcome(cell.axis, cell.value, "WRONG", "", PROMISED)
    with tempfile.TemporaryDirectory(prefix="granchain-extremes-") as folder:
        try:
            outcome = _run_and_compare(cell, Path(folder), outcome)
        except Exception as error:  # its user would see a traceback, or no reference can be computed
            outcome = replace(outcome, why=" ".join(f"crashed: {type(error).__name__}: {error}".split()))
    return replace(outcome, seconds=time.perf_counter() - started)


def _run_and_compare(cell: Cell, folder: Path, outcome: Outcome) -> Outcome:
    path = folder / "run"
    try:
        scene = library.from_plain(cell.scene, "scene")
        promised = DEFAULT_ACCURACY if scene.timestep is None else PROMISED
        outcome = replace(outcome, asked=scene.accuracy or promised)
        # LAMMPS in this process has the diameter of this process
        lammps = engine.run if cell.diameter is None else hosted.run
        done = run(scene, path, ranks=cell.ranks, force=cell.force, lammps=lammps)
    except InputError as error:
        if path.exists():  # too late
            raise
        return replace(outcome, kind="REFUSED", why=str(error))
    except RunError as error:
        return replace(outcome, kind="STOPPED", why=str(error))
    if done.outcome != "done":
        raise KeyboardInterrupt
    reported = None if done.check is None else Reported(done.check.velocity, done.check.reference.velocity)
    sharp = min(outcome.asked, outcome.asked if reported is None else max(reported.error, LEAST_ERROR))
    truth = true_error(done.directory, sharp / SHARPER)
    kind, why = classify(outcome.asked, reported, truth)
    fault = _fault(cell, done.directory, folder)
    return replace(
        outcome,
        kind=kind if fault is None else "WRONG",
        why=why if fault is None else fault,
        error=truth.error,
        uncertainty=truth.uncertainty,
        reported=None if reported is None else reported.error,
        reported_uncertainty=None if reported is None else reported.uncertainty,
        compared_with=truth.by,
        steps=done.directory.problem.steps,
    )


def _fault(cell: Cell, directory: RunDirectory, folder: Path) -> str | None:
    """What else must hold in this cell, and does not."""
    found = None
    if cell.ranks > 1:
        found = _differs_from_one_rank(directory, folder / "one")
    if cell.scaling and found is None:
        found = _differs_from_scaled(cell, directory, folder / "scaled")
    if cell.drift and found is None:
        found = _drifts(directory)
    return found


def _differs_from_one_rank(directory: RunDirectory, path: Path) -> str | None:
    one = run(directory.scene, path, check=False).directory
    for own, other in paired(directory.blocks(), one.blocks()):
        if not (np.array_equal(own.displacement, other.displacement) and np.array_equal(own.velocity, other.velocity)):
            return f"differs from one rank between t = {own.time[0]:g} and {own.time[-1]:g}"
    return None


def _differs_from_scaled(cell: Cell, directory: RunDirectory, path: Path) -> str | None:
    """Compare in the scenes' own units, so that these are compared too."""
    # to V = 1; beads of a material at most ten times faster, for none is kicked faster than its sound
    factor = 1.0 / directory.scene.scale.velocity if directory.scene.material is None else 10.0
    one = run(library.from_plain(scaled(cell.scene, factor), "scene"), path, check=False).directory
    own_unit, unit = directory.scene.scale, one.scene.scale
    worst = 0.0
    for own, other in paired(directory.blocks(), one.blocks()):
        time = own.time * (own_unit.time / unit.time * factor**-0.2) - other.time
        displacement = own.displacement * (own_unit.length / unit.length * factor**0.8) - other.displacement
        velocity = own.velocity * (own_unit.velocity / unit.velocity * factor) - other.velocity
        worst = max(worst, *(float(np.max(np.abs(part))) for part in (time, displacement, velocity)))
    # positions are rounded in every step of both runs, and frequencies are below 3
    problem = directory.problem
    rounding = 6.0 * problem.steps * float(np.spacing(problem.beads * problem.layout.spacing))
    return None if worst <= rounding else f"differs from the scaled run by {worst:.1e}"


def _drifts(directory: RunDirectory) -> str | None:
    problem = directory.problem
    halves = (Conservation(), Conservation())
    middle = 0.5 * problem.duration
    for block in directory.blocks():
        split = int(np.searchsorted(block.time, middle))
        for half, part in zip(halves, (block[:split], block[split:]), strict=True):
            if part.frames:
                half.add(part)
    first, second = (half.energy_drift for half in halves)
    # rounding of positions does work on contacts whose force is below 1
    rounding = (
        problem.steps * float(np.spacing(problem.beads * problem.layout.spacing)) / physics.energy(problem.system)
    )
    return None if second <= 1.1 * first + rounding else f"the energy drifts: off by {first:.1e}, then by {second:.1e}"
