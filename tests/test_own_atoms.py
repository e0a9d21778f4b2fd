"""Atoms beside the beads that an ingredient of one's own adds: their noun and their chain, wherever they are named."""

from dataclasses import replace

import numpy as np
import pytest

from analysis.conservation import AccountMeter
from lammps_inputs import library, physics
from lammps_inputs.decks import deck
from lammps_inputs.laws.spring import Linear
from lammps_inputs.links import Links
from lammps_inputs.system import FurtherLine, Noun
from workflow.engines.reference import engine
from workflow.measures.budget import BudgetMeasurement, ClosedAccount

PENDULUM = Noun("pendulum", "pendulums")
RESONATOR = Noun("resonator", "resonators")

KEYS = {"name": "own", "chains": 2, "beads": 6, "kick": {"velocity": 1.0}, "duration": 8.0, "output": {"every": 0.1}}
TWO_KINDS = [{"mass": 0.3, "stiffness": 1.0}, {"mass": 0.2, "stiffness": 2.0, "rows": [3, 4]}]


def problem(*nouns, resonators=TWO_KINDS, **keys):
    """Two chains whose lines of resonators, two of each kind, are called otherwise."""
    made = library.from_plain({**KEYS, "resonators": resonators, **keys}, "test").problem()
    lines = zip(made.system.further_lines, nouns, strict=True)
    return replace(made, system=replace(made.system, further_lines=tuple(replace(line, noun=n) for line, n in lines)))


MIXED = (RESONATOR, RESONATOR, PENDULUM, PENDULUM)


@pytest.fixture(scope="module")
def mixed():
    """Frames of resonators, and of pendulums at beads 3 and 4."""
    return engine.run(problem(*MIXED))


# --- lines ------------------------------------------------------------------------------------------------------------


def test_an_atom_at_one_bead_of_one_chain_weighs_on_it_and_stands_at_its_place():
    made = library.from_plain({**KEYS, "precompression": {"force": 0.1}}, "test").problem()
    hung = Links.across("hung", Linear(np.array([[0.0] * 2 + [1.0] + [0.0] * 3])), edges=((1, 2),))
    line = FurtherLine(np.array([0.0, 0.0, 0.5, 0.0, 0.0, 0.0]), 1, PENDULUM)
    system = replace(made.system, further_lines=(line,), links=(*made.system.links, hung))
    assert np.argwhere(np.asarray(physics.mass_with_tied(system)) != 1.0).tolist() == [[1, 2]]
    text = deck.render_data(replace(made, system=system))
    (bead,) = (words for words in map(str.split, text.splitlines()) if words[:1] == ["9"] and len(words) == 8)
    (pendulum,) = (words for words in map(str.split, text.splitlines()) if words[:1] == ["15"] and len(words) == 8)
    assert pendulum[2] == bead[2]
    assert float(pendulum[5]) < float(bead[5])
    assert "\n1 1 9 15\n" in text


# --- where they are named ---------------------------------------------------------------------------------------------


def test_the_budget_has_the_energy_of_each_noun_and_closes(mixed):
    account = AccountMeter(mixed.problem).read([mixed])
    assert list(account.other_atoms) == ["pendulums"]
    assert np.max(account.resonators) > 1e-3 < np.max(account.other_atoms["pendulums"])
    np.testing.assert_allclose(account.missing, 0.0, atol=1e-5)
    assert "% in pendulums" in account.sentence(mixed.problem.scale)
    assert "% in resonators" in account.sentence(mixed.problem.scale)
    values = ClosedAccount(**vars(account), closed=0.0, between_frames=0.0, stated=None)
    ((panel,),) = BudgetMeasurement(mixed.problem, values).sheet().rows
    assert {"resonators", "pendulums"} <= {layer.name for layer in panel.layers}
