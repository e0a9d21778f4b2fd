"""Result of a fit: values, intervals, test of fit, likely causes of a misfit; as tables, sentences and plain data."""

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from granchain.parts import Flags, Floats, fields, html, numbers, screen
from workflow.plugins.fit.estimate import FitResult
from workflow.plugins.fit.goodness import LEVEL, TESTS, Goodness, clipped, goodness, resolution
from workflow.plugins.fit.model import Model, reversed_channels

UNDETERMINED = "undetermined"
"""Value that the data do not determine, in a table."""


@dataclass(frozen=True)
class Field:
    """A free field, a gain or baseline of a sensor, or the time offset.

    Attributes:
        unit: unit, such as ``N/m``.
        start: value in the scene, in this unit; None of a sensor.
        value: fitted value; None where the data do not determine it.
        low: lower end of the 95% confidence interval; None where the fit is rejected or not tested, or the data do not
            determine the value.
        high: upper end of the interval.
    """

    unit: str
    start: float | None
    value: float | None
    low: float | None
    high: float | None

    def row(self) -> list[str]:
        """Cells of a table, with so many digits that the width of the interval has two."""
        digits = 6
        if self.low is not None and self.high is not None and self.high > self.low:
            wide = max(abs(self.low), abs(self.high)) / (self.high - self.low)
            digits = min(17, max(digits, 2 + math.ceil(math.log10(wide))))
        value, *ends = (screen.cell(number, f".{digits}g") for number in (self.value, self.low, self.high))
        found = UNDETERMINED if self.value is None else value
        return [self.unit or "-", screen.cell(self.start, ".6g"), found, *ends]


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
        free: name -> free field, gain or baseline of a channel, or the offset where it was free.
        correlation: correlation of the logarithms of fields and gains, of baselines and the offset, in the order of
            ``free``; None where it is undefined.
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
    baseline = model.sensors.lines(model.of_sensors(estimated.parameters))[1]
    before = np.cumsum(np.abs(traces - baseline) > AT_REST * estimated.noise, axis=0) == 0
    fixed, slopes = model.fixed(estimated.parameters)
    left = np.where(estimated.jumps, np.nan, measured.values - traces)
    test = goodness(left, before, estimated.noise, model.slopes(estimated.parameters), slopes)
    statistics = np.stack([test.chi_square, test.autocorrelation, test.runs, *test.p], axis=1).tolist()
    channels = {}
    for channel, unit, noise, largest, row in zip(
        measured.channels, model.units, estimated.noise, size, statistics, strict=True
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
    warnings = clips or (_of_misfit(model, estimated, size, test, fixed) if fits is False else [])
    warnings += _undetermined(model, list(free), estimated)
    warnings += [] if fits is False else _weak(list(free), estimated)
    if not estimated.converged:
        warnings.append("the search did not converge; start from values nearer to the truth")
    return Fit(
        fits=fits,
        verdict=verdict,
        p=numbers.known(test.joint),
        assumed=tuple(name for name, error in zip(fixed, test.change_error, strict=True) if np.isposinf(error)),
        free=free,
        correlation=[[numbers.known(value) for value in row] for row in _correlation(model, estimated).tolist()],
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
    """Free fields, gains and baselines, and the offset where it is free, with confidence intervals."""
    offset, sensors, scene = model.finds_offset, model.sensors, model.scene_at(estimated.parameters)
    names = (*model.names, *[f"{name} of {model.measured.channels[k].name}" for k, name in sensors.free])
    units = [fields.unit(fields.parse(name, scene), scene) for name in model.names]
    for place, name in sensors.free:
        symbol = model.symbol(model.measured.channels[place].quantity)
        units.append(f"{symbol}/{model.units[place]}" if name == "gain" else model.units[place])
    starts = (*model.start, *[None] * len(sensors.free), *[0.0] * offset)
    low, value, high = (
        _values(model, estimated.parameters + sign * np.nan_to_num(estimated.half_width, posinf=0.0))
        for sign in (-1.0, 0.0, 1.0)
    )
    determined = _determined(model, estimated)
    rows = zip((*names, *[OFFSET] * offset), (*units, *[model.symbol("time")] * offset), starts, strict=True)
    return {
        name: Field(
            unit,
            start,
            value[k] if determined[k] else None,
            *((min(low[k], high[k]), max(low[k], high[k])) if determined[k] and intervals else (None, None)),
        )
        for k, (name, unit, start) in enumerate(rows)
    }


def _gains(model: Model) -> list[int]:
    """Numbers of the parameters that are inverse gains."""
    return [len(model.names) + k for k, (_, name) in enumerate(model.sensors.free) if name == "gain"]


def _determined(model: Model, estimated: FitResult) -> Flags:
    """Whether the data determine each parameter, [parameter]; a gain not where it may be infinite."""
    determined = np.isfinite(estimated.half_width)
    gains = _gains(model)
    determined[gains] &= np.abs(estimated.parameters[gains]) > estimated.half_width[gains]
    return np.asarray(determined)


def _correlation(model: Model, estimated: FitResult) -> Floats:
    """Correlation of the logarithms of fields and gains, of baselines and the offset, [parameter, parameter]."""
    signs, gains = np.ones(len(estimated.parameters)), _gains(model)
    signs[gains] = -np.sign(estimated.parameters[gains])  # parameters are inverse gains
    return np.asarray(estimated.correlation * np.outer(signs, signs))


def _values(model: Model, parameters: Floats) -> list[float]:
    """Free fields, gains and baselines, and the offset where it is free, at parameters [parameter]."""
    count = len(model.names)
    with np.errstate(over="ignore"):
        factors = np.exp(parameters[:count]).tolist()
    values = [start * factor for start, factor in zip(model.start, factors, strict=True)]
    offset = [float(parameters[-1]) * model.unit_time] * model.finds_offset
    return [*values, *model.sensors.reported(model.of_sensors(parameters)), *offset]


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


def _undetermined(model: Model, names: list[str], estimated: FitResult) -> list[str]:
    """Warnings of parameters that the data do not determine."""
    warnings = []
    for group, rank in estimated.weak:
        words = _listed([names[k] for k in group])
        if rank and len(group) == 1:
            warnings.append(f"the data do not depend on {words}: leave it out of --free")
        elif rank:
            warnings.append(
                f"the data do not distinguish {words}: other values of them, changed together, fit as well, so they "
                f"are undetermined; give {rank} of these {len(group)}, or use other data"
            )
    for k in _gains(model):
        if math.isfinite(estimated.half_width[k]) and not _determined(model, estimated)[k]:
            warnings.append(f"the data do not determine the {names[k]}: its signal is within the noise")
    return warnings


def _weak(names: list[str], estimated: FitResult) -> list[str]:
    """Warnings of parameters that the data hardly distinguish."""
    warnings = []
    for group, rank in estimated.weak:
        if not rank:
            r = np.nanmax(np.abs(estimated.correlation[np.ix_(group, group)] - np.eye(len(group))))
            others = "other is" if len(group) == 2 else "others are"
            warnings.append(
                f"the data hardly distinguish {_listed([names[k] for k in group])} (correlation {r:.4f}): the "
                f"uncertainty of each is smaller if the {others} given"
            )
    return warnings


def _listed(names: list[str]) -> str:
    """Names with commas between, and "and" before the last."""
    return " and ".join(filter(None, [", ".join(names[:-1]), names[-1]]))
