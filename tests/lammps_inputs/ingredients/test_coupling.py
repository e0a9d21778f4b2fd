"""Springs between chains: pairs, rows, bounds and bond types; the motion is in `test_every_ingredient`."""

import numpy as np
import plain_scene
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lammps_inputs import physics
from lammps_inputs.decks import deck
from lammps_inputs.limits import rates
from lammps_inputs.limits.rates import stability_bound


def scene(coupling, **changes):
    return plain_scene.scene(**{"chains": 3, "beads": 8, "output": None, "coupling": coupling, **changes})


def spring(coupling, **changes):
    """The one link across of a scene."""
    (link,) = scene(coupling, **changes).system.across
    return link


@pytest.mark.parametrize(
    ("topology", "chains", "edges"),
    [
        ("open", 4, ((0, 1), (1, 2), (2, 3))),
        ("ring", 4, ((0, 1), (0, 3), (1, 2), (2, 3))),
        ("ring", 2, ((0, 1),)),
        ({"lattice": [2, 3]}, 6, ((0, 1), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (4, 5))),
        ({"edges": [[3, 1], [2, 3]]}, 3, ((0, 2), (1, 2))),
    ],
)
def test_a_topology_is_these_pairs_of_chains(topology, chains, edges):
    assert spring({"stiffness": 0.1, "topology": topology}, chains=chains).edges == edges


def test_an_edge_may_have_its_own_stiffness():
    link = spring({"stiffness": 0.1, "topology": {"edges": [[1, 2], [1, 3, 0.4], [2, 3, 0.0]]}})
    assert link.edges == ((0, 1), (0, 2))
    np.testing.assert_array_equal(link.law.spring, np.repeat([[0.1], [0.4]], 8, axis=1))


def test_a_bond_type_is_one_stiffness():
    problem = scene({"stiffness": {"from": 0.0, "to": 0.2, "rows": [2, 4]}, "topology": "ring"}).problem()
    data, text = deck.render_data(problem), deck.render_deck(problem)
    assert "18 bonds\n2 bond types" in data
    assert "bond_coeff 1 0.05 0\nbond_coeff 2 0.1 0\n" in text
    assert "\n1 1 3 11\n2 2 4 12\n" in data
    assert "kappa" not in text.replace("coupling", "")


@st.composite
def graphs(draw):
    """Chains, and edges with stiffnesses."""
    chains = draw(st.integers(2, 7))
    pairs = [(one, other) for one in range(1, chains) for other in range(one + 1, chains + 1)]
    chosen = draw(st.lists(st.sampled_from(pairs), min_size=1, unique=True))
    return chains, [[*pair, draw(st.floats(0.01, 1e4))] for pair in chosen]


@pytest.mark.slow
@given(graphs())
def test_no_graph_swings_faster_than_the_bound(case):
    chains, edges = case
    one = scene({"topology": {"edges": edges}}, chains=chains)
    laplacian = np.zeros((chains, chains))
    for lower, higher, stiffness in edges:
        ends = np.eye(chains)[lower - 1] - np.eye(chains)[higher - 1]
        laplacian += stiffness * np.outer(ends, ends)
    fastest = np.sqrt(np.linalg.eigvalsh(laplacian)[-1])
    assert rates.modal_frequency(one.system) == pytest.approx(fastest, rel=1e-9)
    assert stability_bound(one.system) < 2.0 / fastest


def test_a_ramp_is_bounded_by_its_stiffest_row():
    ramp = scene({"stiffness": {"from": 50.0, "to": 1.0, "rows": [2, 5]}}, chains=2)
    assert rates.modal_frequency(ramp.system) == pytest.approx(np.sqrt(2.0 * 50.0), rel=1e-14)


def test_many_chains_are_bounded_without_a_matrix():
    ring = scene({"stiffness": 1.0, "topology": "ring"}, chains=400, beads=2).system
    assert rates.modal_frequency(ring) == pytest.approx(2.0, rel=1e-14)  # sqrt(4), which a ring of an even number has


def test_chains_that_are_tied_are_one_group():
    system = scene({"stiffness": 0.1, "topology": {"edges": [[1, 4], [2, 3]]}}, chains=5).system
    assert [physics.tied_to(system, chain) for chain in range(5)] == [[0, 3], [1, 2], [1, 2], [0, 3], [4]]
