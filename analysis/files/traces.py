r"""Measured traces in a table: a column of times, and one for each force or velocity that was measured.

Columns are named as in ``forces.csv``, or by single words (`WANTED` shows both), with or without a unit in brackets.
A place without a value is empty or ``nan``. A long table of beads (see `table`) is one trace for every bead. A file of
other names, with lines before them, or of signals of a sensor, is described by a `TraceFile`:

    value = gain (signal - baseline)

Plug-ins take this module for data of experiments: `load` reads a file; each `Channel` of it says what was measured and
where, which `analysis.gauges.channels` computes for a run.

Examples:
    >>> head = "time (us),force_wall_right (N)"
    >>> np.savetxt(tmp / "data.csv", [[0.0, 0.0], [5.0, 3.2]], delimiter=",", header=head, comments="")
    >>> data = traces.load(tmp / "data.csv")
    >>> data.channels[0].name, data.time, data.values[:, 0]  # in s and N
    ('force_wall_right_chain_1', array([0.e+00, 5.e-06]), array([0. , 3.2]))
    >>> _ = (tmp / "scope.csv").write_text("Model,SCOPE-4\n\nTIME,CH1\nus,V\n0,0.1\n5,0.3\n")
    >>> columns = {"time": "TIME", "force_wall_right": "CH1"}
    >>> scope = traces.TraceFile(tmp / "scope.csv", columns, gain={"CH1": 20.0}, baseline={"CH1": 0.1})
    >>> traces.load(scope).values[:, 0]  # 20 N/V times 0 V and 0.2 V
    array([0., 4.])
"""

import itertools
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np

from analysis.files import table
from analysis.trajectory import Floats
from lammps_inputs import InputError

Kind = Literal["wall", "contact", "sensor", "velocity", "displacement"]

WANTED = (
    "time, force_wall_right, force_contact_10, force_sensor_20_chain_2, velocity_1_55 (chain, bead), "
    "displacement_1_55; or as in forces.csv: right wall chain 1 (N), contact 10 chain 1 dynamic (N)"
)

OTHER_NAMES = "; --columns gives a file's own names"

_CHAIN = r"(?: chain (?P<chain>\d{1,9}))?"
_ABOVE = r"(?: total|(?P<above> dynamic))?"
_PATTERNS = (
    re.compile(rf"(?:force )?(?:wall (?P<side>left|right)|(?P<which>left|right) wall){_CHAIN}{_ABOVE}"),
    re.compile(rf"(?:force )?(?P<kind>contact|sensor) (?P<bead>\d{{1,9}}){_CHAIN}{_ABOVE}"),
    re.compile(r"(?P<kind>velocity|displacement)(?: chain)? (?P<chain>\d{1,9})(?: bead)? (?P<bead>\d{1,9})"),
)
_MEANT = re.compile(r"(left |right )?(force|wall|contact|sensor|velocity|displacement)\b|(left|right) wall")
_UNIT = re.compile(r"(.*?)\s*[(\[](.*?)[)\]]")

_UNITS = {
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
    "force": {"N": 1.0, "mN": 1e-3, "kN": 1e3},
    "velocity": {"m/s": 1.0, "mm/s": 1e-3, "cm/s": 1e-2},
    "displacement": {"m": 1.0, "mm": 1e-3, "um": 1e-6},
}
"""Unit -> worth in SI."""

_SPELLED = {"second": "s", "seconds": "s", "sec": "s", "volt": "V", "volts": "V", "newton": "N", "newtons": "N"}
"""Units in letters, as in the rows of units of some oscilloscopes."""

_STARTS_NUMBER = re.compile(r"[-+]?[.,]?\d|nan\b|[-+]?inf", re.IGNORECASE)
"""Start of a cell that holds no unit."""

MOST_HEAD = 1000
"""Largest number of lines in which the names of columns are looked for."""

_MICRO = str.maketrans("\N{MICRO SIGN}\N{GREEK SMALL LETTER MU}", "uu")


