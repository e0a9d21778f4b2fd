"""Test of fit: whether residuals are white noise of one size in each channel, as confidence intervals assume. No
physics.

| test            | statistic                                               | reference                             |
|-----------------|---------------------------------------------------------|---------------------------------------|
| size            | mean square after the first arrival over that before it | F distribution                        |
| autocorrelation | Q of lags 1 to 3                                        | Ljung & Box, Biometrika 65, 1978      |
| runs            | number of runs of residuals of one sign                 | Wald & Wolfowitz, Ann. Math. Stat. 11 |

Each fixed field has a further test, the score test (Rao, Proc. Camb. Phil. Soc. 44, 1948): whether a change of the
field would reduce the residuals by more than noise does. It rejects smaller misfits than the other three.

The fit is rejected where the smallest p-value times the number of tests (Bonferroni) is below `LEVEL`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, f, norm

from granchain.parts import Floats
from workflow.plugins.fit.estimate import BLIND

LEVEL = 0.01
"""Probability, by Bonferroni at most, that residuals of white noise are rejected; measured: 0.7% to 1.2%."""

TESTS = ("size", "autocorrelation", "runs")

LAGS = 3
"""More lags make the reference distribution too short in its tail, which the number of tests reaches into."""

FEWEST = 20
"""Least number of rows for a test."""

SAME = 3
"""Least number of consecutive samples of a clipped trace at its largest or its smallest value."""


@dataclass(frozen=True)
class Goodness:
    """Statistics of the residuals of each channel; NaN where there are fewer than `FEWEST` rows.

    Attributes:
        chi_square: [channel] reduced chi-square: mean square after the first arrival over the mean square before it.
        autocorrelation: [channel] autocorrelation of lag 1.
        runs: [channel] number of runs over the number expected.
        p: [test, channel] p-values in the order of `TESTS`.
        change: [fixed field] change of its logarithm that fits best, to first order, with the free fields adjusted.
        change_error: [fixed field] standard error of the change; infinite where the free fields compensate any change,
            NaN where the model does not depend on the field.
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
        """[test, channel] whether a test rejects the fit."""
        return np.asarray(self.p * self._tests < LEVEL)

    @property
    def wrong(self) -> NDArray[np.bool_]:
        """[fixed field] whether its test rejects the fit."""
        return np.asarray(self._p_fixed * self._tests < LEVEL)


def goodness(residuals: Floats, before: NDArray[np.bool_], noise: Floats, free: Floats, fixed: Floats) -> Goodness:
    """Test whether residuals are white noise of one size in each channel.

    Args:
        residuals: [row, channel] in the channel's unit; NaN without data.
        before: [row, channel] whether the row is before the first arrival.
        noise: [channel] standard deviation in the channel's unit.
        free: [row, channel, parameter] derivatives of the model by the parameters.
        fixed: [row, channel, fixed field] derivatives of the model by the logarithms of the fixed fields.
    """
    statistics = []
    for column, early in zip(residuals.T, before.T, strict=True):
        finite = np.isfinite(column)
        values, quiet, moved = column[finite], column[finite & early], column[finite & ~early]
        chi_square, p_size = np.nan, np.nan
        if min(len(quiet), len(moved)) >= FEWEST and np.any(quiet):
            chi_square = np.mean(moved**2) / np.mean(quiet**2)
            p_size = f.sf(chi_square, len(moved), len(quiet))
        r, p_alike = _ljung_box(values)
        runs, p_runs = _runs(values)
        statistics.append((chi_square, r, runs, p_size, p_alike, p_runs))
    columns = np.array(statistics).T
    finite = np.isfinite(residuals)
    weighed = [(slopes / noise[:, np.newaxis])[finite] for slopes in (free, fixed)]
    scores = _scores((residuals / noise)[finite], *weighed)
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
    """Autocorrelation of lag 1, and p; the mean of white residuals is 0 and is not subtracted."""
    count = len(values)
    if count < FEWEST or not np.any(values):
        return np.nan, np.nan
    r = np.array([values[lag:] @ values[:-lag] for lag in range(1, LAGS + 1)]) / (values @ values)
    q = count * (count + 2) * np.sum(r**2 / (count - np.arange(1, LAGS + 1)))
    return float(r[0]), float(chi2.sf(q, LAGS))


def _runs(values: Floats) -> tuple[float, float]:
    """Number of runs over the number expected, and probability of so few."""
    signs = np.sign(values[values != 0.0])
    above, below = int(np.sum(signs > 0.0)), int(np.sum(signs < 0.0))
    if min(above, below) < FEWEST // 4 or above + below < FEWEST:
        return np.nan, np.nan
    count = 1 + int(np.sum(signs[1:] != signs[:-1]))
    expected = 1.0 + 2.0 * above * below / (above + below)
    variance = (expected - 1.0) * (expected - 2.0) / (above + below - 1.0)
    return count / expected, float(norm.cdf((count + 0.5 - expected) / np.sqrt(variance)))


def resolution(values: Floats) -> float:
    """Resolution of values, [row], that are all multiples of one step, as a converter or rounding makes them.

    Returns:
        The step in the unit of the values; 0 where there is none.
    """
    finite = values[np.isfinite(values)]
    steps = np.diff(np.unique(finite))
    if not len(steps) or steps.min() < np.finfo(float).eps * np.abs(finite).max():  # rounding, whose ratios overflow
        return 0.0
    multiples = steps / steps.min()
    return float(steps.min()) if np.all(np.abs(multiples - np.round(multiples)) < 0.01) else 0.0


def clipped(values: Floats, model: Floats) -> tuple[float, int]:
    """Extreme value of a clipped trace and the largest number of consecutive samples at it; NaN and 0 if not clipped.

    Where the trace is clipped, the model is beyond the extreme value; where few digits make samples equal, it is not.

    Args:
        values: [row] the trace in its unit; NaN without data.
        model: [row] trace of the model.
    """
    for sign in (1.0, -1.0):
        extreme = sign * np.nanmax(sign * values)
        at = values == extreme
        ends = np.flatnonzero(np.diff(np.concatenate([[False], at, [False]])))
        longest = int(np.max(ends[1::2] - ends[::2]))
        if longest >= SAME and sign * np.mean(model[at] - extreme) > 0.0:
            return float(extreme), longest
    return np.nan, 0
