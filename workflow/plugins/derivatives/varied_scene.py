"""A scene whose fields are varied: its motion with derivatives by them, and quantities in frames moved a little.

Motion and its derivatives are computed once for all fields (`workflow.plugins.derivatives.motion`). A quantity is
then measured in frames that are moved a little along a derivative, both ways, as in any other frames.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from granchain import InputError, Scene
from granchain.parts import Floats, Problem, Trajectory, engine, evaluate, fields, library, rates
from workflow.plugins.derivatives import tangent
from workflow.plugins.derivatives.motion import (
    MOST_BYTES,
    DerivativesOfMotion,
    Sides,
    bytes_of_frames,
    derivatives_of_motion,
    same_form,
)

SIDES = (-1e-4, -5e-5, 5e-5, 1e-4)
"""Relative changes of a field, for central differences of forces."""

BESIDE = 1e-9
"""Relative change of a field whose value is special, such as an exponent of 1.5, to one that is not."""

JUMP = 0.1
"""Relative difference of derivatives by two changes from which on the quantity is said to have none."""

_CURVED = 1e3
"""Largest second derivative of a smooth quantity by the logarithm of a field, over the quantity."""

FRAMES = 2.0 / engine.STEPS_PER_BOUND
"""Largest time between frames over the stability bound of velocity Verlet: 0.1 T in the paper's scenes."""

HALVED_FRAMES = 3
"""How often times between frames are halved at most: then interpolation is far more accurate than steps."""

NOT_VARIED = ("duration", "until_bead", "timestep", "accuracy", "output", "window", "scheme")
"""Keys by which nothing is derived: they say how a scene is computed, and for how long."""


class SceneInUnits(Scene):
    """A scene whose unit of velocity is another's: that of a scene's own is no smooth function of several kicks."""

    unit_of_velocity: float

    @classmethod
    def of(cls, scene: Scene, unit_of_velocity: float) -> "SceneInUnits":
        """A scene with a unit of velocity."""
        parts = {name: getattr(scene, name) for name in Scene.model_fields}
        return cls.model_construct(**parts, unit_of_velocity=unit_of_velocity)

    def _speed(self) -> float:
        return self.unit_of_velocity


@dataclass(frozen=True)
class VariedScene:
    """A scene and its fields that are varied.

    Attributes:
        plain: the scene.
        problem: its problem.
        quantities: names of quantities.
        values: field -> value.
        source: name of the scene in messages.
    """

    plain: dict[str, Any]
    problem: Problem
    quantities: tuple[str, ...]
    values: dict[str, float]
    source: str

    @classmethod
    def of(cls, plain: dict[str, Any], quantities: tuple[str, ...], by: Sequence[str] | None, source: str) -> Self:
        """A scene with its duration, time step and output written out."""
        every = plain.get("output", {}).get("every")
        plain = {key: value for key, value in plain.items() if key not in ("timestep", "accuracy")}
        scene = with_short_frames(evaluate.scene_to_run(plain, quantities, source), every)
        plain = {key: value for key, value in scene.plain().items() if key != "until_bead"}
        try:
            tangent.refuse_without_slope(scene.system)
        except InputError as error:
            raise InputError(f"{source}: {error}") from None
        values: dict[str, float] = {}
        for name in numbers(plain) if by is None else by:
            try:
                value = _value(plain, name, source)
                values[name] = value * (1.0 + BESIDE) if _special(plain, name, value, source) else value
            except InputError:
                if by is not None:
                    raise
        if not values:
            reason = "the scene holds no number by which there are derivatives" if by is None else "no field is named"
            raise InputError(f"{source}: --by: {reason}")
        plain = fields.put_all(plain, values)
        return cls(plain, library.from_plain(plain, source).problem(), quantities, values, source)

    def at(self, name: str, value: float) -> Scene:
        """The scene with another value of a field, in this scene's unit of velocity."""
        return _in_units(self.plain, name, value, self.problem.scale.velocity, self.source)

    @cached_property
    def sides(self) -> list[Sides]:
        """Problems beside the scene's, for each field."""
        sides = []
        for name, value in self.values.items():
            ends = tuple(self.at(name, value * (1.0 + change)).problem() for change in SIDES)
            sides.append(Sides(ends, tuple(value * change for change in SIDES)))
        return sides

    def fits(self, halvings: int) -> bool:
        """Whether the frames of `motion` do not take too much memory."""
        problem = _halved(self.problem, min(halvings, HALVED_FRAMES))
        return bytes_of_frames(problem, len(self.values)) <= MOST_BYTES

    def motion(self, halvings: int) -> DerivativesOfMotion:
        """The motion and its derivatives, with steps and, up to `HALVED_FRAMES`, times between frames halved so often.

        Raises:
            InputError: the frames would take too much memory.
        """
        if not self.fits(halvings):
            raise InputError(
                f"{self.source}: the frames of {len(self.values)} derivatives would take more than "
                f"{MOST_BYTES / 1e9:g} GB of memory; name fewer fields with `--by`, or take a shorter `duration`"
            )
        of_frames = min(halvings, HALVED_FRAMES)
        steps = engine.default_steps_per_frame(self.problem) * 2 ** (halvings - of_frames)
        sides = [
            Sides(tuple(_halved(side, of_frames) for side in beside.problems), beside.changes) for beside in self.sides
        ]
        return derivatives_of_motion(_halved(self.problem, of_frames), sides, steps)

    def slopes(self, motion: DerivativesOfMotion, middle: Floats, moved: float) -> Floats:
        """Derivatives [quantity, field] by central differences along derivatives of the motion; NaN where undefined.

        Args:
            motion: the motion and its derivatives.
            middle: quantities of the motion, [quantity].
            moved: largest change of a velocity, in units of V.
        """
        slopes = []
        for number, (name, value) in enumerate(self.values.items()):
            change = motion.small(number, abs(value), moved)
            low, high = (self._moved(motion, number, name, side) for side in (-change, change))
            bend = np.abs(high - 2.0 * middle + low) - _CURVED * (change / value) ** 2 * np.abs(middle)
            bends = bend > JUMP * np.abs(high - low)
            slopes.append(np.where(bends, np.nan, (high - low) / (2.0 * change)))
        return np.array(slopes).T

    def unmoved(self, motion: DerivativesOfMotion) -> Floats:
        """Quantities of the motion, [quantity]."""
        return self.measured(library.from_plain(self.plain, self.source), motion.trajectory())

    def _moved(self, motion: DerivativesOfMotion, number: int, name: str, change: float) -> Floats:
        """Quantities, [quantity], in frames that are moved by a change of a field."""
        value = self.values[name] + change
        scene = library.from_plain(fields.put_all(self.plain, {name: value}), self.source)
        problem = scene.problem()
        problem = _halved(problem, round(math.log2(motion.problem.frames / problem.frames)))
        return self.measured(scene, motion.moved(number, change, problem, self.at(name, value).scale))

    def measured(self, scene: Scene, trajectory: Trajectory) -> Floats:
        """Quantities of frames, [quantity], in the scene's units; NaN where undefined."""
        with np.errstate(all="ignore"):
            values = evaluate.of_frames(trajectory.problem, trajectory.blocks, scene, self.quantities)
        return np.array([math.nan if values[name] is None else values[name] for name in self.quantities])


