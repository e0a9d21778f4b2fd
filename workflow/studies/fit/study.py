"""A fit from beginning to end: from a scene and a table to fitted fields, a run of LAMMPS with them, and a report.

| file           | what                                                                         |
|----------------|------------------------------------------------------------------------------|
| fit.json       | what was found, see `Fit.plain`                                              |
| fitted.yaml    | the scene with the fitted fields; its first line says where these do not fit |
| residuals.png  | traces, and their residuals                                                  |
| lammps/        | run directory of the fitted scene, over the time of the data                 |
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from analysis.files import traces
from analysis.files.traces import Channel
from analysis.gauges.channels import read, read_at
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import InputError, html, library, strict_yaml
from lammps_inputs.numbers import known
from workflow.formats import figure_files
from workflow.runs.check import Check
from workflow.runs.own_files import claim
from workflow.runs.run import run
from workflow.runs.study_directory import mark
from workflow.runs.whole_files import write_figure, write_json, write_text
from workflow.studies.fit.estimate import CONFIDENCE, Estimate, estimate
from workflow.studies.fit.fields import Free, free
from workflow.studies.fit.goodness import LEVEL, TESTS, Goodness, clipped, goodness, resolution
from workflow.studies.fit.model import Model
from workflow.sweep import fields

REPORT, FITTED, FIGURE, LAMMPS = "fit.json", "fitted.yaml", "residuals", "lammps"
_RESULT = f"{REPORT} holds what was found"

OFFSET = "time offset"

STARTS = 32
"""Points around the start of which the best are begun from, too."""

SPREAD = math.log(1.5)
"""How far around, in logarithms of the fields."""

BEGUN = 3
"""Searches, from the best of those points."""

STEP = 1e-4
"""Of logarithms, for derivatives."""

OFFSET_STEP = 1e-3
"""Of the time offset, in units of T, likewise."""

NO_MODEL = ("duration", "until_bead", "timestep", "accuracy", "output")
"""Keys that traces do not depend on."""

AT_REST = 0.1
"""Part of the noise that a trace stays below before the first arrival."""

NUMERICAL = 3.0
"""Residuals up to this multiple of the numerical error are not tested: a run is as far from the exact motion."""


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
        verdict: its outcome in one sentence.
        assumed: fixed fields any change of which the free ones compensate, so that no data can test them.
        check: error of the LAMMPS run against the reference.
        lammps: largest difference of a trace of LAMMPS from that of the reference, over the noise; None if LAMMPS did
            not run.
        warnings: likely causes of a rejected fit, clipped traces, and what the data do not determine.
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
    verdict: str
    assumed: tuple[str, ...]
    check: Check | None
    lammps: float | None
    warnings: tuple[str, ...]

    HEAD = ("field", "unit", "start", "found", "95% from", "to")
    """Of `rows`."""

    def rows(self) -> list[tuple[str, ...]]:
        """Table of the fields, with so many digits that the interval shows two."""
        columns = zip(self.names, self.units, self.start, self.value, self.low, self.high, strict=True)
        rows = []
        for name, unit, start, value, low, high in columns:
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
        columns = zip(self.names, self.units, self.start, self.value, self.low, self.high, strict=True)
        test = self.goodness
        return {
            "fits": self.fits,
            "verdict": self.verdict,
            "p": known(test.joint),
            "assumed": list(self.assumed),
            "free": {n: {"unit": u, "start": s, "value": v, "low": a, "high": b} for n, u, s, v, a, b in columns},
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


class _Search:
    """Residuals and derivatives by parameters: logarithms of the fields, then the offset in units of T if free."""

    def __init__(self, model: Model, what: Free, scene: dict[str, Any], offset: float | None) -> None:
        self.model, self.what, self.scene = model, what, scene
        self.fixed_offset = offset
        self._kept: dict[tuple[float, ...], Trajectory | None] = {}

    def offset(self, parameters: Floats) -> float:
        return self.fixed_offset if self.fixed_offset is not None else float(parameters[-1]) * self.model.unit_time

    def fields(self, parameters: Floats) -> list[float]:
        return self.what.values(parameters[: len(self.what.names)])

    def trajectory(self, parameters: Floats) -> Trajectory | None:
        """None where the scene is refused."""
        until = float(self.model.given.time[-1]) - self.offset(parameters)
        key = (*parameters[: len(self.what.names)].tolist(), math.ceil(until / self.model.every))
        if key not in self._kept:
            if len(self._kept) > 4 * len(parameters) + 4:
                self._kept.pop(next(iter(self._kept)))
            try:
                scene = self.what.put(self.scene, self.fields(parameters))
                self._kept[key] = self.model.run(scene, until)
            except (InputError, OverflowError):
                self._kept[key] = None
        return self._kept[key]

    def traces(self, parameters: Floats) -> Floats | None:
        run = self.trajectory(parameters)
        return None if run is None else self.model.traces(run, self.offset(parameters))

    def residuals(self, parameters: Floats) -> Floats:
        values = self.model.given.values
        found = self.traces(parameters)
        if found is None:
            return np.where(np.isfinite(values), np.inf, np.nan)
        return np.asarray(values - found)

    def slopes(self, parameters: Floats) -> Floats:
        return np.stack([self.slope(parameters, place) for place in range(len(parameters))], axis=-1)

    def slope(self, parameters: Floats, place: int) -> Floats:
        """Derivative of the traces by one parameter, [row, channel]."""
        step = STEP if place < len(self.what.names) else OFFSET_STEP
        sides = []
        for sign in (1.0, -1.0):
            moved = parameters.copy()
            moved[place] += sign * step
            sides.append(self.traces(moved))
        middle = self.traces(parameters) if None in [s if s is None else 0 for s in sides] else None
        above, below = (middle if side is None else side for side in sides)
        if above is None or below is None:
            raise InputError(f"{self.model.source}: no scene near these values of the free fields can be computed")
        width = step * sum(side is not None for side in sides)
        return np.asarray((above - below) / max(width, step))

    def fixed(self, parameters: Floats) -> tuple[tuple[str, ...], Floats]:
        """Fixed fields that hold a number, and derivatives of the traces by their logarithms, [row, channel, field]."""
        count = len(self.what.names)
        names, columns = [], []
        varied = {_entries(name) for name in self.what.names}
        for name in _numbers(self.scene):
            try:
                if _entries(name) in varied:
                    continue
                one = free([name], self.scene, self.model.source)
                wide = Free((*self.what.names, name), self.what.start + one.start)
                search = _Search(self.model, wide, self.scene, self.fixed_offset)
                columns.append(search.slope(np.insert(parameters, count, 0.0), count))
                names.append(name)
            except InputError:  # no number, or none near it is a scene
                continue
        shape = (*self.model.given.values.shape, 0)
        return tuple(names), np.stack(columns, axis=-1) if columns else np.empty(shape)

    def aligned(self, logarithms: Floats, size: Floats, *, flipped: bool = False) -> tuple[float, Floats] | None:
        """Sum of squares, weighed by size, and parameters with the offset at which it is least on a raster.

        With ``flipped`` the offset is that at which it is least where the sign of each channel is free.
        """
        given = self.model.given
        if self.fixed_offset is not None:
            left = self.residuals(logarithms)
            return _squares(left / size), logarithms
        try:
            scene = self.what.put(self.scene, self.what.values(logarithms))
            run = self.model.run(scene, float(given.time[-1] - given.time[0]))
        except (InputError, OverflowError):
            return None
        # with traces at the frames, since thousands of offsets are tried
        frames, unit = run.time * run.problem.scale.time, self.model.unit_time
        worth = [getattr(run.problem.scale, channel.quantity) for channel in given.channels]
        shown = read(run, given.channels) * worth
        span = float(given.time[-1] - given.time[0])
        rough = given.time[0] - span / 2.0 + np.arange(0.0, 1.5 * span, max(0.5 * unit, span / 2000.0))
        best = self._least(rough, frames, shown, size, flipped=flipped)
        near = best + np.linspace(-1.0, 1.0, 41) * (rough[1] - rough[0] if len(rough) > 1 else unit)
        best = self._least(near, frames, shown, size, flipped=flipped)
        parameters = np.append(logarithms, best / unit)
        return _squares(self.residuals(parameters) / size), parameters

    def _least(self, offsets: Floats, frames: Floats, shown: Floats, size: Floats, *, flipped: bool) -> float:
        given = self.model.given
        costs = []
        for offset in offsets:
            traces = np.stack([np.interp(given.time - offset, frames, column, left=0.0) for column in shown.T], axis=1)
            cost = np.nansum(((given.values - traces) / size) ** 2, axis=0)
            if flipped:
                cost = np.minimum(cost, np.nansum(((given.values + traces) / size) ** 2, axis=0))
            costs.append(float(np.sum(cost)))
        return float(offsets[int(np.argmin(costs))])

    def flipped(self, parameters: Floats, size: Floats) -> tuple[Channel, ...]:
        """Channels whose opposite sign at least halves the sum of squares, near these parameters or the start."""
        given = self.model.given
        count = len(self.what.names)
        found: tuple[Channel, ...] = ()
        least = 0.5 * _squares(self.residuals(parameters) / size)
        for point in (parameters[:count], np.zeros(count)):
            best = self.aligned(point, size, flipped=True)
            traces = None if best is None else self.traces(best[1])
            if traces is None:
                continue
            signs = np.where(np.nansum(given.values * traces, axis=0) < 0.0, -1.0, 1.0)
            cost = _squares((given.values - signs * traces) / size)
            if cost < least:
                least = cost
                found = tuple(channel for channel, sign in zip(given.channels, signs, strict=True) if sign < 0.0)
        return found


def _numbers(scene: dict[str, Any], above: str = "") -> Iterator[str]:
    """Names of all that holds a number in a scene's plain data."""
    for key, value in scene.items():
        if isinstance(value, dict):
            yield from _numbers(value, f"{above}{key}.")
        elif isinstance(value, list | tuple):
            for number, part in enumerate(value, 1):
                yield from _numbers(part, f"{above}{key}[{number}].") if isinstance(part, dict) else ()
        elif isinstance(value, int | float) and key not in NO_MODEL:
            yield above + key


