"""Run scenes at the extremes of every number and check that errors are reported.

All cells are run on all cores, and each result is stored when it is computed, so that an interrupted report is resumed.
A cell is run in a directory of its own, and ends as one of `KINDS`. The true error of a run is measured against a
reference with smaller steps than the one the run was checked with: every frame of every bead is compared.
"""

import argparse
import math
import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from granchain import InputError, RunError, Scene
from granchain.parts import (
    DEFAULT_ACCURACY,
    Problem,
    RunDirectory,
    StepHalving,
    Study,
    computations,
    difference,
    engine,
    library,
    motion,
    paired,
    physics,
    quantity,
    run,
    screen,
    validate,
)
from workflow.plugins.extremes.cells import PARTS, ReportRun, grid, refuse_unknown, scaled

# --- true error -------------------------------------------------------------------------------------------------------

LONGEST = 8.0
"""Largest estimated time of a refinement of the reference, in s."""

_BEAD_STAGE = 1.5e-9
_STAGE = 20e-9
"""Times of the reference's kernel in s: for a stage of a bead, and for a stage without its beads."""

_HALVINGS = 4


class LargestError(NamedTuple):
    """The largest error of any velocity, and its uncertainty, in units of V."""

    value: float
    uncertainty: float


def true_error(directory: RunDirectory, tolerance: float) -> LargestError:
    """Largest error of a completed run.

    Args:
        directory: run directory.
        tolerance: required uncertainty in units of V; a larger one is accepted where a smaller one takes too long.
    """
    problem = replace(directory.problem, rows=directory.problem.rows.near_front(None))  # all rows, whatever the run had
    steps = 2 * engine.default_steps_per_frame(problem)
    for _ in range(_HALVINGS):
        halving = StepHalving(problem, steps_per_frame=steps)
        references = (replace(block, problem=directory.problem) for block in halving.blocks())
        error = difference.errors_of(directory.blocks(), references)["velocity"].largest
        steps *= 2
        if halving.uncertainty.velocity <= tolerance or _seconds(problem, steps) > LONGEST:
            break
    return LargestError(error, halving.uncertainty.velocity)


def _seconds(problem: Problem, steps_per_frame: int) -> float:
    """Estimated time in s of two simultaneous reference runs, one with half the steps; a pulse takes about T a bead."""
    kicked = [bead for _, bead, _ in physics.excitations(problem.system)]
    rows = min(problem.beads, max(kicked) - min(kicked) + 1 + 0.5 * problem.duration)
    steps = 1.5 * problem.frames * steps_per_frame
    return steps * engine.FORCES_PER_STEP * (rows * problem.chains * _BEAD_STAGE + _STAGE)


# --- measure ----------------------------------------------------------------------------------------------------------

KINDS = ("RIGHT", "REPORTED", "REFUSED", "STOPPED", "WRONG")
"""Kinds of outcomes:

- RIGHT: the largest error of any velocity is the requested one, or less;
- REPORTED: the error is larger, and the run reports it;
- REFUSED: nothing was run, and one line says why;
- STOPPED: the run ended early, and one line says why;
- WRONG: none of these: the run was completed with an error larger than reported, or it crashed.
"""

TRUE_WITHIN = 1.5
"""Largest ratio of the true to the reported error of a run that counts as right. A run compares frames 0.4 T apart,
which may miss the largest error of a wave by 7%, and more of a faster mode, of which it samples four phases.
"""

LEAST_ERROR = 1e-8
"""Least error that is distinguished from 0, in units of V."""


@quantity.result
class RunOutcome:
    """Outcome of one cell of the report; errors are the largest of any velocity."""

    axis: str = quantity.declare("quantity at an extreme", digits="")
    value: str = quantity.declare("value of this quantity", digits="")
    kind: str = quantity.declare("one of RIGHT, REPORTED, REFUSED, STOPPED, WRONG", digits="", head="ends")
    why: str = quantity.declare("reason for the kind")
    asked: float = quantity.declare("largest error that was requested", "V", digits=".1e")
    error: float | None = quantity.declare(
        "error against a more accurate reference", "V", "no run was completed", digits=".1e", default=None
    )
    uncertainty: float | None = quantity.declare("uncertainty of this error", "V", "no run was completed", default=None)
    reported: float | None = quantity.declare(
        "error that the run reports", "V", "no run was completed", digits=".1e", default=None
    )
    reported_uncertainty: float | None = quantity.declare(
        "uncertainty of the reported error",
        "V",
        "no run was completed",
        digits=".1e",
        head="uncertainty",
        default=None,
    )
    steps: int | None = quantity.declare("time steps", "", "no run was completed", digits=",d", default=None)
    seconds: float = quantity.declare("time of the run and its comparison", "s", digits=".1f", default=0.0)


