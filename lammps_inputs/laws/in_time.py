"""Laws in time: of what is done to a bead from outside, a force or a prescribed motion.

A law is a formula or a table. It gives four functions, each the slope of the next: ``rate``, ``force``, ``impulse`` and
``travel``, those of a free bead of mass 1 under the force. Of a prescribed motion ``travel`` is the displacement,
``impulse`` the velocity and ``force`` the acceleration. Constants of integration are any, for only differences count.

A law is a subclass of `TimeLaw` that declares its parameters, as a law on a link does. Its functions take the time
``t`` and the parameters, as scalars or arrays, and are written without branches.
"""

# ruff: noqa: ARG004  every function of a law takes all of its parameters
import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lammps_inputs.laws import Parameters
from lammps_inputs.numbers import text

Floats = NDArray[np.float64]

MOST_IN_FORMULA = 50
"""Largest number of points of a table that is a formula of LAMMPS, which reads it again at every step; longer tables
are vectors (`lammps_inputs.laws.table_lines`).
"""


_NUMBER: Any = 0.0

_EARLIER = 1.0 - 1e-12
"""Factor on times at which a prescribed velocity may jump, so that it has done so in every engine's state at such a
time, whose rounding is less."""

_ROUNDING = 1e-9
"""Jump of a prescribed velocity, over its largest size, that is rounding."""


class TimeLaw(Parameters):
    """Force or prescribed motion in time, and what a law is where it does not say otherwise.

    Attributes:
        omega: angular frequency with which the force oscillates for ever, in units of 1 / T; 0 where it does not.
        jumps: whether the force jumps later than at the start.
        points: number of points between which LAMMPS interpolates; 0 of a formula.
        long: whether these are too many for a formula of LAMMPS.
        numbers: numbers by which a user gives the law, by name, which a deck has as variables; none of a table.
    """

    omega, points = _NUMBER, 0
    jumps, long = False, False

    @staticmethod
    def force(*args: Any, **kwargs: Any) -> Any:
        """Force at a time; on the right where it jumps."""
        raise NotImplementedError

    @staticmethod
    def rate(*args: Any, **kwargs: Any) -> Any:
        """Slope of the force over time; on the right where it jumps."""
        raise NotImplementedError

    @staticmethod
    def impulse(*args: Any, **kwargs: Any) -> Any:
        """Integral of the force, from any time on, which the reference's kernel compiles."""
        raise NotImplementedError

    @staticmethod
    def travel(*args: Any, **kwargs: Any) -> Any:
        """Integral of the impulse, from any time on, which the reference's kernel compiles."""
        raise NotImplementedError

    @property
    def kinks(self) -> tuple[float, ...]:
        """Times between which the force is smooth, from the first at which it acts to the last, which may be inf."""
        raise NotImplementedError

    @property
    def total(self) -> float:
        """Integral of the force's size, of one that never ends over half a period."""
        raise NotImplementedError

    @property
    def fastest(self) -> float:
        """Velocity of largest size of a prescribed motion."""
        raise NotImplementedError

    @property
    def leaps(self) -> tuple[float, ...]:
        """Times just after which the velocity of a prescribed motion has jumped, the start apart."""
        return ()

    @property
    def numbers(self) -> dict[str, float]:
        """Numbers by which a user gives the law; none of a table."""
        return {}

    def of(self, *numbers: float) -> "TimeLaw":
        """The law of other `numbers`."""
        return type(self)(*numbers)

    def formula(self, name: str) -> str:
        """Integral of the force over a step of LAMMPS, as a formula of its variables.

        The step is from ``v_NAMEfrom`` to ``v_NAMEto``, both within the time in which the force acts.
        """
        raise NotImplementedError

    def course(self, name: str) -> tuple[str, str]:
        """Displacement and velocity of a prescribed motion at a time step of LAMMPS, as formulas of its variables."""
        raise NotImplementedError

    def start(self, name: str) -> str:
        """Velocity of a prescribed motion at the start, as a formula of LAMMPS's variables."""
        raise NotImplementedError

    def variables(self, name: str) -> tuple[str, ...]:
        """Deck variables with the numbers that the formulas name."""
        return tuple(f"variable {name}{key} index {text(value)}" for key, value in self.numbers.items())


