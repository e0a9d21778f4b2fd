"""What a fit found: values, intervals, test of fit, likely causes of a misfit; as table, words and plain data."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.files.traces import Channel
from analysis.trajectory import Floats
from lammps_inputs import html
from lammps_inputs.numbers import known
from workflow.runs.check import Check
from workflow.studies.fit.estimate import Estimate
from workflow.studies.fit.goodness import LEVEL, TESTS, Goodness, clipped, goodness, resolution
from workflow.studies.fit.model import Model
from workflow.studies.fit.search import Search, reversed_channels
from workflow.sweep import fields


@dataclass(frozen=True)
class Fit:
    """What was found.

    Attributes:
        names: of what was free, in order; the last is the time offset, where that was free.
        units: of each, such as ``N/m``.
        start, value: of each, in these units.
        low, high: ends of the 95% confidence interval of each; None where the fit is rejected or not tested, or the
            data do not determine the value.
        found: in logarithms (the offset in units of T), and the noise.
        channels: of the data.
        channel_units: of each.
        share: [channel] noise over the largest value of the data.
        goodness: test of fit.
        fixed: names of the fixed fields that it tests.
        fits: whether it is passed; None where it cannot be made.
        assumed: fixed fields any change of which the free ones compensate, so that no data can test them.
        verdict: the outcome of the test of fit in one sentence.
        warnings: likely causes of a rejected fit, clipped traces, and what the data do not determine.
        check: error of the LAMMPS run against the reference.
        lammps: largest difference of a trace of LAMMPS from that of the reference, over the noise; None if LAMMPS did
            not run.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    start: tuple[float, ...]
    value: tuple[float, ...]
    low: tuple[float | None, ...]
    high: tuple[float | None, ...]
    found: Estimate
    channels: tuple[Channel, ...]
    channel_units: tuple[str, ...]
    share: tuple[float, ...]
    goodness: Goodness
    fixed: tuple[str, ...]
    fits: bool | None
    assumed: tuple[str, ...]
    verdict: str = ""
    warnings: tuple[str, ...] = ()
    check: Check | None = None
    lammps: float | None = None

    HEAD = ("field", "unit", "start", "found", "95% from", "to")
    """Of `rows`."""

    def _columns(self) -> Iterator[tuple[Any, ...]]:
        return zip(self.names, self.units, self.start, self.value, self.low, self.high, strict=True)

    def rows(self) -> list[tuple[str, ...]]:
        """Table of the fields, with so many digits that the interval shows two."""
        rows = []
        for name, unit, start, value, low, high in self._columns():
            digits = 6
            if low is not None and high is not None and high > low:
                digits = max(digits, 2 + math.ceil(math.log10(max(abs(low), abs(high)) / (high - low))))
            numbers = ("-" if number is None else f"{number:.{min(digits, 17)}g}" for number in (value, low, high))
            rows.append((name, unit or "-", f"{start:.6g}", *numbers))
        return rows

    def __repr__(self) -> str:
        found = ", ".join(f"{name} = {value:.6g}" for name, value in zip(self.names, self.value, strict=True))
        return f"<fit{' (rejected)' if self.fits is False else ''}: {found[:150]}>"

    def _repr_html_(self) -> str:
        notes = "".join(html.text(note) for note in self.notes())
        return html.text(self.verdict) + html.table("fit", self.HEAD, self.rows()) + notes

    def notes(self) -> list[str]:
        """Warnings, and what intervals assume."""
        said = [f"warning: {warning}" for warning in self.warnings]
        if self.fits and self.assumed:
            fixed = ", ".join(self.assumed)
            said.append(f"intervals assume the given {fixed}: free fields compensate any change, so no data test them")
        return said

    def plain(self) -> dict[str, Any]:
        """For ``fit.json``.

        | key         | what                                                                           |
        |-------------|--------------------------------------------------------------------------------|
        | fits        | whether the test of fit is passed; null where it cannot be made                |
        | verdict     | the same in words                                                              |
        | p           | smallest p-value of its tests, times their number; rejected below 0.01         |
        | assumed     | fixed fields that no data can test, since the free ones compensate any change  |
        | free        | per field: unit, start, value, low and high (95%); the last two null where the |
        |             | test is not passed, or the data do not determine the field                     |
        | correlation | of the logarithms, in the order of ``free``; null where undefined              |
        | channels    | per channel: unit; noise (standard deviation of the residuals), over the       |
        |             | largest value; chi_square, autocorrelation, runs: see `Goodness`, and their p  |
        | rows        | values fitted                                                                  |
        | warnings    | likely causes of a rejected fit, clipped traces, what the data do not determine |
        | lammps      | error of its run in V; largest difference from the reference's traces / noise  |
        """
        test = self.goodness
        return {
            "fits": self.fits,
            "verdict": self.verdict,
            "p": known(test.joint),
            "assumed": list(self.assumed),
            "free": {
                n: {"unit": u, "start": s, "value": v, "low": a, "high": b} for n, u, s, v, a, b in self._columns()
            },
            "correlation": [[known(value) for value in row] for row in self.found.correlation.tolist()],
            "channels": {
                channel.name: {
                    "unit": unit,
                    "noise": float(self.found.noise[place]),
                    "over_largest": self.share[place],
                    "chi_square": known(float(test.chi_square[place])),
                    "autocorrelation": known(float(test.autocorrelation[place])),
                    "runs": known(float(test.runs[place])),
                    "p": [known(p) for p in test.p[:, place].tolist()],
                }
                for place, (channel, unit) in enumerate(zip(self.channels, self.channel_units, strict=True))
            },
            "rows": self.found.rows,
            "converged": self.found.converged,
            "warnings": list(self.warnings),
            "lammps": {
                "error_velocity": None if self.check is None else self.check.velocity,
                "difference": self.lammps,
            },
        }


