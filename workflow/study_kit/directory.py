"""Study: a plan of cases, their evaluation, and a report, in one directory.

::

    STUDY = Study("scan", tables=("scan.csv",), figures=("scan",), cache="cases.jsonl", result="scan.csv is the table")

    def scan(directory, couplings, chains):
        cases = [case(f"{__name__}:computed", {...}, cost=...) for ...]               # plan
        with STUDY.evaluating(directory) as values:
            points = [Point(**value) for value in values(cases)]   # evaluate
            STUDY.write(directory, {"scan.csv": (Point, points)}, {"scan": draw(points)})  # report

- **Plan**: pure functions that return `Computation` of `workflow.workers.computations`, which name a function and data.
- **Evaluate**: `evaluating` computes them in one pool of processes, with the directory's cache and a bar of progress. A
  search evaluates as often as it plans, in one open directory.
- **Report**: a table is a list of records whose class declares its columns once (`analysis.quantity.result`): meaning,
  unit, and how they are printed. `write` writes it as CSV, and `print_records` prints it. `write` also writes figures,
  and other files; `workflow.study_kit.page` makes pages.

`opened` creates or resumes the directory, refuses files of others, keeps other commands out of it, and records for
``granchain status`` whether the study came to its end. A command adds arguments and prints.
"""

import contextlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from analysis import quantity
from lammps_inputs.units import DIMENSIONLESS, Scale
from workflow.formats import figure_files
from workflow.runs import job
from workflow.runs.figures import write_figure
from workflow.runs.files import alone, as_json, write_bytes
from workflow.runs.output_directory import make_directory, record_files
from workflow.screen import count_bar, print_table
from workflow.workers.computations import Computation, StoredResults, values
from workflow.workers.pool import Pool

if TYPE_CHECKING:
    from _typeshed import DataclassInstance
    from matplotlib.figure import Figure

    Records = tuple[type[DataclassInstance], Sequence[DataclassInstance]]
    """Class of records, and its instances."""