# --- formulas ---------------------------------------------------------------------------------------------------------


class Wave(TimeLaw):
    """``peak * sin(omega t + phase)`` from the start until the duration is over, half a period, or for ever."""

    peak: float
    angular_frequency: float
    phase: float
    duration: float

    @staticmethod
    def force(t: Any, peak: Any, omega: Any, phase: Any, duration: Any) -> Any:
        """Force at a time."""
        return peak * np.sin(omega * t + phase) * ((t >= 0.0) & (t < duration))

    @staticmethod
    def rate(t: Any, peak: Any, omega: Any, phase: Any, duration: Any) -> Any:
        """Slope of the force over time; after a jump, the slope on its right."""
        return peak * omega * np.cos(omega * t + phase) * ((t >= 0.0) & (t < duration))

    @staticmethod
    def impulse(t: Any, peak: Any, omega: Any, phase: Any, duration: Any) -> Any:
        """Integral of the force: 0 on average, or after the end, for in numbers that grow digits would be lost."""
        acting = np.minimum(np.maximum(t, 0.0), duration)
        constant = np.cos(phase) * (duration < np.inf)
        return -peak / omega * (np.cos(omega * acting + phase) + constant)

    @staticmethod
    def travel(t: Any, peak: Any, omega: Any, phase: Any, duration: Any) -> Any:
        """Integral of the impulse."""
        acting = np.minimum(np.maximum(t, 0.0), duration)
        constant = np.cos(phase) * (duration < np.inf)
        return -peak / omega * (np.sin(omega * acting + phase) / omega + constant * acting)

    @property
    def kinks(self) -> tuple[float, ...]:
        """Times at which the force starts and ends."""
        return 0.0, self.duration

    @property
    def total(self) -> float:
        """Integral of the force's size over half a period."""
        return 2.0 * abs(self.peak) / self.angular_frequency


class Sine(Wave):
    """``peak * sin(omega t + phase)`` from the start on, for ever."""

    @property
    def omega(self) -> float:
        """Angular frequency."""
        return self.angular_frequency

    @property
    def numbers(self) -> dict[str, float]:
        """Numbers by which a user gives the force."""
        return {"peak": self.peak, "omega": self.omega, "phase": self.phase}

    def of(self, *numbers: float) -> "Sine":
        """The law of other `numbers`."""
        return sine(*numbers)

    def formula(self, name: str) -> str:
        """Integral of the force over a step of LAMMPS; a product, for a difference of cosines would lose digits."""
        turn, start, end = f"0.5*v_{name}omega", f"v_{name}from", f"v_{name}to"
        middle = f"sin({turn}*({start}+{end})+v_{name}phase)"
        return f"2*v_{name}peak/v_{name}omega*{middle}*sin({turn}*({end}-{start}))"


class HalfSine(Wave):
    """``peak * sin(pi t / duration)`` until the duration is over: a hammer, a ball that bounces off."""

    @property
    def total(self) -> float:
        """Integral of the force's size."""
        return 2.0 * abs(self.peak) * self.duration / math.pi

    @property
    def numbers(self) -> dict[str, float]:
        """Numbers by which a user gives the force."""
        return {"peak": self.peak, "duration": self.duration}

    def of(self, *numbers: float) -> "HalfSine":
        """The law of other `numbers`."""
        return half_sine(*numbers)

    def formula(self, name: str) -> str:
        """Integral of the force over a step of LAMMPS, as a formula of its variables."""
        turn = f"PI/v_{name}duration"
        return f"v_{name}peak/({turn})*(cos({turn}*v_{name}from)-cos({turn}*v_{name}to))"


def sine(peak: float, omega: float, phase: float) -> Sine:
    """A force that oscillates for ever, from its peak, angular frequency and phase in radians."""
    return Sine(peak, omega, phase, math.inf)


