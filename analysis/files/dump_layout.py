"""The header of a frame in a LAMMPS binary dump: what stands where, and what a file is that begins differently.

One frame in the file (little endian, nothing is padded; revision 2, written by LAMMPS since 2021):

| bytes         | type           | what                                                               |
|---------------|----------------|--------------------------------------------------------------------|
| 8 + 10        | int64, char    | -10, ``DUMPCUSTOM``                                                |
| 4 + 4         | int32          | 1 (byte order), 2 (revision)                                       |
| 8 + 8         | int64          | step, number of atoms                                              |
| 4 + 24        | int32          | 0 for an orthogonal box, kinds of the 6 boundaries                 |
| 48            | float64        | box: xlo xhi ylo yhi zlo zhi                                       |
| 4             | int32          | number of columns                                                  |
| 4 + n         | int32, char    | length and name of the units (in the first frame only, if at all)  |
| 1 or 1 + 8    | int8, float64  | whether a time follows, the time                                   |
| 4 + n         | int32, char    | length and names of the columns                                    |
| 4             | int32          | number of chunks, one per MPI rank                                 |
| 4 + 8n, each  | int32, float64 | n, and the rows of the chunk, in no order: atoms are placed by id  |
"""

import struct
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # takes a while to import
    from lammps_inputs import Problem

MAGIC = struct.pack("<q10s", -10, b"DUMPCUSTOM")
STEP_AT = len(MAGIC) + 8
BOX_AT = STEP_AT + 8 + 8 + 4 + 24
PROBE_BYTES = 512
HEADER = 154
"""Size in bytes of the header of a frame that LAMMPS writes on one rank."""

MAX_NAMES, _MAX_RANKS = 1 << 16, 1 << 22


@dataclass(frozen=True)
class DumpLayout:
    """Places and sizes of the parts of a frame; two frames of one layout differ in step, box, time and rows only."""

    atoms: int
    columns: tuple[str, ...]
    time_at: int | None
    header: int
    chunks: int

    @property
    def size(self) -> int:
        """Bytes of a frame, header included."""
        return self.header + 4 * self.chunks + 8 * self.atoms * len(self.columns)


def sizes(problem: "Problem") -> tuple[float, float]:
    """Size of a frame, and of all frames of a run, in bytes."""
    columns = 4 if problem.rows.follow else 3
    frame = HEADER + 8.0 * columns * problem.chains * problem.rows.count
    return frame, frame * (problem.frames + 1)


def parse(raw: bytes) -> DumpLayout:
    """Layout of the frame that begins with these bytes.

    Raises:
        ValueError: not the header of a frame; the text says why.
        struct.error: the bytes end within the header, and are right as far as they go.
    """
    at = 0

    def take(fields: str) -> tuple[int, ...]:
        nonlocal at
        values = struct.unpack_from(f"<{fields}", raw, at)
        at += struct.calcsize(f"<{fields}")
        return values

    def take_text(limit: int, name: str) -> str:
        nonlocal at
        (length,) = take("i")
        if not 0 <= length <= limit:
            raise ValueError(f"{length} bytes of {name}")
        (text,) = struct.unpack_from(f"<{length}s", raw, at)
        at += length
        return str(text, "ascii", "replace")

    if not (raw.startswith(MAGIC) or MAGIC.startswith(raw)):
        raise ValueError(_kind_of(raw))
    at = len(MAGIC)
    order, revision = take("2i")
    if order != 1 or revision != 2:
        raise ValueError(f"byte order {order} and revision {revision} of the format; 1 and 2 are read here")
    _, atoms = take("2q")
    if atoms < 1:
        raise ValueError(f"{atoms} atoms")
    triclinic, *boundary = take("7i")
    if triclinic == 1:
        raise ValueError("its box is sheared (triclinic); decks of granchain have orthogonal boxes")
    if triclinic != 0 or not all(0 <= kind <= 3 for kind in boundary):
        raise ValueError(f"box of kind {triclinic}, boundaries {boundary}")
    take("6d")
    (columns,) = take("i")
    take_text(MAX_NAMES, "units")
    (timed,) = take("b")
    if timed not in (0, 1):
        raise ValueError(f"time flag {timed}")
    time_at = at if timed else None
    at += 8 * timed
    names = tuple(take_text(MAX_NAMES, "column names").split())
    if len(names) != columns or "id" not in names:
        raise ValueError(f"{columns} columns with the names {' '.join(names)[:80]!r}; `id` must be among them")
    (chunks,) = take("i")
    if not 1 <= chunks <= _MAX_RANKS:
        raise ValueError(f"{chunks} chunks")
    return DumpLayout(atoms, names, time_at, at, chunks)


def last_step(path: Path) -> int | None:
    """Step of the last whole frame of a file whose frames all have the size of its first, from two headers alone.

    None where there is no frame, or none to be read.
    """
    try:
        with path.open("rb") as file:
            layout = parse(file.read(PROBE_BYTES))
            frames = file.seek(0, 2) // layout.size
            if frames == 0:
                return None
            file.seek((frames - 1) * layout.size)
            head = file.read(STEP_AT + 8)
    except (OSError, ValueError, struct.error):
        return None
    return int(struct.unpack_from("<q", head, STEP_AT)[0]) if head.startswith(MAGIC) else None


def header(step: int, time: float, atoms: int, box: Iterable[float], columns: str) -> bytes:
    """Bytes of a frame before the rows of its only chunk.

    Args:
        step: number of the time step.
        time: time at that step.
        atoms: number of rows that follow.
        box: xlo xhi ylo yhi zlo zhi.
        columns: names of the columns with a blank between two; one of them is ``id``.
    """
    names = columns.encode("ascii")
    count = len(names.split())
    boundary = (2, 2, 1, 1, 1, 1)  # s f f
    fields = f"<2i2q7i6d2ibdi{len(names)}s2i"
    head = (1, 2, step, atoms, 0, *boundary, *box, count, 0, 1, time, len(names), names)
    return MAGIC + struct.pack(fields, *head, 1, count * atoms)


def _kind_of(raw: bytes) -> str:
    """What a file that does not begin like our dumps probably is."""
    if raw.startswith(b"ITEM:"):
        return "it is a text dump; MDAnalysis reads those with format='LAMMPSDUMP'"
    if raw.startswith(struct.pack("<q8s", -8, b"DUMPATOM")):
        return "it is a dump of style atom; use `dump ... custom FILE.bin id x vx`"
    if raw.startswith(MAGIC[7::-1]):
        return "it was written on a big-endian machine"
    if len(raw) >= BOX_AT - 26:
        step, atoms, triclinic, *boundary = struct.unpack_from("<2q7i", raw)
        if step >= 0 < atoms and triclinic in (0, 1) and all(0 <= kind <= 3 for kind in boundary) and any(raw[:44]):
            return "if it is one, LAMMPS before 2021 wrote it, without names of columns"
    return "it begins differently"
