"""What a fit found: values, intervals, test of fit, likely causes of a misfit; as tables, words and plain data."""

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from analysis.quantity import cell
from analysis.trajectory import Floats
from lammps_inputs import html
from lammps_inputs.numbers import known
from workflow.studies.fit.estimate import FitResult
from workflow.studies.fit.goodness import LEVEL, TESTS, Goodness, clipped, goodness, resolution
from workflow.studies.fit.model import Model, reversed_channels
from workflow.sweep import fields


@dataclass(frozen=True)
class Field:
    """A free field, or the time offset.

    Attributes:
        unit: such as ``N/m``.
        start, value: in this unit.
        low, high: ends of the 95% confidence interval; None where the fit is rejected or not tested, or the data do not
            determine the value.
    """

    unit: str
    start: float
    value: float
    low: float | None
    high: float | None

    def row(self) -> list[str]:
        """Cells of a table, with so many digits that the interval shows two."""
        digits = 6
        if self.low is not None and self.high is not None and self.high > self.low:
            wide = max(abs(self.low), abs(self.high)) / (self.high - self.low)
            digits = min(17, max(digits, 2 + math.ceil(math.log10(wide))))
        numbers = (cell(number, f".{digits}g") for number in (self.value, self.low, self.high))
        return [self.unit or "-", f"{self.start:.6g}", *numbers]


@dataclass(frozen=True)
class Residuals:
    """Of a channel.

    Attributes:
        unit: of the channel.
        noise: standard deviation.
        over_largest: the same over the largest value of the data.
        chi_square, autocorrelation, runs: see `Goodness`; None where they are undefined.
        p: of each of `TESTS`.
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
        tests = (cell(value, ".3g") for value in (self.chi_square, self.autocorrelation, self.runs))
        return [self.unit, f"{self.noise:.3g}", f"{100.0 * self.over_largest:.3g}%", *tests]


@dataclass(frozen=True)
class InLammps:
    """The fitted scene in LAMMPS; None where it did not run.

    Attributes:
        error_velocity: error of the run against the reference, in units of V.
        difference: largest difference of a trace from that of the reference, over the noise.
    """

    error_velocity: float | None = None
    difference: float | None = None


@dataclass(frozen=True)
class Fit:
    """What was found.

    Attributes:
        fits: whether the test of fit is passed; None where it cannot be made.
        verdict: the same in one sentence.
        p: smallest p-value of its tests, times their number, rejected below `LEVEL`; None where it cannot be made.
        assumed: fixed fields any change of which the free ones compensate, so that no data can test them.
        free: of each free field, and of the offset where that was free.
        correlation: of the logarithms, in the order of ``free``; None where it is undefined.
        channels: of each channel of the data.
        rows: values fitted.
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
    converged: bool
    warnings: tuple[str, ...]
    lammps: InLammps = InLammps()

    def plain(self) -> dict[str, Any]:
        """For ``fit.json``."""
        return asdict(self)

    def tables(self) -> list[tuple[str, list[str], list[list[str]]]]:
        """Title, head and rows: of the fields, their correlation where there are several, and the residuals."""
        found = [("fields", ["field", "unit", "start", "found", "95% from", "to"], _rows(self.free))]
        if (count := len(self.free)) > 1:
            lines = [
                [name, *(cell(one, ".3f") for one in row[: k + 1]), *[""] * (count - k - 1)]
                for k, (name, row) in enumerate(zip(self.free, self.correlation, strict=True))
            ]
            found.append(("correlation", ["", *map(str, range(1, count + 1))], lines))
        head = ["channel", "unit", "sigma", "of largest", "chi2 / dof", "autocorrelation", "runs / expected"]
        return [*found, ("residuals", head, _rows(self.channels))]

    def __repr__(self) -> str:
        found = ", ".join(f"{name} = {one.value:.6g}" for name, one in self.free.items())
        return f"<fit{' (rejected)' if self.fits is False else ''}: {found[:150]}>"

    def _repr_html_(self) -> str:
        notes = "".join(html.text(note) for note in self.notes())
        return html.text(self.verdict) + html.table(*self.tables()[0]) + notes

    def notes(self) -> list[str]:
        """Warnings, and what intervals assume."""
        said = [f"warning: {warning}" for warning in self.warnings]
        if self.fits and self.assumed:
            fixed = ", ".join(self.assumed)
            said.append(f"intervals assume the given {fixed}: free fields compensate any change, so no data test them")
        return said


def _rows(of: dict[str, Any]) -> list[list[str]]:
    return [[name, *one.row()] for name, one in of.items()]


# --- verdict ----------------------------------------------------------------------------------------------------------

OFFSET = "time offset"

AT_REST = 0.1
"""Part of the noise that a trace stays below before the first arrival."""

NUMERICAL = 3.0
"""Residuals up to this multiple of the numerical error are not tested: a run is as far from the exact motion."""