@dataclass(frozen=True)
class Channel:
    """Quantity and place of one trace.

    Attributes:
        kind: the force on a wall, in a contact or inside a bead; or the velocity or displacement of a bead.
        chain: number of the chain, from 1.
        bead: number of the bead, from 1; the first bead of a contact; 0 at a wall.
        right: whether a wall is the one behind the last beads.
        dynamic: whether a force is without that at rest.
    """

    kind: Kind
    chain: int
    bead: int = 0
    right: bool = False
    dynamic: bool = False

    @property
    def name(self) -> str:
        """Name of the channel as that of a column."""
        if self.kind in ("velocity", "displacement"):
            return f"{self.kind}_{self.chain}_{self.bead}"
        place = ("right" if self.right else "left") if self.kind == "wall" else str(self.bead)
        return f"force_{self.kind}_{place}_chain_{self.chain}" + "_dynamic" * self.dynamic

    @property
    def quantity(self) -> str:
        """Name of the quantity's unit in `lammps_inputs.units.Scale`."""
        return {"velocity": "velocity", "displacement": "length"}.get(self.kind, "force")


FREE = "free"
"""Gain or baseline that is to be estimated."""

Given = float | Literal["free"]


@dataclass(frozen=True)
class TraceFile:
    """A file of traces, and how it is to be read.

    Columns are named by their heading, with or without its unit, or by their number from 1, such as ``#4``.

    Attributes:
        path: the file.
        columns: name of a trace as in `WANTED`, or ``time``, which may end with a unit in brackets -> column of the
            file; columns have such names themselves where it is empty.
        skip: number of lines before the names of the columns; None for the first line that names them.
        gain: column or trace -> value (N, m/s or m, or reduced) per unit of the column, or `FREE`.
        baseline: column or trace -> signal at rest in the unit of the column, or `FREE`; 0 where there is none.
    """

    path: Path
    columns: Mapping[str, str] = field(default_factory=dict)
    skip: int | None = None
    gain: Mapping[str, Given] = field(default_factory=dict)
    baseline: Mapping[str, Given] = field(default_factory=dict)

    @property
    def described(self) -> bool:
        """Whether anything but the path is given."""
        return bool(self.columns or self.gain or self.baseline) or self.skip is not None


@dataclass(frozen=True)
class Calibration:
    """Relation ``value = gain (signal - baseline)`` of a trace to the signal in a column.

    Attributes:
        gain: value per unit of the signal; None where it is to be estimated.
        baseline: signal at rest, in its unit; None where it is to be estimated.
        unit: unit of the signal; empty for the scene's own.
    """

    gain: float | None = 1.0
    baseline: float | None = 0.0
    unit: str = ""

    @property
    def known(self) -> bool:
        """Whether nothing is to be estimated."""
        return self.gain is not None and self.baseline is not None


@dataclass(frozen=True)
class Traces:
    """Traces over one column of times, in the file's own units (SI where columns name them).

    Attributes:
        time: [row], ascending.
        channels: what was measured.
        values: [row, channel]; NaN where there is none.
        units: whether any column names a unit, which only SI has.
        signals: number of a channel, from 0 -> its calibration, where something of that is to be estimated: its values
            are signals in the unit of the column.
    """

    time: Floats
    channels: tuple[Channel, ...]
    values: Floats
    units: bool
    signals: Mapping[int, Calibration] = field(default_factory=dict)


def are_in(path: Path) -> bool:
    """Whether a file's first line names traces; a table of beads, an npz, or what cannot be read has none."""
    names = _named(path)
    return not _BEADS & set(names) and any(_MEANT.match(name) for name in names)


_BEADS = {"chain", "bead"}
"""Columns of a long table of beads, which no table of traces has."""


def _named(path: Path) -> list[str]:
    """Columns in a file's first line; none of what is no text or cannot be read."""
    try:
        with path.open(encoding="utf-8-sig") as file:
            names, _ = table.header(file.readline(100_000))
    except (OSError, UnicodeDecodeError):
        return []
    return [_split(name)[0] for name in names]


