"""Traces of a scene by the reference at the times of a table, as functions of free fields, gains and time offset."""

import copy
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granchain import InputError, Scene
from granchain.parts import Floats, Problem, Trajectory, channels, engine, fields, library, schemes, traces, units
from workflow.plugins.derivatives import tangent
from workflow.plugins.derivatives.motion import Sides, derivatives_of_motion
from workflow.plugins.derivatives.varied_scene import SceneInUnits, numbers
from workflow.plugins.fit.sensors import Sensors

Mask = NDArray[np.bool_]

_LATER = 8
"""Frames beyond the last time, which the interpolation needs."""

MOST_FRAMES = 2_000_000

STEP = 1e-4
"""Change of a logarithm, for derivatives."""

RASTER = 4000
"""Number of rows, at least, that choose the time offset to begin with; of more rows every second, third, ..."""

OFFSET_STEP = 1e-3
"""Change of the time offset in units of T, for derivatives."""

NO_SCENE = "no scene near these values of the free fields can be computed"


class Model:
    """Traces, residuals and derivatives by parameters.

    Parameters, [parameter], are the logarithms of the free fields over their values in the scene, so that fields keep
    their sign, then those of the sensors, and then the time offset in units of T where it is free. Traces are signals
    where a gain or baseline is free. Frames and steps lie at the same times for all
    parameters, so that small changes of the parameters make small changes of the traces.

    Args:
        scene: plain data of the scene to begin with.
        source: name of the scene in messages.
        names: names of the free fields.
        file: the table, see `analysis.files.traces`.
        offset: time of the table minus time of the scene, in the scene's unit; None where it is free.
        gradient: whether derivatives by fields are those of the tangent flow, not differences.

    Raises:
        InputError: the scene is invalid or has no such channels, or a name is that of no field with a number.
    """

    def __init__(
        self,
        scene: dict[str, Any],
        source: str,
        names: Sequence[str],
        file: Path | traces.TraceFile,
        offset: float | None,
        *,
        gradient: bool = False,
    ) -> None:
        library.from_plain(scene, source)
        self.scene, self.source, self.names = scene, source, tuple(names)
        path = file if isinstance(file, Path) else file.path
        self.path, self.gradient = path, gradient
        self.start = tuple(self._start(name) for name in names)
        if len({_entries(name, scene) for name in names}) < len(names):
            raise InputError(f"--free: {', '.join(names)}: one field is named twice")
        if offset is not None and not math.isfinite(offset):
            raise InputError(f"--offset: {offset} given; a time in the scene's units, such as 0")
        self.measured = measured = traces.load(file)
        if not (names or measured.signals):
            raise InputError("--free: name at least one field, such as coupling.stiffness")
        self.fixed_offset = offset
        start = self._problem(scene, 1.0)
        if start.rows.follow:
            raise InputError(f"{source}: window: rows behind it have no traces; leave it out")
        if gradient:
            tangent.refuse_without_slope(start.system)
        if measured.units and not start.scale.si:
            raise InputError(f"{path}: names units, but {source} has no material, so it is in reduced units")
        channels.check(path, measured.channels, start)
        self.sensors = Sensors.of(
            measured, np.array([getattr(start.scale, channel.quantity) for channel in measured.channels])
        )
        self.unit_time = start.scale.time
        self._si = start.scale.si
        self.every = start.every * start.scale.time
        self._steps = engine.default_steps_per_frame(start)
        lasts = measured.time[-1] - (measured.time[0] if offset is None else min(measured.time[0], offset))
        if lasts / self.every > MOST_FRAMES:
            raise InputError(
                f"{path}: lasts {lasts / self.unit_time:.3g} T, too long to fit; cut it where the pulses have passed "
                "(and see that its times, and --offset, are in the scene's units)"
            )
        self.beads = channels.beads_of(measured.channels, start)
        self._trajectories: dict[tuple[float, ...], Trajectory | None] = {}

    def _start(self, name: str) -> float:
        """Value of a field in the scene."""
        try:
            path = fields.parse(name, self.scene)
        except InputError as error:
            raise InputError(f"--free: {error}") from None
        value = fields.look_up(self.scene, path)
        if reason := fields.no_number(value):
            raise InputError(
                f"{self.source}: {name}: {reason}; a free field needs a number other than 0 in the scene to start from"
            )
        if fields.is_whole(path):
            raise InputError(f"--free: {name} counts something, so it is no number that can change little by little")
        return float(value)

    def symbol(self, quantity: str) -> str:
        """Symbol of the unit of a quantity."""
        return units.SI[quantity] if self._si else units.REDUCED

    @property
    def units(self) -> list[str]:
        """Symbol of the unit of each channel: that of the signal, or the scene's."""
        calibrations = zip(self.measured.channels, self.sensors.calibrations, strict=True)
        return [calibration.unit or self.symbol(channel.quantity) for channel, calibration in calibrations]

    # --- parameters ---

    @property
    def finds_offset(self) -> bool:
        """Whether the last parameter is the offset."""
        return self.fixed_offset is None

    def offset(self, parameters: Floats) -> float:
        """Time of the table minus time of the scene at parameters [parameter], in the scene's unit."""
        return self.fixed_offset if self.fixed_offset is not None else float(parameters[-1]) * self.unit_time

    def of_sensors(self, parameters: Floats) -> Floats:
        """Parameters of the sensors, of all parameters [parameter]."""
        return parameters[len(self.names) : len(self.names) + len(self.sensors.free)]

    def fields(self, parameters: Floats) -> dict[str, float]:
        """Free fields at parameters [parameter]: name -> value in the field's unit."""
        starts = zip(self.names, self.start, parameters, strict=False)
        return {name: start * math.exp(value) for name, start, value in starts}

    def scene_at(self, parameters: Floats) -> dict[str, Any]:
        """Plain data of the scene at parameters [parameter]."""
        return fields.put_all(self.scene, self.fields(parameters))

    # --- runs ---

    def _scene(self, scene: dict[str, Any], duration: float, *, own_step: bool = False) -> Scene:
        """A scene with a duration in the scene's unit, and without its end, accuracy, step and output."""
        dropped = ("until_bead", "accuracy") if own_step else ("until_bead", "accuracy", "timestep")
        plain = {key: value for key, value in scene.items() if key not in dropped}
        return library.from_plain({**plain, "duration": duration, "output": {}}, self.source)

    def _problem(self, scene: dict[str, Any], duration: float, *, own_step: bool = False) -> Problem:
        """Problem of `_scene`."""
        return self._scene(scene, duration, own_step=own_step).problem()

    def _timed(self, problem: Problem, steps: int) -> Problem:
        """A problem with so many steps between frames, which lie at the same times for all parameters."""
        every = self.every / problem.scale.time
        frames = round(problem.duration / every)
        rows = problem.rows.only(self.beads)
        return replace(problem, timestep=every / steps, steps_per_frame=steps, frames=frames, rows=rows)

    def run(self, parameters: Floats, until: float) -> Trajectory:
        """Motion of the beads next to the channels, from the start until a time.

        Args:
            parameters: [parameter].
            until: time in the scene's unit.

        Returns:
            Frames with displacements and velocities [frame, chain, bead].

        Raises:
            InputError: the scene is invalid at these parameters.
            OverflowError: a field has no finite value.
        """
        problem = self._problem(self.scene_at(parameters), self._lasts(until))
        steps = self._steps_of(problem)
        return engine.run(self._timed(problem, steps), steps_per_frame=steps)

    def _lasts(self, until: float) -> float:
        """Duration of a run for traces until a time, both in the scene's unit."""
        return (max(0, math.ceil(until / self.every)) + _LATER) * self.every

    def _steps_of(self, problem: Problem) -> int:
        return max(self._steps, engine.default_steps_per_frame(problem))

    def trajectory(self, parameters: Floats) -> Trajectory | None:
        """Motion at parameters [parameter] over the time of the table; None where the scene is refused."""
        until = float(self.measured.time[-1]) - self.offset(parameters)
        key = (*parameters[: len(self.names)].tolist(), math.ceil(until / self.every))
        if key not in self._trajectories:
            if len(self._trajectories) > 4 * len(parameters) + 4:
                self._trajectories.pop(next(iter(self._trajectories)))
            try:
                self._trajectories[key] = self.run(parameters, until)
            except (InputError, OverflowError):
                self._trajectories[key] = None
        return self._trajectories[key]

    def traces(self, parameters: Floats) -> Floats | None:
        """Traces at parameters [parameter], [row, channel], in the channel's unit; None where the scene is refused."""
        run = self.trajectory(parameters)
        return None if run is None else self._traces_of(run, parameters)

    def values(self, parameters: Floats) -> Floats | None:
        """Traces [row, channel] in the scene's units at parameters [parameter]; None where the scene is refused."""
        run = self.trajectory(parameters)
        return None if run is None else self._values_of(run, parameters)

    def _values_of(self, run: Trajectory, parameters: Floats) -> Floats:
        """Traces of a run, [row, channel], in the scene's units."""
        return channels.read_at(run, self.measured.channels, self.measured.time - self.offset(parameters))

    def _traces_of(self, run: Trajectory, parameters: Floats) -> Floats:
        return self.sensors.signals(self._values_of(run, parameters), self.of_sensors(parameters))

    def numerical_error(self, parameters: Floats, traces: Floats, jumps: Mask) -> Floats:
        """Root mean square, [channel], of the difference of a run with the scene's time step and LAMMPS's scheme.

        Data of such a run differ so much from the traces without any noise.

        Args:
            parameters: [parameter].
            traces: [row, channel] traces of the model at these parameters, in the channel's unit.
            jumps: [row, channel] values that are left out.
        """
        last = max(0.0, float(self.measured.time[-1]) - self.offset(parameters)) + _LATER * self.every
        problem = self._problem(self.scene_at(parameters), last, own_step=True)
        run = engine.run(
            replace(problem, rows=problem.rows.only(self.beads)),
            scheme=schemes.VERLET,
            steps_per_frame=problem.steps_per_frame,
        )
        fitted = np.isfinite(self.measured.values) & ~jumps
        difference = np.where(fitted, self._traces_of(run, parameters) - traces, np.nan)
        return np.asarray(np.sqrt(np.nanmean(difference**2, axis=0)))

    # --- residuals and derivatives ---

    def residuals(self, parameters: Floats) -> Floats:
        """Data minus model at parameters [parameter], [row, channel], in the channel's unit.

        NaN without data; all infinite where the scene is refused.
        """
        values = self.measured.values
        traces = self.traces(parameters)
        if traces is None:
            return np.where(np.isfinite(values), np.inf, np.nan)
        return np.asarray(values - traces)

    def slopes(self, parameters: Floats) -> Floats:
        """Derivatives of the traces at parameters [parameter], [row, channel, parameter].

        Raises:
            InputError: the scene is refused on both sides of the parameters.
        """
        fields = range(len(self.names))
        columns = self._along_flow(parameters) if self.gradient else [self.slope(parameters, k) for k in fields]
        if self.sensors.free:
            values = self.values(parameters)
            if values is None:
                raise InputError(f"{self.source}: {NO_SCENE}")
            columns += [*np.moveaxis(self.sensors.slopes(values), -1, 0)]
        columns += [self.slope(parameters, k) for k in range(len(columns), len(parameters))]
        return np.stack(columns, axis=-1)

    def _along_flow(self, parameters: Floats) -> list[Floats]:
        """Derivatives of the traces, [row, channel], by the logarithms of the fields, from the tangent flow."""
        lasts = self._lasts(float(self.measured.time[-1]) - self.offset(parameters))
        middle = self._problem(self.scene_at(parameters), lasts)
        steps, velocity = self._steps_of(middle), middle.scale.velocity
        sides = []
        for place in range(len(self.names)):
            ends: list[Problem] = []
            for change in (-STEP, STEP):
                moved = parameters.copy()
                moved[place] += change
                beside = SceneInUnits.of(self._scene(self.scene_at(moved), lasts), velocity)
                ends.append(self._timed(beside.problem(), steps))
            sides.append(Sides(tuple(ends), (-STEP, STEP)))
        problem = self._timed(middle, steps)
        motion = derivatives_of_motion(problem, sides, steps)
        traces = self._traces_of(motion.moved(0, 0.0, problem), parameters)
        columns = []
        for place, side in enumerate(sides):
            runs = [motion.moved(place, change, end) for change, end in zip(side.changes, side.problems, strict=True)]
            earlier, later = (self._traces_of(run, parameters) for run in runs)
            columns.append(derivative_beside_jumps(later - traces, traces - earlier, STEP))
        return columns

    def slope(self, parameters: Floats, place: int) -> Floats:
        """Derivative of the traces at parameters [parameter] by one of them, [row, channel]."""
        step = STEP if place < len(self.names) else OFFSET_STEP
        sides = []
        for sign in (1.0, -1.0):
            moved = parameters.copy()
            moved[place] += sign * step
            sides.append(self.traces(moved))
        above, below, middle = *sides, self.traces(parameters)
        ahead = None if above is None or middle is None else above - middle
        behind = None if below is None or middle is None else middle - below
        if ahead is not None and behind is not None:
            return derivative_beside_jumps(ahead, behind, step)
        difference = behind if ahead is None else ahead
        if difference is None:
            raise InputError(f"{self.source}: {NO_SCENE}")
        return np.asarray(difference / step)

    def fixed(self, parameters: Floats) -> tuple[tuple[str, ...], Floats]:
        """Fixed fields that hold a number, and derivatives of the traces by their logarithms.

        Args:
            parameters: [parameter].

        Returns:
            Names of the fields, and derivatives [row, channel, field].
        """
        count = len(self.names)
        names, columns = [], []
        varied = {_entries(name, self.scene) for name in self.names}
        for name in numbers(self.scene):
            if _entries(name, self.scene) in varied:
                continue
            wide = copy.copy(self)
            wide._trajectories = {}
            try:
                wide.names, wide.start = (*self.names, name), (*self.start, self._start(name))
                columns.append(wide.slope(np.insert(parameters, count, 0.0), count))
                names.append(name)
            except InputError:  # no number, or none near it is a scene
                continue
        shape = (*self.measured.values.shape, 0)
        return tuple(names), np.stack(columns, axis=-1) if columns else np.empty(shape)