def _entries(name: str) -> tuple[tuple[str, int], ...]:
    """The keys of a field, of several parts each with its number."""
    return tuple((key, number or 1) for key, number in fields.parse(name))


def _squares(left: Floats) -> float:
    return float(np.nansum(left**2))


def fit(
    scene: dict[str, Any],
    path: Path,
    names: list[str],
    directory: Path,
    *,
    source: str,
    offset: float | None = None,
    lammps: bool = True,
) -> Fit:
    """Find fields of a scene from measured traces, and write what was found.

    Args:
        scene: plain data of the scene, with values to start from.
        path: the table, see `analysis.files.traces`.
        names: of the free fields.
        directory: made if need be.
        source: what to call the scene in messages.
        offset: by how much the table's times are later than the scene's, in its units; None to find it, too.
        lammps: whether to run the fitted scene in LAMMPS.

    Raises:
        InputError: the scene, the table, a field or the directory cannot be used.
        RunError: LAMMPS failed.
    """
    library.from_plain(scene, source)
    what = free(names, scene, source)
    given = traces.load(path)
    model = Model(scene, source, path, given)
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{directory}: cannot be written to ({error.strerror})") from None
    claim(directory, (REPORT, FITTED, *figure_files(FIGURE), LAMMPS))
    mark(directory, "fit", done=False, result=_RESULT, resume="the same command fits again")
    if int(np.isfinite(given.values).sum()) <= len(names) + (offset is None):
        raise InputError(f"{path}: has fewer values than there are unknowns")
    search = _Search(model, what, scene, offset)
    size = np.nanmax(np.abs(given.values), axis=0)
    for channel, largest in zip(given.channels, size, strict=True):
        if not largest > 0.0:
            raise InputError(f"{path}: {channel.name}: holds nothing but zeros; leave it out")
    found = _best(search, size)
    fitted = what.put(scene, search.fields(found.parameters))
    result = _described(search, found, size, fitted)
    comment = "" if result.fits is not False else f"# {result.verdict}\n"
    write_text(directory / FITTED, comment + strict_yaml.dump(library.from_plain(fitted, source).plain()))
    if lammps:
        check, apart = _in_lammps(fitted, source, model, search, found, directory / LAMMPS)
        result = replace(result, check=check, lammps=apart)
    write_json(directory / REPORT, result.plain())
    _draw(directory, search, result)
    mark(directory, "fit", done=True, result=_RESULT)
    return result


