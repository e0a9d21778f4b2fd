"""Text dumps of LAMMPS (``dump ... custom FILE id x vx``), of a scene's deck or of the deck that it was adopted from.

Without a map of atoms these are numbered chain after chain and move along x. Displacements are from the first frame,
which is the start; so it does not matter where the deck has its beads, and there are none where a dump begins later.
Positions may be scaled (``dump ... atom``), files compressed (``dump ... custom/gz``). Numbers are as exact as
``dump_modify format`` made them.
"""

import gzip
import io
import math
import zlib
from itertools import islice
from pathlib import Path
from typing import BinaryIO, NamedTuple, TextIO, cast

import numpy as np

from analysis.files.table import MAX_BYTES, TrajectoryTable
from analysis.trajectory import Floats, Integers
from lammps_inputs import InputError
from lammps_inputs.deck_atoms import DeckAtoms

_FIRST = "ITEM: TIMESTEP"
_SCALED = ("s", "su")


class DumpFrame(NamedTuple):
    """One frame of a dump.

    Attributes:
        step: number of the time step.
        time: time of the frame; None where the dump does not state it.
        names: names of the columns that were read: id, then position and velocity where they exist.
        rows: [atom, column]; positions as they stand in the file.
        origin: position of a stated 0.
        unit: length of a stated 1: 1, or the box of scaled positions.
        period: length after which positions begin again, of a box that is periodic along the chains; 0 of others.
    """

    step: int
    time: float | None
    names: list[str]
    rows: Floats
    origin: float = 0.0
    unit: float = 1.0
    period: float = 0.0


def is_text_dump(path: Path) -> bool:
    """Whether a file begins as a text dump of LAMMPS does."""
    try:
        with _opened(path) as file:
            start = file.read(64)
    except (OSError, EOFError, zlib.error):
        return False
    return start.lstrip().startswith((b"ITEM: TIMESTEP", b"ITEM: UNITS", b"ITEM: TIME"))


def _opened(path: Path) -> BinaryIO:
    """A file for reading, decompressed if it is one of gzip, as those of ``dump custom/gz`` are."""
    with path.open("rb") as file:
        compressed = file.read(2) == b"\x1f\x8b"
    return cast(BinaryIO, gzip.open(path, "rb")) if compressed else path.open("rb")


