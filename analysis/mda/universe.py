"""A whole run as MDAnalysis sees it: the scene's chains and springs, the frames of all its files, the scene's units."""

from collections.abc import Sequence
from pathlib import Path

import MDAnalysis

from analysis.files.recording import rest_of_atoms
from analysis.mda.formats import BinaryDumpReader, of_deck
from lammps_inputs import Problem
from lammps_inputs.decks import deck


def universe(problem: Problem, dumps: Sequence[Path | str]) -> MDAnalysis.Universe:
    """A universe of what was run and its frames.

    Segments are chains, residues and atoms are recorded beads (see `ChainsParser`); ``ts.data`` has displacement and
    velocity, dimensionless and as ``si`` in the scene's units (see `BinaryDumpReader`). Engines without a deck, too.

    Args:
        problem: what was run.
        dumps: the files of frames in order, more than one if the run was continued.

    Raises:
        OSError: a file cannot be read as a binary dump; the text names it and says why.
        ValueError: it holds other atoms than the problem, or the deck has no words for one of its forces.
    """
    first, *parts = dumps
    return MDAnalysis.Universe(
        of_deck(deck.render_data(problem), deck.render_deck(problem)),
        str(first),
        format=BinaryDumpReader.format[0],
        parts=parts,
        timestep=problem.timestep,
        rest=None if problem.window is not None else rest_of_atoms(problem),
        scale=problem.scale,
    )