def _best(search: _Search, size: Floats) -> Estimate:
    """The best of searches from the start and from points around it, with what is told of its noise."""
    count = len(search.what.names)
    around = SPREAD * (2.0 * qmc.Sobol(count, seed=1).random(STARTS) - 1.0)
    points = [search.aligned(point, size) for point in (np.zeros(count), *around)]
    ranked = sorted((point for point in points if point is not None), key=lambda point: point[0])
    if not ranked:
        raise InputError(f"{search.model.source}: no scene near these values of the free fields can be computed")
    chosen = [point[1] for point in ranked[:BEGUN]]
    if points[0] is not None and not any(point is points[0][1] for point in chosen):
        chosen.append(points[0][1])
    tried = [estimate(search.residuals, search.slopes, start, size) for start in chosen]
    return min(tried, key=lambda one: _squares(search.residuals(one.parameters) / size))


def _in_lammps(
    fitted: dict[str, Any], source: str, model: Model, search: _Search, found: Estimate, directory: Path
) -> tuple[Check | None, float]:
    """Error of the run of the fitted scene over the data's time, and how far its traces are from the reference's."""
    offset = search.offset(found.parameters)
    until = max(float(model.given.time[-1]) - offset, 0.0) + 8.0 * model.every
    kept = {key: value for key, value in fitted.items() if key not in ("until_bead", "output")}
    scene = library.from_plain({**kept, "duration": until}, source)
    done = run(scene, directory, overwrite=directory.exists())
    theirs = read_at(done.trajectory, model.given.channels, model.given.time - offset)
    own = search.traces(found.parameters)
    assert own is not None
    return done.check, float(np.max(np.abs(theirs - own) / found.noise))