def judged(model: Model, found: FitResult, size: Floats) -> Fit:
    """The fit of an estimate, tested.

    Args:
        model: whose parameters it has.
        found: the estimate.
        size: [channel] largest value of the data.
    """
    given = model.given
    traces = model.traces(found.parameters)
    assert traces is not None
    before = np.cumsum(np.abs(traces) > AT_REST * found.noise, axis=0) == 0
    fixed, slopes = model.fixed(found.parameters)
    test = goodness(given.values - traces, before, found.noise, model.slopes(found.parameters), slopes)
    units = [model.symbol(channel.quantity) for channel in given.channels]
    statistics = np.stack([test.chi_square, test.autocorrelation, test.runs, *test.p], axis=1).tolist()
    channels = {}
    for channel, unit, noise, largest, row in zip(given.channels, units, found.noise, size, statistics, strict=True):
        chi_square, r, runs, *p = map(known, row)
        channels[channel.name] = Residuals(unit, float(noise), float(noise / largest), chi_square, r, runs, p)
    numerical = model.numerical_error(found.parameters, traces)
    below = found.noise < np.maximum(NUMERICAL * numerical, [0.5 * resolution(column) for column in given.values.T])
    clips = _clips(channels, given.values, traces)
    fits = None if below.any() or not math.isfinite(test.joint) else test.joint >= LEVEL and not clips
    free = _free(model, found, intervals=fits is True)
    if below.any():
        k = int(np.argmax(below))
        name, own = list(channels.items())[k]
        verdict = (
            "no test of fit and no confidence intervals, since the data show no noise: residuals of "
            f"{name} ({own.noise:.2g} {own.unit} rms) are below {NUMERICAL:g} times the numerical "
            f"error of a run ({numerical[k]:.2g} {own.unit} rms) or the resolution of the data"
        )
    else:
        verdict = _verdict(test, fits, clipping=bool(clips))
    warnings = clips or (_of_misfit(model, found, size, test, fixed) if fits is False else _weak(list(free), found))
    if not found.converged:
        warnings.append("the search did not converge; start from values nearer to the truth")
    return Fit(
        fits=fits,
        verdict=verdict,
        p=known(test.joint),
        assumed=tuple(name for name, error in zip(fixed, test.change_error, strict=True) if np.isposinf(error)),
        free=free,
        correlation=[[known(value) for value in row] for row in found.correlation.tolist()],
        channels=channels,
        rows=found.rows,
        converged=found.converged,
        warnings=tuple(warnings),
    )


def _free(model: Model, found: FitResult, *, intervals: bool) -> dict[str, Field]:
    """Values of the free fields, and of the offset where it is free, with intervals."""
    offset = model.finds_offset
    names = (*model.names, *[OFFSET] * offset)
    scene = model.scene_at(found.parameters)
    units = (*(fields.unit(fields.parse(name, scene), scene) for name in model.names), *[model.symbol("time")] * offset)

    def values(sign: float) -> list[float]:
        parameters = found.parameters + sign * found.half_width if sign else found.parameters
        with np.errstate(over="ignore"):
            factors = np.exp(parameters[: len(model.names)]).tolist()
        own = [start * factor for start, factor in zip(model.start, factors, strict=True)]
        return [*own, *(float(p) * model.unit_time for p in parameters[len(model.names) :])]

    ends = zip(values(-1.0), values(1.0), np.isfinite(found.half_width) & intervals, strict=True)
    rows = zip(names, units, (*model.start, *[0.0] * offset), values(0.0), ends, strict=True)
    return {
        name: Field(unit, start, value, *((min(one, other), max(one, other)) if valid else (None, None)))
        for name, unit, start, value, (one, other, valid) in rows
    }


def _verdict(test: Goodness, fits: bool | None, *, clipping: bool) -> str:
    """The test of fit in one sentence."""
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
    """What is said of clipped traces."""
    said = []
    for (name, own), *columns in zip(channels.items(), values.T, traces.T, strict=True):
        level, count = clipped(*columns)
        if count:
            said.append(
                f"{name} is clipped: {count} consecutive samples at its extreme value {level:.6g} {own.unit}; "
                "leave the places of all samples at this value empty"
            )
    return said


def _of_misfit(model: Model, found: FitResult, size: Floats, test: Goodness, fixed: tuple[str, ...]) -> list[str]:
    """Likely causes of a rejected fit."""
    flipped = reversed_channels(model, found.parameters, size)
    if flipped:
        names = ", ".join(channel.name for channel in flipped)
        return [f"the opposite sign fits better: reverse the sign of {names} in the table"]
    order = [k for k in np.argsort(-np.abs(test.change / test.change_error)) if test.wrong[k]]
    if order:
        said = [f"{fixed[k]} by {test.change[k]:+.2%} +- {test.change_error[k]:.2%}" for k in order[:3]]
        return [f"a change of one fixed field would fit better, to first order: {', or '.join(said)}"]
    return [
        "the scene lacks something that acts on the chain, a fixed field is wrong, or the noise is filtered (where "
        "residuals are autocorrelated before the first arrival, too: fit to fewer rows): see the figure"
    ]


def _weak(names: list[str], found: FitResult) -> list[str]:
    """What the data do not determine."""
    said = []
    for group, blind in found.weak:
        words = " and ".join(names[k] for k in group)
        if len(group) == 1:
            said.append(f"the data do not depend on {words}: leave it out of --free")
        elif blind:
            said.append(f"the data do not distinguish {words}: only one of them can be free, or other data are needed")
        else:
            r = np.nanmax(np.abs(found.correlation[np.ix_(group, group)] - np.eye(len(group))))
            said.append(
                f"the data hardly distinguish {words} (correlation {r:.4f}): the uncertainty of each is smaller if the "
                "other is given"
            )
    return said
