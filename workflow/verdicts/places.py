"""Every quantity that a run directory or a table of a sweep holds, and where, as its type declares it.

Plug-ins take this module for help on quantities: `places` goes through all of them, each with its file, its key or
column, and its meaning.

Examples:
    >>> [place] = [place for place in places.places() if place.where == "waves.csv: column arrival"]
    >>> place.quantity.symbol, place.quantity.unit, place.quantity.meaning
    ('t', 'time', 'time at which the pulse passes the bead: that of the largest velocity, or the centre of the impulse')
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from analysis.quantity import Quantity, QuantityColumn, declare, result, walk
from analysis.statistics import Histogram, Statistics
from lammps_inputs.units import SI, Label
from workflow.engines.registry import engine_names, load_engine
from workflow.measures.registry import MEASUREMENTS
from workflow.runs.files import RECORD
from workflow.verdicts.analysis_report import REPORT, WAVES, Report, WavesTable

STATISTICS, HISTOGRAM = "statistics.csv", "histogram.csv"
"""Files of `granchain collect --statistics`."""

OWN = ("V", "T")
"""A case's own units: of the largest excitation, and of time (`lammps_inputs.units`)."""


@result
class RunErrors:
    """Errors of a run in `workflow.runs.job`, which loads no numbers."""

    velocity: float = declare(
        "largest error of any velocity, of beads and resonators, in the frames that were compared with the reference",
        "V",
        "the run was not checked",
        columns=(QuantityColumn("error_velocity", "error of velocities"),),
    )
    amplitude: float = declare(
        "largest error of a peak velocity of the leading pulse",
        "V",
        "the run was not checked, or no pulse was seen or leads (drives, foundations, slow resonators)",
        columns=(QuantityColumn("error_amplitude", "error of peak velocities"),),
    )
    arrival: float = declare(
        "largest error of an arrival of the leading pulse",
        "T",
        "the run was not checked, no arrival is sharp, or no pulse leads",
        columns=(QuantityColumn("error_arrival", "error of arrivals"),),
    )


@result
class RecordOfRun:
    """Numbers of a run in `workflow.runs.job`."""

    check: RunErrors = declare("measured error of the run", undefined="the run was not checked")
    engine: str = declare("what computed the run", column="")
    steps: int = declare("number of time steps", column="time steps")
    engine_seconds: float = declare("wall time of the engine", "s", column="time of the engine")
    wall_seconds: float = declare("wall time of the whole run", "s", column="wall time")


@dataclass(frozen=True)
class QuantityPlace:
    """A quantity in one of a run's files.

    Attributes:
        file: its name.
        path: key by key; the name of the column, in a table.
    """

    file: str
    path: tuple[str, ...]
    quantity: Quantity

    @property
    def where(self) -> str:
        """The file and the keys, or the column."""
        return f"{self.file}: {'column ' if self.file.endswith('.csv') else ''}{' > '.join(self.path)}"


@dataclass(frozen=True)
class CollectColumn:
    """A column of the table of a sweep.

    Attributes:
        place: of the quantity that holds its value.
        column: name, label, and key within the value.
    """

    place: QuantityPlace
    column: QuantityColumn

    @property
    def file(self) -> str:
        """Where its value is found."""
        return self.place.file

    @property
    def path(self) -> tuple[str, ...]:
        """Key by key; ``kicked`` is the leading wave of the kicked chain."""
        first, *others = (*self.place.path, *filter(None, [self.column.key]))
        return ("kicked" if first == "waves" else first, *others)

    @property
    def label(self) -> str:
        """Words on an axis; empty for text."""
        return self.column.label

    def unit(self, *, si: bool) -> str:
        """Symbol of what the scene or the case has a unit for; empty for anything else."""
        unit = self.place.quantity.unit
        return self.place.quantity.symbol_of_unit(si=si) if unit in SI or unit in OWN else ""

    def axis(self, *, si: bool | None) -> Label:
        """Label of an axis that shows it; without a unit of the scenes where ``si`` is None."""
        quantity = self.place.quantity
        unit = "" if si is None and quantity.unit in SI else quantity.symbol_of_unit(si=si is True)
        return Label(self.column.label, self.column.symbol, unit)


def tables() -> dict[str, Any]:
    """CSV file -> type whose fields are its columns."""
    of_measurements = {
        measurement.table[0]: measurement.table[1] for measurement in MEASUREMENTS if measurement.table is not None
    }
    of_engines = dict(engine.table for name in engine_names() if (engine := load_engine(name)).table is not None)
    return {WAVES: WavesTable, **of_measurements, **of_engines, STATISTICS: Statistics, HISTOGRAM: Histogram}


def places() -> Iterator[QuantityPlace]:
    """All quantities, file by file."""
    for file, path, kind in _sections():
        for keys, quantity in walk(kind, path):
            yield QuantityPlace(file, keys, quantity)


def _sections() -> list[tuple[str, tuple[str, ...], Any]]:
    """File, key and type."""
    of_measurements = [(REPORT, (measurement.key,), measurement.kind) for measurement in MEASUREMENTS]
    return [
        (REPORT, (), Report),
        *of_measurements,
        (RECORD, (), RecordOfRun),
        *((file, (), kind) for file, kind in tables().items()),
    ]


def collect_columns() -> dict[str, CollectColumn]:
    """Column of the table of a sweep -> what it holds, in their order: numbers of a run first, then text."""
    columns = [CollectColumn(place, column) for place in places() for column in place.quantity.columns]
    return {column.column.name: column for column in sorted(columns, key=lambda column: column.label == "")}
