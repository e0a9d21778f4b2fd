"""MDAnalysis's writer of LAMMPS binary dumps: ``atoms.write("part.bin", frames=universe.trajectory[::10])``."""

from io import BufferedWriter
from pathlib import Path
from typing import Any

import numpy as np
from MDAnalysis.coordinates.base import WriterBase

from analysis.files.dump_layout import header
from analysis.mda.frame import DERIVED, FORMAT, POSITION, UNITS, VELOCITY, bounds, dimensions, lines
from analysis.trajectory import Floats

_FIRST = ("mol", *POSITION, *VELOCITY)


class BinaryDumpWriter(WriterBase):  # type: ignore[misc]  # MDAnalysis has no types
    """LAMMPS binary dumps of style custom, of some or all atoms, each frame with its step, time and box.

    Columns are ``id`` and the arrays [atom] in ``ts.data``, to the last bit. Positions and velocities that are not
    there (all of them, where another reader has read) are written as MDAnalysis has them, in float32; so is y where
    fewer atoms are written than there were, as it then says which chain a bead is in.
    """

    format = FORMAT
    multiframe = True
    units = UNITS

    def __init__(self, filename: Any, n_atoms: int | None = None, **_: Any) -> None:
        """Write to a file, which is replaced when the first frame comes.

        Args:
            filename: the file.
            n_atoms: how many atoms every frame has.

        Raises:
            TypeError: the number of atoms is not given.
        """
        if n_atoms is None:
            raise TypeError("BinaryDumpWriter needs n_atoms")
        self.filename = str(filename)
        self.n_atoms = n_atoms
        self._file: BufferedWriter | None = None
        self._names = ""

    def _write_next_frame(self, obj: Any) -> None:
        """Write the current frame of an AtomGroup or a Universe.

        Raises:
            TypeError: it is neither.
            ValueError: it has another number of atoms, atoms twice, or other columns than the frame before; ``ts.data``
                and ``ts.positions`` (or velocities) disagree; or it is being read from the same file.
        """
        try:
            atoms, trajectory = obj.atoms, obj.universe.trajectory
        except AttributeError:
            raise TypeError(f"{self.filename}: an AtomGroup or a Universe can be written, no {type(obj)}") from None
        ids = atoms.ids if hasattr(atoms, "ids") else atoms.ix + 1
        if len(ids) != self.n_atoms or len(np.unique(ids)) < len(ids):
            raise ValueError(f"{self.filename}: {self.n_atoms} atoms are to be written, each once; not {len(ids)}")
        ts = trajectory.ts
        box = _box(ts)
        columns = _columns(ts, atoms.ix, box)
        names = " ".join(("id", *columns))
        if self._file is None:
            self._file = self._opened(trajectory)
            self._names = names
        if self._names != names:
            raise ValueError(f"{self.filename}: a frame has columns {names}; before it was {self._names}")
        rows = np.stack([ids, *columns.values()], axis=1).astype("<f8")
        step = int(ts.data.get("step", ts.frame))
        head = header(step, float(ts.time), len(ids), box[:, :2].reshape(-1), box[:, 2:].reshape(-1), names)
        self._file.write(head + rows.tobytes())
        self._file.flush()

    def _opened(self, trajectory: Any) -> BufferedWriter:
        path = Path(self.filename)
        sources = getattr(trajectory, "filenames", None)
        for source in (trajectory.filename,) if sources is None else sources:
            if path.exists() and source is not None and Path(str(source)).exists() and path.samefile(str(source)):
                raise ValueError(f"{path}: is what is being read; write to another file")
        return path.open("wb")

    def close(self) -> None:
        """Close the file."""
        if getattr(self, "_file", None) is not None:
            self._file.close()  # type: ignore[union-attr]
            self._file = None


def _box(ts: Any) -> Floats:
    """The box as it was read, unless it was changed; around the atoms where there is none."""
    if ts.dimensions is None:
        return np.stack([ts.positions.min(axis=0), ts.positions.max(axis=0)], axis=1).astype(np.float64)
    read = ts.data.get("box")
    if read is not None and np.array_equal(dimensions(read[np.newaxis])[0], ts.dimensions):
        return np.asarray(read)
    return bounds(ts.dimensions)


def _columns(ts: Any, chosen: Any, box: Floats) -> dict[str, Any]:
    """Name -> [atom] of all columns but ``id``."""
    found = {
        name: values[chosen]
        for name, values in ts.data.items()
        if name not in DERIVED and isinstance(values, np.ndarray) and values.shape == (ts.n_atoms,)
    }
    seen = [(name, ts.positions[chosen, axis]) for name, axis in POSITION.items()]
    if ts.has_velocities:
        seen += [(name, ts.velocities[chosen, axis]) for name, axis in VELOCITY.items()]
    ours = "x" in found
    for name, values in seen:
        if name not in found:
            implied = lines(box, len(chosen)) if name == "y" else None
            if ours and np.array_equal(values, np.zeros(len(chosen)) if implied is None else np.float32(implied)):
                continue
            found[name] = values
        elif not np.array_equal(np.float32(found[name]), values, equal_nan=True):
            which = "positions" if name in POSITION else "velocities"
            raise ValueError(
                f"ts.data[{name!r}] and ts.{which} disagree: what changes one of them must change the other, or "
                f"`del ts.data[{name!r}]`"
            )
    return dict(sorted(found.items(), key=lambda item: _FIRST.index(item[0]) if item[0] in _FIRST else len(_FIRST)))
