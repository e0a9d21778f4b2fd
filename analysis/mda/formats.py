"""MDAnalysis reads our run directories once this module is imported: ``mda.Universe("DIR/data.chains", DUMP)``.

- `BinaryDumpReader`: LAMMPS binary dumps (``.bin``), with the float64 columns of the file in ``ts.data``;
- `ChainsParser`: ``data.chains``, with chains as residues, mass 1, springs as bonds, and the recorded beads only.

MDAnalysis has positions and velocities in float32, which is good for viewing; compute with ``ts.data``::

    import MDAnalysis as mda
    import analysis.mda.formats  # registers the formats

    universe = mda.Universe("DIR/data.chains", "DIR/chains.dump.bin", timestep=0.01)
    for ts in universe.trajectory[::10]:
        print(ts.time, ts.data["velocity"].max())

A run that was continued is a list of dumps; then pass ``rest``, the positions at rest, as only the first has step 0.
"""

from typing import Any

import numpy as np
from MDAnalysis.coordinates.base import ReaderBase
from MDAnalysis.lib.mdamath import triclinic_box
from MDAnalysis.lib.util import store_init_arguments
from MDAnalysis.topology.LAMMPSParser import DATAParser
from numpy.typing import ArrayLike

from analysis.files.binary_dump import BinaryDump
from analysis.trajectory import Floats
from lammps_inputs import InputError

_AHEAD_BYTES = 1 << 17  # frames read ahead when they are asked for one after the other
_POSITION = {"x": 0, "y": 1, "z": 2}
_VELOCITY = {"vx": 0, "vy": 1, "vz": 2}