UNEQUAL = 2.0
"""Ratio of two one-sided differences beyond which a trace jumps within one of them."""


def derivative_beside_jumps(ahead: Floats, behind: Floats, step: float) -> Floats:
    """Derivative from differences over one step to either side, which leaves out jumps.

    A trace jumps at the instant at which a contact with a dashpot closes. A sample that this instant passes within a
    step has a difference of the size of the jump, whatever the step; the other side has the derivative.

    Args:
        ahead, behind: differences over the step above and over the step below, of any shape.
        step: the step.

    Returns:
        The mean of both over the step, or the smaller one where they are `UNEQUAL`; of their shape.
    """
    least, largest = np.minimum(np.abs(ahead), np.abs(behind)), np.maximum(np.abs(ahead), np.abs(behind))
    smooth = (largest <= UNEQUAL * least) & (ahead * behind >= 0.0)
    smaller = np.where(np.abs(ahead) < np.abs(behind), ahead, behind)
    return np.asarray(np.where(smooth, 0.5 * (ahead + behind), smaller) / step)


def _entries(name: str, scene: dict[str, Any]) -> tuple[tuple[str, int], ...]:
    """Keys of a field, each with the number of its entry, 1 where there are no several."""
    return tuple((key, number or 1) for key, number in fields.parse(name, scene))