def classify(accuracy: float, reported: LargestError, truth: LargestError) -> tuple[str, str]:
    """Kind of a completed run, and its reason. NaN counts as an infinite error.

    Args:
        accuracy: largest error that was requested, in units of V.
        reported: error reported by the run.
        truth: error against a more accurate reference.
    """
    bound = TRUE_WITHIN * sum(reported) + LEAST_ERROR
    if bound < truth.value - truth.uncertainty or (math.isnan(truth.value) and not math.isnan(bound)):
        says = f"{reported.value:.1e} V (uncertainty {reported.uncertainty:.1e})"
        return "WRONG", f"reports {says}, is {truth.value:.1e} V"
    if truth.value <= accuracy:
        return "RIGHT", ""
    if not sum(reported) <= accuracy:
        return "REPORTED", f"more than {accuracy:.0e} V, and reports it"
    return "WRONG", f"is {truth.value:.1e} V, more than {accuracy:.0e} V, and does not report it"


PROMISED = validate.TOLERANCES["velocity"]
"""Largest error, in units of V, that a run with a `timestep` of its own has without a remark."""

SHARPER = 10.0
"""Least ratio of the requested error, and of the reported one, to the uncertainty of the reference."""


def computed(**cell: Any) -> dict[str, Any]:
    """Outcome of a cell as plain data, for the worker pool (see `measure`)."""
    return asdict(measure(ReportRun(**cell)))


def measure(cell: ReportRun) -> RunOutcome:
    """Run a cell and compare it with the reference; any exception but an interruption becomes an outcome."""
    started = time.perf_counter()
    outcome = RunOutcome(cell.axis, cell.value, "WRONG", "", PROMISED)
    with tempfile.TemporaryDirectory(prefix="granchain-extremes-") as folder:
        try:
            outcome = _run_and_compare(cell, Path(folder), outcome)
        except Exception as error:  # its user would see a traceback, or no reference can be computed
            outcome = replace(outcome, why=" ".join(f"crashed: {type(error).__name__}: {error}".split()))
    return replace(outcome, seconds=time.perf_counter() - started)


def _run_and_compare(cell: ReportRun, folder: Path, outcome: RunOutcome) -> RunOutcome:
    path = folder / "run"
    try:
        scene = library.from_plain(cell.scene, "scene")
        promised = DEFAULT_ACCURACY if scene.timestep is None else PROMISED
        outcome = replace(outcome, asked=scene.accuracy or promised)
        done = run(scene, path, ranks=cell.ranks, force=cell.force)
    except InputError as error:
        if path.exists():  # too late
            raise
        return replace(outcome, kind="REFUSED", why=str(error))
    except RunError as error:
        return replace(outcome, kind="STOPPED", why=str(error))
    if done.outcome != "done" or done.check is None:
        raise KeyboardInterrupt
    reported = LargestError(done.check.velocity, done.check.reference.velocity)
    truth = true_error(done.directory, min(outcome.asked, max(reported.value, LEAST_ERROR)) / SHARPER)
    kind, why = classify(outcome.asked, reported, truth)
    fault = _fault(cell, done.directory, folder)
    return replace(
        outcome,
        kind=kind if fault is None else "WRONG",
        why=why if fault is None else fault,
        error=truth.value,
        uncertainty=truth.uncertainty,
        reported=reported.value,
        reported_uncertainty=reported.uncertainty,
        steps=done.directory.problem.steps,
    )


def _fault(cell: ReportRun, directory: RunDirectory, folder: Path) -> str | None:
    """Violation of a further requirement of the cell; None if there is none."""
    if cell.ranks > 1 and (off := _apart(directory, directory.scene, folder / "one")):
        return f"differs from one rank by {off:.1e}"
    if cell.scaling:
        # to V = 1; beads of a material at most ten times faster, for none is kicked faster than its sound
        factor = 1.0 / directory.scene.scale.velocity if not directory.scene.scale.si else 10.0
        off = _apart(directory, library.from_plain(scaled(cell.scene, factor), "scene"), folder / "scaled", factor)
        if not off <= 6.0 * _rounding(directory.problem):  # in both runs, and frequencies are below 3
            return f"differs from the scaled run by {off:.1e}"
    return _drifts(directory) if cell.drift else None


def _apart(directory: RunDirectory, other: Scene, path: Path, factor: float = 1.0) -> float:
    """Largest difference from the run on one rank of a scene whose kicks are larger by a factor.

    Values are compared in the units of the scenes, so that the units are compared, too.
    """
    other_run = run(other, path, check=False).directory
    units, worst = (directory.scene.scale, other_run.scene.scale), 0.0
    for pair in paired(directory.blocks(), other_run.blocks()):
        for name, unit, power in (
            ("time", "time", -0.2),
            ("displacement", "length", 0.8),
            ("velocity", "velocity", 1.0),
        ):
            ratio = getattr(units[0], unit) / getattr(units[1], unit) * factor**power
            values, scaled_copy = (getattr(block, name) for block in pair)
            worst = float(np.max(np.abs(values * ratio - scaled_copy), initial=worst))
    return worst


