"""Result of a fit: values, intervals, test of fit, likely causes of a misfit; as tables, sentences and plain data."""

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from granchain.parts import Flags, Floats, fields, html, numbers, screen
from workflow.plugins.fit.estimate import FitResult
from workflow.plugins.fit.goodness import LEVEL, TESTS, Goodness, clipped, goodness, resolution
from workflow.plugins.fit.model import Model, reversed_channels


@dataclass(frozen=True)
class Field:
    """A free field, or the time offset.

    Attributes:
        unit: unit, such as ``N/m``.
        start: value in the scene, in this unit.
        value: fitted value.
        low: lower end of the 95% confidence interval; None where the fit is rejected or not tested, or the data do not
            determine the value.
        high: upper end of the interval.
    """

    unit: str
    start: float
    value: float
    low: float | None
    high: float | None

    def row(self) -> list[str]:
        """Cells of a table, with so many digits that the width of the interval has two."""
        digits = 6
        if self.low is not None and self.high is not None and self.high > self.low:
            wide = max(abs(self.low), abs(self.high)) / (self.high - self.low)
            digits = min(17, max(digits, 2 + math.ceil(math.log10(wide))))
        cells = (screen.cell(number, f".{digits}g") for number in (self.value, self.low, self.high))
        return [self.unit or "-", f"{self.start:.6g}", *cells]


@dataclass(frozen=True)
class Residuals:
    """Residuals of a channel.

    Attributes:
        unit: unit of the channel.
        noise: standard deviation of the residuals, in this unit.
        over_largest: this standard deviation over the largest value of the data.
        chi_square: see `Goodness`; None where it is undefined.
        autocorrelation: see `Goodness`; None where it is undefined.
        runs: see `Goodness`; None where it is undefined.
        p: p-value of each of `TESTS`; None where it is undefined.
    """

    unit: str
    noise: float
    over_largest: float
    chi_square: float | None
    autocorrelation: float | None
    runs: float | None
    p: list[float | None]

    def row(self) -> list[str]:
        """Cells of a table."""
        tests = (screen.cell(value, ".3g") for value in (self.chi_square, self.autocorrelation, self.runs))
        return [self.unit, f"{self.noise:.3g}", f"{100.0 * self.over_largest:.3g}%", *tests]


@dataclass(frozen=True)
class InLammps:
    """The fitted scene in LAMMPS; None where it did not run.

    Attributes:
        error_velocity: error of the run against the reference, in units of V.
        difference: largest difference of a trace from that of the reference, over the noise of the channel.
    """

    error_velocity: float | None = None
    difference: float | None = None


@dataclass(frozen=True)
class Fit:
    """Result of a fit.

    Attributes:
        fits: whether the test of fit is passed; None where it cannot be made.
        verdict: the result of the test in one sentence.
        p: smallest p-value of the tests, times their number; the fit is rejected below `LEVEL`; None where no test can
            be made.
        assumed: fixed fields any change of which the free ones compensate, so that no data can test them.
        free: name -> free field, or the offset where it was free.
        correlation: correlation of the logarithms, in the order of ``free``; None where it is undefined.
        channels: name -> residuals of a channel of the data.
        rows: number of values fitted.
        left_out: number of values left out, at which a trace of the model jumps within the uncertainty.
        converged: whether the search came to its end.
        warnings: likely causes of a rejected fit, clipped traces, and what the data do not determine.
        lammps: run of the fitted scene.
    """

    fits: bool | None
    verdict: str
    p: float | None
    assumed: tuple[str, ...]
    free: dict[str, Field]
    correlation: list[list[float | None]]
    channels: dict[str, Residuals]
    rows: int
    left_out: int
    converged: bool
    warnings: tuple[str, ...]
    lammps: InLammps = InLammps()

    def plain(self) -> dict[str, Any]:
        """Contents of ``fit.json``."""
        return asdict(self)

    def tables(self) -> list[tuple[str, list[str], list[list[str]]]]:
        """Title, head and rows of tables of the fields, of their correlation if there are several, and of residuals."""
        tables = [("fields", ["field", "unit", "start", "found", "95% from", "to"], _rows(self.free))]
        if (count := len(self.free)) > 1:
            lines = [
                [name, *(screen.cell(number, ".3f") for number in row[: k + 1]), *[""] * (count - k - 1)]
                for k, (name, row) in enumerate(zip(self.free, self.correlation, strict=True))
            ]
            tables.append(("correlation", ["", *map(str, range(1, count + 1))], lines))
        head = ["channel", "unit", "sigma", "of largest", "chi2 / dof", "autocorrelation", "runs / expected"]
        return [*tables, ("residuals", head, _rows(self.channels))]

    def __repr__(self) -> str:
        values = ", ".join(f"{name} = {field.value:.6g}" for name, field in self.free.items())
        return f"<fit{' (rejected)' if self.fits is False else ''}: {values[:150]}>"

    def _repr_html_(self) -> str:
        notes = "".join(html.text(note) for note in self.notes())
        return html.text(self.verdict) + html.table(*self.tables()[0]) + notes

    def notes(self) -> list[str]:
        """Warnings, and assumptions of the confidence intervals."""
        notes = [f"warning: {warning}" for warning in self.warnings]
        if self.left_out:
            notes.append(
                f"{self.left_out} of {self.rows + self.left_out} values are left out: a trace of the model jumps there "
                "within the uncertainty, where a contact with a dashpot closes"
            )
        if self.fits and self.assumed:
            fixed = ", ".join(self.assumed)
            notes.append(f"intervals assume the given {fixed}: free fields compensate any change, so no data test them")
        return notes


