"""Keys of a scene from what was measured of a deck."""

import numpy as np
import pytest

from lammps_inputs.deck_atoms import DeckAtoms
from workflow.plugins.adopt.scene_of import atoms_text


@pytest.mark.parametrize(
    "atoms", [[1, 2, 3], [30, 29, 28, 2], [1, 3, 5, 7], [5, 1, 2, 3, 9], [8, 1], [58, 55, 52, 1], [4, 11, 2, 1]]
)
def test_atoms_are_those_of_their_text(atoms):
    text = atoms_text(np.array(atoms))
    assert DeckAtoms(deck="in.mine", axis="z", atoms=(text,), timestep=0.5).numbers.tolist() == [atoms]
    assert len(text) <= len(",".join(map(str, atoms)))
