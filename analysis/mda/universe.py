"""A whole run as MDAnalysis sees it: the scene's chains and springs, the frames of all its files, the scene's units."""

from collections.abc import Sequence
from pathlib import Path

import MDAnalysis
import numpy as np
from MDAnalysis.core.topology import Topology

from analysis.files.recording import all_ids, rest_of_atoms
from analysis.mda.formats import BinaryDumpReader, TopologyAtoms, segment_names, topology
from analysis.trajectory import Integers
from lammps_inputs import Problem, physics

BEAD, FURTHER = 1, 2
"""Types of atoms: beads of chains, and others."""


def universe(problem: Problem, dumps: Sequence[Path | str]) -> MDAnalysis.Universe:
    """A universe of what was run and its frames.

    Segments are chains, residues and atoms are recorded beads (see `ChainsParser`); ``ts.data`` has displacement and
    velocity, dimensionless and as ``si`` in the scene's units (see `BinaryDumpReader`). They follow from the problem
    alone: any engine may have computed the run.

    Args:
        problem: what was run.
        dumps: the files of frames in order, more than one if the run was continued.

    Raises:
        OSError: a file cannot be read as a binary dump; the text names it and says why.
        ValueError: it holds other atoms than the problem.
    """
    first, *parts = dumps
    return MDAnalysis.Universe(
        topology_of(problem),
        str(first),
        format=BinaryDumpReader.format[0],
        parts=parts,
        timestep=problem.timestep,
        rest=None if problem.rows.follow else rest_of_atoms(problem),
        scale=problem.scale,
    )


def topology_of(problem: Problem) -> Topology:
    """The recorded atoms of a problem: chains and lines of other atoms as segments, springs between them as bonds."""
    number, rows = all_ids(problem), problem.rows.existing
    line, bead = (number - 1) // rows, (number - 1) % rows + 1
    masses = np.broadcast_to(physics.masses(problem.system), (physics.lines(problem.system), problem.beads))
    layout = problem.layout
    atoms = TopologyAtoms(
        number=number,
        kind=np.where(line < problem.chains, BEAD, FURTHER),
        mass=masses[line, bead - 1],
        radius=np.where(line < problem.chains, layout.diameter, layout.diameter_of_others) / 2.0,
        bead=bead,
        line=line,
    )
    names = segment_names(problem.chains, problem.lines - problem.chains)
    return topology(atoms, names, _bonds(problem, number))


def _bonds(problem: Problem, number: Integers) -> Integers:
    """Places in ``number`` of the atoms at both ends of each spring, [bond, 2]."""
    rows, ends = problem.rows.existing, [np.empty((0, 2), dtype=np.int64)]
    for link in problem.system.across:
        for edge, tied in zip(link.edges, link.acts(problem.beads), strict=True):
            row = np.flatnonzero(tied[:rows]) + 1
            pair = np.stack([line * rows + row for line in edge], axis=1)
            ends.append(np.searchsorted(number, pair[np.isin(pair, number).all(axis=1)]))
    return np.concatenate(ends)
