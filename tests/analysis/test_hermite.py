"""Polynomials through values and derivatives: exact for polynomials, of the expected order for anything else."""

import numpy as np
import pytest

from analysis import hermite

CASES = [((0, 1), 2), ((0, 1), 3), ((0, 1), 4), ((0, 1, 2, 3), 2), ((-1, 0, 1), 1), ((0, 1, 2), 2)]


def sampled(function, nodes, derivatives, spacing):
    """Value and derivatives of a polynomial at the nodes, [node, derivative]."""
    return np.array([[function.deriv(order)(node * spacing) for order in range(derivatives)] for node in nodes])


@pytest.mark.parametrize("spacing", [1.0, 0.1, 7.0])
@pytest.mark.parametrize(("nodes", "derivatives"), CASES)
def test_a_polynomial_of_the_full_degree_is_found_again(nodes, derivatives, spacing):
    size = len(nodes) * derivatives
    wanted = np.random.default_rng(size).uniform(-1, 1, size)
    data = sampled(np.polynomial.Polynomial(wanted / spacing ** np.arange(size)), nodes, derivatives, spacing)
    # the matrix of 4 nodes with 2 derivatives has the condition number 5e4
    np.testing.assert_allclose(hermite.coefficients(nodes, data, spacing), wanted, rtol=0, atol=1e-10)


@pytest.mark.parametrize(("derivatives", "order"), [(2, 4), (3, 6)])
def test_the_error_of_a_cosine_falls_with_the_expected_order(derivatives, order):
    spacing = np.array([0.8, 0.56, 0.4, 0.28, 0.2])
    s = np.linspace(0, 1, 21)
    error = []
    for h in spacing:
        data = np.array([[np.cos(t + k * np.pi / 2) for k in range(derivatives)] for t in (-h / 2, h / 2)])
        polynomial = hermite.coefficients((0, 1), data[:, :, None] * np.ones(21), h)
        error.append(np.abs(hermite.value(polynomial, s) - np.cos((s - 0.5) * h)).max())
    assert np.polyfit(np.log(spacing), np.log(error), 1)[0] == pytest.approx(order, abs=0.05)


@pytest.mark.parametrize("zero", [0.0, 1e-9, 0.25, 1 / 3, 1.0])
def test_a_falling_zero_is_found_to_rounding(zero):
    cubic = np.array([[zero], [-1.0 + zero**2], [-zero], [0.0]])  # (zero - s)(1 + zero s), falling on [0, 1]
    found = hermite.falling_zero(cubic, np.zeros(1), np.ones(1))
    assert found[0] == pytest.approx(zero, abs=4 * np.finfo(float).eps)