def _described(search: _Search, found: Estimate, size: Floats, fitted: dict[str, Any]) -> Fit:
    names = (*search.what.names, *([] if search.fixed_offset is not None else [OFFSET]))
    unit = search.model.unit_time
    count = len(search.what.names)
    given = search.model.given
    traces = search.traces(found.parameters)
    assert traces is not None
    before = np.cumsum(np.abs(traces) > AT_REST * found.noise, axis=0) == 0
    fixed, slopes = search.fixed(found.parameters)
    test = goodness(given.values - traces, before, found.noise, search.slopes(found.parameters), slopes)
    offset = search.offset(found.parameters)
    numerical = search.model.numerical_error(fitted, offset, traces)
    unresolved = found.noise < np.maximum(
        NUMERICAL * numerical, [0.5 * resolution(column) for column in given.values.T]
    )
    clips = _clips(search.model, given.values, traces)
    fits = None if unresolved.any() or not math.isfinite(test.joint) else test.joint >= LEVEL and not clips

    def in_units(parameters: Floats) -> list[float]:
        with np.errstate(over="ignore"):
            values = [start * float(np.exp(p)) for start, p in zip(search.what.start, parameters[:count], strict=True)]
        return [*values, *(float(p) * unit for p in parameters[count:])]

    ends = [in_units(found.parameters - found.half_width), in_units(found.parameters + found.half_width)]
    valid = np.isfinite(found.half_width) & (fits is True)
    low = tuple(min(a, b) if ok else None for a, b, ok in zip(*ends, valid, strict=True))
    high = tuple(max(a, b) if ok else None for a, b, ok in zip(*ends, valid, strict=True))
    units = [fields.unit(fields.parse(name), fitted) for name in search.what.names]
    result = Fit(
        names=names,
        units=(*units, *([] if search.fixed_offset is not None else [search.model.symbol("time")])),
        start=(*search.what.start, *([] if search.fixed_offset is not None else [0.0])),
        value=tuple(in_units(found.parameters)),
        low=low,
        high=high,
        found=found,
        channels=given.channels,
        channel_units=search.model.units,
        share=tuple((found.noise / size).tolist()),
        goodness=test,
        fixed=fixed,
        fits=fits,
        verdict="",
        assumed=tuple(name for name, error in zip(fixed, test.change_error, strict=True) if np.isposinf(error)),
        check=None,
        lammps=None,
        warnings=(),
    )
    warnings = clips or (_of_misfit(search, result, size) if fits is False else _weak(result))
    if not found.converged:
        warnings.append("the search did not converge; start from values nearer to the truth")
    verdict = _verdict(result, unresolved, numerical, clips)
    return replace(result, verdict=verdict, warnings=tuple(warnings))


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


def _of_misfit(search: _Search, fit: Fit, size: Floats) -> list[str]:
    """Likely causes of a rejected fit."""
    flipped = search.flipped(fit.found.parameters, size)
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


def _draw(directory: Path, search: _Search, fit: Fit) -> None:
    from analysis.figures.traces import residual_figure  # matplotlib takes half a second to import

    own = search.traces(fit.found.parameters)
    run = search.trajectory(fit.found.parameters)
    assert own is not None
    assert run is not None
    mark = "; fit rejected" if fit.fits is False else ""
    figure = residual_figure(run.problem, search.model.given, own, fit.found.noise, mark=mark)
    write_figure(directory, FIGURE, figure)


__all__ = ["CONFIDENCE", "FITTED", "REPORT", "Fit", "fit"]
