"""Least squares: the best parameters, their uncertainty, and which the data do not distinguish. No physics.

The noise is taken to be normal, white and of one size in each channel, found from the residuals; `goodness` tests that.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.stats import t as student

from granchain.parts import Floats

Residuals = Callable[[Floats], Floats]
"""Parameters -> data minus model, [row, channel]; NaN without data; all infinite where there is no model."""

Mask = NDArray[np.bool_]

Slopes = Callable[[Floats], Floats]
"""Parameters -> derivatives of the model, [row, channel, parameter], in the channel's unit."""

CONFIDENCE = 0.95

REACH = 2.0
"""Standard errors along a principal axis within which jumps of the model are looked for."""

FARTHEST = 0.05
"""Largest distance within which they are: beyond it a model of weakly determined parameters is not smooth enough."""

ROUNDS = 3
"""Number of fits; each weighs channels by the noise that the previous one estimated."""

WEAK = 0.1
"""Singular value of the derivatives, each of length 1, below which parameters are hard to distinguish; for two
parameters it corresponds to a correlation of 0.99.
"""

BLIND = 1e-3
"""Singular value below which parameters are not distinguished at all."""

UNSEEN = 1e-6
"""Length of a parameter's derivatives over the largest below which the data do not depend on it."""

SHARE = 0.3
"""Least component of a parameter in the direction of a small singular value for it to be named."""

TRACE = 0.01
"""Least component of a parameter in the directions of singular values below `BLIND` for it to be undetermined; smaller
ones are errors of derivatives.
"""


@dataclass(frozen=True)
class FitResult:
    """Estimate of the parameters.

    Attributes:
        parameters: [parameter] the best.
        error: [parameter] standard error; infinite where the data do not determine the parameter.
        half_width: [parameter] half-width of the confidence interval.
        correlation: [parameter, parameter]; NaN where the data do not determine it.
        noise: [channel] standard deviation of the residuals, in the channel's unit.
        rows: number of values that were fitted.
        jumps: [row, channel] values that were left out, since the model jumps there within the uncertainty (`jumping`).
        weak: groups of parameters, by number, that the data hardly distinguish, and how many of each group must be
            given for the data to determine the others; 0 where they are determined, if weakly.
        converged: whether the search came to its end.
    """

    parameters: Floats
    error: Floats
    half_width: Floats
    correlation: Floats
    noise: Floats
    rows: int
    jumps: Mask
    weak: tuple[tuple[tuple[int, ...], int], ...]
    converged: bool


def estimate(residuals: Residuals, slopes: Slopes, start: Floats, size: Floats) -> FitResult:
    """Fit a model by least squares, channels weighed by their noise.

    Args:
        residuals, slopes: functions of the parameters, see `Residuals` and `Slopes`.
        start: [parameter] where the search begins.
        size: [channel] largest value of the data in the channel's unit, which weighs channels in the first round.
    """
    noise, parameters, converged = size, start, True
    jumps = np.zeros(residuals(start).shape, dtype=bool)
    for _ in range(ROUNDS):
        weights = 1.0 / noise
        mask = np.isfinite(residuals(parameters)) & ~jumps

        def weighed(p: Floats, mask: Mask = mask, weights: Floats = weights) -> Floats:
            """Residuals over the noise at parameters [parameter], [value]."""
            return np.asarray((residuals(p) * weights)[mask])

        def derivatives(p: Floats, mask: Mask = mask, weights: Floats = weights) -> Floats:
            """Derivatives of the weighed residuals at parameters [parameter], [value, parameter]."""
            return np.asarray(-(slopes(p) * weights[:, np.newaxis])[mask])

        solution = least_squares(weighed, parameters, derivatives, method="trf", x_scale="jac", xtol=1e-10, ftol=1e-12)
        parameters, converged = solution.x, bool(solution.status > 0)
        noise = _noise(_without(residuals(parameters), jumps), len(parameters), size)
        jumps = jumping(residuals, parameters, _covariance(derivatives(parameters, weights=1.0 / noise))[0], noise)
    left = _without(residuals(parameters), jumps)
    noise = _noise(left, len(parameters), size)
    jacobian = -(slopes(parameters) / noise[:, np.newaxis])[np.isfinite(left)]
    rows = len(jacobian)
    covariance, weak = _covariance(jacobian)
    error = np.sqrt(np.diag(covariance))
    factor = float(student.ppf(0.5 + 0.5 * CONFIDENCE, max(1, rows - len(parameters))))
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = covariance / np.sqrt(np.outer(np.diag(covariance), np.diag(covariance)))
    return FitResult(parameters, error, factor * error, correlation, noise, rows, jumps, weak, converged)


