"""A trajectory that LAMMPS wrote as text (``dump ... custom FILE id x vx``), from any deck of the same beads.

Atoms are numbered chain after chain. Displacements are from the first frame, which is the start; so it does not matter
where the deck has its beads. Numbers are as exact as ``dump_modify format`` made them.
"""

import math
from itertools import islice
from pathlib import Path
from typing import TextIO

import numpy as np

from analysis.files.table import MAX_BYTES, Table
from analysis.trajectory import Floats
from lammps_inputs import InputError

_FIRST = "ITEM: TIMESTEP"
_POSITIONS = ("x", "xu")


def is_one(path: Path) -> bool:
    """Whether a file begins as such a dump does."""
    try:
        with path.open("rb") as file:
            start = file.read(64)
    except OSError:
        return False
    return start.lstrip().startswith((b"ITEM: TIMESTEP", b"ITEM: UNITS", b"ITEM: TIME"))


def load(path: Path, beads: int, timestep: float) -> Table:
    """Read a dump; what is cut off at its end is left out.

    Args:
        path: the file.
        beads: in every chain.
        timestep: of the deck, in the units that the table is to have; not needed where frames know their time.

    Raises:
        InputError: it cannot be read, lacks a column, or has atoms that come and go.
    """
    if path.stat().st_size > MAX_BYTES:
        raise InputError(f"{path}: larger than 4 GiB; write fewer frames or beads")
    times: list[float] = []
    frames: list[Floats] = []
    names: list[str] = []
    try:
        with path.open(encoding="utf-8") as file:
            while (read := _frame(file, path)) is not None:
                step, told, names, rows = read
                times.append(step * timestep if told is None else told)
                frames.append(rows[np.argsort(rows[:, names.index("id")])])
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    except (UnicodeDecodeError, ValueError) as error:
        raise InputError(f"{path}: is no text dump of LAMMPS ({error})") from None
    if len(frames) < 2:
        raise InputError(f"{path}: holds {len(frames)} whole frames; a start and at least one more are needed")
    atom = frames[0][:, names.index("id")]
    if any(rows.shape != frames[0].shape or np.any(rows[:, names.index("id")] != atom) for rows in frames):
        raise InputError(f"{path}: not the same atoms in all frames")
    chain, bead = np.divmod(atom.astype(np.int64) - 1, beads)
    chains, numbers = np.unique(chain), np.unique(bead)
    if len(chains) * len(numbers) != len(atom) or np.any(atom < 1):
        raise InputError(
            f"{path}: its {len(atom)} atoms are not the same beads of chains of {beads}, one after the other"
        )
    values = np.stack(frames).reshape(len(frames), len(chains), len(numbers), -1)
    if not np.all(np.isfinite(values)):
        raise InputError(f"{path}: holds what is not a finite number")
    position = next((values[..., names.index(name)] for name in _POSITIONS if name in names), None)
    time = np.array(times)
    if not np.all(np.diff(time) > 0.0):
        raise InputError(f"{path}: times are not ascending")
    return Table(
        time=time,
        chains=chains + 1,
        beads=numbers + 1,
        displacement=None if position is None else position - position[0],
        velocity=values[..., names.index("vx")] if "vx" in names else None,
    )


def _frame(file: TextIO, path: Path) -> tuple[int, float | None, list[str], Floats] | None:
    """Step, time if it is told, names of the columns, and [atom, column] of the next whole frame; None at the end."""
    step, time, count = -1, None, -1
    while line := file.readline():
        item = line.strip()
        if item == _FIRST:
            step = int(file.readline())
        elif item == "ITEM: TIME":
            time = float(file.readline())
        elif item == "ITEM: NUMBER OF ATOMS":
            count = int(file.readline())
        elif item.startswith("ITEM: ATOMS"):
            names = item.split()[2:]
            if "id" not in names or not {"vx", *_POSITIONS} & set(names):
                raise InputError(f"{path}: its columns are {' '.join(names)}; id, and x or vx, are needed")
            rows = list(islice(file, count))
            if step < 0 or count < 1 or len(rows) < count or not rows[-1].endswith("\n"):
                return None
            found = np.loadtxt(rows, ndmin=2, dtype=np.float64)
            if found.shape[1] != len(names):
                raise ValueError(f"{len(names)} columns are named, {found.shape[1]} found")
            return step, time if time is None or math.isfinite(time) else None, names, found
    return None
