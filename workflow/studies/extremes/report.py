"""All cells on all cores, each kept when it is done, so that an interrupted report is resumed."""

import hashlib
import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path

from lammps_inputs import InputError, library
from workflow.formats import figure_files
from workflow.runs.study_directory import study_directory
from workflow.runs.whole_files import write_figure, write_text
from workflow.studies.extremes.cells import Cell
from workflow.studies.extremes.outcome import KINDS, Outcome
from workflow.studies.lines import to_csv
from workflow.workers.pool import Pool, Task
from workflow.workers.results import Results, key_of

CELLS = "cells.jsonl"

Progress = Callable[..., None]

QUICK = 1e7
"""Largest cost of a cell of the quick report: about a second, most of it for starting and judging; see `cost`."""


def make_report(
    cells: Sequence[Cell], directory: Path | None = None, *, progress: Progress | None = None
) -> list[Outcome]:
    """Measure what is missing; the outcomes of all cells, in their order.

    Args:
        cells: what to run.
        directory: made, or gone on with; None to keep nothing.
        progress: called with the numbers of cells done, of all, and of those that are wrong.

    Raises:
        InputError: the directory cannot be written to.
        RunError: a process died.
    """
    if directory is None:
        return _measured(cells, Results(None), progress)
    files = (CELLS, "extremes.csv", *figure_files("extremes"))
    with (
        study_directory(directory, "extremes", files, result="extremes.csv is the table"),
        Results(directory / CELLS) as kept,
    ):
        outcomes = _measured(cells, kept, progress)
        from workflow.studies.extremes.figure import extremes_figure  # matplotlib takes a while to import

        write_text(directory / "extremes.csv", to_csv(Outcome, outcomes))
        write_figure(directory, "extremes", extremes_figure(outcomes))
    return outcomes


def _measured(cells: Sequence[Cell], kept: Results, progress: Progress | None) -> list[Outcome]:
    """Outcomes of all cells. Those with several ranks have the cores to themselves, when the others are done."""
    program = _program()
    keys = [key_of([program, asdict(cell)]) for cell in cells]
    missing = {key: cell for key, cell in zip(keys, cells, strict=True) if key not in kept}
    done = len(cells) - len(missing)
    for alone in (False, True):
        # the longest first, so that no core is left with one long cell at the end
        some = sorted((one for one in missing.items() if (one[1].ranks > 1) == alone), key=lambda one: -cost(one[1]))
        tasks = ((key, Task("workflow.studies.extremes.measure:computed", asdict(cell))) for key, cell in some)
        with Pool(1 if alone else None, interrupt=True) as pool:
            for key, outcome in pool.values(tasks):
                kept.keep(key, outcome)
                done += 1
                if progress is not None:
                    progress(done, len(cells), sum(kept[key]["kind"] == "WRONG" for key in keys if key in kept))
    return [Outcome(**kept[key]) for key in keys]


def cost(cell: Cell) -> float:
    """Bead-steps of a cell or so; 0 if it is refused at once."""
    try:
        scene = library.from_plain(cell.scene, "scene").model_copy(update={"accuracy": None, "window": None})
        steps = scene.problem().steps
    except (InputError, ValueError):
        return 0.0
    return steps * (300.0 + scene.chains * scene.beads)


def _program() -> str:
    """Fingerprint of all that computes or judges."""
    root = Path(__file__).parents[3]
    digest = hashlib.sha256()
    for package in ("lammps_inputs", "analysis", "workflow"):
        for path in sorted((root / package).rglob("*.py")):
            digest.update(f"{path.relative_to(root)}\n".encode() + path.read_bytes())
    return digest.hexdigest()


def counts(outcomes: Sequence[Outcome]) -> dict[str, int]:
    """How many there are of each kind."""
    found = Counter(outcome.kind for outcome in outcomes)
    return {kind: found[kind] for kind in KINDS}


def written(number: float | None) -> str:
    """An error as it is shown: two digits, or a dash."""
    return "-" if number is None or math.isnan(number) else f"{number:.1e}"
