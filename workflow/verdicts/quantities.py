"""Every quantity that a run directory or a table of a sweep holds, as its type declares it, for help and the manual.

``python -m workflow.verdicts.quantities`` prints the manual's page, ``analysis/QUANTITIES.md``.
"""

import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from analysis.quantity import Quantity, QuantityColumn, declare, result, walk
from analysis.statistics import Histogram, Statistics
from lammps_inputs.units import SI, Label
from workflow.engines.registry import engine_names
from workflow.measures import MEASUREMENTS
from workflow.runs.engines import engine_called
from workflow.runs.files import RECORD
from workflow.verdicts import terms
from workflow.verdicts.analysis_report import REPORT, WAVES, Report, WavesTable

STATISTICS, HISTOGRAM = "statistics.csv", "histogram.csv"
"""Files of `granchain collect --statistics`."""

OWN = ("V", "T")
"""A case's own units: of the largest excitation, and of time (`lammps_inputs.units`)."""

WIDTH = 100


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
    of_engines = dict(engine.table for name in engine_names() if (engine := engine_called(name)).table is not None)
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


def explained(word: str) -> str | None:
    """What `granchain help` says of a quantity or of a term of the verdicts; None where there is none of that name.

    Args:
        word: a column; a key, also behind that which it stands under (``budget.time``); the key or file that holds
            others (``budget``, ``waves.csv``), whose names are listed; or a term.
    """
    keys = tuple(word.split("."))
    named = [place for place in places() if any(column.name == word for column in place.quantity.columns)]
    named += [place for place in places() if place.path[-len(keys) :] == keys]
    by_quantity: dict[Quantity, list[QuantityPlace]] = {}
    for place in named:
        by_quantity.setdefault(place.quantity, []).append(place)
    lines = [line for quantity, at in by_quantity.items() for line in _lines(word, quantity, at)]
    lines += _held(word)
    if (criterion := terms.explained(word)) is not None:
        lines += _filled(criterion, "    ")
    return "\n".join([word, *lines]) if lines else None


def _held(word: str) -> Iterator[str]:
    """Names under a key, or in a file, wherever there is one of that name."""
    held: dict[tuple[str, ...], dict[str, None]] = {}
    for place in places():
        chain = (place.file, *place.path)
        for depth, name in enumerate(chain[:-1], 1):
            if name == word:
                held.setdefault(chain[:depth], {})[chain[depth]] = None
    for (file, *keys), names in held.items():
        holder = f"{file}: {' > '.join(keys)}" if keys else file
        yield from _filled(f"{holder} holds {', '.join(names)}", "    ")


def _lines(word: str, quantity: Quantity, at: list[QuantityPlace]) -> Iterator[str]:
    columns = [column for column in quantity.columns if word in (column.name, at[0].path[-1])]
    labels = [column.label for column in columns if column.name == word and column.label]
    yield from _filled("; ".join(dict.fromkeys([*labels, quantity.meaning])), "    ")
    if quantity.symbol:
        yield f"      symbol: {quantity.symbol}"
    if unit := _unit(quantity):
        yield f"      unit: {unit}"
    if quantity.undefined:
        yield from _filled(f"undefined where: {quantity.undefined}", "      ")
    keys = [column.key for column in columns if column.name == word and column.key]
    for where in dict.fromkeys(place.where for place in at):
        yield f"      {' > '.join([where, *keys])}"
    if columns:
        yield f"      granchain collect: column {', '.join(column.name for column in columns)}"


def _filled(text: str, indent: str) -> list[str]:
    return textwrap.wrap(text.replace("``", ""), WIDTH, initial_indent=indent, subsequent_indent=indent + "  ")


def _unit(quantity: Quantity) -> str:
    if quantity.pure:
        return "1"
    return f"{SI[quantity.unit]} with a material, else reduced" if quantity.unit in SI else quantity.unit


INTRODUCTION = """# Quantities

Generated by `python -m workflow.verdicts.quantities` from the types that declare them; `granchain help NAME` prints
one. Symbols are those of [MODEL.md](../lammps_inputs/MODEL.md#notation). Units are those of a scene with a material;
scenes without one have reduced units. V is the largest excitation (the kick velocity), T the unit of time
(`granchain show`). Ratios have the unit 1; texts, counts and numbers of beads and chains have none.

A quantity that is undefined is null in JSON, an empty cell in CSV and `-` in printed tables. The last column is the
name in the table of `granchain collect`. The last two sections define the terms of the verdicts and derive the numbers
of the pulse in a single chain.

An uncertainty is a sum of bounds:

- what the time between frames leaves: differences of polynomials of several degrees, and contacts, dashpots and
  forces that begin between frames;
- the error of the run by its time step (`run_error`), measured against the reference, with that of the reference;
- of an asymptotic amplitude and a train, the variation of the peak velocity.

The error of the run, in units of m, V and T, with the error e of all velocities:

- leading pulses: that of peak velocities, and of arrivals, of leading pulses;
- other pulses and last beads: e in peak velocities v, and e / v^1.2 in arrivals;
- energies: twice that of the peak velocity, relative to it;
- forces: e m omega / 2, with the largest mass m and angular frequency omega; impulses: 2 m e each time that a contact
  closes; the time of the largest force F: that of arrivals or m e / F; dwells: five times as much.

Results of fits and of scatter (`decay_law.n_star_error`, `beat_length.uncertainty`, `expected.uncertainty`) have the
bound on what errors of amplitudes change in them beside the standard deviation.
"""

HEAD = """
| name | symbol | unit | meaning | undefined where | collect |
|---|---|---|---|---|---|
"""


def manual() -> str:
    """The manual's page of quantities, in Markdown."""
    page, last = INTRODUCTION, ""
    inside = {path[0] for path, _ in walk(Report) if len(path) > 1} | {measurement.key for measurement in MEASUREMENTS}
    for place in places():
        grouped = place.file == REPORT and place.path[0] in inside
        name = f"{place.file}: {place.path[0]}" if grouped else place.file
        path = place.path[1:] if grouped else place.path
        if name != last:
            page += f"\n## `{name}`\n" + ("" if path else f"\n{_sentence(place.quantity)}\n") + HEAD
            last = name
        page += _row(place.quantity, path) if path else ""
    return page + terms.manual()


def _sentence(quantity: Quantity) -> str:
    text = quantity.meaning + (f"; null where {quantity.undefined}" if quantity.undefined else "")
    return f"{text[0].upper()}{text[1:]}.".replace("``", "`")


def _row(quantity: Quantity, path: tuple[str, ...]) -> str:
    cells = [
        f"`{'.'.join(path)}`",
        f"${quantity.symbol}$" if quantity.symbol else "",
        "1" if quantity.pure else SI.get(quantity.unit, quantity.unit),
        quantity.meaning.replace("``", "`"),
        quantity.undefined.replace("``", "`"),
        ", ".join(f"`{column.name}`" for column in quantity.columns),
    ]
    return f"| {' | '.join(cells)} |\n"


if __name__ == "__main__":
    print(manual(), end="")
