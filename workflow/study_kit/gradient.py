"""Derivatives of quantities of a scene by its fields, from the tangent flow of the reference.

Motion and its derivatives are computed once for all fields (`workflow.engines.reference.derivatives`). A quantity is
then measured in frames that are moved a little along a derivative, both ways, as in any other frames.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property, partial
from typing import Any, Self

import numpy as np

from analysis.trajectory import Floats, Trajectory, blocks
from lammps_inputs import InputError, Problem, Scene, library
from lammps_inputs.numbers import known
from lammps_inputs.units import REDUCED
from workflow.engines.reference import engine, tangent
from workflow.engines.reference.derivatives import DerivativesOfMotion, Sides, derivatives_of_motion, same_form
from workflow.runs.engines import ENGINES
from workflow.runs.files import write_text
from workflow.runs.output_directory import claim
from workflow.runs.run_directory import RunDirectory
from workflow.screen import count_bar
from workflow.study_kit import scene_quantities
from workflow.study_kit.directory import csv_text
from workflow.sweep import fields
from workflow.verdicts.analyse import Analysis
from workflow.verdicts.derivative import Derivative

SIDES = (-1e-4, -5e-5, 5e-5, 1e-4)
"""Relative changes of a field, for central differences of forces."""

FORCES = 1e-7
"""Relative error of these differences: rounding of the way of beads whose motion is given; mostly far below."""

BESIDE = 1e-9
"""Relative change of a field whose value is special, such as an exponent of 1.5, to one that is not."""

NEAR, FAR = 1e-5, 2e-5
"""Largest changes of a velocity, in units of V, along a derivative of the motion where quantities are measured."""

JUMP = 0.1
"""Relative difference of derivatives by these two from which on the quantity is said to have none."""

_CURVED = 1e3
"""Largest second derivative of a smooth quantity by the logarithm of a field, over the quantity."""

_NOISE = 1e-9
"""Relative change of a quantity by a relative change of 1 of a field, below which a derivative is that of rounding."""

SAFETY = 3.0
"""Uncertainty over the difference from a run with half the steps, as of the reference itself."""

GOAL, DOUBLINGS = 2e-7, 5
"""Relative difference of a run with half the steps that is aimed for, and how often steps are doubled for it."""

GRADIENT = "gradient.csv"
"""File of the derivatives in a run's directory."""

NOT_VARIED = ("duration", "until_bead", "timestep", "accuracy", "output", "window", "scheme")
"""Keys by which nothing is derived: they say how a scene is computed, and for how long."""


def gradient(
    plain: dict[str, Any], quantities: Sequence[str], by: Sequence[str] | None, source: str
) -> list[Derivative]:
    """Derivatives of quantities of a scene by its fields, with uncertainties.

    Args:
        plain: plain data of the scene.
        quantities: names of quantities (`scene_quantities.KNOWN`), or such as ``peak_velocity@50``, at a bead.
        by: dotted paths of fields that hold a number other than 0; None for all of the scene.
        source: name of the scene in messages.

    Returns:
        One for each quantity and field, quantity by quantity.

    Raises:
        InputError: a name is that of no quantity or field, the scene cannot be linearised, or a field has no value on
            both sides of its own.
    """
    varied = _Varied.of(plain, tuple(dict.fromkeys(quantities)), by, source)
    steps = engine.default_steps_per_frame(varied.problem)
    with count_bar("derivatives") as count:
        motion = varied.motion(steps)
        coarse = varied.slopes(motion, varied.unmoved(motion), NEAR)
        for done in range(DOUBLINGS):
            count(done, DOUBLINGS)
            steps *= 2
            motion = varied.motion(steps)
            middle = varied.unmoved(motion)
            slopes = varied.slopes(motion, middle, NEAR)
            change = np.abs(slopes - coarse)
            if not np.any(change > GOAL * np.abs(slopes)):
                break
            coarse = slopes
        farther = varied.slopes(motion, middle, FAR)
        return list(varied.lines(middle, (slopes, farther), change))


