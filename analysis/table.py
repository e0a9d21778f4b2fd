"""A user's own trajectory in a file: a long table of time, chain, bead, displacement and/or velocity, or the same as npz.

Text has a header line with the column names and commas or blanks between columns. An npz holds arrays under those names:
one number per row of such a table, or ``time`` [frame] with ``displacement`` and ``velocity`` [frame, chain, bead].
"""

import re
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analysis.trajectory import Floats
from lammps_inputs import InputError

KEYS = ("time", "chain", "bead")
VALUES = ("displacement", "velocity")
MAX_BYTES = 4 << 30


@dataclass(frozen=True)
class Table:
    """Values on a grid of times, chains and beads, in the file's own units.

    Attributes:
        time: [frame], ascending.
        chains, beads: numbers along the other axes, counted from 1.
        displacement, velocity: [frame, chain, bead]; None where the file has no such column; NaN where a row is missing.
    """

    time: Floats
    chains: NDArray[np.int64]
    beads: NDArray[np.int64]
    displacement: Floats | None
    velocity: Floats | None


def load(path: Path) -> Table:
    """Read a table.

    Raises:
        InputError: the file is missing, not of either kind, lacks a column, or names a place twice.
    """
    try:
        if path.stat().st_size > MAX_BYTES:
            raise InputError(f"{path}: larger than 4 GiB; write fewer frames or beads")
        with path.open("rb") as file:
            start = file.read(4)
        columns = _from_npz(path) if start[:2] == b"PK" else _from_text(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    present = [name for name in VALUES if name in columns]
    if not present:
        raise InputError(f"{path}: has neither a displacement nor a velocity column")
    if columns[present[0]].ndim == 3:
        return _from_grid(path, columns)
    for name in KEYS:
        if name not in columns:
            raise InputError(f"{path}: has no column {name!r}")
    return _on_grid(path, columns)


def _from_npz(path: Path) -> dict[str, Floats]:
    try:
        with np.load(path, allow_pickle=False) as archive:
            return {name: np.asarray(archive[name], dtype=np.float64) for name in (*KEYS, *VALUES) if name in archive}
    except (ValueError, zipfile.BadZipFile, EOFError) as error:
        raise InputError(f"{path}: is not an npz of plain numbers ({error})") from None


def _from_text(path: Path) -> dict[str, Floats]:
    try:
        with path.open(encoding="utf-8-sig") as file:
            head = file.readline()
            delimiter = "," if "," in head else None
            names = [name for name in re.split(r"[,\s]+", head.strip().lstrip("#").strip()) if name]
            if not set(names) & {*KEYS, *VALUES}:
                raise InputError(f"{path}: its first line names no column; wanted are {', '.join((*KEYS, *VALUES))}")
            data = np.loadtxt(file, delimiter=delimiter, ndmin=2, dtype=np.float64)
    except UnicodeDecodeError:
        raise InputError(f"{path}: is neither a text table nor an npz") from None
    except ValueError as error:
        raise InputError(f"{path}: {error}") from None
    if data.shape[1] != len(names):
        raise InputError(f"{path}: {len(names)} names in the first line, but {data.shape[1]} columns of numbers")
    return {name: data[:, k] for k, name in enumerate(names)}


def _from_grid(path: Path, columns: dict[str, Floats]) -> Table:
    values = {name: columns[name] for name in VALUES if name in columns}
    shape = next(iter(values.values())).shape
    time = columns.get("time", np.zeros(0))
    if time.shape != shape[:1] or any(value.shape != shape for value in values.values()):
        raise InputError(f"{path}: arrays do not fit together; wanted are time [frame], values [frame, chain, bead]")
    if not np.all(np.diff(time) > 0.0):
        raise InputError(f"{path}: times are not ascending")
    chains = columns.get("chain", np.arange(1.0, shape[1] + 1))
    beads = columns.get("bead", np.arange(1.0, shape[2] + 1))
    if chains.shape != shape[1:2] or beads.shape != shape[2:]:
        raise InputError(f"{path}: chain and bead do not number the last two axes")
    return Table(
        time, chains.astype(np.int64), beads.astype(np.int64), values.get("displacement"), values.get("velocity")
    )


def _on_grid(path: Path, columns: dict[str, Floats]) -> Table:
    lengths = {len(columns[name]) for name in (*KEYS, *VALUES) if name in columns}
    if len(lengths) != 1 or any(columns[name].ndim != 1 for name in (*KEYS, *VALUES) if name in columns):
        raise InputError(f"{path}: columns have different lengths")
    for name in ("chain", "bead"):
        if not np.all(columns[name] == np.round(columns[name])):
            raise InputError(f"{path}: column {name!r} holds numbers that are not whole")
    time, at_time = np.unique(columns["time"], return_inverse=True)
    chains, at_chain = np.unique(columns["chain"].astype(np.int64), return_inverse=True)
    beads, at_bead = np.unique(columns["bead"].astype(np.int64), return_inverse=True)
    shape = (len(time), len(chains), len(beads))
    place = np.ravel_multi_index((at_time, at_chain, at_bead), shape)
    if len(np.unique(place)) < len(place):
        raise InputError(f"{path}: a time, chain and bead is given twice")

    def grid(name: str) -> Floats | None:
        if name not in columns:
            return None
        values = np.full(shape, np.nan)
        values.flat[place] = columns[name]
        return values

    return Table(time, chains, beads, grid("displacement"), grid("velocity"))
