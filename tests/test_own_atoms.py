"""Atoms beside the beads that an ingredient of one's own adds: their noun and their chain, wherever they are named."""

from dataclasses import replace

import numpy as np
import pytest

from analysis.compare import start
from analysis.compare.difference import errors_of
from analysis.conservation import AccountMeter
from lammps_inputs import library, physics
from lammps_inputs.decks import deck
from lammps_inputs.ingredients.base import FurtherAtoms, together
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


def atoms(mass, noun, chain_of_line=()):
    """Atoms at the beads of some lines, each tied to its bead by a spring."""
    mass = np.array(mass, dtype=float)
    edges = tuple((chain, 2 + line) for line, chain in enumerate(chain_of_line or (0, 1)))
    return FurtherAtoms(mass, (Links.across(noun[0], Linear(1.0), edges=edges),), (), noun, chain_of_line)


def test_lines_of_one_noun_and_chain_are_shared_where_places_are_free_and_no_others():
    first, second = atoms([[1, 0], [1, 0]], RESONATOR), atoms([[0, 2], [0, 2]], RESONATOR)
    lines, ties, _ = together(2, [first, second, atoms([[0, 3]], PENDULUM, (1,)), atoms([[4, 0]], RESONATOR, (1,))])
    assert [(line.mass.tolist(), line.chain, line.noun) for line in lines] == [
        ([1.0, 2.0], 0, RESONATOR),
        ([1.0, 2.0], 1, RESONATOR),
        ([0.0, 3.0], 1, PENDULUM),
        ([4.0, 0.0], 1, RESONATOR),
    ]
    assert [link.edges for link in ties] == [((0, 2), (1, 3)), ((0, 2), (1, 3)), ((1, 4),), ((1, 5),)]


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


def test_the_atom_that_does_not_start_at_rest_is_called_by_its_noun(mixed):
    further = np.array(mixed.further_lines)
    further[0, 1, 3, 2] = 0.5
    (text,) = start.differences(replace(mixed, further_lines=further))
    assert text == "the pendulum at bead 3 of chain 2 starts with velocity 0.5 instead of 0"


def test_a_deviation_is_of_the_atom_by_its_noun_its_number_and_its_chain(mixed):
    for line, words in enumerate(("resonator 1 at bead 3 of chain 1", "", "pendulum 1 at bead 3 of chain 1")):
        further = np.array(mixed.further_lines)
        further[10, 1, line, 2] += 0.5
        where = errors_of([replace(mixed, further_lines=further)], [mixed])["velocity"].where
        assert where.words == (words or "resonator 1 at bead 3 of chain 2")


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
