"""A user's own trajectory in a file: a long table of time, chain, bead and displacement or velocity, or an npz.

Text has a header line with the column names and semicolons, commas, tabs or blanks between columns; other columns are
passed over. An npz
holds arrays under those names: one number per row of such a table, or a grid, that is ``time`` [frame] with
``displacement`` and/or ``velocity`` [frame, chain, bead] (then ``chain`` and ``bead`` may number the axes; else they
count from 1). A place without a value is left out of a table; a value that is not a finite number is refused.
"""

import itertools
import math
import re
import struct
import warnings
import zipfile
import zlib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np

from analysis.trajectory import Floats, Integers
from lammps_inputs import InputError
from lammps_inputs.numbers import machine_memory

Name = TypeVar("Name")

KEYS = ("time", "chain", "bead")
VALUES = ("displacement", "velocity")
MAX_BYTES = 4 << 30
MAX_NUMBER = 2**31 - 1
"""Largest number of a chain or bead, as in LAMMPS."""


@dataclass(frozen=True)
class TrajectoryTable:
    """Values on a grid of times, chains and beads, in the file's own units.

    Attributes:
        time: [frame], ascending.
        chains, beads: numbers along the other axes, ascending, counted from 1.
        displacement, velocity: [frame, chain, bead]; None without such a column; NaN where a row is missing.
        position: [frame, chain, bead] positions as they stand in a file that holds no displacements.
        position_unit: length of 1 of these positions: 1, or the box of scaled ones.
        dump: whether the file is a dump of LAMMPS.
    """

    time: Floats
    chains: Integers
    beads: Integers
    displacement: Floats | None
    velocity: Floats | None
    position: Floats | None = None
    position_unit: float = 1.0
    dump: bool = False