# --- verdict ----------------------------------------------------------------------------------------------------------

OFFSET = "time offset"

AT_REST = 0.1
"""Part of the noise that a trace stays below before the first arrival."""

NUMERICAL = 3.0
"""Residuals up to this multiple of the numerical error are not tested: a run is as far from the exact motion."""


def judged(search: Search, found: Estimate, size: Floats, fitted: dict[str, Any]) -> Fit:
    """The fit of an estimate, tested.

    Args:
        search: whose estimate it is.
        found: the estimate.
        size: [channel] largest value of the data.
        fitted: plain data of the scene with the values found.
    """
    given = search.model.given
    traces = search.traces(found.parameters)
    assert traces is not None
    before = np.cumsum(np.abs(traces) > AT_REST * found.noise, axis=0) == 0
    fixed, slopes = search.fixed(found.parameters)
    test = goodness(given.values - traces, before, found.noise, search.slopes(found.parameters), slopes)
    numerical = search.model.numerical_error(fitted, search.offset(found.parameters), traces)
    steps = [0.5 * resolution(column) for column in given.values.T]
    unresolved = found.noise < np.maximum(NUMERICAL * numerical, steps)
    clips = _clips(search.model, given.values, traces)
    fits = None if unresolved.any() or not math.isfinite(test.joint) else test.joint >= LEVEL and not clips
    ends = [_in_units(search, found.parameters + sign * found.half_width) for sign in (-1.0, 1.0)]
    valid = np.isfinite(found.half_width) & (fits is True)
    intervals = [(min(pair), max(pair)) if ok else (None, None) for *pair, ok in zip(*ends, valid, strict=True)]
    offset = search.finds_offset
    result = Fit(
        names=(*search.what.names, *[OFFSET] * offset),
        units=(
            *(fields.unit(fields.parse(name), fitted) for name in search.what.names),
            *[search.model.symbol("time")] * offset,
        ),
        start=(*search.what.start, *[0.0] * offset),
        value=tuple(_in_units(search, found.parameters)),
        low=tuple(low for low, _ in intervals),
        high=tuple(high for _, high in intervals),
        found=found,
        channels=given.channels,
        channel_units=search.model.units,
        share=tuple((found.noise / size).tolist()),
        goodness=test,
        fixed=fixed,
        fits=fits,
        assumed=tuple(name for name, error in zip(fixed, test.change_error, strict=True) if np.isposinf(error)),
    )
    warnings = clips or (_of_misfit(search, result, size) if fits is False else _weak(result))
    if not found.converged:
        warnings.append("the search did not converge; start from values nearer to the truth")
    return replace(result, verdict=_verdict(result, unresolved, numerical, clips), warnings=tuple(warnings))