def with_short_frames(scene: Scene, every: float | None) -> Scene:
    """A scene with its duration, time step and output written out, whose frames resolve the fastest motion.

    Args:
        scene: a scene with a duration.
        every: time between its frames, in its units; None for the default. It lasts a whole number of these.
    """
    output = scene.output.model_copy(update={"every": every})
    scene = scene.model_copy(update={"timestep": None, "accuracy": None, "output": output}).resolved()
    problem = scene.problem()
    parts = math.ceil(problem.every / (FRAMES * rates.stability_bound(problem.system)) * (1.0 - 1e-9))
    duration = scene.scale.measured(problem.duration, "time")
    output = scene.output.model_copy(update={"every": duration / (problem.frames * parts)})
    return scene.model_copy(update={"timestep": None, "duration": duration, "output": output}).resolved()


def _halved(problem: Problem, halvings: int) -> Problem:
    """A problem with times between frames halved so often."""
    parts = 2**halvings
    return replace(problem, timestep=problem.timestep / parts, frames=problem.frames * parts)


def _in_units(plain: dict[str, Any], name: str, value: float, unit_of_velocity: float, source: str) -> Scene:
    """A scene with another value of a field, in a unit of velocity.

    Raises:
        InputError: it is no scene.
    """
    try:
        scene = library.from_plain(fields.put_all(plain, {name: value}), source)
    except InputError as error:
        raise InputError(f"{source}: no derivative by {name}: a value beside its own is refused ({error})") from None
    return SceneInUnits.of(scene, unit_of_velocity)


def _special(plain: dict[str, Any], name: str, value: float, source: str) -> bool:
    """Whether the equations have another form at a value of a field than on both sides of it.

    Raises:
        InputError: they have different forms on the two sides.
    """
    values = (value * (1.0 + step) for step in (0.0, *SIDES[1:3]))
    at, low, high = (_in_units(plain, name, beside, 1.0, source).problem() for beside in values)
    if not same_form(low, high):
        raise InputError(f"{source}: no derivative by {name}: the form of the equations changes at its value")
    return not same_form(at, low)


def numbers(plain: dict[str, Any]) -> tuple[str, ...]:
    """Dotted paths of all fields of a scene by which there may be derivatives: they hold a number other than 0."""
    return tuple(
        name
        for key, part in plain.items()
        if key not in NOT_VARIED
        for name, value in fields.held({key: part})
        if value != 0 and not fields.is_whole(fields.parse(name, plain))
    )


def _value(plain: dict[str, Any], name: str, source: str) -> float:
    """The number that a field holds.

    Raises:
        InputError: it holds none, or one that cannot change little by little.
    """
    path = fields.parse(name, plain)
    value = fields.look_up(plain, path)
    if path[0][0] in NOT_VARIED:
        raise InputError(f"{source}: no derivative by {name}: it says how, or how long, a scene is computed")
    if fields.is_whole(path):
        raise InputError(f"{source}: no derivative by {name}: it counts something")
    if reason := fields.no_number(value):
        raise InputError(f"{source}: no derivative by {name}: it {reason}; it needs a number other than 0 in the scene")
    return float(value)
