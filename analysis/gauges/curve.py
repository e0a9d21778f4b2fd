"""Forces between frames, with bounds on them; maxima and crossings of samples.

A force follows from the strain of its contact. Where frames determine the forces on all beads, the strain between two
frames is the polynomial of degree seven through its value and three derivatives there, as that of a displacement is
where a bead is fastest (`analysis.tracking.brackets`); else it is that of degree three, through value and rate.

The strain may be off by what the polynomial differs from that of degree five, without the third derivatives; by what
rates, accelerations and their rates at the two frames leave unexplained of the change of the strain; by contacts that
close or open near by, which no polynomial follows (`kinks`); and as the velocities of LAMMPS are not quite the slopes
of its displacements. Forces rise with the strain: they lie between those of the least and the largest strain.
"""

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from analysis import hermite
from analysis.gauges.gauge import Gauge, Probe, memory_at_frames, strain_at_frames
from analysis.tracking.brackets import kinks
from analysis.trajectory import Flags, Floats, Integers, Trajectory
from lammps_inputs import Problem, physics
from lammps_inputs.limits import rates

TOUCH = 1e-18
"""Force from which on there is an impulse to add up, of an overlap of 1e-12."""

PANEL = 0.05
"""Largest stretch of time for one Gauss rule of four nodes, in units of T."""

PHASE = 0.125
"""The same of the system's fastest motion, in radian, up to `MOST_PANELS` from frame to frame."""

MOST_PANELS = 20

HASTY = 4.0
"""Phase of the fastest motion from frame to frame from which on less is certain, by its square up to twice as much."""

CHANGED, UNEXPLAINED = 2.0, 0.3
"""How far a strain may be off, in what a polynomial of lower degree differs, and in what is left unexplained. Measured
at all contacts of chains of all ingredients and times between frames from 0.1 to 2: the sum, with kinks, holds for all
but those whose fastest motion has a phase of 5 and more from frame to frame; of these, one in a hundred is off by more.
"""

NEAR = 8.0
"""What a strain may be off by at s, over ``s (1 - s)`` and its largest; as a power of s it rises from 0 at a frame."""

UNSEEN = 3.0
"""The same of strains between few recorded beads, by the rule of the cubic polynomial of an oscillation as fast as any;
more with dashpots, which may jump unseen.
"""

UNSEEN_DASHPOT = 3.0

_VALUE, _SLOPE, _FLAT = 1.4e-3, 5.5e-3, 2.2
"""Largest values of ``s**3 (1 - s)**4 / 6`` and of its slope, and of ``140 s**3 (1 - s)**3``, between 0 and 1."""