def load_dump(path: Path, beads: int, timestep: float, deck: DeckAtoms | None = None) -> TrajectoryTable:
    """Read a dump; what is cut off at its end is left out.

    Args:
        path: the file.
        beads: in every chain.
        timestep: of the deck, in the units that the table is to have; not needed where frames know their time.
        deck: which atom is which bead; None where atoms are numbered chain after chain and move along x.

    Returns:
        The table; displacement is None where the first frame is later than the start.

    Raises:
        InputError: it cannot be read, lacks a column, or has atoms that come and go.
    """
    if path.stat().st_size > MAX_BYTES:
        raise InputError(f"{path}: larger than 4 GiB; write fewer frames or beads")
    frames = _frames(path, "x" if deck is None else deck.axis[-1])
    if len(frames) < 2:
        raise InputError(f"{path}: holds {len(frames)} complete frames; a start and at least one more are needed")
    first = frames[0]
    if any(frame.rows.shape != first.rows.shape or np.any(frame.rows[:, 0] != first.rows[:, 0]) for frame in frames):
        raise InputError(f"{path}: not the same atoms in all frames")
    atoms = first.rows[:, 0].astype(np.int64)
    of_bead = _atoms_of_beads(path, atoms, beads) if deck is None else _atoms_of_deck(path, atoms, deck)
    if not all(np.all(np.isfinite(frame.rows)) for frame in frames):
        raise InputError(f"{path}: holds what is not a finite number")
    first_step = 0 if deck is None else deck.first_step
    time = np.array([(f.step - first_step) * timestep if f.time is None else f.time for f in frames])
    if not np.all(np.diff(time) > 0.0):
        raise InputError(f"{path}: times are not ascending")
    values = np.stack([frame.rows for frame in frames])
    sign = 1.0 if deck is None else deck.sign
    stated = values[..., 1] if "position" in first.names else None
    origin, unit = np.array([(frame.origin, frame.unit) for frame in frames]).T[:, :, np.newaxis]
    position = None if stated is None else sign * (origin + unit * stated)
    if position is not None and first.period:  # atoms that leave a periodic box enter it at the other end
        position = np.unwrap(position, period=first.period, axis=0)
    velocity = sign * values[..., -1] if "velocity" in first.names else None
    late = time[0] > 0.5 * timestep
    if late and velocity is None:
        raise InputError(
            f"{path}: begins at step {first.step}, after the start, so that displacements are unknown, and has no "
            "velocities; write frames from the start on"
        )
    return TrajectoryTable(
        time=time,
        chains=np.arange(of_bead.shape[0]) + 1 if deck is not None else np.unique((atoms - 1) // beads) + 1,
        beads=np.arange(of_bead.shape[1]) + 1 if deck is not None else np.unique((atoms - 1) % beads) + 1,
        displacement=None if position is None or late else _placed(position - position[0], of_bead),
        velocity=None if velocity is None else _placed(velocity, of_bead),
        position=None if stated is None or late else _placed(stated, of_bead),
        position_unit=float(np.max(unit)),
        dump=True,
    )


def _frames(path: Path, axis: str) -> list[DumpFrame]:
    """All complete frames, their atoms in ascending order of their numbers."""
    frames: list[DumpFrame] = []
    try:
        with io.TextIOWrapper(_opened(path), encoding="utf-8") as file:
            while (frame := _frame(file, path, axis)) is not None:
                frames.append(frame._replace(rows=frame.rows[np.argsort(frame.rows[:, 0])]))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    except (EOFError, zlib.error) as error:
        raise InputError(f"{path}: the compressed file is cut or damaged ({error})") from None
    except (UnicodeDecodeError, ValueError) as error:
        raise InputError(f"{path}: is no text dump of LAMMPS ({error})") from None
    return frames


def _placed(values: Floats, of_bead: Integers) -> Floats:
    """Values [frame, atom] as [frame, chain, bead]; NaN where a bead has no atom in the dump."""
    return np.where(of_bead >= 0, values[:, np.maximum(of_bead, 0)], np.nan)


def _atoms_of_beads(path: Path, atoms: Integers, beads: int) -> Integers:
    """Places of the atoms of all beads, [chain, bead], that are numbered chain after chain."""
    chain, bead = np.divmod(atoms - 1, beads)
    shape = len(np.unique(chain)), len(np.unique(bead))
    if math.prod(shape) != len(atoms) or np.any(atoms < 1):
        raise InputError(
            f"{path}: its {len(atoms)} atoms are not the same beads of chains of {beads}, one after the other"
        )
    return np.arange(len(atoms)).reshape(shape)


def _atoms_of_deck(path: Path, atoms: Integers, deck: DeckAtoms) -> Integers:
    """Places of the atoms of all beads, [chain, bead], by their numbers in a deck; -1 where the dump lacks one."""
    numbers = deck.numbers
    place = np.clip(np.searchsorted(atoms, numbers), 0, len(atoms) - 1)
    present = atoms[place] == numbers
    if not np.any(present):
        raise InputError(
            f"{path}: has none of the atoms of {deck.deck} that are beads ({', '.join(deck.atoms)}), by the scene's "
            "key `adopted`"
        )
    return np.where(present, place, -1)


def _frame(file: TextIO, path: Path, axis: str) -> DumpFrame | None:
    """The next complete frame, with positions and velocities along an axis; None at the end."""
    step, time, count = -1, None, -1
    box: list[str] = []
    flags: list[str] = []
    while line := file.readline():
        item = line.strip()
        if item == _FIRST:
            step = int(file.readline())
        elif item == "ITEM: TIME":
            time = float(file.readline())
        elif item == "ITEM: NUMBER OF ATOMS":
            count = int(file.readline())
        elif item.startswith("ITEM: BOX BOUNDS"):
            box, flags = [file.readline() for _ in "xyz"], item.split()[3:6]
        elif item.startswith("ITEM: ATOMS"):
            columns = item.split()[2:]
            chosen = _columns(path, columns, axis)
            lines = list(islice(file, count))
            if step < 0 or count < 1 or len(lines) < count or not lines[-1].endswith("\n"):
                return None
            if (width := len(lines[0].split())) != len(columns):
                raise ValueError(f"{len(columns)} columns are named, {width} found")
            rows = np.loadtxt(lines, ndmin=2, dtype=np.float64, usecols=[columns.index(n) for n in chosen.values()])
            low, high, along, column = 0.0, 1.0, "xyz".index(axis), chosen.get("position", axis)
            ends = [float(word) for word in box[along].split()[:2]] if box else [0.0, 0.0]
            if column.removeprefix(axis) in _SCALED:
                low, high = ends
            wraps = flags[along : along + 1] == ["pp"] and not column.endswith("u")
            finite = None if time is None or not math.isfinite(time) else time
            return DumpFrame(step, finite, list(chosen), rows, low, high - low, wraps * (ends[1] - ends[0]))
    return None


def _columns(path: Path, columns: list[str], axis: str) -> dict[str, str]:
    """Names of the columns of id, position and velocity along an axis, of the last two those that exist."""
    positions = (f"{axis}{suffix}" for suffix in ("u", "", "su", "s"))
    position = next((name for name in positions if name in columns), None)
    chosen = {"id": "id"}
    chosen |= {} if position is None else {"position": position}
    chosen |= {"velocity": f"v{axis}"} if f"v{axis}" in columns else {}
    if "id" not in columns or len(chosen) < 2:
        raise InputError(f"{path}: its columns are {' '.join(columns)}; id, and {axis} or v{axis}, are needed")
    return chosen
