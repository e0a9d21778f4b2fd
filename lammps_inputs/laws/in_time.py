"""Laws of a force in time: what is done to a bead from outside, from the start on.

A law is a subclass of `TimeLaw` that declares its parameters, as a law on a link does. Its functions take the time
``t`` and the parameters, as scalars or arrays, and are written without branches.
"""

# ruff: noqa: ARG004  every function of a law takes all of its parameters
import math
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


class TimeLaw(Parameters):
    """Force in time, and what a law is where it does not say otherwise.

    Attributes:
        omega: angular frequency with which the force oscillates for ever, in units of 1 / T; 0 where it does not.
        jumps: whether the force jumps later than at the start.
        points: number of points between which the force is linear; 0 of a formula.
        long: whether these are too many for a formula of LAMMPS.
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
        """Integral of the force from the start to a time, which the reference's kernel compiles."""
        raise NotImplementedError

    @staticmethod
    def travel(*args: Any, **kwargs: Any) -> Any:
        """Distance that a free bead of mass 1 has gone at a time: the integral of the impulse."""
        raise NotImplementedError

    @property
    def kinks(self) -> tuple[float, ...]:
        """Times between which the force is smooth, from the first at which it acts to the last, which may be inf."""
        raise NotImplementedError

    @property
    def total(self) -> float:
        """Integral of the force's size, of one that never ends over half a period."""
        raise NotImplementedError

    def formula(self, name: str) -> str:
        """Integral of the force over a step of LAMMPS, as a formula of its variables.

        The step is from ``v_NAMEfrom`` to ``v_NAMEto``, both within the time in which the force acts.
        """
        raise NotImplementedError

    def variables(self, name: str) -> tuple[str, ...]:
        """Deck variables with the parameters that the formula names."""
        return tuple(f"variable {name}{key} index {text(value)}" for key, value in self.by_name.items())


class HalfSine(TimeLaw):
    """``peak * sin(pi t / duration)`` until the duration is over: a hammer, a ball that bounces off."""

    peak: float
    duration: float

    @staticmethod
    def force(t: Any, peak: Any, duration: Any) -> Any:
        """Force at a time."""
        return peak * np.sin(math.pi * t / duration) * ((t >= 0.0) & (t < duration))

    @staticmethod
    def rate(t: Any, peak: Any, duration: Any) -> Any:
        """Slope of the force over time; after a jump, the slope on its right."""
        return peak * math.pi / duration * np.cos(math.pi * t / duration) * ((t >= 0.0) & (t < duration))

    @staticmethod
    def impulse(t: Any, peak: Any, duration: Any) -> Any:
        """Integral of the force, ``2 peak duration / pi`` at the end."""
        acting = np.minimum(np.maximum(t, 0.0), duration)
        return peak * duration / math.pi * (1.0 - np.cos(math.pi * acting / duration))

    @staticmethod
    def travel(t: Any, peak: Any, duration: Any) -> Any:
        """Distance that a free bead of mass 1 has gone at a time: the integral of the impulse."""
        acting = np.minimum(np.maximum(t, 0.0), duration)
        wave = duration / math.pi * np.sin(math.pi * acting / duration)
        return peak * duration / math.pi * (acting - wave + 2.0 * np.maximum(t - duration, 0.0))

    @property
    def kinks(self) -> tuple[float, ...]:
        """Times at which the force starts and ends."""
        return 0.0, self.duration

    @property
    def total(self) -> float:
        """Integral of the force's size."""
        return 2.0 * abs(self.peak) * self.duration / math.pi

    def formula(self, name: str) -> str:
        """Integral of the force over a step of LAMMPS, as a formula of its variables."""
        turn = f"PI/v_{name}duration"
        return f"v_{name}peak/({turn})*(cos({turn}*v_{name}from)-cos({turn}*v_{name}to))"


class Rectangular(TimeLaw):
    """A constant force until the duration is over."""

    jumps = True

    peak: float
    duration: float

    @staticmethod
    def force(t: Any, peak: Any, duration: Any) -> Any:
        """Force at a time."""
        return peak * ((t >= 0.0) & (t < duration))

    @staticmethod
    def rate(t: Any, peak: Any, duration: Any) -> Any:
        """Slope of the force: 0 between its jumps."""
        return 0.0 * peak * t

    @staticmethod
    def impulse(t: Any, peak: Any, duration: Any) -> Any:
        """Integral of the force, ``peak * duration`` at the end."""
        return peak * np.minimum(np.maximum(t, 0.0), duration)

    @staticmethod
    def travel(t: Any, peak: Any, duration: Any) -> Any:
        """Distance that a free bead of mass 1 has gone at a time: the integral of the impulse."""
        acting = np.minimum(np.maximum(t, 0.0), duration)
        return peak * (0.5 * acting * acting + duration * np.maximum(t - duration, 0.0))

    @property
    def kinks(self) -> tuple[float, ...]:
        """Times at which the force starts and ends."""
        return 0.0, self.duration

    @property
    def total(self) -> float:
        """Integral of the force's size."""
        return abs(self.peak) * self.duration

    def formula(self, name: str) -> str:
        """Integral of the force over a step of LAMMPS, as a formula of its variables."""
        return f"v_{name}peak*(v_{name}to-v_{name}from)"