@dataclass(frozen=True)
class Curve:
    """Force of one contact over s, in many stretches from frame to frame.

    Attributes:
        probe: the contact.
        polynomial: its strain, [power, stretch].
        chain: [stretch] whose.
        spacing: time from s = 0 to s = 1.
        memory: [frame before or after, stretch], of a contact whose force depends on it.
        off: how far the strain and its rate may be off, [0 or 1, stretch]; less near the frames, where they are known.
    """

    probe: Probe
    polynomial: Floats
    chain: Integers
    spacing: float
    memory: Floats | None
    off: Floats

    @classmethod
    def between(cls, probe: Probe, strain: Floats, memory: Floats | None, chains: Integers, spacing: float) -> "Curve":
        """Curves from frame to frame, stretches [interval * chains + chain], without bounds.

        Args:
            probe: the contact.
            strain: [derivative, frame, chain].
            memory: [frame, chain]; None where no force depends on it.
            chains: [chain] whose.
            spacing: time between frames.
        """
        ends = _ends(strain)
        if memory is not None:
            memory = np.stack([memory[:-1], memory[1:]]).reshape(2, -1)
        chain = np.tile(chains, strain.shape[1] - 1)
        polynomial = hermite.coefficients((0, 1), ends, spacing)
        return cls(probe, polynomial, chain, spacing, memory, np.zeros((2, len(chain))))

    def of(self, stretch: Integers) -> "Curve":
        """The curves in chosen stretches."""
        return replace(
            self,
            polynomial=self.polynomial[:, stretch],
            chain=self.chain[stretch],
            memory=None if self.memory is None else self.memory[:, stretch],
            off=self.off[:, stretch],
        )

    def _memory(self, rate: Floats) -> Floats | None:
        """Largest overlap so far; what opens has reached it."""
        return None if self.memory is None else np.where(rate >= 0.0, self.memory[0], self.memory[1])

    def _rate(self, s: Floats) -> Floats:
        """Rate of the strain at s, in units of L / T."""
        return hermite.value(hermite.derivative(self.polynomial), s) / self.spacing

    def elastic(self, s: Floats) -> Floats:
        """Force at s, a number for each stretch, but for the dashpot's: positive where the contact is closed."""
        memory = None if self.memory is None else self._memory(self._rate(s))
        return self.probe.force(hermite.value(self.polynomial, s), self.chain, memory)

    def __call__(self, s: Floats) -> Floats:
        """Force at s, a number for each stretch."""
        if self.probe.loss is None:
            return self.elastic(s)
        return self.elastic(s) + self.probe.loss(hermite.value(self.polynomial, s), self._rate(s), self.chain)

    def _off(self, s: Floats) -> Floats:
        """How far the strain and its rate may be off at s, [0 or 1, stretch]."""
        return self.off * np.minimum(NEAR * s * (1.0 - s), 1.0)

    def late(self, s: Floats) -> Floats:
        """How far from s the strain may pass what it is there, [stretch]; 1 at most, and where it hardly changes."""
        off, _ = self._off(s)
        passed = 2.0 * off / np.maximum(np.abs(self._rate(s)) * self.spacing, np.finfo(float).tiny)
        return np.asarray(np.minimum(passed, 1.0))

    def bounds(self, s: Floats) -> tuple[Floats, Floats]:
        """Least and largest force at s, each [stretch]."""
        strain, (off, rate_off) = hermite.value(self.polynomial, s), self._off(s)
        rate = np.zeros_like(s) if self.probe.loss is None and self.memory is None else self._rate(s)
        low, high = (self.probe.force(strain + side * off, self.chain, self._memory(rate)) for side in (-1.0, 1.0))
        if self.probe.loss is None:
            return low, high
        losses = [
            self.probe.loss(strain + side * off, rate + faster * rate_off, self.chain)
            for side, faster in itertools.product((-1.0, 0.0, 1.0), (-1.0, 1.0))
        ]
        return low + np.min(losses, axis=0), high + np.max(losses, axis=0)

    def integral(self, border: Floats) -> Floats:
        """Integral over s from 0 to 1, in each stretch.

        In a panel where the contact opens or closes, the force is a power 3/2 from there on, of which no rule makes
        much: with the square root of the time from there as variable it is smooth.
        """
        node, weight = np.polynomial.legendre.leggauss(4)
        node, weight = 0.5 * (node + 1.0), 0.5 * weight
        size = self.polynomial.shape[1]
        total = np.zeros(size)
        closed = np.stack([self.elastic(np.full(size, s)) for s in border]) > TOUCH
        for panel, (low, high) in enumerate(itertools.pairwise(border.tolist())):
            whole = closed[panel] & closed[panel + 1]
            for s, w in zip(node, weight, strict=True):
                total += np.where(whole, w * (high - low) * self(np.full(size, low + s * (high - low))), 0.0)
        panel_of, entry = np.nonzero(closed[:-1] != closed[1:])
        one = self.of(entry)
        low, high, before = border[panel_of], border[panel_of + 1], closed[panel_of, entry]
        at = hermite.change(lambda s: one.elastic(s) > TOUCH, before, low, high)
        width = np.sqrt(np.where(before, at - low, high - at))
        way = np.where(before, -1.0, 1.0)
        for s, w in zip(node, weight, strict=True):
            root = width * s
            np.add.at(total, entry, w * width * 2.0 * root * one(at + way * root * root))
        return total


