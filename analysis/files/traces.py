"""Measured traces in a table: a column of times, and one for each force or velocity that was measured.

Columns are named as in ``forces.csv``, or by single words (`WANTED` shows both), with or without a unit in brackets.
A place without a value is empty or ``nan``. A long table of beads (see `table`) is one trace for every bead.

Plug-ins take this module for data of experiments: `load` reads a file; each `Channel` of it says what was measured and
where, which `analysis.gauges.channels` computes for a run.

Examples:
    >>> head = "time (us),force_wall_right (N)"
    >>> np.savetxt(tmp / "data.csv", [[0.0, 0.0], [5.0, 3.2]], delimiter=",", header=head, comments="")
    >>> data = traces.load(tmp / "data.csv")
    >>> data.channels[0].name, data.time, data.values[:, 0]  # in s and N
    ('force_wall_right_chain_1', array([0.e+00, 5.e-06]), array([0. , 3.2]))
"""

import math
import re
from dataclasses import dataclass
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
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6},
    "force": {"N": 1.0, "mN": 1e-3, "kN": 1e3},
    "velocity": {"m/s": 1.0, "mm/s": 1e-3, "cm/s": 1e-2},
    "displacement": {"m": 1.0, "mm": 1e-3, "um": 1e-6},
}
"""Unit -> worth in SI."""

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


@dataclass(frozen=True)
class Traces:
    """Traces over one column of times, in the file's own units (SI where columns name them).

    Attributes:
        time: [row], ascending.
        channels: what was measured.
        values: [row, channel]; NaN where there is none.
        units: whether any column names a unit, which only SI has.
    """

    time: Floats
    channels: tuple[Channel, ...]
    values: Floats
    units: bool


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


def load(path: Path) -> Traces:
    """Read traces, or every bead of a table as one.

    Raises:
        InputError: the file is missing, of no such kind, names a column wrongly, or holds what is no number.
    """
    names = _named(path)
    if not names or _BEADS & set(names):
        return _of_beads(path)
    try:
        if path.stat().st_size > table.MAX_BYTES:
            raise InputError(f"{path}: larger than 4 GiB; write fewer rows")
        chosen, data = table.read_text(
            path,
            lambda names: _chosen(path, names),
            "is not a text table",
            lambda text: float(text) if text.strip() else math.nan,
        )
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    columns = list(chosen)
    for column, values in zip(columns, data.T, strict=True):
        if np.isinf(values).any() or np.isnan(values).all():
            row = int(np.argmax(~np.isfinite(values)))
            line = table.line_of_row(path, row)
            raise InputError(f"{path}: column {column.heading!r} holds {values[row]} in line {line}")
    time = data[:, 0] * columns[0].worth
    if not np.all(np.diff(time) > 0.0):  # also where a time is missing
        raise InputError(f"{path}: times are not ascending")
    channels = tuple(column.channel for column in columns if column.channel is not None)
    units = any(_split(column.heading)[1] not in ("", "-") for column in columns)
    return Traces(time, channels, data[:, 1:] * [column.worth for column in columns[1:]], units)


class _Column(NamedTuple):
    """A column that is read, of times where it has no channel, with its unit in SI and its heading in the file."""

    channel: Channel | None
    worth: float
    heading: str


def _chosen(path: Path, names: list[str]) -> dict[_Column, int]:
    """The columns that are read, time first, and where they are."""
    places: dict[Channel | None, tuple[int, float]] = {}
    for place, heading in enumerate(names):
        name, unit = _split(heading)
        channel = None if name == "time" else _channel(name)
        if name != "time" and channel is None:
            if _MEANT.match(name):
                raise InputError(f"{path}: column {heading!r}: not known, or names no place; such as {WANTED}")
            continue
        if channel in places:
            raise InputError(f"{path}: column {heading!r}: there is another of the same")
        units = _UNITS["time" if channel is None else "force" if channel.quantity == "force" else channel.kind]
        worth = _worth(unit, units)
        if worth is None:
            raise InputError(f"{path}: column {heading!r}: the unit {unit!r} is not known; {', '.join(units)}")
        places[channel] = place, worth
    if None not in places:
        raise InputError(f"{path}: has no column 'time'; columns are such as {WANTED}")
    if len(places) == 1:
        raise InputError(f"{path}: holds no trace; columns are such as {WANTED}")
    in_order = sorted(places.items(), key=lambda entry: entry[0] is not None)
    return {_Column(channel, worth, names[place]): place for channel, (place, worth) in in_order}


def _worth(unit: str, units: dict[str, float]) -> float | None:
    """Value of a unit in SI, 1 without a unit; None if unknown. Letters of any case, but M is not milli."""
    if unit in ("", "-"):
        return 1.0
    unit = unit.translate(_MICRO)
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
