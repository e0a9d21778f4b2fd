"""Derivatives of quantities of a scene by its fields, from the tangent flow of the reference.

Motion and its derivatives are computed once for all fields (`workflow.engines.reference.derivatives`). A quantity is
then measured in frames that are moved a little along a derivative, both ways, as in any other frames.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import numpy as np

from analysis.trajectory import Floats, Trajectory, blocks
from lammps_inputs import InputError, Problem, library
from lammps_inputs.units import REDUCED
from workflow.engines.reference import engine
from workflow.engines.reference.derivatives import DerivativesOfMotion, Sides, derivatives_of_motion, same_form
from workflow.study_kit import scene_quantities
from workflow.sweep import fields

STEP = 1e-4
"""Relative change of a field, for the central difference of forces: its error is some 1e-9 of it."""

BESIDE = 1e-9
"""Relative change of a field whose value is special, such as a whole exponent, to one that is not."""

MOVED = (1e-5, 2e-5)
"""Largest changes of a velocity, in units of V, along a derivative of the motion where quantities are measured."""

JUMP = 0.1
"""Relative difference of derivatives by these two from which on the quantity is said to have none."""

_NOISE = 1e-9
"""Relative change of a quantity by a relative change of 1 of a field, below which a derivative is that of rounding."""

SAFETY = 3.0
"""Uncertainty over the difference from a run with half the steps, as of the reference itself."""

GOAL, DOUBLINGS = 2e-7, 5
"""Relative difference of a run with half the steps that is aimed for, and how often steps are doubled for it."""

NOT_VARIED = ("duration", "until_bead", "timestep", "accuracy", "output", "window", "scheme")
"""Keys by which nothing is derived: they say how a scene is computed, and for how long."""


@dataclass(frozen=True)
class Derivative:
    """Derivative of a quantity of a scene by one of its fields.

    Attributes:
        quantity: name of the quantity.
        field: dotted path of the field.
        value: the quantity, in the scene's unit; None where it is undefined.
        derivative: change of the quantity over that of the field, in their units; None where the quantity is undefined,
            jumps or bends.
        uncertainty: bound on the error of the derivative by time steps and measurement; None without a derivative.
        unit: unit of the derivative; empty of a number.
        relative: relative change of the quantity over that of the field; None where either is 0 or undefined.
    """

    quantity: str
    field: str
    value: float | None
    derivative: float | None
    uncertainty: float | None
    unit: str
    relative: float | None

    def sentence(self) -> str:
        """The derivative in words."""
        if self.derivative is None or self.uncertainty is None:
            reason = "is undefined" if self.value is None else "jumps or bends, so that it has no derivative"
            return f"{self.quantity} {reason} (by {self.field})"
        unit = f" {self.unit}" if self.unit else ""
        digits = _digits(self.derivative, self.uncertainty)
        share = "" if self.relative is None else f"; 1% more of it makes {self.relative:+.3g}%"
        return (
            f"{self.quantity} changes by {self.derivative:+.{digits}g}{unit} (+- {self.uncertainty:.0e}) per unit of "
            f"{self.field}{share}"
        )


def _digits(value: float, uncertainty: float) -> int:
    """Significant digits that an uncertainty leaves, 2 to 8."""
    if value == 0.0 or uncertainty == 0.0:
        return 8
    return min(8, max(2, 1 + math.floor(math.log10(abs(value) / uncertainty))))


def gradient(
    plain: dict[str, Any], quantities: Sequence[str], by: Sequence[str] | None, source: str
) -> list[Derivative]:
    """Derivatives of quantities of a scene by its fields, with uncertainties.

    Args:
        plain: plain data of the scene.
        quantities: names of quantities (`scene_quantities.KNOWN`), or such as ``amplitude@50``, at a bead.
        by: dotted paths of fields that hold a number other than 0; None for all of the scene.
        source: name of the scene in messages.

    Returns:
        One for each quantity and field, quantity by quantity.

    Raises:
        InputError: a name is that of no quantity or field, the scene cannot be linearised, or a field has no value on
            both sides of its own.
    """
    varied = _Varied.of(plain, tuple(quantities), by, source)
    steps = engine.default_steps_per_frame(varied.problem)
    coarse = varied.derivatives(steps)
    for _ in range(DOUBLINGS):
        steps *= 2
        fine = varied.derivatives(steps)
        change = np.abs(fine.slope - coarse.slope)
        size = np.maximum(np.abs(fine.slope), 1e-300)
        if not np.any(change > GOAL * size):
            break
        coarse = fine
    return list(varied.lines(fine, SAFETY * change + fine.doubt))


@dataclass(frozen=True)
class _Slopes:
    """Derivatives [quantity, field], what measuring leaves in doubt of them, and the quantities [quantity]."""

    value: Floats
    slope: Floats
    doubt: Floats


@dataclass(frozen=True)
class _Varied:
    """A scene and its fields that are varied."""

    plain: dict[str, Any]
    problem: Problem
    quantities: tuple[str, ...]
    values: dict[str, float]
    source: str

    @classmethod
    def of(cls, plain: dict[str, Any], quantities: tuple[str, ...], by: Sequence[str] | None, source: str) -> "_Varied":
        for name in quantities:
            scene_quantities.refuse_unknown(name, source, "quantity")
        scene = scene_quantities.scene_to_run(plain, quantities, source).resolved()
        plain = {key: value for key, value in scene.plain().items() if key not in ("until_bead", "accuracy")}
        names = numbers(plain) if by is None else tuple(dict.fromkeys(by))
        values = {name: _value(plain, name, source) for name in names}
        beside = {
            name: value * (1.0 + BESIDE) for name, value in values.items() if _special(plain, name, value, source)
        }
        plain = fields.put_all(plain, beside)
        return cls(plain, library.from_plain(plain, source).problem(), quantities, values | beside, source)

    def at(self, name: str, value: float) -> dict[str, Any]:
        """The scene with another value of a field."""
        return fields.put_all(self.plain, {name: value})

    def sides(self) -> list[Sides]:
        """Problems on both sides for each field."""
        sides = []
        for name, value in self.values.items():
            low, high = (_problem(self.at(name, value * (1.0 + step)), name, self.source) for step in (-STEP, STEP))
            sides.append(Sides(low, high, 2.0 * STEP * value))
        return sides

    def derivatives(self, steps: int) -> _Slopes:
        """Derivatives with so many steps from frame to frame."""
        motion = derivatives_of_motion(self.problem, self.sides(), steps)
        value = self.measured(self.plain, motion.trajectory())
        slopes, doubts = [], []
        for number, (name, at) in enumerate(self.values.items()):
            fastest = float(np.max(np.abs(motion.dv[number]), initial=0.0))
            near, far = (self.slope(motion, number, name, at, moved, fastest) for moved in MOVED)
            slopes.append((4.0 * near - far) / 3.0)
            doubts.append(np.abs(far - near) / 3.0)
        slope, doubt = np.array(slopes).T, np.array(doubts).T
        noise = _NOISE * np.abs(value)[:, np.newaxis] / np.abs(list(self.values.values()))
        return _Slopes(value, np.where(3.0 * doubt > JUMP * np.abs(slope) + noise, np.nan, slope), doubt + noise)

    def slope(
        self, motion: DerivativesOfMotion, number: int, name: str, at: float, moved: float, fastest: float
    ) -> Floats:
        """Derivatives of the quantities, [quantity], by central differences along the derivative of the motion."""
        change = min(moved / fastest if fastest > 0.0 else math.inf, moved * abs(at))
        sides = []
        for sign in (-1.0, 1.0):
            plain = self.at(name, at + sign * change)
            sides.append(self.measured(plain, motion.moved(number, _problem(plain, name, self.source), sign * change)))
        return np.asarray((sides[1] - sides[0]) / (2.0 * change))

    def measured(self, plain: dict[str, Any], trajectory: Trajectory) -> Floats:
        """Quantities of frames, [quantity], in the scene's units; NaN where undefined."""
        scene = library.from_plain(plain, self.source)
        with np.errstate(all="ignore"):
            values = scene_quantities.of_frames(trajectory.problem, partial(blocks, trajectory), scene, self.quantities)
        return np.array([math.nan if values[name] is None else values[name] for name in self.quantities])

    def lines(self, slopes: _Slopes, uncertainty: Floats) -> Iterator[Derivative]:
        """All derivatives."""
        for place, quantity in enumerate(self.quantities):
            value = _known(slopes.value[place])
            for number, (name, at) in enumerate(self.values.items()):
                slope = _known(slopes.slope[place, number])
                share = None if slope is None or not value else slope * at / value
                doubt = None if slope is None else float(uncertainty[place, number])
                yield Derivative(quantity, name, value, slope, doubt, self.unit(quantity, name), share)

    def unit(self, quantity: str, name: str) -> str:
        """Unit of a quantity over that of a field, such as ``(m/s)/(N/m)``; empty of a number."""
        above, below = (scene_quantities.label(part, self.plain).unit for part in (quantity, name))
        above, below = ("" if unit == REDUCED else unit for unit in (above, below))
        return above if not below else f"({above or '1'})/({below})"


def _known(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _problem(plain: dict[str, Any], name: str, source: str) -> Problem:
    """Problem of a scene with another value of a field.

    Raises:
        InputError: it is no scene.
    """
    try:
        return library.from_plain(plain, source).problem()
    except InputError as error:
        raise InputError(f"{source}: no derivative by {name}: a value beside its own is refused ({error})") from None


def _special(plain: dict[str, Any], name: str, value: float, source: str) -> bool:
    """Whether the equations have another form at a value of a field than on both sides of it.

    Raises:
        InputError: they have different forms on the two sides.
    """
    at, low, high = (
        _problem(fields.put_all(plain, {name: value * (1.0 + step)}), name, source) for step in (0.0, -STEP, STEP)
    )
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
    if isinstance(value, bool) or not isinstance(value, int | float) or value == 0:
        reason = "is not there" if value is None else f"is {str(value)[:60]!r}"
        raise InputError(f"{source}: no derivative by {name}: it {reason}; it needs a number other than 0 in the scene")
    return float(value)


def plain_of(derivatives: Sequence[Derivative]) -> list[dict[str, Any]]:
    """Derivatives as data for JSON."""
    return [asdict(derivative) for derivative in derivatives]