def load(path: Path) -> TrajectoryTable:
    """Read a table.

    Raises:
        InputError: the file is missing, of neither kind, lacks a column, or holds a place twice or what is no number.
    """
    try:
        if path.stat().st_size > MAX_BYTES:
            raise InputError(f"{path}: larger than 4 GiB; write fewer frames or beads")
        with path.open("rb") as file:
            start = file.read(12)
        if start[8:] == b"DUMP":
            raise InputError(f"{path}: is a binary dump of LAMMPS; write it as text, into a file without .bin")
        columns = _from_npz(path) if start[:2] == b"PK" else _from_text(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    except MemoryError:
        raise InputError(f"{path}: too large for this machine's memory") from None
    present = [name for name in VALUES if name in columns]
    if not present:
        raise InputError(f"{path}: has neither a displacement nor a velocity column")
    for name, values in columns.items():
        if values.size == 0:
            raise InputError(f"{path}: column {name!r} is empty")
        wrong = np.argwhere(~np.isfinite(values))
        if len(wrong):
            place = ", ".join(str(index + 1) for index in wrong[0])
            place = f"entry {place}" if start[:2] == b"PK" else f"line {line_of_row(path, int(wrong[0][0]))}"
            raise InputError(f"{path}: column {name!r} holds {values[tuple(wrong[0])]} in {place}; leave such rows out")
    if columns[present[0]].ndim == 3:
        return _from_grid(path, columns)
    for name in KEYS:
        if name not in columns:
            raise InputError(f"{path}: has no column {name!r}; needed are {', '.join(KEYS)}")
    return _on_grid(path, columns)


def _from_npz(path: Path) -> dict[str, Floats]:
    damage = (ValueError, TypeError, KeyError, RuntimeError, EOFError, struct.error, zlib.error, zipfile.BadZipFile)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # numpy warns where it would leave out imaginary parts
            with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
                _refuse_what_unpacks_to_too_much(path, archive.zip)
                arrays = {name: archive[name] for name in (*KEYS, *VALUES) if name in archive}
                return {name: np.asarray(values, dtype=np.float64) for name, values in arrays.items()}
    except InputError:
        raise
    except (*damage, Warning) as error:
        raise InputError(f"{path}: is not an npz of plain numbers ({error})") from None


def _refuse_what_unpacks_to_too_much(path: Path, archive: zipfile.ZipFile) -> None:
    """Refuse an archive by the sizes in its directory, beyond which nothing of an entry is unpacked."""
    size, limit = sum(entry.file_size for entry in archive.infolist()), min(MAX_BYTES, machine_memory() // 4)
    if size > limit:
        raise InputError(f"{path}: unpacks to {size / 1e9:.3g} GB; at most {limit / 1e9:.3g} GB are read here")


def _from_text(path: Path) -> dict[str, Floats]:
    def chosen(head: Head) -> dict[str, int]:
        names = head.names
        wanted = [name for name in (*KEYS, *VALUES) if name in names]
        if not wanted:
            raise InputError(f"{path}: its first line names no column; needed are {', '.join((*KEYS, *VALUES))}")
        for name in wanted:
            if names.count(name) > 1:
                raise InputError(f"{path}: its first line names {name!r} twice")
        return {name: names.index(name) for name in wanted}

    _, places, data = read_text(path, first_line, chosen, "is neither a text table nor an npz")
    return {name: data[:, k] for k, name in enumerate(places)}


@dataclass(frozen=True)
class Head:
    """Head of a text table.

    Attributes:
        names: names of the columns.
        delimiter: what stands between columns; None for blanks.
        lines: number of lines before the rows.
        units: units of the columns where a line below the names has them, else empty.
    """

    names: list[str]
    delimiter: str | None
    lines: int
    units: tuple[str, ...] = ()


def first_line(path: Path) -> Head:
    """Head of a text whose first line has the names of the columns."""
    with path.open(encoding="utf-8-sig") as file:
        return Head(*header(file.readline()), 1)


def read_text(
    path: Path,
    find: Callable[[Path], Head],
    chosen: Callable[[Head], dict[Name, int]],
    otherwise: str,
    convert: Callable[[str], float] | None = None,
) -> tuple[Head, dict[Name, int], Floats]:
    """Some columns of a text with a line of names.

    Args:
        path: the file.
        find: from the file, its head; may raise.
        chosen: from the head, what is to be read -> which column it is; may raise.
        otherwise: end of the message on a file that is no text.
        convert: a cell to a number, where not every cell is one.

    Returns:
        The head, the chosen names with their columns, and the values [row, choice] in that order.

    Raises:
        InputError: it is no such text, or holds what is no number.
    """
    try:
        head = find(path)
        places = chosen(head)
        with path.open(encoding="utf-8-sig") as file, warnings.catch_warnings():
            warnings.filterwarnings("ignore", "loadtxt: input contained no data")
            data = np.loadtxt(
                _rows_as_wide_as(itertools.islice(file, head.lines, None), head, path),
                delimiter=head.delimiter,
                ndmin=2,
                usecols=list(places.values()),
                converters=convert,
            )
    except UnicodeDecodeError:
        raise InputError(f"{path}: {otherwise}") from None
    except InputError:
        raise
    except ValueError as error:
        raise InputError(f"{path}: {_cell_that_is_no_number(path, head, places, convert) or error}") from None
    if data.size == 0:
        raise InputError(f"{path}: holds no row")
    return head, places, data


def _rows(path: Path, head: Head) -> Iterator[tuple[int, list[str]]]:
    """Number of the line, and the cells, of each row of a text below its head."""
    with path.open(encoding="utf-8-sig") as file:
        for number, line in enumerate(itertools.islice(file, head.lines, None), head.lines + 1):
            row = line.partition("#")[0].strip(BLANKS)
            if row.strip():
                yield number, [cell.strip() for cell in row.split(head.delimiter)]


BLANKS = " \r\n"
"""Blanks around a row; a tab stands before an empty cell, or after one."""


def line_of_row(path: Path, row: int, head: Head | None = None) -> int:
    """Number of the line in which a row of a text stands, rows counted from 0 below the head."""
    lines = _rows(path, head or first_line(path))
    return next(number for count, (number, _) in enumerate(lines) if count == row)


_DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+([eE][-+]?\d+)?")

DECIMAL_POINT = "decimal commas are not read: write 0.5, not 0,5"


def _cell_that_is_no_number(
    path: Path, head: Head, places: dict[Name, int], convert: Callable[[str], float] | None
) -> str:
    """Sentence on the first cell of some columns that is no number, with its line and column; empty if none is."""
    for number, cells in _rows(path, head):
        for place in places.values():
            try:
                (convert or float)(cells[place])
            except ValueError:
                if [cell.strip("\"'") for cell in cells[: len(head.names)]] == head.names:
                    return f"line {number} repeats the names of the columns; a file holds one record, so cut it there"
                hint = f"; {DECIMAL_POINT}" if _DECIMAL_COMMA.fullmatch(cells[place]) else ""
                return f"line {number}: column {head.names[place]!r} holds {cells[place]!r}, which is no number{hint}"
    return ""


def header(line: str) -> tuple[list[str], str | None]:
    """Names of the columns, and what stands between them (None: blanks)."""
    line = line.strip().lstrip("#").strip()
    delimiter = next((mark for mark in (";", ",", "\t") if mark in line), None)
    names = [name.strip().strip("\"'") for name in line.split(delimiter)]
    while len(names) > 1 and not names[-1]:  # a delimiter at the end of each line
        names.pop()
    return names, delimiter


def _rows_as_wide_as(lines: Iterable[str], head: Head, path: Path) -> Iterator[str]:
    """The lines, as long as each has as many columns as there are names; one may end with a delimiter."""
    width = len(head.names)
    for number, line in enumerate(lines, head.lines + 1):
        row = line.partition("#")[0].strip(BLANKS)
        if not row.strip():
            continue
        cells = row.split(head.delimiter)
        if len(cells) != width and (len(cells) != width + 1 or cells[-1].strip()):
            where = "the first line" if head.lines == 1 else "the line of names"
            hint = f"; {DECIMAL_POINT}" if head.delimiter == "," and len(cells) > width else ""
            raise InputError(f"{path}: {width} names in {where}, but {len(cells)} columns in line {number}{hint}")
        yield line


def _from_grid(path: Path, columns: dict[str, Floats]) -> TrajectoryTable:
    values = {name: columns[name] for name in VALUES if name in columns}
    shape = next(iter(values.values())).shape
    time = columns.get("time", np.zeros(0))
    if time.shape != shape[:1] or any(value.shape != shape for value in values.values()):
        raise InputError(f"{path}: arrays do not fit together; needed are time [frame], values [frame, chain, bead]")
    if not np.all(np.diff(time) > 0.0):
        raise InputError(f"{path}: times are not ascending")
    chains = _numbers(path, "chain", columns.get("chain", np.arange(1.0, shape[1] + 1)))
    beads = _numbers(path, "bead", columns.get("bead", np.arange(1.0, shape[2] + 1)))
    if chains.shape != shape[1:2] or beads.shape != shape[2:]:
        raise InputError(f"{path}: chain and bead do not number the last two axes")
    if len(np.unique(chains)) < len(chains) or len(np.unique(beads)) < len(beads):
        raise InputError(f"{path}: a chain or bead is named twice")
    by_chain, by_bead = np.argsort(chains), np.argsort(beads)
    ordered = {name: value[:, by_chain][:, :, by_bead] for name, value in values.items()}
    return TrajectoryTable(time, chains[by_chain], beads[by_bead], ordered.get("displacement"), ordered.get("velocity"))


def _on_grid(path: Path, columns: dict[str, Floats]) -> TrajectoryTable:
    if any(column.ndim != 1 for column in columns.values()) or len({len(column) for column in columns.values()}) > 1:
        raise InputError(f"{path}: columns have different lengths")
    time, at_time = np.unique(columns["time"], return_inverse=True)
    chains, at_chain = np.unique(_numbers(path, "chain", columns["chain"]), return_inverse=True)
    beads, at_bead = np.unique(_numbers(path, "bead", columns["bead"]), return_inverse=True)
    shape = (len(time), len(chains), len(beads))
    if 8 * math.prod(shape) > MAX_BYTES:
        raise InputError(
            f"{path}: {len(time)} times of {len(chains)} chains and {len(beads)} beads are too many; "
            "is `time` the same in all rows of a frame?"
        )
    place = np.ravel_multi_index((at_time, at_chain, at_bead), shape)
    if len(np.unique(place)) < len(place):
        raise InputError(f"{path}: a time, chain and bead is given twice")

    def grid(name: str) -> Floats | None:
        """Values of a column, [frame, chain, bead]; None without that column."""
        if name not in columns:
            return None
        values = np.full(shape, np.nan)
        values.flat[place] = columns[name]
        return values

    return TrajectoryTable(time, chains, beads, grid("displacement"), grid("velocity"))


def _numbers(path: Path, name: str, column: Floats) -> Integers:
    if not np.all((column == np.round(column)) & (column >= 0.0) & (column <= MAX_NUMBER)):
        raise InputError(f"{path}: column {name!r} holds what is not the number of a {name}")
    return column.astype(np.int64)
