"""A fit from beginning to end: from a scene and a table to fitted fields, a run of LAMMPS with them, and a report.

| file           | what                                                                         |
|----------------|------------------------------------------------------------------------------|
| fit.json       | what was found, see `Fit.plain`                                              |
| fitted.yaml    | the scene with the fitted fields                                             |
| residuals.png  | traces, and what is left of them                                             |
| lammps/        | run directory of the fitted scene, over the time of the data                 |
"""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import qmc

from analysis.files import traces
from analysis.files.traces import Channel
from analysis.gauges.channels import read, read_at
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import InputError, html, library, strict_yaml
from workflow.formats import figure_files
from workflow.runs.check import Check
from workflow.runs.own_files import claim
from workflow.runs.run import run
from workflow.runs.study_directory import mark
from workflow.runs.whole_files import write_figure, write_json, write_text
from workflow.studies.fit.estimate import CONFIDENCE, Estimate, estimate
from workflow.studies.fit.fields import Free, free
from workflow.studies.fit.model import Model

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


@dataclass(frozen=True)
class Fit:
    """What was found.

    Attributes:
        names: of what was free, in order; the last is the time offset, where that was free.
        start, value, low, high: of each, in the scene's units, with the ends of its 95% interval; None where the data
            tell nothing.
        found: in logarithms (the offset in units of T), and the noise.
        channels: of the data.
        share: [channel] noise over the largest value of the data.
        check: error of the LAMMPS run against the reference.
        lammps: largest difference of a trace of LAMMPS from that of the reference, over the noise; None if LAMMPS did
            not run.
        warnings: what the data cannot tell, in words.
    """

    names: tuple[str, ...]
    start: tuple[float, ...]
    value: tuple[float, ...]
    low: tuple[float | None, ...]
    high: tuple[float | None, ...]
    found: Estimate
    channels: tuple[Channel, ...]
    share: tuple[float, ...]
    check: Check | None
    lammps: float | None
    warnings: tuple[str, ...]

    def __repr__(self) -> str:
        found = ", ".join(f"{name} = {value:.6g}" for name, value in zip(self.names, self.value, strict=True))
        return f"<fit: {found[:150]}>"

    def _repr_html_(self) -> str:
        columns = zip(self.names, self.start, self.value, self.low, self.high, strict=True)
        rows = [
            (name, *("-" if number is None else f"{number:.6g}" for number in numbers)) for name, *numbers in columns
        ]
        notes = "".join(html.text(f"warning: {warning}") for warning in self.warnings)
        return html.table(repr(self)[1:4], ("free", "start", "found", "95% from", "to"), rows) + notes

    def plain(self) -> dict[str, Any]:
        """For ``fit.json``.

        | key         | what                                                                        |
        |-------------|-----------------------------------------------------------------------------|
        | free        | per field: start, value, low and high (95%); null where the data tell nothing |
        | correlation | of the logarithms, in the order of ``free``                                 |
        | channels    | per channel: noise in its unit, over its largest value, correlation of neighbouring residuals |
        | rows        | values fitted                                                               |
        | widened     | how many times wider intervals are than of white noise                      |
        | warnings    | what the data cannot tell                                                   |
        | lammps      | error of its run in V; largest difference from the reference's traces over the noise |
        """
        columns = zip(self.names, self.start, self.value, self.low, self.high, strict=True)
        seen = zip(self.channels, self.found.noise, self.share, self.found.alike, strict=True)
        return {
            "free": {n: {"start": s, "value": v, "low": a, "high": b} for n, s, v, a, b in columns},
            "correlation": self.found.correlation.tolist(),
            "channels": {c.name: {"noise": float(n), "over_largest": s, "alike": float(r)} for c, n, s, r in seen},
            "rows": self.found.rows,
            "widened": self.found.widened,
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
        self.fixed = offset
        self._kept: dict[tuple[float, ...], Trajectory | None] = {}

    def offset(self, parameters: Floats) -> float:
        return self.fixed if self.fixed is not None else float(parameters[-1]) * self.model.unit_time

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
        columns = []
        for place in range(len(parameters)):
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
            columns.append((above - below) / max(width, step))
        return np.stack(columns, axis=-1)

    def aligned(self, logarithms: Floats, size: Floats) -> tuple[float, Floats] | None:
        """Sum of squares, weighed by size, and parameters with the offset at which it is least on a raster."""
        given = self.model.given
        if self.fixed is not None:
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
        best = self._least(rough, frames, shown, size)
        near = best + np.linspace(-1.0, 1.0, 41) * (rough[1] - rough[0] if len(rough) > 1 else unit)
        best = self._least(near, frames, shown, size)
        parameters = np.append(logarithms, best / unit)
        return _squares(self.residuals(parameters) / size), parameters

    def _least(self, offsets: Floats, frames: Floats, shown: Floats, size: Floats) -> float:
        given = self.model.given
        costs = []
        for offset in offsets:
            columns = [np.interp(given.time - offset, frames, column, left=0.0) for column in shown.T]
            costs.append(_squares((given.values - np.stack(columns, axis=1)) / size))
        return float(offsets[int(np.argmin(costs))])


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
    best = search.fields(found.parameters)
    fitted = what.put(scene, best)
    write_text(directory / FITTED, strict_yaml.dump(library.from_plain(fitted, source).plain()))
    check, apart = None, None
    if lammps:
        check, apart = _in_lammps(fitted, source, model, search, found, directory / LAMMPS)
    result = _described(search, found, size, check, apart)
    write_json(directory / REPORT, result.plain())
    _draw(directory, search, found)
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


def _described(search: _Search, found: Estimate, size: Floats, check: Check | None, apart: float | None) -> Fit:
    names = (*search.what.names, *([] if search.fixed is not None else [OFFSET]))
    unit = search.model.unit_time
    count = len(search.what.names)

    def in_units(parameters: Floats) -> list[float]:
        with np.errstate(over="ignore"):
            values = [start * float(np.exp(p)) for start, p in zip(search.what.start, parameters[:count], strict=True)]
        return [*values, *(float(p) * unit for p in parameters[count:])]

    ends = [in_units(found.parameters - found.half_width), in_units(found.parameters + found.half_width)]
    known = np.isfinite(found.half_width)
    low = tuple(min(a, b) if ok else None for a, b, ok in zip(*ends, known, strict=True))
    high = tuple(max(a, b) if ok else None for a, b, ok in zip(*ends, known, strict=True))
    return Fit(
        names=names,
        start=(*search.what.start, *([] if search.fixed is not None else [0.0])),
        value=tuple(in_units(found.parameters)),
        low=low,
        high=high,
        found=found,
        channels=search.model.given.channels,
        share=tuple((found.noise / size).tolist()),
        check=check,
        lammps=apart,
        warnings=tuple(_warnings(names, found)),
    )


def _warnings(names: tuple[str, ...], found: Estimate) -> list[str]:
    said = []
    for group, blind in found.weak:
        words = " and ".join(names[k] for k in group)
        if len(group) == 1:
            said.append(f"the data tell nothing of {words}: leave it out of --free")
        elif blind:
            said.append(f"the data cannot tell {words} apart: only one of them can be free, or other data are needed")
        else:
            r = np.nanmax(np.abs(found.correlation[np.ix_(group, group)] - np.eye(len(group))))
            said.append(
                f"the data hardly tell {words} apart (correlation {r:.4f}): each is surer if the other is given"
            )
    if found.widened > 1.0:
        said.append(
            f"neighbouring residuals are alike, so that intervals are {found.widened:.2g} times wider than of white "
            "noise: noise is filtered, or the scene lacks something that the chain has; see the figure"
        )
    if not found.converged:
        said.append("the search did not come to its end; start from values nearer to the truth")
    return said


def _draw(directory: Path, search: _Search, found: Estimate) -> None:
    from analysis.figures.traces import residual_figure  # matplotlib takes half a second to import

    own = search.traces(found.parameters)
    run = search.trajectory(found.parameters)
    assert own is not None
    assert run is not None
    given = search.model.given
    write_figure(directory, FIGURE, residual_figure(run.problem, given, own, found.noise))


__all__ = ["CONFIDENCE", "FITTED", "REPORT", "Fit", "fit"]