def load(file: Path | TraceFile) -> Traces:
    """Read traces, or every bead of a table as one.

    Args:
        file: the file, and how it is to be read where its columns do not say so.

    Returns:
        The traces; signals whose gain or baseline is to be estimated remain as they are.

    Raises:
        InputError: the file is missing, of no such kind, names a column wrongly, or holds what is no number.
    """
    file = TraceFile(file) if isinstance(file, Path) else file
    path = file.path
    if not file.described and (not (names := _named(path)) or _BEADS & set(names)):
        return _of_beads(path)
    try:
        if path.stat().st_size > table.MAX_BYTES:
            raise InputError(f"{path}: larger than 4 GiB; write fewer rows")
        head, chosen, data = table.read_text(
            path,
            lambda _: _head(file),
            lambda head: _chosen(file, head),
            "is not text in UTF-8; save it as such",
            _number,
        )
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    columns = list(chosen)
    for column, values in zip(columns, data.T, strict=True):
        if np.isinf(values).any() or np.isnan(values).all():
            row = int(np.argmax(~np.isfinite(values)))
            line = table.line_of_row(path, row, head)
            raise InputError(f"{path}: column {column.heading!r} holds {values[row]} in line {line}")
    _refuse_descending(path, head, columns[0].heading, data[:, 0])
    calibrations = [column.calibration for column in columns[1:]]
    values = data[:, 1:].copy()
    for place, calibration in enumerate(calibrations):
        if calibration.gain is not None and calibration.baseline is not None:
            values[:, place] = calibration.gain * (values[:, place] - calibration.baseline)
    gain = columns[0].calibration.gain
    assert gain is not None
    return Traces(
        data[:, 0] * gain,
        tuple(column.channel for column in columns if column.channel is not None),
        values,
        any(column.has_unit for column in columns),
        {place: calibration for place, calibration in enumerate(calibrations) if not calibration.known},
    )


def _number(cell: str) -> float:
    """Number in a cell, which may stand between quotes; NaN of an empty one."""
    text = cell.strip().strip("\"'").strip()
    if "_" in text:  # which `float` passes over
        raise ValueError(text)
    return float(text) if text else math.nan


def _refuse_descending(path: Path, head: table.Head, heading: str, time: Floats) -> None:
    """Refuse times [row] that are missing or not ascending, by the first line in which they are."""
    missing = np.isnan(time)
    wrong = missing if missing.any() else np.concatenate([[False], np.diff(time) <= 0.0])
    if not wrong.any():
        return
    row = int(np.argmax(wrong))
    line = table.line_of_row(path, row, head)
    if missing.any():
        raise InputError(f"{path}: line {line} has no time in column {heading!r}; leave such lines out")
    equal = "; write times with more digits" if time[row] == time[row - 1] else "; a file holds one record"
    raise InputError(
        f"{path}: times are not ascending: column {heading!r} holds {time[row]:.10g} in line {line}, after "
        f"{time[row - 1]:.10g}{equal}"
    )


# --- head -------------------------------------------------------------------------------------------------------------


def _head(file: TraceFile) -> table.Head:
    """Names of the columns of a file, and units below them."""
    with file.path.open(encoding="utf-8-sig") as text:
        lines = list(itertools.islice(text, MOST_HEAD + (file.skip or 0)))
    start = _start(file, lines)
    names, delimiter = table.header(lines[start])
    if _numbered(file) and _names_columns(file, lines[start]):  # a row
        return table.Head([f"#{k + 1}" for k in range(len(names))], delimiter, start)
    below = lines[start + 1] if start + 1 < len(lines) else ""
    units = [cell.strip().strip("\"'") for cell in below.strip(table.BLANKS).split(delimiter)]
    if len(units) < len(names) or not any(units) or units == names or any(map(_STARTS_NUMBER.match, units)):
        return table.Head(names, delimiter, start + 1)
    return table.Head(names, delimiter, start + 2, tuple(unit.strip("()[] ") for unit in units))


def _start(file: TraceFile, lines: list[str]) -> int:
    """Place of the line of names among the first lines of a file, or of the first row where columns have numbers.

    Raises:
        InputError: there is none.
    """
    if not any(line.strip() for line in lines):
        raise InputError(f"{file.path}: is empty")
    if not file.columns and not file.skip:
        return 0
    skip = file.skip or 0
    if skip >= len(lines):
        raise InputError(f"--skip: {skip} given, but {file.path} has {len(lines)} lines")
    first = next((k for k, line in enumerate(lines) if _names_columns(file, line)), None)
    if file.skip is not None:
        if _numbered(file) or _names_columns(file, lines[skip]):
            return skip
        hint = "" if first is None else f"; line {first + 1} does: --skip {first}"
        raise InputError(f"{file.path}: line {skip + 1} does not name {_listed(file)}{hint}")
    if first is not None:
        return first
    best = max(range(len(lines)), key=lambda k: len(_known(file, lines[k])))
    if not _known(file, lines[best]):
        raise InputError(f"{file.path}: no line names {_listed(file)} (see --columns)")
    missing = [column for column in file.columns.values() if column not in _known(file, lines[best])]
    names = ", ".join(table.header(lines[best])[0])
    raise InputError(f"{file.path}: has no column {missing[0]!r}; line {best + 1} names {names[:200]}")


