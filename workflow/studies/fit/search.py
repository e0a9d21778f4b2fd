"""Free fields of a scene, the residuals of a scene with other values of them, and the offset to begin a search with."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from analysis.files.traces import Channel
from analysis.gauges.channels import read
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import InputError
from workflow.studies.fit.model import Model
from workflow.sweep import fields

# --- fields -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Free:
    """Fields that are to be found; each is its starting value times the exponential of a parameter, so keeps its sign.

    Attributes:
        names: as the user wrote them.
        start: their values in the scene.
    """

    names: tuple[str, ...]
    start: tuple[float, ...]

    def values(self, logarithms: Any) -> list[float]:
        """Of the fields, from the parameters."""
        return [start * math.exp(value) for start, value in zip(self.start, logarithms, strict=True)]

    def put(self, scene: dict[str, Any], values: list[float]) -> dict[str, Any]:
        """Plain data of the scene with these values."""
        return fields.put_all(scene, dict(zip(self.names, values, strict=True)))


def free(names: list[str], scene: dict[str, Any], source: str) -> Free:
    """Fields by name, with what the scene has there.

    Raises:
        InputError: no field, one twice, or one that holds no number to start from.
    """
    if not names:
        raise InputError("--free: name at least one field, such as coupling.stiffness")
    start = []
    for name in names:
        try:
            path = fields.parse(name, scene)
        except InputError as error:
            raise InputError(f"--free: {error}") from None
        if names.count(name) > 1:
            raise InputError(f"--free: {name} is named twice")
        value = fields.look_up(scene, path)
        if isinstance(value, bool) or not isinstance(value, int | float) or value == 0:
            found = "is not there" if value is None else f"is {str(value)[:60]!r}"
            raise InputError(
                f"{source}: {name}: {found}; a free field needs a number other than 0 in the scene to start from"
            )
        if fields.is_whole(path):
            raise InputError(f"--free: {name} counts something, so it is no number that can change little by little")
        start.append(float(value))
    return Free(tuple(names), tuple(start))


# --- search -----------------------------------------------------------------------------------------------------------

STEP = 1e-4
"""Of logarithms, for derivatives."""

OFFSET_STEP = 1e-3
"""Of the time offset, in units of T, likewise."""

NO_MODEL = ("duration", "until_bead", "timestep", "accuracy", "output")
"""Keys that traces do not depend on."""

NO_SCENE = "no scene near these values of the free fields can be computed"


class Search:
    """Residuals and derivatives by parameters: logarithms of the fields, then the offset in units of T if free.

    Args:
        model: what computes traces.
        what: free fields.
        scene: plain data of the scene to begin with.
        offset: by how much the table's times are later than the scene's, in its units; None where it is free.
    """

    def __init__(self, model: Model, what: Free, scene: dict[str, Any], offset: float | None) -> None:
        self.model, self.what, self.scene = model, what, scene
        self.fixed_offset = offset
        self._kept: dict[tuple[float, ...], Trajectory | None] = {}

    @property
    def finds_offset(self) -> bool:
        """Whether the last parameter is the offset."""
        return self.fixed_offset is None

    def offset(self, parameters: Floats) -> float:
        """In the scene's units of time."""
        return self.fixed_offset if self.fixed_offset is not None else float(parameters[-1]) * self.model.unit_time

    def fields(self, parameters: Floats) -> list[float]:
        """Values of the free fields."""
        return self.what.values(parameters[: len(self.what.names)])

    def trajectory(self, parameters: Floats) -> Trajectory | None:
        """Of the beads that matter; None where the scene is refused."""
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
        """[row, channel]; None where the scene is refused."""
        run = self.trajectory(parameters)
        return None if run is None else self.model.traces(run, self.offset(parameters))

    def residuals(self, parameters: Floats) -> Floats:
        """Data minus model, [row, channel]; NaN without data; all infinite where the scene is refused."""
        values = self.model.given.values
        found = self.traces(parameters)
        if found is None:
            return np.where(np.isfinite(values), np.inf, np.nan)
        return np.asarray(values - found)

    def slopes(self, parameters: Floats) -> Floats:
        """Derivatives of the traces, [row, channel, parameter]."""
        return np.stack([self.slope(parameters, place) for place in range(len(parameters))], axis=-1)

    def slope(self, parameters: Floats, place: int) -> Floats:
        """Derivative of the traces by one parameter, [row, channel]."""
        step = STEP if place < len(self.what.names) else OFFSET_STEP
        sides = []
        for sign in (1.0, -1.0):
            moved = parameters.copy()
            moved[place] += sign * step
            sides.append(self.traces(moved))
        count = sum(side is not None for side in sides)
        middle = self.traces(parameters) if count < 2 else None
        above, below = (middle if side is None else side for side in sides)
        if above is None or below is None:
            raise InputError(f"{self.model.source}: {NO_SCENE}")
        return np.asarray((above - below) / (step * max(count, 1)))

    def fixed(self, parameters: Floats) -> tuple[tuple[str, ...], Floats]:
        """Fixed fields that hold a number, and derivatives of the traces by their logarithms, [row, channel, field]."""
        count = len(self.what.names)
        names, columns = [], []
        varied = {_entries(name) for name in self.what.names}
        for name in _numbers(self.scene):
            if _entries(name) in varied:
                continue
            try:
                one = free([name], self.scene, self.model.source)
                wide = Free((*self.what.names, name), self.what.start + one.start)
                search = Search(self.model, wide, self.scene, self.fixed_offset)
                columns.append(search.slope(np.insert(parameters, count, 0.0), count))
                names.append(name)
            except InputError:  # no number, or none near it is a scene
                continue
        shape = (*self.model.given.values.shape, 0)
        return tuple(names), np.stack(columns, axis=-1) if columns else np.empty(shape)


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


