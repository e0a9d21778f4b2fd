"""Test of fit: whether residuals are white noise of one size in each channel, as confidence intervals assume. No
physics.

| test            | statistic                                               | reference                             |
|-----------------|---------------------------------------------------------|---------------------------------------|
| size            | mean square after the first arrival over that before it | F distribution                        |
| autocorrelation | Q of lags 1 to 3                                        | Ljung & Box, Biometrika 65, 1978      |
| runs            | number of runs of residuals of one sign                 | Wald & Wolfowitz, Ann. Math. Stat. 11 |

And one of each fixed field, the score test (Rao, Proc. Camb. Phil. Soc. 44, 1948): whether a change of it would reduce
the residuals by more than noise does. It rejects smaller misfits than the other three.

The fit is rejected where the smallest p-value times the number of tests (Bonferroni) is below `LEVEL`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, f, norm

from analysis.trajectory import Floats
from workflow.studies.fit.estimate import BLIND

LEVEL = 0.01
"""Probability, by Bonferroni at most, that residuals of white noise are rejected; measured: 0.7% to 1.2%."""

TESTS = ("size", "autocorrelation", "runs")

LAGS = 3
"""More lags make the reference distribution too short in its tail, which the number of tests reaches into."""

FEWEST = 20
"""Rows that a test takes."""

SAME = 3
"""Consecutive samples at its largest or its smallest value that a clipped trace has at least."""


@dataclass(frozen=True)
class Goodness:
    """Statistics of the residuals of each channel; NaN where there are fewer than `FEWEST` rows.

    Attributes:
        chi_square: reduced chi-square: mean square after the first arrival, with the mean square before it as variance.
        autocorrelation: of lag 1.
        runs: number of runs over the number expected.
        p: [test, channel] in the order of `TESTS`.
        change: [fixed field] of its logarithm, that fits best, to first order, with the free fields following.
        change_error: standard error; infinite where these compensate any change, NaN where the model does not depend on
            the field.
    """

    chi_square: Floats
    autocorrelation: Floats
    runs: Floats
    p: Floats
    change: Floats
    change_error: Floats

    @property
    def _p_fixed(self) -> Floats:
        return np.asarray(2.0 * norm.sf(np.abs(self.change / self.change_error)))

    @property
    def _tests(self) -> int:
        return int(np.isfinite(self.p).sum() + np.isfinite(self._p_fixed).sum())

    @property
    def joint(self) -> float:
        """Smallest p-value times the number of tests; NaN where none of `TESTS` can be made."""
        if not np.isfinite(self.p).any():
            return np.nan
        return float(min(1.0, self._tests * min(np.nanmin(self.p), np.nanmin(self._p_fixed, initial=1.0))))

    @property
    def rejected(self) -> NDArray[np.bool_]:
        """[test, channel]."""
        return np.asarray(self.p * self._tests < LEVEL)

    @property
    def wrong(self) -> NDArray[np.bool_]:
        """[fixed field] whether its test rejects the fit."""
        return np.asarray(self._p_fixed * self._tests < LEVEL)


def goodness(residuals: Floats, before: NDArray[np.bool_], noise: Floats, free: Floats, fixed: Floats) -> Goodness:
    """Test residuals.

    Args:
        residuals: [row, channel]; NaN without data.
        before: [row, channel] rows before the first arrival.
        noise: [channel] standard deviation.
        free: [row, channel, parameter] derivatives of the model.
        fixed: [row, channel, fixed field] likewise.
    """
    found = []
    for column, early in zip(residuals.T, before.T, strict=True):
        known = np.isfinite(column)
        values, quiet, moved = column[known], column[known & early], column[known & ~early]
        chi_square, p_size = np.nan, np.nan
        if min(len(quiet), len(moved)) >= FEWEST and np.any(quiet):
            chi_square = np.mean(moved**2) / np.mean(quiet**2)
            p_size = f.sf(chi_square, len(moved), len(quiet))
        r, p_alike = _ljung_box(values)
        runs, p_runs = _runs(values)
        found.append((chi_square, r, runs, p_size, p_alike, p_runs))
    columns = np.array(found).T
    known = np.isfinite(residuals)
    weighed = [(slopes / noise[:, np.newaxis])[known] for slopes in (free, fixed)]
    scores = _scores((residuals / noise)[known], *weighed)
    return Goodness(columns[0], columns[1], columns[2], columns[3:6], *scores)


def _scores(residuals: Floats, free: Floats, fixed: Floats) -> tuple[Floats, Floats]:
    """Changes of fixed fields that fit best, each alone, and their standard errors; residuals in units of the noise."""
    rest = fixed - free @ np.linalg.lstsq(free, fixed, rcond=None)[0]
    size, length = np.linalg.norm(fixed, axis=0), np.linalg.norm(rest, axis=0)
    change, error = np.full(len(size), np.nan), np.where(size > 0.0, np.inf, np.nan)
    tested = length > BLIND * size
    error[tested] = 1.0 / length[tested]
    change[tested] = (residuals @ rest)[tested] * error[tested] ** 2
    return change, error


def _ljung_box(values: Floats) -> tuple[float, float]:
    """Correlation of lag 1, and p; the mean of white residuals is 0 and is not subtracted."""
    count = len(values)
    if count < FEWEST or not np.any(values):
        return np.nan, np.nan
    r = np.array([values[lag:] @ values[:-lag] for lag in range(1, LAGS + 1)]) / (values @ values)
    q = count * (count + 2) * np.sum(r**2 / (count - np.arange(1, LAGS + 1)))
    return float(r[0]), float(chi2.sf(q, LAGS))


def _runs(values: Floats) -> tuple[float, float]:
    """Runs over the number expected, and p of so few."""
    signs = np.sign(values[values != 0.0])
    above, below = int(np.sum(signs > 0.0)), int(np.sum(signs < 0.0))
    if min(above, below) < FEWEST // 4 or above + below < FEWEST:
        return np.nan, np.nan
    count = 1 + int(np.sum(signs[1:] != signs[:-1]))
    expected = 1.0 + 2.0 * above * below / (above + below)
    variance = (expected - 1.0) * (expected - 2.0) / (above + below - 1.0)
    return count / expected, float(norm.cdf((count + 0.5 - expected) / np.sqrt(variance)))


def resolution(values: Floats) -> float:
    """Step of values that are all multiples of one, as a converter or rounding makes them; 0 where there is none."""
    finite = values[np.isfinite(values)]
    steps = np.diff(np.unique(finite))
    if not len(steps) or steps.min() < np.finfo(float).eps * np.abs(finite).max():  # rounding, whose ratios overflow
        return 0.0
    multiples = steps / steps.min()
    return float(steps.min()) if np.all(np.abs(multiples - np.round(multiples)) < 0.01) else 0.0


def clipped(values: Floats, model: Floats) -> tuple[float, int]:
    """The extreme value of a clipped trace, and how many consecutive samples at most are at it; NaN and 0 of others.

    Where the trace is clipped, the model is beyond the extreme value; where few digits make samples equal, it is not.
    """
    for sign in (1.0, -1.0):
        extreme = sign * np.nanmax(sign * values)
        at = values == extreme
        ends = np.flatnonzero(np.diff(np.concatenate([[False], at, [False]])))
        longest = int(np.max(ends[1::2] - ends[::2]))
        if longest >= SAME and sign * np.mean(model[at] - extreme) > 0.0:
            return float(extreme), longest
    return np.nan, 0
