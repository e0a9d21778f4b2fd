"""Beads, springs and velocities of a run in one file for OVITO and in one for VMD, as LAMMPS has them.

Chains stand side by side, beads have their relative radii, and springs between chains are bonds. Numbers are those of
LAMMPS, in units of L, T and V; single precision, as these programs have it.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, TextIO

import numpy as np
from numpy.typing import NDArray

from granchain.parts import Flags, Floats, Integers, Problem, Trajectory, radii, recording, screen
from workflow.plugins.export.registry import FORMATS
from workflow.plugins.export.request import ExportRequest, Writers


def springs(problem: Problem) -> list[tuple[int, int, Flags]]:
    """Both lines of atoms of each pair that springs tie, from 0, and whether there is a spring in each row, [row]."""
    pairs: list[tuple[int, int, Flags]] = []
    for link in problem.system.across:
        acts = link.acts(problem.beads)
        pairs += [(lower, higher, of_edge) for (lower, higher), of_edge in zip(link.edges, acts, strict=True)]
    return pairs


@dataclass(frozen=True)
class DrawnAtoms:
    """Atoms of every frame: the recorded beads, in a window those that it holds, and other atoms such as resonators.

    Attributes:
        problem: what was run.
        relative_radii: radius of each bead over that of the reference bead, [chain, bead].
    """

    problem: Problem
    relative_radii: Floats

    @cached_property
    def line(self) -> Integers:
        """Line of each atom, [atom] from 0: the chain, or a line of other atoms after all chains."""
        return np.asarray(self._places // self.problem.rows.count)

    @cached_property
    def column(self) -> Integers:
        """Place of each atom along the last axis of frames, [atom] from 0."""
        return np.asarray(self._places % self.problem.rows.count)

    @cached_property
    def _places(self) -> Integers:
        """Place of each atom in a frame [line, bead], [atom] from 0."""
        problem = self.problem
        if problem.lines > problem.chains:
            return recording.all_ids(problem) - 1
        return np.arange(problem.chains * problem.rows.count)

    @cached_property
    def radius(self) -> Floats:
        """Radius of each atom, [atom]; in a window those of its first place, where all beads are alike."""
        problem, layout = self.problem, self.problem.layout
        recorded = self.relative_radii[:, problem.rows.numbers[: problem.rows.count] - 1]
        beads = 0.5 * layout.diameter * recorded / np.max(self.relative_radii)
        of_chain = beads[problem.system.chain_of_line[self.line], self.column]
        return np.where(self.line < problem.chains, of_chain, 0.5 * layout.diameter_of_others)

    @cached_property
    def y(self) -> Floats:
        """Lateral place of each atom, [atom]: that of its line."""
        return self.problem.layout.apart((0, 1)) * self.line.astype(np.float64)

    @cached_property
    def bonds(self) -> Integers:
        """Pairs of atoms with a spring between them, [bond, 2] from 0."""
        problem = self.problem
        number = np.full((problem.lines, problem.rows.count), -1, dtype=np.int64)
        number[self.line, self.column] = np.arange(len(self.line))
        rows = problem.rows.numbers[: problem.rows.count] - 1
        pairs = [np.empty((0, 2), dtype=np.int64)]
        for lower, higher, acts in springs(problem):
            if higher < problem.lines:
                ends = np.stack([number[lower], number[higher]], axis=1)[acts[rows]]
                pairs.append(ends[np.all(ends >= 0, axis=1)])
        return np.concatenate(pairs)

    @property
    def names(self) -> list[str]:
        """Name of each line of atoms: a chain, or the noun of other atoms and the number of the line among theirs."""
        names = {chain: f"chain {chain + 1}" for chain in range(self.problem.chains)}
        for noun, lines in self.problem.system.lines_by_noun.items():
            names |= {line: f"{noun.plural} {n}" for n, line in enumerate(lines.tolist(), 1)}
        return [names[line] for line in range(self.problem.lines)]

    def beads(self, block: Trajectory) -> Integers:
        """Number of the bead of each atom in a block, [atom] from 1."""
        return block.beads[self.column]

    def frames(self, block: Trajectory) -> Iterator[tuple[float, Floats, Floats]]:
        """Time, x and velocity [atom] of each frame of a block."""
        places = self.problem.layout.places[:, block.beads - 1]
        rest = places[self.problem.system.chain_of_line[self.line], self.column]
        x, v = block.atoms
        for frame, time in enumerate(block.time):
            yield float(time), rest + x[frame, self.line, self.column], v[frame, self.line, self.column]


def _atoms(request: ExportRequest) -> DrawnAtoms:
    return DrawnAtoms(request.directory.problem, radii(request.directory.scene.setting))


# --- OVITO ------------------------------------------------------------------------------------------------------------


def ovito(request: ExportRequest) -> Writers:
    """The file in the format GSD, which holds radii, bonds, velocities and times of all frames."""
    return {FORMATS["ovito"].file: lambda path: _write_gsd(request, path)}


_GSD_BYTES = 24.0
"""Of a bead in a frame: position and velocity, each three numbers of four bytes."""


def _write_gsd(request: ExportRequest, path: Path) -> None:
    import gsd.hoomd

    atoms = _atoms(request)
    problem = atoms.problem
    lengths = _box(problem)
    first = True
    with gsd.hoomd.open(str(path), "w") as file:
        for block in request.pieces(FORMATS["ovito"].file, _GSD_BYTES):
            for time, x, velocity in atoms.frames(block):
                frame = gsd.hoomd.Frame()
                frame.configuration.step = round(time / problem.timestep)
                frame.configuration.box = [*lengths, 0.0, 0.0, 0.0]
                frame.particles.N = len(x)
                centred = np.stack([x, atoms.y, np.zeros_like(x)], axis=1) - _middle(lengths, atoms)
                frame.particles.position = centred.astype(np.float32)
                along = np.stack([velocity, np.zeros_like(x), np.zeros_like(x)], axis=1)
                frame.particles.velocity = along.astype(np.float32)
                frame.particles.diameter = (2.0 * atoms.radius).astype(np.float32)
                frame.particles.types = atoms.names
                frame.particles.typeid = atoms.line
                frame.log["Time"] = np.array([time])
                if first or problem.rows.follow:
                    frame.log["particles/Bead"] = atoms.beads(block).astype(np.int32)
                _bond(frame, atoms)
                file.append(frame)
                first = False


def _bond(frame: Any, atoms: DrawnAtoms) -> None:
    frame.bonds.N = len(atoms.bonds)
    frame.bonds.types = ["spring"]
    frame.bonds.typeid = np.zeros(len(atoms.bonds), dtype=np.uint32)
    frame.bonds.group = atoms.bonds.astype(np.uint32)


def _box(problem: Problem) -> list[float]:
    """Lengths of the box around all beads at rest, with a place to spare on every side."""
    layout = problem.layout
    side = layout.apart((0, 1))
    return [(problem.beads + 1) * layout.spacing, problem.lines * side, 2.0 * layout.diameter]


def _middle(lengths: list[float], atoms: DrawnAtoms) -> Floats:
    """Middle of the box, [axis], which GSD has as the origin."""
    return np.array([0.5 * lengths[0], 0.5 * float(np.max(atoms.y)), 0.0])


# --- VMD --------------------------------------------------------------------------------------------------------------


def vmd(request: ExportRequest) -> Writers:
    """The script that makes the molecule, its frames and how it is drawn: ``vmd -e frames.vmd``."""
    return {FORMATS["vmd"].file: lambda path: _write_vmd(request, path)}


_VMD_BYTES = 20.0
"""Of a bead in a frame: x and the velocity as text."""


def _write_vmd(request: ExportRequest, path: Path) -> None:
    atoms = _atoms(request)
    largest = 0.0
    with path.open("w", encoding="ascii") as out:
        for block in request.pieces(FORMATS["vmd"].file, _VMD_BYTES):
            if not largest:
                out.write(_vmd_head(atoms, block))
            for time, x, velocity in atoms.frames(block):
                largest = max(largest, float(np.max(np.abs(velocity))))
                out.write(f"frame {time:.9g} {{{_words(x)}}} {{{_words(velocity)}}}\n")
        _vmd_tail(out, largest)


def _words(values: NDArray[Any], digits: str = ".7g") -> str:
    return " ".join(format(value, digits) for value in values.tolist())


_FRAME = "proc frame {time x velocity} { " + "; ".join(
    (
        "global molecule beads frames time_of_frame",
        "if {$frames > 0} { animate dup $molecule }",
        "$beads frame $frames",
        "$beads set x $x",
        "$beads set user $velocity",
        "$beads set vx $velocity",
        "set time_of_frame($frames) $time",
        "incr frames",
        "return }",
    )
)
"""Command of Tcl that adds a frame: the one before again, with other places and velocities."""


def _vmd_head(atoms: DrawnAtoms, block: Trajectory) -> str:
    """Commands that make the molecule; each is a line, as VMD reads scripts line by line."""
    neighbours: list[list[int]] = [[] for _ in atoms.line]
    for first, second in atoms.bonds.tolist():
        neighbours[first].append(second)
        neighbours[second].append(first)
    bonds = " ".join(f"{{{' '.join(map(str, ends))}}}" for ends in neighbours)
    segment_of = [f"{name[0].upper()}{n}" for n, name in enumerate(atoms.names, 1)]
    segments = " ".join(segment_of[n] for n in atoms.line.tolist())
    name = "".join(
        sign if sign.isascii() and (sign.isalnum() or sign in " -_.") else "_"
        for sign in screen.one_line(atoms.problem.name)
    )
    return f"""# granchain: {name}; open it by: vmd -e FILE
# x in units of L; user and vx are the velocity in units of V; the variable time_of_frame holds times in units of T
display update off
set molecule [mol new atoms {len(atoms.line)}]
mol rename $molecule {{{name}}}
animate dup $molecule
set beads [atomselect $molecule all]
$beads set name X
$beads set type X
$beads set resname BEAD
$beads set segname {{{segments}}}
$beads set resid {{{" ".join(map(str, atoms.beads(block).tolist()))}}}
$beads set radius {{{_words(atoms.radius)}}}
$beads set y {{{_words(atoms.y)}}}
$beads set z 0
$beads setbonds {{{bonds}}}
set frames 0
{_FRAME}
"""


def _vmd_tail(out: TextIO, largest: float) -> None:
    """Commands that draw the beads at their radii with the velocity as their colour, and the springs."""
    out.write(f"""mol delrep 0 $molecule
mol representation VDW 1.0 16
mol color User
mol selection all
mol addrep $molecule
mol colupdate 0 $molecule on
mol scaleminmax $molecule 0 {-largest:.7g} {largest:.7g}
mol representation Bonds 0.3 8
mol color ColorID 2
mol addrep $molecule
color scale method BWR
display projection Orthographic
animate goto 0
display resetview
display update on
""")
