import numpy as np
import pytest

from lammps_inputs.laws.spring import Linear
from lammps_inputs.links import Links, largest_eigenvalue

RING = ((0, 1), (0, 3), (1, 2), (2, 3))


def open_row(chains):
    return Links.across("springs", Linear(1.0), edges=tuple((chain, chain + 1) for chain in range(chains - 1)))


@pytest.mark.parametrize("chains", [1, 2, 3, 4, 10, 57])
def test_the_largest_eigenvalue_is_that_of_an_open_row_of_chains(chains):
    ends = np.diff(np.eye(chains), axis=0)
    laplacian = ends.T @ ends if chains > 1 else np.zeros((1, 1))
    assert largest_eigenvalue(open_row(chains), chains) == pytest.approx(np.linalg.eigvalsh(laplacian)[-1], abs=1e-13)


def test_a_ring_of_four_has_eigenvalue_4():
    assert largest_eigenvalue(Links.across("springs", Linear(1.0), edges=RING), 4) == pytest.approx(4.0, abs=1e-14)


@pytest.mark.parametrize("edges", [((0, 1), (1, 2), (2, 3)), RING], ids=["open", "ring"])
def test_the_force_across_is_the_slope_of_the_energy(edges):
    link = Links.across("springs", Linear(0.3), edges=edges)
    displacement = np.random.default_rng(1).normal(size=(4, 3))
    force, h = np.zeros_like(displacement), 1e-5
    link.drive(force, link.force(displacement))
    for place in np.ndindex(displacement.shape):
        moved = np.zeros_like(displacement)
        moved[place] = h
        slope = (link.energy(displacement + moved).sum() - link.energy(displacement - moved).sum()) / (2 * h)
        assert force[place] == pytest.approx(-slope, abs=1e-9)  # a quadratic: only rounding, 1e-16 / h


@pytest.mark.parametrize("edges", [((0, 1), (1, 2), (2, 3)), RING], ids=["open", "ring"])
def test_the_chains_shares_of_the_energy_add_up(edges):
    link = Links.across("springs", Linear(0.3), edges=edges)
    displacement = np.random.default_rng(2).normal(size=(5, 4, 3))
    total = np.zeros((5, 4))
    link.add_chain_energy(total, link.energy(displacement))
    assert total.sum(axis=1) == pytest.approx(link.energy(displacement).sum(axis=(1, 2)), rel=1e-14)