def _listed(file: TraceFile) -> str:
    return ", ".join(file.columns.values()) or "a column"


def _by_number(column: str) -> bool:
    return re.fullmatch(r"#[1-9]\d{0,5}", column) is not None


def _numbered(file: TraceFile) -> bool:
    """Whether columns are named by their numbers alone, so that no line of names is needed."""
    return bool(file.columns) and all(map(_by_number, file.columns.values()))


def _names_columns(file: TraceFile, line: str) -> bool:
    """Whether a line names all columns that are read, or has numbers in them where they have numbers alone."""
    cells, _ = table.header(line)
    if not _numbered(file):
        return len(_known(file, line)) == len(file.columns)
    places = [places[0] for column in file.columns.values() if (places := _places(column, cells))]
    return len(places) == len(file.columns) and all(_is_number(cells[place]) for place in places)


def _known(file: TraceFile, line: str) -> list[str]:
    """Those of the columns that are read which a line names."""
    names, _ = table.header(line)
    return [column for column in file.columns.values() if _places(column, names)]


def _is_number(cell: str) -> bool:
    try:
        return not math.isnan(_number(cell))
    except ValueError:
        return False


def _places(column: str, names: list[str]) -> list[int]:
    """Columns that are meant: that of a number, those of this heading, or else those of this one without its unit."""
    if _by_number(column):
        return [int(column[1:]) - 1] if int(column[1:]) <= len(names) else []
    exact = [place for place, name in enumerate(names) if name == column]
    name = _split(column)[0]
    return exact or [place for place, heading in enumerate(names) if name and _split(heading)[0] == name]


# --- columns ----------------------------------------------------------------------------------------------------------


class _Column(NamedTuple):
    """A column that is read, of times where it has no channel."""

    channel: Channel | None
    calibration: Calibration
    heading: str
    has_unit: bool


def _chosen(file: TraceFile, head: table.Head) -> dict[_Column, int]:
    """The columns that are read, time first, and where they are."""
    path, places = file.path, dict[Channel | None, tuple[int, str]]()
    for name, unit, place in _named_here(file, head):
        channel = None if name == "time" else _channel(name)
        heading = head.names[place]
        if name != "time" and channel is None:
            if _MEANT.match(name) or file.columns:
                shown = f"--columns: {name!r}" if file.columns else f"{path}: column {heading!r}"
                raise InputError(f"{shown}: not known, or names no place; such as {WANTED}")
            continue
        if channel in places:
            raise InputError(f"{path}: column {heading!r}: there is another of the same")
        places[channel] = place, unit
    if None not in places:
        where = "--columns: names no time, such as time=TIME" if file.columns else f"{path}: has no column 'time'"
        raise InputError(f"{where}; columns are such as {WANTED}{OTHER_NAMES * (not file.columns)}")
    if len(places) == 1:
        raise InputError(f"{path}: holds no trace; columns are such as {WANTED}{OTHER_NAMES}")
    gains, baselines = (
        {place: _given(file, option, head, place, channel) for channel, (place, _) in places.items()}
        for option in ("gain", "baseline")
    )
    _refuse_unused(file, head, places)
    columns = {}
    for channel, (place, unit) in sorted(places.items(), key=lambda entry: entry[0] is not None):
        heading, gain = head.names[place], gains[place]
        calibration = _calibration(path, heading, channel, unit, (gain, baselines[place]))
        columns[_Column(channel, calibration, heading, gain is None and unit not in ("", "-"))] = place
    return columns


def _named_here(file: TraceFile, head: table.Head) -> Iterator[tuple[str, str, int]]:
    """Name that a column has here, in lower letters, its unit, and its place."""
    below = dict(enumerate(head.units))
    if not file.columns:
        for place, heading in enumerate(head.names):
            name, unit = _split(heading)
            yield name, unit or below.get(place, ""), place
    for ours, column in file.columns.items():
        places = _places(column, head.names)
        if len(places) != 1:
            numbers = " or ".join(f"#{place + 1}" for place in places)
            reason = f"several columns have this name; choose {numbers}" if places else "there is no such column"
            raise InputError(f"--columns: {column!r}: {reason}")
        (place,) = places
        name, unit = _split(ours)
        yield name, unit or _split(head.names[place])[1] or below.get(place, ""), place


