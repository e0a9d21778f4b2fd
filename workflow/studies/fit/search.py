"""Residuals of a scene with other values of its free fields, and their derivatives."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from analysis.trajectory import Floats, Trajectory
from lammps_inputs import InputError
from workflow.studies.fit.fields import Free, free
from workflow.studies.fit.model import Model
from workflow.sweep import fields

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