@dataclass(frozen=True)
class GaugeCurve:
    """Force at a gauge over s, the mean of its contacts', in many stretches from frame to frame."""

    contacts: tuple[Curve, ...]

    @property
    def chain(self) -> Integers:
        """[stretch] whose."""
        return self.contacts[0].chain

    @property
    def moving(self) -> Flags:
        """[stretch] whether any contact is ever out of its state at rest."""
        return np.asarray(np.any([np.any(curve.polynomial != 0.0, axis=0) for curve in self.contacts], axis=0))

    def of(self, stretch: Integers) -> "GaugeCurve":
        """The curves in chosen stretches."""
        return GaugeCurve(tuple(curve.of(stretch) for curve in self.contacts))

    def __call__(self, s: Floats) -> Floats:
        """Force at s, a number for each stretch."""
        return np.asarray(sum(curve(s) for curve in self.contacts)) / len(self.contacts)

    def elastic(self, s: Floats) -> Floats:
        """The same without dashpots."""
        return np.asarray(sum(curve.elastic(s) for curve in self.contacts)) / len(self.contacts)

    def bounds(self, s: Floats) -> Floats:
        """Least and largest force at s, [0 or 1, stretch]."""
        return np.asarray(np.sum([curve.bounds(s) for curve in self.contacts], axis=0)) / len(self.contacts)

    def late(self, s: Floats) -> Floats:
        """How far from s the contact that closes or opens there may do so, [stretch]."""
        closing = np.argmax([curve.elastic(s) for curve in self.contacts], axis=0)
        return np.asarray(np.choose(closing, [curve.late(s) for curve in self.contacts]))

    def impulse(self, border: Floats) -> Floats:
        """Integral over time of the force minus the static one, in each stretch."""
        above = (curve.integral(border) - curve.probe.static[curve.chain] for curve in self.contacts)
        return np.asarray(sum(above)) * self.contacts[0].spacing / len(self.contacts)


def fastest(problem: Problem) -> float:
    """Largest angular frequency of any motion, or rate at which dashpots stop it, in units of 1 / T."""
    return max(rates.fastest(problem.system), rates.drag(problem.system))


def between_frames(block: Trajectory, gauge: Gauge, frequency: float) -> GaugeCurve:
    """Force at a gauge from frame to frame of a block, stretches [interval * chains + chain], with its bounds.

    Args:
        block: frames.
        gauge: where.
        frequency: what `fastest` says of the problem.
    """
    chains = np.arange(block.problem.chains)
    found = []
    for probe in gauge.probes:
        strain = strain_at_frames(block, probe)
        curve = Curve.between(probe, strain, memory_at_frames(block, probe), chains, block.spacing)
        found.append(replace(curve, off=_off(block, curve, _ends(strain), frequency)))
    return GaugeCurve(tuple(found))


def _ends(strain: Floats) -> Floats:
    """Strains at both ends of each stretch, [end, derivative, interval * chains + chain]."""
    return np.stack([strain[:, :-1], strain[:, 1:]]).reshape(2, len(strain), -1)


