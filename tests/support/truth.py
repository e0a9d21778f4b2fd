"""The motion of a scene by an integrator of its own, scipy's DOP853, and what is in it; no code is shared with the product.

The state carries what dashpots take and what comes from outside, so that a budget needs no rule between frames.
"""  # noqa: E501

import math
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from scene_keys import hardest, nature
from scenes_nature import Floats, Nature, Wall
from scipy.integrate import OdeSolution, solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq
from scipy.signal import find_peaks

from lammps_inputs import Scene

FINE = 0.02
"""Time in T between the states in which maxima are looked for; a quartic through five is then good to 1e-7 V and T."""

SMALL = 1e-9
"""Force and overlap at which a contact counts as closed."""

_THROUGH_FIVE = np.linalg.inv(np.vander(np.arange(-2.0, 3.0), increasing=True))


class Maximum(NamedTuple):
    """A maximum of a bead's velocity along a direction.

    Attributes:
        since, until: bounds on the time in which the velocity is nearly (1e-5) that.
        prominence: by how much it stands above what is around it.
        centre: ``time`` less displacement over velocity.
        pressed: overlap with a neighbour.
        bend: how sharp it is, the second derivative's size.
    """

    time: float
    since: float
    until: float
    velocity: float
    prominence: float
    centre: float
    pressed: float
    bend: float = math.inf

    def late(self, off: float) -> float:
        """By how much it may be shifted by an error of velocity that changes over the time of a pulse."""
        return 0.3 * math.sqrt(2.0 * off / max(self.bend, 1e-9))


class Contact(NamedTuple):
    """A stretch of time in which a contact is closed."""

    start: float
    end: float
    over: bool
    """Whether it ended before the run did."""


class Truth:
    """A scene's own trajectory until a time."""

    def __init__(self, scene: Scene, duration: float, rtol: float = 1e-8) -> None:
        self.scene, self.nature, self.end = scene, nature(scene), duration
        self.solution = _solved(self.nature, duration, rtol)
        self.times = np.linspace(0.0, duration, math.ceil(duration / FINE) + 1)
        self.way = 1 if hardest(scene)[2] > 0.0 else -1
        self._maxima: dict[tuple[int, int, int], list[Maximum]] = {}

    def states(self, time: Any) -> tuple[Floats, Floats]:
        """Displacements and velocities, [..., chain, bead]."""
        shape = np.shape(time)
        found = self.solution(np.ravel(time)).T[:, : 2 * self.nature.mass.size]
        found = found.reshape(*shape, 2, *self.nature.mass.shape)[..., : self.scene.chains, :]
        return found[..., 0, :, :], found[..., 1, :, :]

    def exchange(self, time: Floats) -> dict[str, Floats]:
        """Energy ``energy_input`` by forces from outside, and taken by each kind of dashpots, until times."""
        return dict(zip(_names(self.nature), self.solution(time)[2 * self.nature.mass.size :], strict=True))

    @cached_property
    def fine(self) -> tuple[Floats, Floats]:
        """At the fine times."""
        return self.states(self.times)

    @cached_property
    def _between(self) -> tuple[Floats, Floats]:
        """In the middle of each two fine times."""
        return self.states(0.5 * (self.times[1:] + self.times[:-1]))

    def velocity(self, chain: int, bead: int, since: float, until: float) -> tuple[Floats, Floats]:
        """Fine times within bounds, ten times finer by a spline, and the velocity of a bead (from 1) then."""
        low, high = np.searchsorted(self.times, (since, until))
        part = slice(max(int(low) - 4, 0), int(high) + 4)
        time = self.times[part]
        near = np.linspace(max(since, time[0]), min(until, time[-1]), 10 * len(time))
        return near, CubicSpline(time, self.fine[1][part, chain - 1, bead - 1])(near)

    # --- maxima of velocities -----------------------------------------------------------------------------------------

    def maxima(self, chain: int, bead: int, way: int = 0) -> list[Maximum]:
        """Of a bead, counted from 1, of the velocity along a way (by default that of the hardest blow)."""
        key = (chain, bead, way or self.way)
        if key not in self._maxima:
            self._maxima[key] = self._found(*key)
        return self._maxima[key]

    def _found(self, chain: int, bead: int, way: int) -> list[Maximum]:
        x, v = (way * part[:, chain - 1, bead - 1] for part in self.fine)
        places, more = find_peaks(np.concatenate([[-2.0], v, [-2.0]]), prominence=1e-7)
        step, found = self.times[1], []
        for place, prominence in zip(places - 1, more["prominences"], strict=True):
            shift, top, bend = 0.0, v[place], 0.0
            if 1 < place < len(v) - 2:
                a, b, c, d, e = (_THROUGH_FIVE @ v[place - 2 : place + 3]).tolist()
                for _ in range(5):
                    bend = 2.0 * c + shift * (6.0 * d + shift * 12.0 * e)
                    slope = b + shift * (2.0 * c + shift * (3.0 * d + shift * 4.0 * e))
                    shift = min(1.0, max(-1.0, shift - slope / bend)) if bend < 0.0 else 0.0
                top = max(top, a + shift * (b + shift * (c + shift * (d + shift * e))))
            below = np.flatnonzero(v < top - 1e-5)
            since = self.times[below[below < place].max(initial=-1) + 1]
            until = self.times[below[below > place].min(initial=len(v)) - 1]
            time = self.times[place] + shift * step
            centre = time - (x[place] + shift * step * top) / top if top else 0.0
            pressed = self._pressed(int(place), chain - 1, bead - 1)
            found.append(
                Maximum(time, min(time, since), max(time, until), top, prominence, centre, pressed, -bend / step**2)
            )
        return found

    def _pressed(self, place: int, chain: int, bead: int) -> float:
        overlap = np.pad(self.nature.overlap(self.fine[0][place])[chain], 1, constant_values=-1.0)
        return float(max(overlap[bead], overlap[bead + 1]))

    def levels(self, chain: int, bead: int) -> list[Maximum]:
        """Where a bead flies freely for a while before it is pushed on: no maximum, but it was passed by a pulse."""
        x, v = (self.way * part[:, chain - 1, bead - 1] for part in self.fine)
        flat = np.concatenate([[False], np.abs(np.diff(v)) < 1e-9, [False]])
        edges = np.flatnonzero(np.diff(flat.astype(int)))
        return [
            Maximum(self.times[a], self.times[a], self.times[b - 1], v[a], 0.0, self.times[a] - x[a] / v[a], -1.0)
            for a, b in zip(edges[::2], edges[1::2], strict=True)
            if v[a] > 1e-3
        ]

    # --- forces -------------------------------------------------------------------------------------------------------

    def largest(self, values: Any) -> tuple[float, float]:
        """Time and size of the largest of what follows from states, values(x, v) -> [...]; refined about the largest."""  # noqa: E501
        coarse = values(*self.fine)
        top = int(np.argmax(coarse))
        near = np.linspace(self.times[max(top - 1, 0)], self.times[min(top + 1, len(self.times) - 1)], 41)
        fine = values(*self.states(near))
        best = int(np.argmax(fine))
        return (near[best], float(fine[best])) if fine[best] > coarse[top] else (self.times[top], float(coarse[top]))

    def integral(self, values: Any) -> float:
        """Over time, by Simpson's rule on the fine times with one point between."""
        ends, inside = values(*self.fine), values(*self._between)
        return float(np.sum(ends[:-1] + 4.0 * inside + ends[1:]) * self.times[1] / 6.0)

    def closed(self, overlap: Any, least: float, *, both: bool = False) -> list[Contact]:
        """Stretches in which what follows from displacements (or both) exceeds something.

        Short ones between fine times are not seen.
        """
        if not both:
            return self.closed(lambda x, _: overlap(x), least, both=True)
        value = overlap(*self.fine) - least
        on = np.concatenate([[False], value > 0.0, [False]])
        found = []
        for a, b in np.flatnonzero(np.diff(on.astype(int))).reshape(-1, 2).tolist():
            start = self._crossing(overlap, least, a - 1) if a > 0 else 0.0
            end = self._crossing(overlap, least, b - 1) if b < len(value) else self.end
            found.append(Contact(start, end, b < len(value)))
        return found

    def _crossing(self, overlap: Any, least: float, place: int) -> float:
        def at(time: float) -> float:
            return float(overlap(*self.states(np.array([time])))[0] - least)

        low, high = self.times[place], self.times[place + 1]
        return float(brentq(at, low, high, xtol=1e-12)) if at(low) * at(high) < 0.0 else float(high)