# --- offset -----------------------------------------------------------------------------------------------------------


def squares(residuals: Floats) -> float:
    """Sum of the squares of residuals [row, channel]; NaN counts as 0."""
    return float(np.nansum(residuals**2))


def aligned(model: Model, logarithms: Floats, size: Floats, *, flipped: bool = False) -> tuple[float, Floats] | None:
    """Choose the offset on a raster, and gains and baselines, with the least sum of squares of residuals over size.

    Args:
        model: the model.
        logarithms: [field] logarithms of the free fields over their values in the scene.
        size: [channel] largest value of the data in the channel's unit.
        flipped: whether the sign of each channel is free in the choice of the offset.

    Returns:
        The sum of squares, and the parameters [parameter]; None where the scene is refused.
    """
    measured, sensors = model.measured, model.sensors
    zeros = np.zeros(len(sensors.free))

    def completed(*offset: float) -> tuple[float, Floats] | None:
        """Sum of squares, and parameters, [parameter], with the best gains and baselines at an offset in units of T."""
        parameters = np.concatenate([logarithms, zeros, offset])
        values = model.values(parameters)
        if values is None:
            return None
        parameters = np.concatenate([logarithms, sensors.best(values, measured.values), offset])
        return squares(model.residuals(parameters) / size), parameters

    if not model.finds_offset:
        return completed()
    span = float(measured.time[-1] - measured.time[0])
    try:
        run = model.run(logarithms, span)
    except (InputError, OverflowError):
        return None
    # traces are interpolated between frames, since thousands of offsets are tried
    frames, unit = run.time * run.problem.scale.time, model.unit_time
    shown = channels.read(run, measured.channels) * [
        getattr(run.problem.scale, channel.quantity) for channel in measured.channels
    ]

    every = max(1, len(measured.time) // RASTER)
    times, data = measured.time[::every], measured.values[::every]

    def cost(offset: float) -> float:
        traces = np.stack([np.interp(times - offset, frames, column, left=0.0) for column in shown.T], axis=1)
        traces = sensors.signals(traces, sensors.best(traces, data))
        sums = np.nansum(((data - traces) / size) ** 2, axis=0)
        if flipped:  # which a free gain may be, too
            sums = np.minimum(sums, np.nansum(((data + traces) / size) ** 2, axis=0))
        return float(np.sum(sums))

    rough = measured.time[0] - span / 2.0 + np.arange(0.0, 1.5 * span, max(0.5 * unit, span / 2000.0))
    best = min(rough, key=cost)
    best = min(best + np.linspace(-1.0, 1.0, 41) * (rough[1] - rough[0] if len(rough) > 1 else unit), key=cost)
    return completed(best / unit)


def reversed_channels(model: Model, parameters: Floats, size: Floats) -> tuple[traces.Channel, ...]:
    """Channels whose opposite sign at least halves the sum of squares, near parameters or the start.

    A signal whose gain or baseline is free is none of them.

    Args:
        model: the model.
        parameters: [parameter].
        size: [channel] largest value of the data in the channel's unit.
    """
    measured = model.measured
    count = len(model.names)
    flipped: tuple[traces.Channel, ...] = ()
    least = 0.5 * squares(model.residuals(parameters) / size)
    for point in (parameters[:count], np.zeros(count)):
        best = aligned(model, point, size, flipped=True)
        computed = None if best is None else model.traces(best[1])
        if computed is None:
            continue
        signs = np.where(np.nansum(measured.values * computed, axis=0) < 0.0, -1.0, 1.0)
        signs[[*measured.signals]] = 1.0  # a gain has either sign
        cost = squares((measured.values - signs * computed) / size)
        if cost < least:
            least = cost
            flipped = tuple(channel for channel, sign in zip(measured.channels, signs, strict=True) if sign < 0.0)
    return flipped