def half_sine(peak: float, duration: float) -> HalfSine:
    """Half a sine of a force, from its peak and its duration."""
    return HalfSine(peak, math.pi / duration, 0.0, duration)


class Oscillation(TimeLaw):
    """Prescribed displacement ``amplitude * sin(omega t + phase)``."""

    amplitude: float
    omega: float
    phase: float

    kinks = 0.0, math.inf

    @staticmethod
    def rate(t: Any, amplitude: Any, omega: Any, phase: Any) -> Any:
        """Slope of the acceleration over time."""
        return -amplitude * omega * omega * omega * np.cos(omega * t + phase)

    @staticmethod
    def force(t: Any, amplitude: Any, omega: Any, phase: Any) -> Any:
        """Acceleration at a time."""
        return -amplitude * omega * omega * np.sin(omega * t + phase)

    @staticmethod
    def impulse(t: Any, amplitude: Any, omega: Any, phase: Any) -> Any:
        """Velocity at a time."""
        return amplitude * omega * np.cos(omega * t + phase)

    @staticmethod
    def travel(t: Any, amplitude: Any, omega: Any, phase: Any) -> Any:
        """Displacement at a time."""
        return amplitude * np.sin(omega * t + phase)

    @property
    def fastest(self) -> float:
        """Velocity of largest size."""
        return self.amplitude * self.omega

    @property
    def numbers(self) -> dict[str, float]:
        """Numbers by which a user gives the motion."""
        return self.by_name

    def course(self, name: str) -> tuple[str, str]:
        """Displacement from the place at the start, and velocity, as formulas of LAMMPS."""
        turn = f"v_{name}omega*step*v_timestep+v_{name}phase"
        return (
            f"v_{name}amplitude*(sin({turn})-sin(v_{name}phase))",
            f"v_{name}amplitude*v_{name}omega*cos({turn})",
        )

    def start(self, name: str) -> str:
        """Velocity at the start, as a formula of LAMMPS."""
        return f"v_{name}amplitude*v_{name}omega*cos(v_{name}phase)"


# --- tables -----------------------------------------------------------------------------------------------------------