def _names(own: Nature) -> list[str]:
    zero = np.zeros_like(own.mass)
    return list(own.power(0.0, zero, zero))


def _solved(own: Nature, end: float, rtol: float) -> OdeSolution:
    """States over time: displacements, velocities, exchange; from kink to kink of what comes from outside."""
    size, shape = own.mass.size, own.mass.shape
    counted = own.lossy or bool(own.pushes) or bool(own.moved) or own.stiffness is not None
    names = _names(own)

    def rates(time: float, state: Floats) -> Floats:
        x, v = state[: 2 * size].reshape(2, *shape)
        power = list(own.power(time, x, v).values()) if counted else [0.0] * len(names)
        return np.concatenate([v, own.acceleration(time, x, v), np.reshape(power, -1)], axis=None)

    state = np.concatenate([np.zeros(size), own.start.ravel(), np.zeros(len(names))])
    kinks = [*own.bends, *(kink for push in own.pushes for kink in push.kinks)]
    edges = sorted({0.0, end, *(kink for kink in kinks if 0.0 < kink < end)})
    pieces = []
    for since, until in pairwise(edges):
        # no stage of a step is at its end, where the push is over
        found = solve_ivp(
            rates, (since, np.nextafter(until, 0.0) if until < end else until), state, "DOP853",
            rtol=rtol, atol=1e-2 * rtol, max_step=0.4, dense_output=True,
        )  # fmt: skip
        if not found.success:
            raise ArithmeticError(found.message)
        state = found.y[:, -1]
        pieces.append(found.sol)
    return OdeSolution(
        np.concatenate([pieces[0].ts[:1], *(piece.ts[1:] for piece in pieces)]),
        [step for piece in pieces for step in piece.interpolants],
    )


def force_of(own: Nature, kind: str, chain: int, bead: int) -> Any:
    """What a gauge reads, (x, v) -> [...]: chain and bead from 1, the bead of a wall 1 or the last."""
    if kind == "wall":
        wall = wall_of(own, bead)
        return lambda x, v: own.at_wall(wall, x, v)[..., chain - 1]
    if kind == "contact":
        return lambda x, v: own.contacts(x, v)[..., chain - 1, bead - 1]
    return lambda x, v: own.contacts(x, v)[..., chain - 1, bead - 2 : bead].mean(axis=-1)


def wall_of(own: Nature, bead: int) -> Wall:
    return next(wall for wall in own.walls if wall.bead == bead - 1)