def _rows(entries: dict[str, Any]) -> list[list[str]]:
    return [[name, *entry.row()] for name, entry in entries.items()]


# --- verdict ----------------------------------------------------------------------------------------------------------

OFFSET = "time offset"

AT_REST = 0.1
"""Share of the noise below which a trace stays before the first arrival."""

NUMERICAL = 3.0
"""Residuals up to this multiple of the numerical error are not tested: a run is as far from the exact motion."""


def judged(model: Model, estimated: FitResult, size: Floats) -> Fit:
    """Test an estimate.

    Args:
        model: the model.
        estimated: the estimate of its parameters.
        size: [channel] largest value of the data, in the channel's unit.

    Returns:
        The result, with intervals where the test of fit is passed.
    """
    measured = model.measured
    traces = model.traces(estimated.parameters)
    assert traces is not None
    before = np.cumsum(np.abs(traces) > AT_REST * estimated.noise, axis=0) == 0
    fixed, slopes = model.fixed(estimated.parameters)
    left = np.where(estimated.jumps, np.nan, measured.values - traces)
    test = goodness(left, before, estimated.noise, model.slopes(estimated.parameters), slopes)
    units = [model.symbol(channel.quantity) for channel in measured.channels]
    statistics = np.stack([test.chi_square, test.autocorrelation, test.runs, *test.p], axis=1).tolist()
    channels = {}
    for channel, unit, noise, largest, row in zip(
        measured.channels, units, estimated.noise, size, statistics, strict=True
    ):
        chi_square, r, runs, *p = map(numbers.known, row)
        channels[channel.name] = Residuals(unit, float(noise), float(noise / largest), chi_square, r, runs, p)
    numerical = model.numerical_error(estimated.parameters, traces, estimated.jumps)
    below = estimated.noise < np.maximum(
        NUMERICAL * numerical, [0.5 * resolution(column) for column in measured.values.T]
    )
    clips = _clips(channels, measured.values, traces)
    fits = None if below.any() or not math.isfinite(test.joint) else test.joint >= LEVEL and not clips
    free = _free(model, estimated, intervals=fits is True)
    without = _without_noise(channels, numerical, below) if below.any() else ""
    verdict = without or _verdict(test, fits, clipping=bool(clips))
    warnings = clips or (
        _of_misfit(model, estimated, size, test, fixed) if fits is False else _weak(list(free), estimated)
    )
    if not estimated.converged:
        warnings.append("the search did not converge; start from values nearer to the truth")
    return Fit(
        fits=fits,
        verdict=verdict,
        p=numbers.known(test.joint),
        assumed=tuple(name for name, error in zip(fixed, test.change_error, strict=True) if np.isposinf(error)),
        free=free,
        correlation=[[numbers.known(value) for value in row] for row in estimated.correlation.tolist()],
        channels=channels,
        rows=estimated.rows,
        left_out=int(np.sum(estimated.jumps & np.isfinite(measured.values))),
        converged=estimated.converged,
        warnings=tuple(warnings),
    )


def _without_noise(channels: dict[str, Residuals], numerical: Floats, below: Flags) -> str:
    """Why no fit is tested where residuals, [channel], are below what a run or the data resolve."""
    k = int(np.argmax(below))
    name, residuals = list(channels.items())[k]
    return (
        "no test of fit and no confidence intervals, since the data show no noise: residuals of "
        f"{name} ({residuals.noise:.2g} {residuals.unit} rms) are below {NUMERICAL:g} times the numerical "
        f"error of a run ({numerical[k]:.2g} {residuals.unit} rms) or the resolution of the data"
    )


