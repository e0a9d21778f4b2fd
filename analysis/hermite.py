"""Polynomials through values and derivatives at equally spaced frames, for many series at once.

Plug-ins take this module for what happens between frames: `coefficients` gives the polynomials, `value` and
`derivative` evaluate them, `falling_zero` finds where they fall through zero, such as the end of a contact.

Examples:
    >>> position, velocity = [1.0, -1.0], [-1.0, -3.0]  # at t = 0 and t = 1
    >>> through = hermite.coefficients((0, 1), np.array([position, velocity]).T, spacing=1.0)  # [power]
    >>> hermite.falling_zero(through[:, np.newaxis], np.zeros(1), np.ones(1)).round(6)
    array([0.618034])
"""

import functools
import math
from collections.abc import Callable

import numpy as np

from analysis.trajectory import Flags, Floats

HALVINGS = 50


@functools.lru_cache
def _coefficients_from_data(nodes: tuple[int, ...], derivatives: int) -> Floats:
    """Inverse of the confluent Vandermonde matrix; data are ordered by node, then by derivative."""
    size = len(nodes) * derivatives
    rows = [
        [math.perm(power, order) * float(node) ** (power - order) if power >= order else 0.0 for power in range(size)]
        for node in nodes
        for order in range(derivatives)
    ]
    return np.asarray(np.linalg.inv(np.array(rows)))


def coefficients(nodes: tuple[int, ...], data: Floats, spacing: float) -> Floats:
    """Polynomials of ``t / spacing`` with given values and derivatives at t = node * spacing.

    Args:
        nodes: frames relative to the one where t = 0.
        data: [node, derivative, ...]: value, first derivative, ... in one unit and that over the unit of time.
        spacing: time between frames, in the unit of time of the derivatives.

    Returns:
        Coefficients, [power, ...], by ascending power, in the unit of the values.
    """
    count, derivatives = data.shape[:2]
    scaled = data * (spacing ** np.arange(derivatives)).reshape((1, derivatives) + (1,) * (data.ndim - 2))
    flat = scaled.reshape((count * derivatives, *data.shape[2:]))
    matrix = _coefficients_from_data(nodes, derivatives)
    # term by term: a matrix product rounds one series otherwise according to how many others there are
    result = np.zeros_like(flat)
    for power, row in enumerate(matrix):
        for factor, term in zip(row, flat, strict=True):
            result[power] += factor * term
    return result


def derivative(polynomials: Floats) -> Floats:
    """Derivatives of polynomials with respect to ``t / spacing``.

    Args:
        polynomials: [power, ...] coefficients, in any unit.

    Returns:
        [power, ...] coefficients of the derivatives, in the same unit; there is one power less.
    """
    powers = np.arange(1, len(polynomials)).reshape((-1,) + (1,) * (polynomials.ndim - 1))
    return polynomials[1:] * powers


def value(polynomials: Floats, s: Floats) -> Floats:
    """Values of polynomials.

    Args:
        polynomials: [power, ...] coefficients, of `coefficients` or `derivative`, in any unit.
        s: [...] times in units of the spacing.

    Returns:
        [...] in the unit of the coefficients.
    """
    result = np.zeros_like(s)
    for coefficient in polynomials[::-1]:
        result = result * s + coefficient
    return result


def integral(polynomials: Floats, s: Floats) -> Floats:
    """Integrals of polynomials [power, ...] over ``t / spacing`` from 0 to s, of the trailing shape."""
    return s * value(polynomials / np.arange(1, len(polynomials) + 1)[:, np.newaxis], s)


def falling_zero(polynomials: Floats, low: Floats, high: Floats) -> Floats:
    """Place at which each polynomial falls through zero, by bisection.

    Args:
        polynomials: [power, ...] coefficients, in any unit; values are positive at low, and not at high.
        low, high: [...] times in units of the spacing.

    Returns:
        [...] times in units of the spacing.
    """
    return change(lambda s: value(polynomials, s) > 0.0, np.True_, low, high)


def change(state: Callable[[Floats], Flags], before: Flags | np.bool_, low: Floats, high: Floats) -> Floats:
    """Place at which a state that is ``before`` at low, and not at high, changes, by bisection; all of one shape."""
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        same = state(middle) == before
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return 0.5 * (low + high)


def first_fall(above: Floats, time: Floats, shift: int = 0) -> tuple[Floats, Floats]:
    """Time when samples first fall through zero after time 0, and the size of their slope then, [series]; else NaN.

    Args:
        above: [series, sample] the values; they fall through zero between the middle two of six samples, through which
            a polynomial goes.
        time: [series, sample] evenly spaced.
        shift: number of samples by which these six are later.
    """
    nodes = (0, 1, 2, 3, 4, 5)
    row, size = np.arange(len(above)), above.shape[1]
    fallen = (time > 0.0) & (above <= 0.0)
    if size < len(nodes):
        return np.full(len(above), np.nan), np.full(len(above), np.nan)
    first = np.where(np.any(fallen, axis=1), np.argmax(fallen, axis=1), 0)
    start = np.clip(first - 3 + shift, 0, size - len(nodes))
    data = np.array([above[row, start + node] for node in nodes])[:, np.newaxis]
    step = time[row, start + 1] - time[row, start]
    low = np.maximum((first - 1 - start).astype(float), -time[row, start] / step)
    polynomials = coefficients(nodes, data, 1.0)
    at = falling_zero(polynomials, low, (first - start).astype(float))
    slope = np.abs(value(derivative(polynomials), at)) / step
    falls = np.any(fallen, axis=1) & np.all(np.isfinite(data[:, 0]), axis=0)
    return np.where(falls, time[row, start] + at * step, np.nan), np.where(falls & (slope > 0.0), slope, np.nan)
