"""All cells on all cores, each kept when it is done, so that an interrupted report is resumed."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from lammps_inputs import InputError, library
from workflow.studies.extremes.cells import Cell
from workflow.studies.extremes.measure import Outcome
from workflow.studies.study import Study, to_csv
from workflow.workers import evaluate
from workflow.workers.evaluate import key_of
from workflow.workers.pool import Answer, Task

TABLE = "extremes.csv"
STUDY = Study("extremes", f"{TABLE} is the table", tables=(TABLE,), cache="cells.jsonl")

QUICK = 1e7
"""Largest cost of a cell of the quick report: about a second, most of it for starting and judging; see `cost`."""


def make_report(
    cells: Sequence[Cell], directory: Path | None = None, *, progress: evaluate.Progress | None = None
) -> list[Outcome]:
    """Measure what is missing; the outcomes of all cells, in their order.

    Args:
        cells: what to run.
        directory: new, or resumed; None to keep nothing.
        progress: called with the numbers of cells done, of all, and of those that are wrong.

    Raises:
        InputError: the directory cannot be written to.
        RunError: a process died.
    """
    with STUDY.opened(directory) as cache:
        found = evaluate.values(plan(cells), cache, progress=progress, failed=_is_wrong)
        outcomes = [Outcome(**value) for value in found]
        if directory is not None:
            STUDY.write(directory, {TABLE: to_csv(Outcome, outcomes)})
    return outcomes


def plan(cells: Sequence[Cell]) -> list[evaluate.Case]:
    """Their cases, which are computed again when the program changes. Those of several ranks use all cores."""
    program = _program()
    return [
        evaluate.Case(
            key_of([program, asdict(cell)]),
            Task("workflow.studies.extremes.measure:computed", asdict(cell)),
            cost(cell),
            alone=cell.ranks > 1,
        )
        for cell in cells
    ]


def _is_wrong(answer: Answer) -> bool:
    return bool(answer.failed) or answer.value["kind"] == "WRONG"


def cost(cell: Cell) -> float:
    """Bead-steps of a cell or so; 0 if it is refused at once."""
    try:
        scene = library.from_plain(cell.scene, "scene").model_copy(update={"accuracy": None, "window": None})
        steps = scene.problem().steps
    except (InputError, ValueError):
        return 0.0
    return steps * (300.0 + scene.chains * scene.beads)


def _program() -> str:
    """Fingerprint of all that computes or compares."""
    root = Path(__file__).parents[3]
    files = [path for package in ("lammps_inputs", "analysis", "workflow") for path in (root / package).rglob("*.py")]
    return key_of([[path.relative_to(root).as_posix(), path.read_text("utf-8")] for path in sorted(files)])