class BinaryDumpReader(ReaderBase):  # type: ignore[misc]  # MDAnalysis has no types
    """LAMMPS binary dumps of style custom, frame by frame in any order.

    In ``ts.data``, in ascending order of atom id, float64:

    - each column of the dump by its name (``x``, ``vx``, ...);
    - ``velocity``: the column ``vx``;
    - ``displacement``: ``x`` minus the positions at rest, if these are known;

    and ``step``, ``time`` and ``dt`` (time between the first two frames).

    Frames of ours have no y, as chains are lines; positions then get the y of the chain, as in ``data.chains``, so that
    chains are seen side by side, also in what MDAnalysis writes (XYZ, DCD, PDB, ...) for VMD or OVITO.
    """

    format = ["BIN", "LAMMPSBIN"]  # noqa: RUF012  MDAnalysis's own way
    units = {"time": None, "length": None, "velocity": None}  # noqa: RUF012

    @store_init_arguments  # type: ignore[untyped-decorator]
    def __init__(
        self, filename: Any, timestep: float | None = None, rest: ArrayLike | None = None, **kwargs: Any
    ) -> None:
        """Open a dump.

        Args:
            filename: the dump.
            timestep: time per step; by default the times in the dump if LAMMPS wrote them, else 1.
            rest: [atom] x of the atoms at rest; by default x of step 0, if that is the first frame.
            **kwargs: those of all MDAnalysis readers; ``dt``, the time between the first two frames, is another way to
                give the timestep.

        Raises:
            OSError: the file cannot be read as a binary dump; the text names it and says why.
            ValueError: ``rest`` does not fit the atoms, or both timestep and dt are given.

        Warns:
            CutDumpWarning: the file ends within a frame, which is left out.
        """
        super().__init__(filename, **kwargs)
        try:
            self._dump = BinaryDump(self.filename)
            self._columns = tuple(name for name in self._dump.columns if name != "id")
            self._times = self._frame_times(timestep, self._ts_kwargs.pop("dt", None))
            self._rest = self._rest_positions(rest)
        except InputError as error:  # a ValueError, whose text MDAnalysis would swallow in a list of files
            raise OSError(str(error)) from error
        self._boxes = _boxes(self._dump)
        self._y = None if "y" in self._columns else _lines(self._dump)
        self.n_atoms = self._dump.n_atoms
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
        if "x" not in self._columns:
            return None
        if rest is None:
            return self._dump.read(0, 1, columns=("x",))[0, 0] if self._dump.steps[0] == 0 else None
        positions = np.array(rest, dtype=np.float64).reshape(-1)
        if len(positions) != self._dump.n_atoms:
            raise ValueError(f"rest holds {len(positions)} positions; {self.filename} has {self._dump.n_atoms} atoms")
        return positions

    def _reopen(self) -> None:
        self.ts = self._Timestep(self._dump.n_atoms, velocities="vx" in self._columns, reader=self, **self._ts_kwargs)
        self.ts.positions = np.zeros((self._dump.n_atoms, 3), dtype=np.float32)
        if self.ts.has_velocities:
            self.ts.velocities = np.zeros((self._dump.n_atoms, 3), dtype=np.float32)
        self.ts.dt = float(self._times[1] - self._times[0]) if self.n_frames > 1 else 1.0
        self.ts.frame = -1
        self._first = 0
        self._ahead: Floats = np.empty((0, len(self._columns), self._dump.n_atoms))

    def _read_next_timestep(self) -> Any:
        if self.ts.frame + 1 >= self.n_frames:
            raise EOFError
        return self._read_frame(self.ts.frame + 1)

    def _read_frame(self, frame: int) -> Any:
        if not self._first <= frame < self._first + len(self._ahead):
            in_a_row = frame == self.ts.frame + 1
            count = max(1, _AHEAD_BYTES // (8 * len(self._columns) * self.n_atoms)) if in_a_row else 1
            self._ahead = self._dump.read(frame, frame + count, columns=self._columns)
            self._first = frame
        self._fill(frame, self._ahead[frame - self._first].copy())
        return self.ts

    def _fill(self, frame: int, values: Floats) -> None:
        """Put a frame into the timestep; values are [column, atom]."""
        ts, data = self.ts, self.ts.data
        ts.frame = frame
        ts.dimensions = self._boxes[frame]
        data["step"] = int(self._dump.steps[frame])
        data["time"] = float(self._times[frame])
        for name, column in zip(self._columns, values, strict=True):
            data[name] = column
            if name in _POSITION:
                ts.positions[:, _POSITION[name]] = column
            elif name in _VELOCITY and ts.has_velocities:
                ts.velocities[:, _VELOCITY[name]] = column
        if self._y is not None:
            ts.positions[:, 1] = self._y
        if ts.has_velocities:
            data["velocity"] = data["vx"]
        if self._rest is not None:
            data["displacement"] = data["x"] - self._rest


def _lines(dump: BinaryDump) -> Floats | None:
    """[atom] y of its chain; None for a box that is not of a ``data.chains``, see
    `lammps_inputs.decks.deck.render_data`.

    There the box ends one chain's distance beside the first and last chain; each chain has as many atoms, in a row.
    """
    (y_low, y_high), (z_low, z_high) = dump.box[0, 1:]
    if dump.tilt is not None or y_low >= 0.0 or (z_low, z_high) != (y_low, -y_low):
        return None
    chains = round(float(-y_high / y_low))
    if chains < 1 or y_high != -y_low * chains or dump.n_atoms % chains:
        return None
    return np.repeat(-y_low * np.arange(chains), dump.n_atoms // chains)


def _boxes(dump: BinaryDump) -> Any:
    """[frame, 6] lengths and angles of the box; a dump has the bounds of a sheared box, not its edges."""
    low, high = dump.box[:, :, 0], dump.box[:, :, 1]
    if dump.tilt is None:
        return np.concatenate([high - low, np.full_like(low, 90.0)], axis=1, dtype=np.float32, casting="same_kind")
    xy, xz, yz = dump.tilt.T
    zero = np.zeros_like(xy)
    x = high[:, 0] - low[:, 0] - np.ptp([zero, xy, xz, xy + xz], axis=0)
    y = high[:, 1] - low[:, 1] - np.ptp([zero, yz], axis=0)
    z = high[:, 2] - low[:, 2]
    edges = np.array([[x, zero, zero], [xy, y, zero], [xz, yz, z]]).transpose(2, 0, 1)
    return np.array([triclinic_box(*vectors) for vectors in edges])


class ChainsParser(DATAParser):  # type: ignore[misc]
    """Topology of a ``data.chains``: an atom per recorded bead, a residue per chain, a bond per spring."""

    format = "CHAINS"

    def grab_datafile(self) -> tuple[dict[str, str], dict[str, list[str]]]:
        """Header and sections as of the stock parser, with the lines of either layout as ``id resid type x y z``.

        Raises:
            ValueError: the lines are not those of a ``data.chains``.
        """
        header, sections = super().grab_datafile()
        if "Atoms" not in sections:
            return header, sections
        rows = [line.split() for line in sections["Atoms"]]
        if any(len(row) < 7 for row in rows):
            raise ValueError(f"{self.filename}: its Atoms are not those of a data.chains")
        # sphere: id type diameter density x y z; hybrid sphere bond: id type x y z diameter density molecule
        x = 2 if len(rows[0]) == 8 else 4
        _, chain = np.unique([float(row[x + 1]) for row in rows], return_inverse=True)
        atoms = [(row[0], str(number + 1), row[1], *row[x : x + 3]) for row, number in zip(rows, chain, strict=True)]
        if header["atom types"].split() == ["2"]:
            atoms = [atom for atom in atoms if atom[2] == "2"]
            kept = {atom[0] for atom in atoms}
            bonds = sections.get("Bonds", [])
            sections["Bonds"] = [bond for bond in bonds if kept.issuperset(bond.split()[2:4])]
        sections["Atoms"] = [" ".join(atom) for atom in atoms]
        sections["Masses"] = ["1 1.0", "2 1.0"]
        return header, sections

    def parse(self, **kwargs: Any) -> Any:
        """The topology."""
        return super().parse(**{**kwargs, "atom_style": "id resid type x y z"})