def _without(residuals: Floats, jumps: Mask) -> Floats:
    """Residuals [row, channel], NaN where the model jumps."""
    return np.where(jumps, np.nan, residuals)


def jumping(residuals: Residuals, parameters: Floats, covariance: Floats, noise: Floats) -> Mask:
    """Values at which the model jumps within the uncertainty of the parameters, [row, channel].

    A trace jumps at the instant at which a contact with a dashpot closes; a sample that this instant passes says on
    which side of it the parameters are, which no derivative does. Along each principal axis of the covariance the
    second difference over a step h is of order h^2 where the model is smooth: that over `REACH` is four times that over
    half of it. Where the two differ by more than the noise, the model jumps.

    Args:
        residuals: function of the parameters.
        parameters: [parameter] the best.
        covariance: [parameter, parameter], infinite on the diagonal where undetermined.
        noise: [channel] standard deviation in the channel's unit.
    """
    middle = residuals(parameters)
    determined = np.flatnonzero(np.isfinite(np.diag(covariance)))
    variances, axes = np.linalg.eigh(covariance[np.ix_(determined, determined)])
    jumps = np.zeros(middle.shape, dtype=bool)
    for variance, axis in zip(variances, axes.T, strict=True):
        step = np.zeros(len(parameters))
        step[determined] = min(REACH * np.sqrt(max(variance, 0.0)), FARTHEST) * axis
        with np.errstate(invalid="ignore"):  # infinite where there is no model
            wide, narrow = (
                residuals(parameters + h * step) - 2.0 * middle + residuals(parameters - h * step) for h in (1.0, 0.5)
            )
            change = np.abs(wide - 4.0 * narrow)
        jumps |= np.isfinite(change) & (change > noise)
    return jumps


def _noise(left: Floats, parameters: int, size: Floats) -> Floats:
    """Standard deviation of the residuals, [channel], at least 1e-9 of the data's size, so that weights are finite."""
    count = np.isfinite(left).sum(axis=0)
    freedom = np.maximum(1.0, count * (1.0 - parameters / max(parameters + 1, int(count.sum()))))
    return np.asarray(np.maximum(np.sqrt(np.nansum(left**2, axis=0) / freedom), 1e-9 * size))


def _covariance(jacobian: Floats) -> tuple[Floats, tuple[tuple[tuple[int, ...], int], ...]]:
    """Inverse of the normal matrix, infinite on the diagonal where undetermined, and groups of `FitResult.weak`."""
    count = jacobian.shape[1]
    length = np.sqrt(np.sum(jacobian**2, axis=0))
    blind = length <= UNSEEN * max(float(np.max(length, initial=0.0)), 1e-300)
    weak: list[tuple[tuple[int, ...], int]] = [((int(k),), 1) for k in np.flatnonzero(blind)]
    determined = np.flatnonzero(~blind)
    covariance = np.full((count, count), np.nan)
    _, singular, directions = np.linalg.svd(jacobian[:, determined] / length[determined], full_matrices=False)
    lost = np.linalg.norm(directions[singular < BLIND], axis=0) > TRACE
    for group in _groups(directions[singular < BLIND]):
        weak.append((tuple(int(k) for k in determined[list(group)]), _rank(directions[singular < BLIND], group)))
    for value, direction in zip(singular[::-1], directions[::-1], strict=True):
        if BLIND <= value < WEAK and len(determined) > 1:
            weak.append((tuple(int(k) for k in determined[np.abs(direction) > SHARE]), 0))
    safe = np.maximum(singular, BLIND)
    inverse = (directions.T / safe**2) @ directions / np.outer(length[determined], length[determined])
    covariance[np.ix_(determined, determined)] = inverse
    for k in (*np.flatnonzero(blind), *determined[lost]):
        covariance[k, :] = covariance[:, k] = np.nan
        covariance[k, k] = np.inf
    return covariance, tuple(weak)


def _groups(directions: Floats) -> list[tuple[int, ...]]:
    """Parameters, by number, that combinations of directions [direction, parameter] change together.

    Two belong to one group where the projection on the directions couples them.
    """
    coupled = np.abs(directions.T @ directions) > TRACE**2
    waiting, groups = [k for k in range(len(coupled)) if coupled[k, k]], []
    while waiting:
        group, new = set[int](), {waiting[0]}
        while new:
            group |= new
            new = {k for k in waiting if k not in group and coupled[k, list(group)].any()}
        groups.append(tuple(sorted(group)))
        waiting = [k for k in waiting if k not in group]
    return groups


def _rank(directions: Floats, group: tuple[int, ...]) -> int:
    """Number of directions [direction, parameter] within a group of parameters: the trace of the projection on them."""
    return max(1, round(float(np.sum(directions[:, list(group)] ** 2))))
