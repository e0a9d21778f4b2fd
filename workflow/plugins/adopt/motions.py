"""Prescribed motions of beads, as LAMMPS moves them, as the keys of a scene's drive."""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from workflow.plugins.adopt.digits import tidy

Floats = NDArray[np.float64]

RECORDED = 20_000
"""Intervals of a recorded motion at most, and of a table of it."""

EXACT = 1e-9
"""Deviation of a motion from its law, relative to its largest displacement, that is rounding."""

IN_TABLE = 1e-8
"""Deviation of a table between its points, relative to its largest displacement."""


@dataclass(frozen=True)
class GivenMotion:
    """Displacement of a bead that LAMMPS moves, whatever acts on it.

    Attributes:
        time: times from the start, [frame], at equal intervals.
        displacement: displacements from the place at the start, [frame].
    """

    time: Floats
    displacement: Floats

    @property
    def none(self) -> bool:
        """Whether the bead stays where it is."""
        return not np.any(self.displacement)

    @property
    def speed(self) -> float:
        """Largest velocity."""
        return float(np.max(np.abs(np.diff(self.displacement) / np.diff(self.time)), initial=0.0))

    def reversed(self) -> "GivenMotion":
        """The motion along the axis in the other direction."""
        return replace(self, displacement=-self.displacement)

    def keys(self) -> dict[str, Any]:
        """Keys of a drive beside its chain and bead."""
        return self._piston() or self._harmonic() or self._table()

    def _is(self, displacement: Floats) -> bool:
        largest = float(np.max(np.abs(self.displacement)))
        return bool(np.max(np.abs(displacement - self.displacement)) <= EXACT * largest)

    def _piston(self) -> dict[str, Any]:
        """Keys of a constant velocity, from the start on or between two times; none if it is not one."""
        time, x = self.time, self.displacement
        steps = np.diff(x)
        fastest = int(np.argmax(np.abs(steps)))
        velocity = float(steps[fastest] / (time[fastest + 1] - time[fastest]))
        at_speed = np.abs(steps - steps[fastest]) <= 1e-6 * abs(steps[fastest])
        first, last = int(np.argmax(at_speed)), len(steps) - int(np.argmax(at_speed[::-1]))
        velocity = float((x[last] - x[first]) / (time[last] - time[first]))
        begin = max(0.0, float(time[first] - (x[first] - x[0]) / velocity))
        end = begin + float((x[-1] - x[0]) / velocity)
        if not self._is(velocity * (np.clip(time, begin, end) - begin)):
            return {}
        times = {"from": tidy(begin)} if begin > EXACT * time[-1] else {}
        times |= {"until": tidy(end)} if end < (1.0 - EXACT) * time[-1] else {}
        return {"velocity": tidy(velocity), **times}

    def _harmonic(self) -> dict[str, Any]:
        """Keys of a harmonic motion; none if it is not one."""
        time, x = self.time, self.displacement
        step = float(time[1] - time[0])
        if len(x) < 8:
            return {}
        change = np.diff(x)  # of one frequency, without the constant
        before, middle, after = change[:-2], change[1:-1], change[2:]
        cosine = float(np.sum((before + after) * middle) / (2.0 * np.sum(middle * middle)))
        if not abs(cosine) < 1.0:
            return {}
        omega = math.acos(cosine) / step
        omega = _refined(omega, time, x)
        matrix = np.stack([np.sin(omega * time), np.cos(omega * time) - 1.0], axis=1)
        (sine, other), *_ = np.linalg.lstsq(matrix, x, rcond=None)
        if not self._is(matrix @ [sine, other]):
            return {}
        amplitude, phase = math.hypot(sine, other), math.degrees(math.atan2(other, sine))
        keys = {"displacement": tidy(amplitude), "frequency": tidy(omega / (2.0 * math.pi))}
        return keys | ({"phase": tidy(phase)} if abs(phase) > 1e-9 else {})

    def _table(self) -> dict[str, Any]:
        """Keys of a table with as few points as describe the motion, in powers of two."""
        time, x = self.time, self.displacement
        largest = float(np.max(np.abs(x)))
        every = 1 << max(0, (len(time) - 1).bit_length() - 4)
        while every > 1:
            chosen = _each(every, len(time))
            spline = CubicSpline(time[chosen], x[chosen])
            if np.max(np.abs(spline(time) - x)) <= IN_TABLE * largest:
                break
            every //= 2
        chosen = _each(every, len(time))
        points = [[float(t), float(d)] for t, d in zip(time[chosen], x[chosen] - x[0], strict=True)]
        return {"table": points, "quantity": "displacement"}


def _each(every: int, count: int) -> NDArray[np.int64]:
    """Every so many of the numbers below a count, and the last."""
    return np.unique(np.append(np.arange(0, count, every), count - 1))


def _refined(omega: float, time: Floats, x: Floats) -> float:
    """Angular frequency by Gauss-Newton steps from one that is nearly it."""
    for _ in range(20):
        matrix = np.stack([np.sin(omega * time), np.cos(omega * time) - 1.0], axis=1)
        (sine, other), *_ = np.linalg.lstsq(matrix, x, rcond=None)
        slope = time * (sine * np.cos(omega * time) - other * np.sin(omega * time))
        design = np.column_stack([matrix, slope])
        more = float(np.linalg.lstsq(design, x - matrix @ [sine, other], rcond=None)[0][2])
        omega += more
        if abs(more) <= 1e-15 * omega:
            break
    return omega