def values_and_slopes(plain: dict[str, Any], names: Sequence[str], by: Sequence[str], source: str) -> dict[str, Any]:
    """What a process answers: ``values`` [quantity] and ``slopes`` [quantity, field], None where undefined.

    Steps are twice those of the reference's default. A scene that has no derivatives is ``refused``, with the reason.

    Args:
        plain: plain data of the scene.
        names: names of the quantities.
        by: dotted paths of the fields.
        source: name of the scene in messages.
    """
    try:
        varied = _Varied.of(plain, tuple(names), by, source)
        motion = varied.motion(2 * engine.default_steps_per_frame(varied.problem))
        values = varied.unmoved(motion)
        slopes = varied.slopes(motion, values, NEAR)
    except (InputError, ValueError, ArithmeticError) as error:
        return {"refused": str(error)}
    return {"values": list(map(known, values.tolist())), "slopes": [list(map(known, row)) for row in slopes.tolist()]}


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
class _Varied:
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
        for name in quantities:
            scene_quantities.refuse_unknown(name, source, "quantity")
        scene = scene_quantities.scene_to_run(plain, quantities, source)
        scene = scene.model_copy(update={"accuracy": None}).resolved()
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

    def motion(self, steps: int) -> DerivativesOfMotion:
        """The motion and its derivatives, with so many steps from frame to frame."""
        return derivatives_of_motion(self.problem, self.sides, steps)

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
        return self.measured(scene, motion.moved(number, change, scene.problem(), self.at(name, value).scale))

    def measured(self, scene: Scene, trajectory: Trajectory) -> Floats:
        """Quantities of frames, [quantity], in the scene's units; NaN where undefined."""
        with np.errstate(all="ignore"):
            values = scene_quantities.of_frames(trajectory.problem, partial(blocks, trajectory), scene, self.quantities)
        return np.array([math.nan if values[name] is None else values[name] for name in self.quantities])

    def lines(self, middle: Floats, slopes: tuple[Floats, Floats], change: Floats) -> Iterator[Derivative]:
        """All derivatives.

        Args:
            middle: quantities of the motion, [quantity].
            slopes: derivatives by moving frames by `NEAR` and by `FAR`, [quantity, field] each.
            change: change of the first by the last doubling of the steps.
        """
        near, far = slopes
        bend = (far - near) / 3.0
        for place, quantity in enumerate(self.quantities):
            value = known(float(middle[place]))
            for number, (name, at) in enumerate(self.values.items()):
                slope = float(near[place, number] - bend[place, number])
                noise = 0.0 if value is None else _NOISE * abs(value / at)
                doubt = abs(float(bend[place, number])) + noise
                unit = self._unit(quantity, name)
                if not 3.0 * (doubt - noise) <= JUMP * abs(slope) + noise:  # NaN, too
                    yield Derivative(quantity, name, value, None, None, unit, None)
                    continue
                uncertainty = SAFETY * float(change[place, number]) + doubt + FORCES * abs(slope)
                yield Derivative(quantity, name, value, slope, uncertainty, unit, slope * at / value if value else None)

    def _unit(self, quantity: str, name: str) -> str:
        """Unit of a quantity over that of a field, such as ``(m/s)/(N/m)``; empty of a number."""
        units = [scene_quantities.label(part, self.plain).unit for part in (quantity, name)]
        above, below = ("" if unit == REDUCED else unit for unit in units)
        return above if not below else f"({above or '1'})/({below})"


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


def of_run(directory: RunDirectory, quantities: Sequence[str], by: Sequence[str] | None) -> tuple[Derivative, ...]:
    """Derivatives for the scene of a run; nothing is written.

    Args:
        directory: the run's directory.
        quantities: names of quantities.
        by: dotted paths of fields; None for all numbers of the scene.

    Raises:
        InputError: see `gradient`; or the beads of the run do not deform.
    """
    if not ENGINES[directory.engine].deforms:
        raise InputError(f"--gradient: {directory.path} is a run of rigid beads, which has no derivatives")
    return tuple(gradient(directory.scene.plain(), quantities, by, str(directory.path)))


def with_derivatives(analysis: Analysis, directory: RunDirectory, derivatives: tuple[Derivative, ...]) -> Analysis:
    """The analysis of a run with derivatives, which are also written beside the frames.

    Raises:
        InputError: another file of that name stands there.
    """
    if not derivatives:
        return analysis
    claim(directory.path, [GRADIENT])
    write_text(directory.path / GRADIENT, csv_text([asdict(derivative) for derivative in derivatives]))
    return replace(analysis, tables=(*analysis.tables, GRADIENT), derivatives=derivatives)