@dataclass(frozen=True)
class Study:
    """The directory of one kind of study.

    Attributes:
        command: name of the command that makes the directory.
        result: what to look at once the study is finished, for ``granchain status``.
        tables: names of the files of text that it writes: CSV, JSON, HTML.
        figures: names of its figures, without suffix.
        cache: name of the file that holds the values of cases; empty for none.
        others: names of further files and folders that it makes.
        resume: what to do where the study is not finished, for ``granchain status``.

    Examples:
        >>> study = Study("scan", result="scan.csv is the table", tables=("scan.csv",), cache="cases.jsonl")
        >>> with study.opened(tmp / "scanned") as cache:  # values of cases of earlier starts, by key
        ...     table = quantity.csv_of_rows([{"coupling": 0.1, "amplitude": 0.682}])
        ...     study.write(tmp / "scanned", {"scan.csv": table})
        >>> sorted(path.name for path in (tmp / "scanned").iterdir())
        ['cases.jsonl', 'run.json', 'scan.csv']
    """

    command: str
    result: str
    tables: Sequence[str] = ()
    figures: Sequence[str] = ()
    cache: str = ""
    others: Sequence[str] = ()
    resume: str = "the same command resumes"

    @property
    def figure_files(self) -> tuple[str, ...]:
        """Names of the files of its figures, in the formats that were chosen."""
        return figure_files(*self.figures)

    @property
    def files(self) -> tuple[str, ...]:
        """Names of all files and folders that the study makes in the directory."""
        cache = (self.cache,) if self.cache else ()
        return (*self.tables, *self.figure_files, *cache, *self.others)

    @contextlib.contextmanager
    def opened(self, directory: Path | None) -> Iterator[StoredResults]:
        """Create or resume a directory for the time of a block, which gets the stored values of its cases.

        Args:
            directory: marked as finished where the block ends without an exception; None writes nothing.

        Raises:
            InputError: the directory cannot be written, is in use, or has a file of such a name that is not a study's.
        """
        if directory is None:
            yield StoredResults(None)
            return
        make_directory(directory)
        with alone(directory):
            record_files(directory, self.files)
            self.mark(directory, done=False)
            with StoredResults(directory / self.cache if self.cache else None) as cache:
                yield cache
            self.mark(directory, done=True)

    @contextlib.contextmanager
    def evaluating(self, directory: Path | None, jobs: int | None = None) -> Iterator[Callable[..., list[Any]]]:
        """Create or resume a directory with worker processes and a progress bar for the time of a block.

        The block gets a function from cases to their values, which it may call as often as a search plans. Options of
        the function are ``of`` and ``words``, how many cases there may be and what else the bar says, and ``failed``
        (`workflow.workers.computations.values`).

        Args:
            directory: see `opened`.
            jobs: cases at a time; None for all cores.

        Raises:
            InputError: see `opened`.
        """
        done, pool = 0, Pool(jobs, interrupt=True)
        with self.opened(directory) as cache, count_bar(self.command) as bar, pool:

            def evaluated(cases: Sequence[Computation], *, of: int = 0, words: str = "", **options: Any) -> list[Any]:
                nonlocal done

                def show(now: int, total: int, bad: int) -> None:
                    bar(done + now, of or done + total, words or bad)

                evaluated_values = values(cases, cache, pool=pool, progress=show, **options)
                done += len(evaluated_values)
                return evaluated_values

            yield evaluated

    def write(
        self,
        directory: Path,
        tables: "Mapping[str, str | bytes | Mapping[str, Any] | Records]",
        figures: "Mapping[str, Figure] | None" = None,
        scale: Scale = DIMENSIONLESS,
    ) -> None:
        """Write tables by name, and figures by name without suffix; each file completely or not at all.

        Args:
            directory: the study's directory.
            tables: contents of files; data for JSON; or class and instances of records, for CSV with a line for each
                record and a column for each field of the class.
            figures: what is drawn.
            scale: units of the fields that declare one.
        """
        for name, table in tables.items():
            write_bytes(directory / name, _content(table, scale))
        for name, figure in (figures or {}).items():
            write_figure(directory, name, figure)

    def remove_all_but(self, directory: Path, names: Sequence[str]) -> None:
        """Remove files of an earlier start of the study, but for its cache and those of some names."""
        record_files(directory, names, outdated=set(self.files).difference(names, (self.cache,)))

    @staticmethod
    def print_records(
        title: str,
        kind: "type[DataclassInstance]",
        records: "Sequence[DataclassInstance]",
        scale: Scale = DIMENSIONLESS,
    ) -> None:
        """Print a table of the columns that declare ``digits`` (`analysis.quantity.Quantity`), in the units of a scale.

        Nothing is printed where there are no records.
        """
        if not records:
            return
        shown = {name: column for name, (column, _) in quantity.declared(kind).items() if column.digits is not None}
        rows = [
            [
                quantity.cell(_measured(record, name, column.unit, scale), column.digits or "")
                for name, column in shown.items()
            ]
            for record in records
        ]
        print_table(title, [scale.heading(column.head or name, column.unit) for name, column in shown.items()], rows)

    @staticmethod
    def with_provenance(report: Mapping[str, Any]) -> dict[str, Any]:
        """A report, and where and with what it was computed."""
        return {**report, **job.provenance()}

    def mark(self, directory: Path, *, done: bool) -> None:
        """Record in ``run.json``, as `opened` does, the command of a directory and whether the study is finished."""
        study = job.StudyRecord(command=self.command, done=done, result=self.result, resume=self.resume)
        job.update(directory, study=study.plain())


def _content(table: "str | bytes | Mapping[str, Any] | Records", scale: Scale) -> bytes:
    """Content of a file: as it is, as JSON, or as CSV."""
    if isinstance(table, bytes):
        return table
    if isinstance(table, Mapping):
        return f"{as_json(table)}\n".encode()
    return (table if isinstance(table, str) else _csv_of(*table, scale)).encode()


def _csv_of(kind: "type[DataclassInstance]", records: "Sequence[DataclassInstance]", scale: Scale) -> str:
    """CSV text, a line for each record and a column for each field of their class."""
    units = {field.name: _declared(kind, field.name).unit for field in fields(kind)}
    head = [scale.heading(name, unit) for name, unit in units.items()]
    rows = [[_measured(record, name, unit, scale) for name, unit in units.items()] for record in records]
    return quantity.csv_of_rows([dict(zip(head, row, strict=True)) for row in rows], head)


def _declared(kind: "type[DataclassInstance]", name: str) -> quantity.Quantity:
    columns = quantity.declared(kind)
    return columns[name][0] if name in columns else quantity.Quantity("")


def _measured(record: "DataclassInstance", name: str, unit: str, scale: Scale) -> Any:
    value = getattr(record, name)
    return None if value is None else quantity.in_units(value, unit, scale)