def _free(model: Model, estimated: FitResult, *, intervals: bool) -> dict[str, Field]:
    """Free fields, and the offset where it is free, with confidence intervals."""
    offset = model.finds_offset
    names = (*model.names, *[OFFSET] * offset)
    scene = model.scene_at(estimated.parameters)
    units = (*(fields.unit(fields.parse(name, scene), scene) for name in model.names), *[model.symbol("time")] * offset)

    def values(sign: float) -> list[float]:
        parameters = estimated.parameters + sign * estimated.half_width if sign else estimated.parameters
        with np.errstate(over="ignore"):
            factors = np.exp(parameters[: len(model.names)]).tolist()
        values_of_fields = [start * factor for start, factor in zip(model.start, factors, strict=True)]
        return [*values_of_fields, *(float(p) * model.unit_time for p in parameters[len(model.names) :])]

    ends = zip(values(-1.0), values(1.0), np.isfinite(estimated.half_width) & intervals, strict=True)
    rows = zip(names, units, (*model.start, *[0.0] * offset), values(0.0), ends, strict=True)
    return {
        name: Field(unit, start, value, *((min(low, high), max(low, high)) if valid else (None, None)))
        for name, unit, start, value, (low, high, valid) in rows
    }


def _verdict(test: Goodness, fits: bool | None, *, clipping: bool) -> str:
    """Verdict of the test of fit in one sentence."""
    if fits is None:
        return "no test of fit and no confidence intervals: too few rows"
    if fits:
        return (
            f"test of fit passed: residuals are consistent with white noise of one size (p = {test.joint:.2g}; "
            f"rejected below {LEVEL:g})"
        )
    tests = [name for name, some in zip(TESTS, np.any(test.rejected, axis=1).tolist(), strict=True) if some]
    tests += ["fixed fields"] * bool(test.wrong.any()) + ["clipping"] * clipping
    p = f"; p = {max(test.joint, 1e-300):.1g}, rejected below {LEVEL:g}" if test.joint < LEVEL else ""
    return (
        "the model does not fit the data to within white noise of one size, so there are no confidence intervals "
        f"(tests failed: {', '.join(tests)}{p})"
    )


def _clips(channels: dict[str, Residuals], values: Floats, traces: Floats) -> list[str]:
    """Warnings of clipped traces."""
    warnings = []
    for (name, residuals), *columns in zip(channels.items(), values.T, traces.T, strict=True):
        level, count = clipped(*columns)
        if count:
            warnings.append(
                f"{name} is clipped: {count} consecutive samples at its extreme value {level:.6g} {residuals.unit}; "
                "leave the places of all samples at this value empty"
            )
    return warnings


def _of_misfit(model: Model, estimated: FitResult, size: Floats, test: Goodness, fixed: tuple[str, ...]) -> list[str]:
    """Likely causes of a rejected fit."""
    flipped = reversed_channels(model, estimated.parameters, size)
    if flipped:
        names = ", ".join(channel.name for channel in flipped)
        return [f"the opposite sign fits better: reverse the sign of {names} in the table"]
    order = [k for k in np.argsort(-np.abs(test.change / test.change_error)) if test.wrong[k]]
    if order:
        changes = [f"{fixed[k]} by {test.change[k]:+.2%} +- {test.change_error[k]:.2%}" for k in order[:3]]
        return [f"a change of one fixed field would fit better, to first order: {', or '.join(changes)}"]
    return [
        "the scene lacks something that acts on the chain, a fixed field is wrong, or the noise is filtered (where "
        "residuals are autocorrelated before the first arrival, too: fit to fewer rows): see the figure"
    ]


def _weak(names: list[str], estimated: FitResult) -> list[str]:
    """Warnings of fields that the data do not determine."""
    warnings = []
    for group, blind in estimated.weak:
        words = " and ".join(names[k] for k in group)
        if len(group) == 1:
            warnings.append(f"the data do not depend on {words}: leave it out of --free")
        elif blind:
            warnings.append(
                f"the data do not distinguish {words}: only one of them can be free, or other data are needed"
            )
        else:
            r = np.nanmax(np.abs(estimated.correlation[np.ix_(group, group)] - np.eye(len(group))))
            warnings.append(
                f"the data hardly distinguish {words} (correlation {r:.4f}): the uncertainty of each is smaller if the "
                "other is given"
            )
    return warnings