def _off(block: Trajectory, curve: Curve, ends: Floats, frequency: float) -> Floats:
    """How far strains between frames and their rates may be off, [0 or 1, stretch]; nothing where nothing moves."""
    spacing, phase = block.spacing, frequency * block.spacing
    if not block.forces_known:
        begins = np.array([curve.elastic(np.full(ends.shape[-1], s)) for s in (0.0, 1.0)])
        return _unseen(ends, spacing, phase, begins, damped=physics.contact_loss(block.system) is not None)
    found = _smooth(ends, spacing) * np.clip((phase / HASTY) ** 2, 1.0, 4.0)
    moving = np.flatnonzero(np.any(ends != 0.0, axis=(0, 1)))
    interval, chain = moving // block.problem.chains, moving % block.problem.chains
    for bead in (curve.probe.behind, curve.probe.ahead):
        if bead > 0 and len(moving):
            missed, _ = kinks(block, interval, chain, np.full(len(moving), bead - 1))
            found[:, moving] += missed * np.array([[0.5 * spacing], [1.0]])
    # velocity Verlet's velocities differ from the slope of its displacements by this
    hurried = block.problem.timestep**2 / 6.0 * np.max(np.abs(ends[:, 3]), axis=0)
    return np.asarray(found + hurried * np.array([[0.2 * spacing], [1.0]]))


def _smooth(ends: Floats, spacing: float) -> Floats:
    """How far strains of degree seven, and their rates, may be off where no force sets in, [0 or 1, stretch]."""
    (one, one_rate, one_bend, one_jerk), (two, two_rate, two_bend, two_jerk) = ends
    lower = hermite.coefficients((0, 1), ends[:, :3], spacing)
    changed = np.abs(spacing**3 * one_jerk - 6.0 * lower[3])
    changed += np.abs(spacing**3 * two_jerk - 6.0 * lower[3] - 24.0 * lower[4] - 60.0 * lower[5])
    explained = 0.5 * spacing * (one_rate + two_rate) + spacing**2 / 10.0 * (one_bend - two_bend)
    explained += spacing**3 / 120.0 * (one_jerk + two_jerk)
    unexplained = UNEXPLAINED * np.abs(two - one - explained)
    return np.array(
        [
            CHANGED * _VALUE * changed + unexplained,
            (CHANGED * _SLOPE * changed + _FLAT * unexplained) / spacing,
        ]
    )


def _unseen(ends: Floats, spacing: float, phase: float, force: Floats, *, damped: bool) -> Floats:
    """How far strains of degree three, and their rates, may be off, [0 or 1, stretch].

    A cubic is off by ``h**4 / 384`` times the fourth derivative, which in an oscillation is the square of the frequency
    times the second; and the change of the strain that the rates at both ends leave unexplained is ``h**3 / 12`` times
    the third. A force that sets in or ends between the frames, as those of the neighbours may then, too, moves beads by
    some ``h**2 / 20`` times as much.

    Args:
        ends: strain and its rate at both frames, [end, derivative, stretch].
        spacing: time between them.
        phase: of the fastest motion from one to the other.
        force: elastic force at both, [end, stretch].
        damped: whether there are dashpots.
    """
    (one, one_rate), (two, two_rate) = ends
    swift = min(phase, 2.0 * HASTY)
    off = 2.0 * swift**2 / 384.0 * spacing * np.abs(two_rate - one_rate)
    off += swift / 16.0 * np.abs(two - one - 0.5 * spacing * (one_rate + two_rate))
    off += np.where(np.min(force, axis=0) <= 0.0, spacing**2 / 20.0 * np.max(force, axis=0), 0.0)
    off *= UNSEEN * (UNSEEN_DASHPOT if damped else 1.0)
    return np.array([off, 4.0 / spacing * off])


def borders(spacing: float, frequency: float = 0.0) -> Floats:
    """Borders of panels, from 0 to 1, between frames so far apart in a system whose fastest motion has a frequency."""
    panels = max(spacing / PANEL, min(frequency * spacing / PHASE, MOST_PANELS))
    return np.linspace(0.0, 1.0, max(1, int(np.ceil(panels * (1.0 - 1e-9)))) + 1)


def maximum(value: Callable[[Floats], Floats], low: Floats, high: Floats) -> Floats:
    """Where something with one maximum between low and high is largest."""
    for _ in range(2 * hermite.HALVINGS):
        one, two = low + (high - low) / 3.0, high - (high - low) / 3.0
        rising = value(one) < value(two)
        low, high = np.where(rising, one, low), np.where(rising, high, two)
    return 0.5 * (low + high)