def _in_units(search: Search, parameters: Floats) -> list[float]:
    """Values of the fields, and the offset where it is free, in the scene's units."""
    count = len(search.what.names)
    with np.errstate(over="ignore"):
        values = [start * float(np.exp(p)) for start, p in zip(search.what.start, parameters[:count], strict=True)]
    return [*values, *(float(p) * search.model.unit_time for p in parameters[count:])]


def _verdict(fit: Fit, unresolved: NDArray[np.bool_], numerical: Floats, clips: list[str]) -> str:
    """The test of fit in one sentence."""
    test = fit.goodness
    if unresolved.any():
        k = int(np.argmax(unresolved))
        unit = fit.channel_units[k]
        return (
            "no test of fit and no confidence intervals, since the data show no noise: residuals of "
            f"{fit.channels[k].name} ({fit.found.noise[k]:.2g} {unit} rms) are below {NUMERICAL:g} times the numerical "
            f"error of a run ({numerical[k]:.2g} {unit} rms) or the resolution of the data"
        )
    if fit.fits is None:
        return "no test of fit and no confidence intervals: too few rows"
    if fit.fits:
        return (
            f"test of fit passed: residuals are consistent with white noise of one size (p = {test.joint:.2g}; "
            f"rejected below {LEVEL:g})"
        )
    tests = [name for name, some in zip(TESTS, np.any(test.rejected, axis=1).tolist(), strict=True) if some]
    tests += ["fixed fields"] * bool(test.wrong.any()) + ["clipping"] * bool(clips)
    p = f"; p = {max(test.joint, 1e-300):.1g}, rejected below {LEVEL:g}" if test.joint < LEVEL else ""
    return (
        "the model does not fit the data to within white noise of one size, so there are no confidence intervals "
        f"(tests failed: {', '.join(tests)}{p})"
    )


def _clips(model: Model, values: Floats, traces: Floats) -> list[str]:
    """What is said of clipped traces."""
    said = []
    for channel, unit, *columns in zip(model.given.channels, model.units, values.T, traces.T, strict=True):
        level, count = clipped(*columns)
        if count:
            said.append(
                f"{channel.name} is clipped: {count} consecutive samples at its extreme value {level:.6g} {unit}; "
                "leave the places of all samples at this value empty"
            )
    return said


def _of_misfit(search: Search, fit: Fit, size: Floats) -> list[str]:
    """Likely causes of a rejected fit."""
    flipped = reversed_channels(search, fit.found.parameters, size)
    if flipped:
        names = ", ".join(channel.name for channel in flipped)
        return [f"the opposite sign fits better: reverse the sign of {names} in the table"]
    test = fit.goodness
    order = [k for k in np.argsort(-np.abs(test.change / test.change_error)) if test.wrong[k]]
    if order:
        said = [f"{fit.fixed[k]} by {test.change[k]:+.2%} +- {test.change_error[k]:.2%}" for k in order[:3]]
        return [f"a change of one fixed field would fit better, to first order: {', or '.join(said)}"]
    filtered = int(np.max(test.filtered))
    said = []
    if filtered > 1:
        said.append(
            "residuals are autocorrelated before the first arrival, too: where the noise is filtered, fit to one row "
            f"in {filtered} of the table"
        )
    return [*said, "the scene lacks something that acts on the chain, or a fixed field is wrong: see the figure"]


def _weak(fit: Fit) -> list[str]:
    """What the data do not determine."""
    said = []
    for group, blind in fit.found.weak:
        words = " and ".join(fit.names[k] for k in group)
        if len(group) == 1:
            said.append(f"the data do not depend on {words}: leave it out of --free")
        elif blind:
            said.append(f"the data do not distinguish {words}: only one of them can be free, or other data are needed")
        else:
            r = np.nanmax(np.abs(fit.found.correlation[np.ix_(group, group)] - np.eye(len(group))))
            said.append(
                f"the data hardly distinguish {words} (correlation {r:.4f}): the uncertainty of each is smaller if the "
                "other is given"
            )
    return said
