"""MDAnalysis reads the files of a run once this module is imported: ``mda.Universe("DIR/data.chains", DUMP)``.

- `BinaryDumpReader`: LAMMPS binary dumps (``.bin``), their float64 columns in ``ts.data``;
- `ChainsParser`: ``data.chains``, with chains as segments, beads as residues, springs as bonds; recorded beads only.

MDAnalysis has positions and velocities in float32, which is good for viewing; compute with ``ts.data``::

    import MDAnalysis as mda
    import analysis.mda.formats  # registers the formats

    universe = mda.Universe("DIR/data.chains", "DIR/chains.dump.bin")
    for ts in universe.trajectory[::10]:
        print(ts.time, ts.data["velocity"].max())
    universe.atoms.write("part.xyz", frames=universe.trajectory[::10])

A run that was continued has several dumps; see `analysis.mda.universe` for all of a run at once.
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from MDAnalysis.coordinates.base import ReaderBase
from MDAnalysis.core import topologyattrs as attributes
from MDAnalysis.core.topology import Topology
from MDAnalysis.lib.util import openany, store_init_arguments
from MDAnalysis.topology.base import TopologyReaderBase
from numpy.typing import ArrayLike

from analysis.files.binary_dump import BinaryDump, Parts
from analysis.trajectory import Flags, Floats, FramesInUnits, Integers
from lammps_inputs import InputError, file_names
from lammps_inputs.units import Scale, sphere_density

ATOM, RESIDUE = "X", "bead"
"""Names of atoms and residues, for formats that need some; X is no chemical element to other programs."""

_SECTION = re.compile(r"^(Atoms|Bonds)\b.*\n", re.MULTILINE)
_RECORDED = re.compile(r"^group recorded (type|id) (.+)$", re.MULTILINE)


class ChainsParser(TopologyReaderBase):  # type: ignore[misc]  # MDAnalysis has no types
    """Topology of a ``data.chains``, with the beads that the ``in.chains`` beside it records.

    - segment: a chain, ``segid C1``, ``C2`` and so on; of atoms beside the beads, such as resonators, ``R1`` and so on;
    - residue: a bead of a chain, ``resid`` from 1; in a window a row;
    - atom: the same bead; ``id`` is LAMMPS's, ``mass`` and ``radius`` are in LAMMPS's own (dimensionless) units;
    - bond: a spring between chains.
    """

    format = "CHAINS"

    def parse(self, **_: Any) -> Topology:
        """The topology.

        Raises:
            ValueError: the file is no ``data.chains``; the text names it.
        """
        with openany(self.filename, "rt") as file:
            data = file.read()
        beside = Path(str(self.filename)).with_name(file_names.DECK)
        try:
            return of_deck(data, beside.read_text(encoding="utf-8") if beside.is_file() else "")
        except ValueError as error:
            raise ValueError(f"{self.filename}: {error}") from None


def of_deck(data: str, commands: str) -> Topology:
    """The topology of the texts of a ``data.chains`` and of an ``in.chains``, which says what is recorded.

    Raises:
        ValueError: the text is not that of a ``data.chains``.
    """
    sections = _sections(data)
    number, kind, mass, diameter, y = _atoms(sections.get("Atoms", ()))
    chain = np.unique(y, return_inverse=True)[1]
    rows = int(np.count_nonzero(chain == 0))
    beads = np.array([diameter[np.argmax(chain == line)] == diameter[0] for line in range(chain[-1] + 1)])
    names = segment_names(int(np.count_nonzero(beads)), int(np.sum(~beads)))
    recorded = _recorded(commands, number, kind)
    bonds = np.array([line.split() for line in sections.get("Bonds", ())], dtype=np.int64).reshape(-1, 4)
    ends = np.searchsorted(number, bonds[:, 2:])
    ends = ends[recorded[ends].all(axis=1)]
    place = np.cumsum(recorded) - 1
    atoms = TopologyAtoms(
        number=number[recorded],
        kind=kind[recorded],
        mass=mass[recorded],
        radius=diameter[recorded] / 2.0,
        bead=(number[recorded] - 1) % rows + 1,
        line=chain[recorded],
    )
    return topology(atoms, names, place[ends])


@dataclass(frozen=True)
class TopologyAtoms:
    """Atoms of a topology, each array [atom].

    Attributes:
        number: LAMMPS's number of the atom.
        kind: its type.
        mass, radius: dimensionless.
        bead: number of the bead in its chain, from 1; in a window of the row.
        line: its chain, or line of other atoms, from 0.
    """

    number: Integers
    kind: Integers
    mass: Floats
    radius: Floats
    bead: Integers
    line: Integers


def segment_names(chains: int, further: int) -> list[str]:
    """Names of the chains and of the lines of other atoms after them."""
    return [*(f"C{n}" for n in range(1, chains + 1)), *(f"R{n}" for n in range(1, further + 1))]


def topology(atoms: TopologyAtoms, names: Sequence[str], bonds: Integers) -> Topology:
    """The topology of atoms in segments of these names, with bonds [bond, 2] between atoms counted from 0."""
    count = len(atoms.number)
    return Topology(
        count,
        count,
        len(names),
        attrs=[
            attributes.Atomids(atoms.number),
            attributes.Atomnames(np.full(count, ATOM, dtype=object)),
            attributes.Atomtypes(atoms.kind.astype(str).astype(object)),
            attributes.Masses(atoms.mass),
            attributes.Radii(atoms.radius),
            attributes.Resids(atoms.bead),
            attributes.Resnums(atoms.bead.copy()),
            attributes.Resnames(np.full(count, RESIDUE, dtype=object)),
            attributes.Segids(np.array(names, dtype=object)),
            attributes.Bonds([tuple(pair) for pair in bonds.tolist()]),
        ],
        atom_resindex=np.arange(count),
        residue_segindex=atoms.line,
    )


def _sections(data: str) -> dict[str, list[str]]:
    """Name -> lines."""
    _, *parts = _SECTION.split(data)
    pairs = zip(parts[::2], parts[1::2], strict=True)
    return {name: [line for line in body.splitlines() if line.strip()] for name, body in pairs}


def _atoms(lines: Iterable[str]) -> tuple[Any, ...]:
    """Number, type, mass, diameter and y of every atom, in their order."""
    # sphere: id type diameter density x y z; hybrid sphere bond: id type x y z diameter density molecule
    try:
        rows = np.array([line.split() for line in lines], dtype=np.float64)
        size, y = {7: (2, 5), 8: (5, 3)}[rows.shape[1]]
    except (ValueError, KeyError, IndexError):
        raise ValueError("its Atoms are not those of a data.chains") from None
    number, kind = rows[:, 0].astype(np.int64), rows[:, 1].astype(np.int64)
    if len(number) == 0 or number[0] != 1 or np.any(np.diff(number) < 1):
        raise ValueError("its Atoms are not those of a data.chains")
    diameter, density = rows[:, size], rows[:, size + 1]
    # the mass of 1 is exact in a run, and its density is not
    mass = (
        np.ones(len(rows)) if np.ptp(density) == 0.0 else density / np.array([*map(sphere_density, diameter.tolist())])
    )
    return number, kind, mass, diameter, rows[:, y]


def _recorded(commands: str, number: Integers, kind: Integers) -> Flags:
    """[atom] whether its frames are written."""
    match = _RECORDED.search(commands)
    if match is None:
        return np.ones(len(number), dtype=bool)
    if match[1] == "type":
        return np.asarray(kind == int(match[2]))
    chosen = (map(int, words.split(":")) for words in match[2].split())
    return np.isin(number, [atom for first, last, stride in chosen for atom in range(first, last + 1, stride)])


FORMAT = ["BIN", "LAMMPSBIN"]
UNITS = {"time": None, "length": None, "velocity": None}
"""Numbers are dimensionless, so that MDAnalysis converts none."""

POSITION = {"x": 0, "y": 1, "z": 2}
VELOCITY = {"vx": 0, "vy": 1, "vz": 2}
"""Column -> axis."""

DERIVED = ("velocity", "displacement")
"""Arrays in ``ts.data`` that are no columns of a dump."""


def dimensions(box: Floats) -> Any:
    """Lengths and angles, [frame, 6], of boxes [frame, axis, low or high end]."""
    lengths = box[:, :, 1] - box[:, :, 0]
    return np.concatenate([lengths, np.full_like(lengths, 90.0)], axis=1, dtype=np.float32, casting="same_kind")


def lines(box: Floats, n_atoms: int) -> Floats | None:
    """[atom] y of the atom's chain; None for a box that is not that of a ``data.chains``.

    The box of `lammps_inputs.decks.deck.render_data` ends one distance of chains beside the first and last chain; each
    chain has as many atoms, in a row.
    """
    (y_low, y_high), (z_low, z_high) = box[1:]
    if y_low >= 0.0 or (z_low, z_high) != (y_low, -y_low):
        return None
    chains = round(float(-y_high / y_low))
    if chains < 1 or y_high != -y_low * chains or n_atoms % chains:
        return None
    return np.repeat(-y_low * np.arange(chains), n_atoms // chains)


_AHEAD_BYTES = 1 << 17  # frames read ahead when they are asked for one after the other


class BinaryDumpReader(ReaderBase):  # type: ignore[misc]  # MDAnalysis has no types
    """LAMMPS binary dumps of style custom, frame by frame in any order.

    In ``ts.data``, in ascending order of atom id, float64:

    - each column of the dump by its name (``x``, ``vx``, ...);
    - ``velocity``: the column ``vx``;
    - ``displacement``: ``x`` minus the positions at rest, if these are known; in a window those of the rows in ``mol``;
    - ``si``: time, displacement and velocity in the scene's units, if the scale is given;

    and ``step``, ``time``, ``dt`` (time between the first two frames) and ``box`` (bounds, see `analysis.mda.formats`).

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
        """Distance between rows at rest in a window, whose molecules are its rows; None where there is no window."""
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
            data["si"] = FramesInUnits(
                data["time"] * scale.time, data["displacement"] * scale.length, data["velocity"] * scale.velocity
            )
