"""MDAnalysis's reader of LAMMPS binary dumps (``.bin``), with the float64 columns of the file in ``ts.data``."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from MDAnalysis.coordinates.base import ReaderBase
from MDAnalysis.lib.util import store_init_arguments
from numpy.typing import ArrayLike

from analysis.files.binary_dump import BinaryDump
from analysis.files.parts import Parts
from analysis.mda.frame import FORMAT, POSITION, UNITS, VELOCITY, dimensions, lines
from analysis.mda.writer import BinaryDumpWriter
from analysis.trajectory import Floats, Measured
from lammps_inputs import InputError
from lammps_inputs.units import Scale

_AHEAD_BYTES = 1 << 17  # frames read ahead when they are asked for one after the other


class BinaryDumpReader(ReaderBase):  # type: ignore[misc]  # MDAnalysis has no types
    """LAMMPS binary dumps of style custom, frame by frame in any order.

    In ``ts.data``, in ascending order of atom id, float64:

    - each column of the dump by its name (``x``, ``vx``, ...);
    - ``velocity``: the column ``vx``;
    - ``displacement``: ``x`` minus the positions at rest, if these are known; in a window those of the rows in ``mol``;
    - ``si``: time, displacement and velocity in the scene's units, if the scale is given;

    and ``step``, ``time``, ``dt`` (time between the first two frames) and ``box`` (bounds, see `analysis.mda.frame`).

    Numbers are dimensionless (V = 1) and are never converted: to MDAnalysis they have no unit.

    Frames of ours have no y, as chains are lines; positions then get the y of the chain, as in ``data.chains``, so that
    chains are seen side by side, also in what MDAnalysis writes (XYZ, DCD, PDB, ...) for VMD or OVITO.
    """

    format = FORMAT
    units = UNITS

    @store_init_arguments  # type: ignore[untyped-decorator]
    def __init__(
        self,
        filename: Any,
        timestep: float | None = None,
        rest: ArrayLike | None = None,
        parts: Sequence[Path | str] = (),
        scale: Scale | None = None,
        **kwargs: Any,
    ) -> None:
        """Open a dump.

        Args:
            filename: the dump.
            timestep: time per step; by default the times in the dump if LAMMPS wrote them, else 1.
            rest: [atom] x of the atoms at rest; by default x of step 0, if that is the first frame.
            parts: further dumps, of a run that was continued; a step that several hold comes from the first of them.
            scale: what one dimensionless unit is worth, the ``scale`` of a problem.
            **kwargs: those of all MDAnalysis readers; ``dt``, the time between the first two frames, is another way to
                give the timestep.

        Raises:
            OSError: a file cannot be read as a binary dump; the text names it and says why.
            ValueError: ``rest`` does not fit the atoms, or both timestep and dt are given.

        Warns:
            CutDumpWarning: the last file ends within a frame, which is left out.
        """
        super().__init__(filename, **kwargs)
        self.filenames = (self.filename, *(str(part) for part in parts))
        try:
            self._dump = Parts(self.filenames)
            self._times = self._frame_times(timestep, self._ts_kwargs.pop("dt", None))
            self._rest = self._rest_positions(rest)
            self._row = self._row_length()
        except InputError as error:  # a ValueError, whose text MDAnalysis would swallow in a list of files
            raise OSError(str(error)) from error
        self._scale = scale
        self._dimensions = dimensions(self._dump.box)
        self._y = None if "y" in self._dump.columns else lines(self._dump.box[0], self._dump.n_atoms)
        self.n_atoms = self._dump.n_atoms
        has_velocities = "vx" in self._dump.columns
        self.ts = self._Timestep(self.n_atoms, velocities=has_velocities, reader=self, **self._ts_kwargs)
        self.ts.positions = np.zeros((self.n_atoms, 3), dtype=np.float32)
        if has_velocities:
            self.ts.velocities = np.zeros((self.n_atoms, 3), dtype=np.float32)
        self.ts.dt = float(self._times[1] - self._times[0]) if self.n_frames > 1 else 1.0
        self._reopen()
        self._read_next_timestep()

    @classmethod
    def parse_n_atoms(cls, filename: Any, **_: Any) -> int:
        """Number of atoms in a dump."""
        return BinaryDump(filename).n_atoms

    @property
    def n_frames(self) -> int:
        """Number of whole frames."""
        return self._dump.n_frames

    def close(self) -> None:
        """Nothing stays open between two frames."""

    def Writer(self, filename: Any, n_atoms: int | None = None, **kwargs: Any) -> BinaryDumpWriter:  # noqa: N802
        """A writer of the same format, and of as many atoms unless another number is given."""
        return BinaryDumpWriter(filename, n_atoms=self.n_atoms if n_atoms is None else n_atoms, **kwargs)

    def _frame_times(self, timestep: float | None, dt: float | None) -> Floats:
        if timestep is not None and dt is not None:
            raise ValueError("give either timestep (time per step) or dt (time per frame)")
        steps = self._dump.steps
        if dt is not None:
            timestep = dt / float(steps[1] - steps[0]) if len(steps) > 1 else dt
        if timestep is None and self._dump.times is not None:
            return self._dump.times
        return np.asarray(steps * (1.0 if timestep is None else timestep), dtype=np.float64)

    def _rest_positions(self, rest: ArrayLike | None) -> Floats | None:
        columns = self._dump.columns
        if "x" not in columns:
            return None
        if rest is None:
            return self._dump.read(0, 1)[0, columns.index("x")] if self._dump.steps[0] == 0 else None
        positions = np.array(rest, dtype=np.float64).reshape(-1)
        if len(positions) != self._dump.n_atoms:
            raise ValueError(f"rest holds {len(positions)} positions; {self.filename} has {self._dump.n_atoms} atoms")
        return positions

    def _row_length(self) -> float | None:
        """Distance between rows in a window, whose molecules are its rows: where they are at rest. None elsewhere."""
        columns = self._dump.columns
        if self._rest is None or "mol" not in columns or self._dump.steps[0] != 0:
            return None
        x, row = (self._dump.read(0, 1)[0, columns.index(name)] for name in ("x", "mol"))
        length = float(x[0] / row[0]) if row[0] else 0.0
        return length if np.array_equal(x, row * length) else None

    def _reopen(self) -> None:
        self.ts.frame = -1
        self.ts.data["time"] = float(self._times[0]) - self.ts.dt
        self._first = 0
        self._ahead: Floats = np.empty((0, len(self._dump.columns), self.n_atoms))

    def _read_next_timestep(self) -> Any:
        if self.ts.frame + 1 >= self.n_frames:
            raise EOFError
        return self._read_frame(self.ts.frame + 1)

    def _read_frame(self, frame: int) -> Any:
        if not self._first <= frame < self._first + len(self._ahead):
            in_a_row = frame == self._first + len(self._ahead)
            count = max(1, _AHEAD_BYTES // (8 * len(self._dump.columns) * self.n_atoms)) if in_a_row else 1
            self._ahead = self._dump.read(frame, count)
            self._first = frame
        self._fill(frame, self._ahead[frame - self._first].copy())
        return self.ts

    def _fill(self, frame: int, values: Floats) -> None:
        """Put a frame into the timestep; values are [column, atom]."""
        ts, data = self.ts, self.ts.data
        ts.frame = frame
        ts.dimensions = self._dimensions[frame]
        data["step"] = int(self._dump.steps[frame])
        data["time"] = float(self._times[frame])
        data["box"] = self._dump.box[frame].copy()
        for name, column in zip(self._dump.columns, values, strict=True):
            data[name] = column
            if name in POSITION:
                ts.positions[:, POSITION[name]] = column
            elif name in VELOCITY and ts.has_velocities:
                ts.velocities[:, VELOCITY[name]] = column
        if self._y is not None:
            ts.positions[:, 1] = self._y
        if ts.has_velocities:
            data["velocity"] = data["vx"]
        if self._rest is not None:
            data["displacement"] = data["x"] - (self._rest if self._row is None else data["mol"] * self._row)
        if self._scale is not None and {"velocity", "displacement"} <= data.keys():
            scale = self._scale
            data["si"] = Measured(
                data["time"] * scale.time, data["displacement"] * scale.length, data["velocity"] * scale.velocity
            )