def _given(file: TraceFile, option: str, head: table.Head, place: int, channel: Channel | None) -> Given | None:
    """Gain or baseline that is given for a column; None where none is.

    Raises:
        InputError: it is no number that can be one.
    """
    for key, value in getattr(file, option).items():
        if not _is_meant(key, head, place, channel):
            continue
        valid = value == FREE or (isinstance(value, int | float) and math.isfinite(value))
        if channel is None or not valid or (option == "gain" and value == 0.0):
            example = "20.5 or free" if option == "gain" else "0.02 or free"
            reason = f"{value!r} given; a number such as {example}" if channel else "times have none"
            raise InputError(f"--{option}: {key}: {reason}")
        return value if value == FREE else float(value)
    return None


def _is_meant(key: str, head: table.Head, place: int, channel: Channel | None) -> bool:
    """Whether a name is that of a column in a file, or of its trace."""
    return place in _places(key, head.names) or (channel is not None and _channel(_split(key)[0]) == channel)


def _refuse_unused(file: TraceFile, head: table.Head, places: Mapping[Channel | None, tuple[int, str]]) -> None:
    """Refuse gains and baselines of what is no trace of a file."""
    for option in ("gain", "baseline"):
        for key in getattr(file, option):
            if not any(_is_meant(key, head, place, channel) for channel, (place, _) in places.items()):
                traces = ", ".join(head.names[place] for channel, (place, _) in places.items() if channel)
                raise InputError(f"--{option}: {key!r} is no trace of {file.path}, whose columns are {traces}")


def _calibration(
    path: Path, heading: str, channel: Channel | None, unit: str, given: tuple[Given | None, Given | None]
) -> Calibration:
    """Gain and baseline of a column.

    Raises:
        InputError: its unit is unknown, and no gain is given.
    """
    gain, baseline = given
    if gain is None:
        units = _UNITS["time" if channel is None else "force" if channel.quantity == "force" else channel.kind]
        gain = _worth(unit, units)
        if gain is None:
            hint = "" if channel is None else f"; of a sensor's signal give the gain: --gain {heading}=20 or free"
            raise InputError(f"{path}: column {heading!r}: the unit {unit!r} is not known; {', '.join(units)}{hint}")
    elif not unit:
        unit = f"unit of {heading}"
    unknown = {"gain": gain == FREE, "baseline": baseline == FREE}
    return Calibration(
        None if unknown["gain"] else float(gain),
        None if unknown["baseline"] else float(baseline or 0.0),
        _SPELLED.get(unit.lower(), unit),
    )


def _worth(unit: str, units: dict[str, float]) -> float | None:
    """Value of a unit in SI, 1 without a unit; None if unknown. Letters of any case, but M is not milli."""
    if unit in ("", "-"):
        return 1.0
    unit = _SPELLED.get(unit.lower(), unit.translate(_MICRO))
    alike = {} if unit.startswith("M") else {name.lower(): worth for name, worth in units.items()}
    return units.get(unit, alike.get(unit.lower()))


def _split(heading: str) -> tuple[str, str]:
    """Name in lower letters, its words with one blank between them, and unit."""
    with_unit = _UNIT.fullmatch(heading.strip())
    name, unit = with_unit.groups() if with_unit else (heading, "")
    return " ".join(re.split(r"[\s_]+", name.strip().lower())), unit.strip()


def _channel(name: str) -> Channel | None:
    for pattern in _PATTERNS:
        match = pattern.fullmatch(name)
        if match is None:
            continue
        parts = match.groupdict()
        chain = int(parts["chain"] or 1)
        if "side" in parts:
            right = "right" in (parts["side"], parts["which"])
            return Channel("wall", chain, right=right, dynamic=parts["above"] is not None)
        kind: Kind = next(kind for kind in ("contact", "sensor", "velocity", "displacement") if kind == parts["kind"])
        return Channel(kind, chain, int(parts["bead"]), dynamic=parts.get("above") is not None)
    return None


def _of_beads(path: Path) -> Traces:
    bead_table = table.load(path)
    channels, values = [], []
    kinds: tuple[Kind, ...] = ("velocity", "displacement")
    for kind in kinds:
        grid = getattr(bead_table, kind)
        if grid is None:
            continue
        for j, k in np.argwhere(np.isfinite(grid).any(axis=0)).tolist():
            channels.append(Channel(kind, int(bead_table.chains[j]), int(bead_table.beads[k])))
            values.append(grid[:, j, k])
    return Traces(bead_table.time, tuple(channels), np.stack(values, axis=1), units=False)