class Sine(TimeLaw):
    """``peak * sin(omega t + phase)`` from the start on, for ever."""

    peak: float
    omega: float
    phase: float

    @staticmethod
    def force(t: Any, peak: Any, omega: Any, phase: Any) -> Any:
        """Force at a time."""
        return peak * np.sin(omega * t + phase) * (t >= 0.0)

    @staticmethod
    def rate(t: Any, peak: Any, omega: Any, phase: Any) -> Any:
        """Slope of the force over time; after a jump, the slope on its right."""
        return peak * omega * np.cos(omega * t + phase) * (t >= 0.0)

    @staticmethod
    def impulse(t: Any, peak: Any, omega: Any, phase: Any) -> Any:
        """Integral of the force, which oscillates about a mean that is not 0 unless the force begins at its largest."""
        return peak / omega * (np.cos(phase) - np.cos(omega * np.maximum(t, 0.0) + phase))

    @staticmethod
    def travel(t: Any, peak: Any, omega: Any, phase: Any) -> Any:
        """Integral of the impulse, which oscillates and drifts with the mean impulse."""
        acting = np.maximum(t, 0.0)
        wave = (np.sin(omega * acting + phase) - np.sin(phase)) / omega
        return peak / omega * (acting * np.cos(phase) - wave)

    @property
    def kinks(self) -> tuple[float, ...]:
        """Start of the force, which never ends."""
        return 0.0, math.inf

    @property
    def total(self) -> float:
        """Integral of the force's size over half a period."""
        return 2.0 * abs(self.peak) / self.omega

    def formula(self, name: str) -> str:
        """Integral of the force over a step of LAMMPS; a product, for a difference of cosines would lose digits."""
        turn, start, end = f"0.5*v_{name}omega", f"v_{name}from", f"v_{name}to"
        middle = f"sin({turn}*({start}+{end})+v_{name}phase)"
        return f"2*v_{name}peak/v_{name}omega*{middle}*sin({turn}*({end}-{start}))"


class TabulatedForce(TimeLaw):
    """Linear between points; no force before the first and after the last."""

    time: Floats
    value: Floats
    gained: Floats
    """Impulse until each point."""
    gone: Floats
    """Travel until each point."""

    @staticmethod
    def force(t: Any, time: Any, value: Any, gained: Any, gone: Any) -> Any:
        """Force at a time."""
        k = np.minimum(np.maximum(np.searchsorted(time, t, side="right"), 1), time.shape[0] - 1)
        slope = (value[k] - value[k - 1]) / (time[k] - time[k - 1])
        return (value[k - 1] + slope * (t - time[k - 1])) * ((t >= time[0]) & (t < time[-1]))

    @staticmethod
    def rate(t: Any, time: Any, value: Any, gained: Any, gone: Any) -> Any:
        """Slope of the force over time; after a jump, the slope on its right."""
        k = np.minimum(np.maximum(np.searchsorted(time, t, side="right"), 1), time.shape[0] - 1)
        return (value[k] - value[k - 1]) / (time[k] - time[k - 1]) * ((t >= time[0]) & (t < time[-1]))

    @staticmethod
    def impulse(t: Any, time: Any, value: Any, gained: Any, gone: Any) -> Any:
        """Integral of the force from the start to a time."""
        acting = np.minimum(np.maximum(t, time[0]), time[-1])
        k = np.minimum(np.maximum(np.searchsorted(time, acting, side="right"), 1), time.shape[0] - 1)
        slope, s = (value[k] - value[k - 1]) / (time[k] - time[k - 1]), acting - time[k - 1]
        return gained[k - 1] + s * (value[k - 1] + 0.5 * slope * s)

    @staticmethod
    def travel(t: Any, time: Any, value: Any, gained: Any, gone: Any) -> Any:
        """Distance that a free bead of mass 1 has gone at a time: the integral of the impulse."""
        acting = np.minimum(np.maximum(t, time[0]), time[-1])
        k = np.minimum(np.maximum(np.searchsorted(time, acting, side="right"), 1), time.shape[0] - 1)
        slope, s = (value[k] - value[k - 1]) / (time[k] - time[k - 1]), acting - time[k - 1]
        flown = gained[-1] * np.maximum(t - time[-1], 0.0)
        return gone[k - 1] + s * (gained[k - 1] + s * (0.5 * value[k - 1] + slope * s / 6.0)) + flown

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
    def points(self) -> int:  # type: ignore[override]
        """Number of points."""
        return len(self.time)

    @property
    def long(self) -> bool:  # type: ignore[override]
        """Whether it is too long for a formula of LAMMPS."""
        return self.points > MOST_IN_FORMULA

    def variables(self, name: str) -> tuple[str, ...]:  # noqa: ARG002
        """None: the numbers stand in the formula."""
        return ()

    def formula(self, name: str) -> str:
        """Integral of the force over a step: half of each change of slope, times the square of the time since.

        Times are written in steps: LAMMPS evaluates a variable again wherever it is named, ten times slower.

        A long one is the difference of two variables of `lammps_inputs.laws.table_lines`.
        """
        if self.long:
            return f"v_{name}to_gained-v_{name}from_gained"
        slope = np.diff(self.value) / np.diff(self.time)
        change = 0.5 * np.diff(slope, prepend=0.0, append=0.0)
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


def make_table(time: Floats, value: Floats) -> TabulatedForce:
    """Table from its points, in ascending order of time.

    Args:
        time: times of the points, [point].
        value: forces there, [point]; both dimensionless, or both in the scene's units.
    """
    width, mean = np.diff(time), 0.5 * (value[1:] + value[:-1])
    gained = np.concatenate([[0.0], np.cumsum(mean * width)])
    gone = gained[:-1] * width + (2.0 * value[:-1] + value[1:]) / 6.0 * width * width
    return TabulatedForce(time, value, gained, np.concatenate([[0.0], np.cumsum(gone)]))