class Table(TimeLaw):
    """Linear pieces of a force, each until the next begins; none before the first. The last has no force, for ever.

    Of a prescribed motion they are pieces of its acceleration, and the velocity may jump between them.
    """

    time: Floats
    """Times at which the pieces begin, ascending."""
    value: Floats
    """Force there."""
    slope: Floats
    """Slope of each piece."""
    gained: Floats
    """Impulse until there."""
    gone: Floats
    """Travel until there."""

    @staticmethod
    def force(t: Any, time: Any, value: Any, slope: Any, gained: Any, gone: Any) -> Any:
        """Force at a time."""
        k = np.maximum(np.searchsorted(time, t, side="right") - 1, 0)
        return (value[k] + slope[k] * (t - time[k])) * (t >= time[0])

    @staticmethod
    def rate(t: Any, time: Any, value: Any, slope: Any, gained: Any, gone: Any) -> Any:
        """Slope of the force over time; after a jump, the slope on its right."""
        k = np.maximum(np.searchsorted(time, t, side="right") - 1, 0)
        return slope[k] * (t >= time[0])

    @staticmethod
    def impulse(t: Any, time: Any, value: Any, slope: Any, gained: Any, gone: Any) -> Any:
        """Integral of the force until a time."""
        k = np.maximum(np.searchsorted(time, t, side="right") - 1, 0)
        s = np.maximum(t - time[k], 0.0)
        return gained[k] + s * (value[k] + 0.5 * slope[k] * s)

    @staticmethod
    def travel(t: Any, time: Any, value: Any, slope: Any, gained: Any, gone: Any) -> Any:
        """Integral of the impulse until a time."""
        k = np.maximum(np.searchsorted(time, t, side="right") - 1, 0)
        s = np.maximum(t - time[k], 0.0)
        return gone[k] + s * (gained[k] + s * (0.5 * value[k] + slope[k] * s / 6.0))

    @property
    def kinks(self) -> tuple[float, ...]:
        """Times of all points."""
        return tuple(self.time.tolist())

    @property
    def total(self) -> float:
        """Integral of the force's size."""
        size, width = np.abs(self.value), np.diff(self.time)
        both = size[:-1] + size[1:]
        crosses = self.value[:-1] * self.value[1:] < 0.0
        mean = np.where(crosses, (size[:-1] ** 2 + size[1:] ** 2) / np.where(both > 0.0, both, 1.0), both) / 2.0
        return float(np.sum(mean * width))

    @property
    def fastest(self) -> float:
        """Velocity of largest size: where a piece begins or ends, or its acceleration passes through 0."""
        width = np.append(np.diff(self.time), 0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            turn = np.nan_to_num(np.clip(-self.value / self.slope, 0.0, width))
        velocity = np.ravel([self.gained + s * (self.value + 0.5 * self.slope * s) for s in (0.0, turn, width)])
        return float(velocity[np.argmax(np.abs(velocity))])

    @property
    def leaps(self) -> tuple[float, ...]:
        """Times just after which the velocity of a prescribed motion has jumped, the start apart."""
        width = np.diff(self.time)
        before = self.gained[:-1] + width * (self.value[:-1] + 0.5 * self.slope[:-1] * width)
        jump = np.abs(self.gained[1:] - before)
        return tuple((self.time[1:][jump > _ROUNDING * abs(self.fastest)] / _EARLIER).tolist())

    @property
    def points(self) -> int:  # type: ignore[override]
        """Number of points."""
        return len(self.time)

    @property
    def long(self) -> bool:  # type: ignore[override]
        """Whether it is too long for a formula of LAMMPS."""
        return self.points > MOST_IN_FORMULA

    def formula(self, name: str) -> str:
        """Integral of the force over a step: half of each change of slope, times the square of the time since.

        Times are written in steps: LAMMPS evaluates a variable again wherever it is named, ten times slower.

        A long one is the difference of two variables of `lammps_inputs.laws.table_lines`.
        """
        if self.long:
            return f"v_{name}to_gained-v_{name}from_gained"
        change = 0.5 * np.diff(self.slope, prepend=0.0)
        after, before = ("((step+0.5)*v_timestep)", "((step-0.5)*v_timestep)")

        def until(t: str) -> str:
            begin = text(float(self.time[0]))
            terms = [f"{text(float(self.value[0]))}*({t}>{begin})*({t}-{begin})"] if self.value[0] else []
            terms += [
                f"{text(float(c))}*({t}>{text(float(at))})*({t}-{text(float(at))})^2"
                for c, at in zip(change, self.time, strict=True)
            ]
            return f"({'+'.join(terms)})"

        # beyond the last point both are the total impulse, but for rounding
        return f"({until(after)}-{until(before)})*({before}<{text(float(self.time[-1]))})"

    def course(self, name: str) -> tuple[str, str]:
        """Displacement and velocity, variables of `lammps_inputs.laws.table_lines`."""
        return f"v_{name}now_gone", f"v_{name}now_gained"

    def start(self, name: str) -> str:  # noqa: ARG002
        """Velocity at the start."""
        return text(float(self.gained[0]))


class Rectangular(Table):
    """A constant force until the duration is over."""

    jumps, points, long = True, 0, False

    @property
    def total(self) -> float:
        """Integral of the force's size."""
        return abs(float(self.gained[-1]))

    @property
    def numbers(self) -> dict[str, float]:
        """Numbers by which a user gives the force."""
        return {"peak": float(self.value[0]), "duration": float(self.time[-1])}

    def of(self, *numbers: float) -> "Rectangular":
        """The law of other `numbers`."""
        return rectangular(*numbers)

    def formula(self, name: str) -> str:
        """Integral of the force over a step of LAMMPS, as a formula of its variables."""
        return f"v_{name}peak*(v_{name}to-v_{name}from)"


def rectangular(peak: float, duration: float) -> Rectangular:
    """A constant force, from its size and its duration."""
    each = ([0.0, duration], [peak, 0.0], [0.0, 0.0], [0.0, peak * duration], [0.0, 0.5 * peak * duration**2])
    return Rectangular(*map(np.array, each))


def of_force(time: Floats, value: Floats) -> Table:
    """Force that is linear between points and 0 outside.

    Args:
        time: times of the points, [point], in ascending order.
        value: forces there, [point]; both dimensionless, or both in the scene's units.
    """
    width, mean = np.diff(time), 0.5 * (value[1:] + value[:-1])
    gained = np.concatenate([[0.0], np.cumsum(mean * width)])
    gone = gained[:-1] * width + (2.0 * value[:-1] + value[1:]) / 6.0 * width * width
    slope = np.append(np.diff(value) / width, 0.0)
    return Table(time, value, slope, gained, np.concatenate([[0.0], np.cumsum(gone)]))


# --- tables of prescribed motions -------------------------------------------------------------------------------------


class ConstantVelocity(Table):
    """A piston: a bead that moves with constant velocity between two times, and rests before and after."""

    points, long = 0, False

    @property
    def numbers(self) -> dict[str, float]:
        """Number by which a user gives the motion."""
        return {"velocity": self.fastest}

    def of(self, *numbers: float) -> "ConstantVelocity":
        """The law of another velocity."""
        factor = numbers[0] / self.fastest
        return replace(self, gained=factor * self.gained, gone=factor * self.gone)

    def course(self, name: str) -> tuple[str, str]:
        """Displacement and velocity, as formulas of LAMMPS."""
        t = "step*v_timestep"
        since, acting = (t, "1") if self.gained[0] else ("0", "0")
        for sign, at in zip("-+" if self.gained[0] else "+-", map(text, self.kinks[1:]), strict=False):
            since += f"{sign}({t}>={at})*({t}-{at})"
            acting += f"{sign}({t}>={at})"
        return f"v_{name}velocity*({since})", f"v_{name}velocity*({acting})"

    def start(self, name: str) -> str:
        """Velocity at the start, as a formula of LAMMPS."""
        return f"v_{name}velocity" if self.gained[0] else "0"


def constant_velocity(velocity: float, begin: float = 0.0, end: float = math.inf) -> ConstantVelocity:
    """Motion with constant velocity from one time to another."""
    times, gained, gone = [0.0], [0.0 if begin > 0.0 else velocity], [0.0]
    for time, later in ((begin, velocity), (end, 0.0)):
        if 0.0 < time < math.inf:
            times.append(_EARLIER * time)
            gone.append(gone[-1] + gained[-1] * (times[-1] - times[-2]))
            gained.append(later)
    none = np.zeros(len(times))
    return ConstantVelocity(np.array(times), none, none, np.array(gained), np.array(gone))


def of_velocity(time: Floats, velocity: Floats) -> Table:
    """Motion whose velocity is linear between points; the bead rests before the first, and keeps the last velocity.

    Args:
        time: times of the points, [point], in ascending order.
        velocity: velocities there, [point].
    """
    time = _EARLIER * time
    width = np.diff(time)
    value = np.append(np.diff(velocity) / width, 0.0)
    gone = np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * width)])
    return _from_rest(time, value, np.zeros(len(time)), velocity, gone)


def of_displacement(time: Floats, displacement: Floats) -> Table:
    """Motion by the cubic spline through points (not-a-knot); the bead rests before the first and after the last.

    Args:
        time: times of the points, [point], in ascending order.
        displacement: displacements there, [point], from 0 on.
    """
    from scipy import interpolate  # takes a tenth of a second to import

    time = _EARLIER * time
    jerk, acceleration, velocity, _ = interpolate.CubicSpline(time, displacement).c
    value, slope, gained = (np.append(part, 0.0) for part in (2.0 * acceleration, 6.0 * jerk, velocity))
    return _from_rest(time, value, slope, gained, displacement)


def _from_rest(time: Floats, *columns: Floats) -> Table:
    """Table of a motion, with a piece of rest before the first point where that is later than the start."""
    before = [0.0] if time[0] > 0.0 else []
    return Table(*(np.concatenate([before, column]) for column in (time, *columns)))
