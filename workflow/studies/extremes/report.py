"""The whole grid: cells on all cores, each a file when it is done, so that a report goes on where it stopped."""

import hashlib
import json
import math
import multiprocessing
import os
import re
import signal
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict
from pathlib import Path

from lammps_inputs import InputError, library
from workflow.engines.lammps.mpi import cores
from workflow.errors import RunError
from workflow.formats import figure_files
from workflow.runs.own_files import claim
from workflow.runs.whole_files import write_figure, write_json, write_text
from workflow.studies.extremes.cells import Cell
from workflow.studies.extremes.measure import measure
from workflow.studies.extremes.outcome import KINDS, Outcome
from workflow.studies.lines import to_csv
from workflow.studies.spawned import SpawnPool

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
    kept = _Kept(directory)
    done = {k: outcome for k, cell in enumerate(cells) if (outcome := kept.read(cell)) is not None}
    for k, outcome in _measured([(k, cell) for k, cell in enumerate(cells) if k not in done]):
        done[k] = outcome
        kept.write(cells[k], outcome)
        if progress is not None:
            progress(len(done), len(cells), sum(found.kind == "WRONG" for found in done.values()))
    outcomes = [done[k] for k in range(len(cells))]
    if directory is not None:
        from workflow.studies.extremes.figure import extremes_figure  # matplotlib takes a while to import

        write_text(directory / "extremes.csv", to_csv(Outcome, outcomes))
        write_figure(directory, "extremes", extremes_figure(outcomes))
    return outcomes


def cost(cell: Cell) -> float:
    """Bead-steps of a cell or so; 0 if it is refused at once."""
    try:
        scene = library.from_plain(cell.scene, "scene").model_copy(update={"accuracy": None, "window": None})
        steps = scene.problem().steps
    except (InputError, ValueError):
        return 0.0
    return steps * (300.0 + scene.chains * scene.beads)


def _measured(wanted: list[tuple[int, Cell]]) -> Iterator[tuple[int, Outcome]]:
    """Outcomes as they come. Cells with several ranks have the cores to themselves, when the others are done."""
    # the longest first, so that no core is left with one long cell at the end
    alone, shared = ([(k, cell) for k, cell in wanted if (cell.ranks > 1) == several] for several in (True, False))
    shared.sort(key=lambda one: -cost(one[1]))
    processes = min(cores(), max(1, len(shared)))
    with SpawnPool(processes, initializer=_Child.begin) as pool:
        futures = {pool.submit(_Child.measure, cell): k for k, cell in shared}
        try:
            for future in as_completed(futures):
                yield futures[future], future.result()
        except BrokenProcessPool:
            raise RunError("extremes: a process died (too little memory?); what is done is kept") from None
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for child in multiprocessing.active_children():
                if child.pid is not None:
                    os.kill(child.pid, signal.SIGINT)  # only Ctrl-C has reached them
            raise
    for k, cell in alone:
        yield k, measure(cell)


class _Child:
    """A process of the pool: the first interrupt ends the cell that it measures, and it begins none after that."""

    ended = False
    measuring = False

    @classmethod
    def begin(cls) -> None:
        signal.signal(signal.SIGINT, cls._interrupt)

    @classmethod
    def _interrupt(cls, *_: object) -> None:
        first, cls.ended = not cls.ended, True
        if first and cls.measuring:
            raise KeyboardInterrupt

    @classmethod
    def measure(cls, cell: Cell) -> Outcome:
        cls.measuring = True
        try:
            if cls.ended:
                raise KeyboardInterrupt
            return measure(cell)
        finally:
            cls.measuring = False


class _Kept:
    """Outcomes in files. One counts as long as neither its cell nor the program has changed since."""

    def __init__(self, directory: Path | None) -> None:
        self._folder = None if directory is None else directory / "cells"
        self._program = _program()
        if self._folder is not None:
            try:
                self._folder.parent.mkdir(parents=True, exist_ok=True)
                claim(self._folder.parent, ("cells", "extremes.csv", *figure_files("extremes")))
                self._folder.mkdir(exist_ok=True)
            except OSError as error:
                raise InputError(f"{directory}: cannot be written to ({error.strerror})") from None

    def read(self, cell: Cell) -> Outcome | None:
        if self._folder is None:
            return None
        try:
            data = json.loads(self._path(self._folder, cell).read_text(encoding="utf-8"))
            return Outcome(**data["outcome"]) if data["of"] == self._of(cell) else None
        except (OSError, ValueError, TypeError, KeyError):
            return None

    def write(self, cell: Cell, outcome: Outcome) -> None:
        if self._folder is not None:
            write_json(self._path(self._folder, cell), {"of": self._of(cell), "outcome": asdict(outcome)})

    def _of(self, cell: Cell) -> str:
        return hashlib.sha256(f"{self._program}{cell!r}".encode()).hexdigest()

    @staticmethod
    def _path(folder: Path, cell: Cell) -> Path:
        return folder / (re.sub(r"[^A-Za-z0-9.+^-]+", "_", f"{cell.axis}_{cell.value}") + ".json")


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