# --- offset -----------------------------------------------------------------------------------------------------------


def squares(residuals: Floats) -> float:
    """Sum of squares, of what is known."""
    return float(np.nansum(residuals**2))


def aligned(search: Search, logarithms: Floats, size: Floats, *, flipped: bool = False) -> tuple[float, Floats] | None:
    """Sum of squares, weighed by size, and parameters with the offset at which it is least on a raster.

    With ``flipped`` the offset is that at which it is least where the sign of each channel is free. None where the
    scene is refused.
    """
    given = search.model.given
    if not search.finds_offset:
        return squares(search.residuals(logarithms) / size), logarithms
    span = float(given.time[-1] - given.time[0])
    try:
        run = search.model.run(search.what.put(search.scene, search.what.values(logarithms)), span)
    except (InputError, OverflowError):
        return None
    # with traces at the frames, since thousands of offsets are tried
    frames, unit = run.time * run.problem.scale.time, search.model.unit_time
    shown = read(run, given.channels) * [getattr(run.problem.scale, channel.quantity) for channel in given.channels]

    def cost(offset: float) -> float:
        traces = np.stack([np.interp(given.time - offset, frames, column, left=0.0) for column in shown.T], axis=1)
        found = np.nansum(((given.values - traces) / size) ** 2, axis=0)
        if flipped:
            found = np.minimum(found, np.nansum(((given.values + traces) / size) ** 2, axis=0))
        return float(np.sum(found))

    rough = given.time[0] - span / 2.0 + np.arange(0.0, 1.5 * span, max(0.5 * unit, span / 2000.0))
    best = min(rough, key=cost)
    best = min(best + np.linspace(-1.0, 1.0, 41) * (rough[1] - rough[0] if len(rough) > 1 else unit), key=cost)
    parameters = np.append(logarithms, best / unit)
    return squares(search.residuals(parameters) / size), parameters


def reversed_channels(search: Search, parameters: Floats, size: Floats) -> tuple[Channel, ...]:
    """Channels whose opposite sign at least halves the sum of squares, near these parameters or the start."""
    given = search.model.given
    count = len(search.what.names)
    found: tuple[Channel, ...] = ()
    least = 0.5 * squares(search.residuals(parameters) / size)
    for point in (parameters[:count], np.zeros(count)):
        best = aligned(search, point, size, flipped=True)
        traces = None if best is None else search.traces(best[1])
        if traces is None:
            continue
        signs = np.where(np.nansum(given.values * traces, axis=0) < 0.0, -1.0, 1.0)
        cost = squares((given.values - signs * traces) / size)
        if cost < least:
            least = cost
            found = tuple(channel for channel, sign in zip(given.channels, signs, strict=True) if sign < 0.0)
    return found