def _drifts(directory: RunDirectory) -> str | None:
    problem = directory.problem
    energy, first, second = physics.energy(problem.system), 0.0, 0.0
    for block in directory.blocks():
        split = int(np.searchsorted(block.time, 0.5 * problem.duration))
        drift = np.abs(motion.energy(problem.system, *block.atoms) / energy - 1.0)
        first = float(np.max(drift[:split], initial=first))
        second = float(np.max(drift[split:], initial=second))
    # rounding of positions does work on contacts whose force is below 1
    rounding = _rounding(problem) / energy
    return None if second <= 1.1 * first + rounding else f"the energy drifts: off by {first:.1e}, then by {second:.1e}"


def _rounding(problem: Problem) -> float:
    """Rounding of LAMMPS's positions, summed over all steps."""
    return problem.steps * float(np.spacing(problem.beads * problem.layout.spacing))


# --- report -----------------------------------------------------------------------------------------------------------

TABLE = "extremes.csv"
STUDY = Study("extremes", f"{TABLE} is the table", tables=(TABLE,), cache="cells.jsonl")

QUICK = 1e7
"""Largest cost of a cell of the quick report, see `cost`: about a second, most of it for its start and comparison."""


def plan(cells: Sequence[ReportRun]) -> list[computations.Computation]:
    """Cases of cells, which are computed again when the program changes; those of several ranks use all cores."""
    program = _program()
    return [
        computations.case(
            f"{__name__}:computed",
            asdict(cell),
            key=computations.key_of([program, asdict(cell)]),
            cost=cost(cell),
            alone=cell.ranks > 1,
        )
        for cell in cells
    ]


def cost(cell: ReportRun) -> float:
    """Approximate number of bead-steps of a cell; 0 if its scene is refused."""
    try:
        scene = library.from_plain(cell.scene, "scene").model_copy(update={"accuracy": None, "window": None})
        steps = scene.problem().steps
    except (InputError, ValueError):
        return 0.0
    return steps * (300.0 + scene.chains * scene.beads)


def _program() -> str:
    """Checksum of the program's modules."""
    root = Path(__file__).parents[3]
    files = [path for package in ("lammps_inputs", "analysis", "workflow") for path in (root / package).rglob("*.py")]
    return computations.key_of([[path.relative_to(root).as_posix(), path.read_text("utf-8")] for path in sorted(files)])


def carry_out(parts: Sequence[str], directory: Path | None, *, quick: bool) -> list[RunOutcome]:
    """Run what is missing of the report, on all cores.

    Args:
        parts: names of its parts; none for all.
        directory: made if need be, or resumed; None writes nothing.
        quick: whether only cells are run that take about a second.

    Raises:
        InputError: there is no such part, or the directory cannot be used.
        RunError: a process was killed.
    """
    refuse_unknown(parts, "extremes")
    chosen = [cell for cell in grid(parts) if not quick or cost(cell) <= QUICK]
    with STUDY.evaluating(directory) as values:
        results = values(plan(chosen), failed=lambda result: bool(result.failed) or result.value["kind"] == "WRONG")
        outcomes = [RunOutcome(**value) for value in results]
        if directory is not None:
            STUDY.write(directory, {TABLE: (RunOutcome, outcomes)})
    return outcomes


# --- command ----------------------------------------------------------------------------------------------------------

EXAMPLES = (
    "extremes --quick",
    "extremes losses loads",
    "extremes -o extremes      # the same command resumes",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("parts", metavar="PART", nargs="*", help=f"of {', '.join(PARTS)} (default all)")
    parser.add_argument(
        "-o", "--output", metavar="DIR", type=Path, help="new directory, or one to resume: table, cells"
    )
    parser.add_argument("--quick", action="store_true", help="only the cells that take about a second")


def execute(arguments: argparse.Namespace) -> int:
    """Run what is missing, print a table; exit code 1 if a cell is silently wrong."""
    outcomes = carry_out(arguments.parts, arguments.output, quick=arguments.quick)
    title = "largest error of any velocity (V), against a more accurate reference"
    STUDY.print_records(title, RunOutcome, outcomes)
    for outcome in outcomes:
        if outcome.kind in ("REFUSED", "STOPPED", "WRONG"):
            print(f"{outcome.kind} {outcome.axis} {outcome.value}: {outcome.why}")
    counts = {kind: sum(outcome.kind == kind for outcome in outcomes) for kind in KINDS}
    print(f"{len(outcomes)} cells: " + ", ".join(f"{number} {kind}" for kind, number in counts.items()))
    if arguments.output is not None:
        screen.print_files(arguments.output, STUDY.files)
    return 1 if counts["WRONG"] else 0
