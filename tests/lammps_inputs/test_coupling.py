import numpy as np
import pytest

from lammps_inputs import coupling


@pytest.mark.parametrize("chains", [1, 2, 3, 4, 10, 57])
def test_the_largest_eigenvalue_is_that_of_an_open_row_of_chains(chains):
    ends = np.diff(np.eye(chains), axis=0)
    laplacian = ends.T @ ends if chains > 1 else np.zeros((1, 1))
    assert coupling.largest_eigenvalue(chains) == pytest.approx(np.linalg.eigvalsh(laplacian)[-1], abs=1e-13)


def test_two_chains_have_eigenvalue_2():
    assert coupling.largest_eigenvalue(2) == pytest.approx(2.0, abs=1e-15)


def test_any_row_of_chains_stays_below_4():
    assert all(coupling.largest_eigenvalue(chains) < 4.0 for chains in (2, 3, 10, 1000))


def test_a_spring_holds_half_its_stiffness_times_the_square():
    assert coupling.energy(np.array([0.0, 2.0, -2.0]), 0.1).tolist() == [0.0, 0.2, 0.2]


def test_the_bond_has_no_rest_length():
    style, coefficients = coupling.bond_lines()
    assert style == "bond_style harmonic"
    assert coefficients.split()[-1] == "0"


def test_the_bond_has_half_the_stiffness_with_17_digits():
    assert coupling.bond_lines()[1] == "bond_coeff 1 $(v_kappa/2:%.17g) 0"