def crossing(time: Floats, values: Floats, k: int, level: float) -> float:
    """When evenly sampled values cross a level between samples k - 1 and k: of a cubic through the four around them."""
    first = min(max(k - 2, 0), max(len(values) - 4, 0))
    around = values[first : first + 4] - level
    curve = np.polynomial.Polynomial.fit(np.arange(len(around)), around, len(around) - 1, domain=[-1, 1])
    roots = curve.roots()
    within = np.real(roots[(np.abs(np.imag(roots)) < 1e-9) & (np.abs(np.real(roots) - (k - 0.5 - first)) <= 0.5)])
    before, after = values[k - 1] - level, values[k] - level
    place = within[0] if len(within) == 1 else k - 1 - first + before / (before - after)
    return float(time[first] + place * (time[k] - time[k - 1]))


def excursion(time: Floats, values: Floats, at: float, level: float) -> tuple[float, float]:
    """From when to when evenly sampled values exceed a level around a time; infinite where the record has no end of it.

    NaN where none of the samples does.
    """
    first = max(int(np.argmin(np.abs(time - at))) - 1, 0)
    k = first + int(np.argmax(values[first : first + 3]))
    if not values[k] > level:
        return np.nan, np.nan
    before, after = np.flatnonzero(values[:k] <= level), np.flatnonzero(values[k:] <= level)
    start = crossing(time, values, int(before[-1]) + 1, level) if len(before) else -np.inf
    end = crossing(time, values, k + int(after[0]), level) if len(after) else np.inf
    return start, end


CUBIC = 0.05
"""Error of a cubic through four samples, with a margin of two, in the fourth difference of five: ``2 * 3 / 128``."""

DIP = 0.25
"""How far values may fall below a least sample, in the second difference there: a parabola falls by up to an eighth."""


def excursion_error(time: Floats, values: Floats, span: tuple[float, float], level: float, floor: float) -> float:
    """Uncertainty of an `excursion`'s duration by the time between samples; infinite where it cannot be determined.

    Args:
        time, values: the samples.
        span: from when to when they exceed the level.
        level: which.
        floor: what values do not fall below; where they reach it, as forces do when a contact opens, no cubic follows.
    """
    inside = np.flatnonzero((time >= span[0]) & (time <= span[1]))
    low = inside[(inside > 0) & (inside < len(time) - 1)]
    bend = values[low - 1] - 2.0 * values[low] + values[np.minimum(low + 1, len(time) - 1)]
    least = (values[low] <= values[low - 1]) & (values[low] <= values[np.minimum(low + 1, len(time) - 1)])
    if len(time) < 6 or np.any(least & (values[low] - DIP * bend < level)):
        return np.inf
    spacing, total = float(time[1] - time[0]), 0.0
    for moment, outward in zip(span, (-1, 1), strict=True):
        if not np.isfinite(moment):
            continue
        k = min(max(int(np.searchsorted(time, moment)), 1), len(time) - 1)
        first = min(max(k - 3, 0), len(time) - 6)
        off = CUBIC * float(np.max(np.abs(np.diff(values[first : first + 6], 4))))
        steep = abs(float(values[k] - values[k - 1]))
        total += off / steep * spacing if steep > 0.0 else np.inf
        if np.min(values[max(k - 2, 0) : k + 2]) <= floor:  # the samples inside alone say where it ends
            last = k - 1 if outward > 0 else k
            near = values[last - 3 : last + 1] if outward > 0 else values[last : last + 4][::-1]
            if len(near) < 4:
                return np.inf
            beyond = float(4.0 * near[3] - 6.0 * near[2] + 4.0 * near[1] - near[0])
            share = (near[3] - level) / (near[3] - beyond) if beyond < near[3] else np.inf
            total += abs(float(time[last]) + outward * min(float(share), 1.0) * spacing - moment)
    return total
