"""Force over time as it is measured: on walls, in contacts, and inside a bead, with what a gauge there would report.

Force follows from displacements. Between two frames a displacement is the polynomial of degree five through its value
and two derivatives there (degree three, where the beads around were not recorded), so that a force is known at any
time: its impulse is an integral by Gauss rules, cut where a contact opens or closes; its largest value lies between
frames, and so do the moments at which contacts open and close. A contact that acts at a distance may pull: its force is
then negative, and it counts as closed while it pushes.

How far a force between frames may be off is measured at every frame: the polynomial from the frame before to the frame
after it leaves out the frame between them. The uncertainty between frames half as far apart is a quarter of the
difference there, with a margin, as polynomials are off by the square of the time between frames or by a higher power of
it. The uncertainties of the largest force, its time, impulses and dwells follow from that. A number that is too
uncertain is not stated.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from analysis import hermite
from analysis.gauges.gauge import (
    PULSE,
    ContactCurve,
    ContactFrames,
    Gauge,
    at_frames,
    borders,
    excursion,
    maximum,
)
from analysis.trajectory import Flags, Floats, Integers, Trajectory, joined
from lammps_inputs import Problem
from workflow.measures.forces.readings import Readings

LARGEST_UNCERTAINTY = 0.05
"""Uncertainty beyond which a number is not stated: of a largest force, as a share of its excess over the static one; of
an impulse, as a share of the integral of the size of that excess; of a dwell, as a share of the dwell.
"""

FAINT = 1e-5
"""Uncertainty of forces and impulses, in m V / T and m V, up to which they are stated however small they are."""

CLOSED = 1e-9
"""Force from which on a contact counts as closed, of an overlap of 1e-6, far above rounding: behind a pulse beads touch
with hardly any force.
"""

NEARLY = 0.01
"""Share of the largest force that a panel's ends may be below it for the largest to be looked for in it: forces are
round enough for a panel to hide 0.2%.
"""

HIDDEN = 0.002
"""Share of the largest force by which the ends of a panel may be below a maximum in it."""

HALF_AS_FAR = 0.3
"""Error of a polynomial between frames half as far apart, over that between the others: a quarter, where it falls with
the square of the time between them, and a margin. With a quarter, a few of about 1,800 numbers that were counted were
off by more, by up to a fifth; so their share, about one in a thousand, is known to its order of magnitude only.
"""

_JUST = 1e-9
"""Share of the time between frames after which the force of a contact that has closed is taken."""

MOST_ENTRIES = 4000
"""Stretches from frame to frame that are looked at together."""


class _Changes(NamedTuple):
    """Moments at which contacts close or open, each [change].

    Attributes:
        chain: number of the chain, from 0.
        time: time of the change, in units of T.
        closes: whether the contact closes.
        rate: size of the rate of the strain then, in units of L / T.
    """

    chain: Integers
    time: Floats
    closes: Flags
    rate: Floats


@dataclass(frozen=True)
class _Dwells:
    """Contacts, or times above the static force, in which the force was largest; each array [chain, gauge].

    Attributes:
        duration: of the contact, so far where it has not ended; 0 where the force never exceeds the static one.
        error: uncertainty of the duration.
        earliest, latest: time before and after which the force belongs to another contact.
        ended: whether the contact has ended by the last frame.
        contacts: how often the contact has closed.
    """

    duration: Floats
    error: Floats
    earliest: Floats
    latest: Floats
    ended: Flags
    contacts: Integers


@dataclass(frozen=True)
class _Frames:
    """Forces at frames, and what polynomials between frames are off by; each array but time [frame, chain, gauge].

    Attributes:
        time: [frame].
        force: at the frames.
        force_error: uncertainty of the force around each frame.
        strain_error: uncertainty of the strain around each frame.
    """

    time: Floats
    force: Floats
    force_error: Floats
    strain_error: Floats

    def around(self, errors: Floats, time: float) -> float:
        """Larger one of errors, [frame], at the two frames around a time."""
        second = int(np.clip(np.searchsorted(self.time, time), 1, len(self.time) - 1))
        return float(np.max(errors[second - 1 : second + 1]))


class ForceMeter:
    """Reads gauges in a run that is given piece by piece; holds two frames and the numbers of the gauges."""

    def __init__(self, problem: Problem, gauges: tuple[Gauge, ...]) -> None:
        self.problem = problem
        self.gauges = gauges
        shape = (problem.chains, len(gauges))
        self._time: list[Floats] = []
        self._force: list[Floats] = []
        self._residuals: list[Floats] = []
        """Differences of strain and force at frames that polynomials leave out, [0 or 1, frame, chain, gauge]."""
        self._static = np.stack([gauge.static for gauge in gauges], axis=-1)
        self._largest, self._at = np.full(shape, -np.inf), np.full(shape, np.nan)
        self._impulse, self._quadrature, self._size = np.zeros((3, *shape))
        self._closed = np.zeros(shape, dtype=bool)
        self._changes: list[list[_Changes]] = [[] for _ in gauges]
        self._tops: list[list[Floats]] = [[] for _ in gauges]
        """Largest of the values at borders of each stretch, [interval, chain], by gauge and block."""
        self._carried: Trajectory | None = None

    def add(self, block: Trajectory) -> None:
        """Take the next frames, evenly spaced in time with those before."""
        force = at_frames(block, self.gauges)
        first = np.argmax(force, axis=0)
        largest = np.max(force, axis=0)
        self._at = np.where(largest > self._largest, block.time[first], self._at)
        self._largest = np.maximum(self._largest, largest)
        self._time.append(block.time.copy())
        self._force.append(force)
        before = 0
        if self._carried is not None:
            before = self._carried.frames
            block = joined([self._carried, block])
        else:
            self._closed = at_frames(block[:1], self.gauges, dashpots=False)[0] > CLOSED
        self._residuals.append(np.stack([left_out(block, gauge) for gauge in self.gauges], axis=-1))
        step = max(1, MOST_ENTRIES // self.problem.chains)
        for start in range(max(0, before - 1), block.frames - 1, step):
            part = block[start : start + step + 1]
            for place, gauge in enumerate(self.gauges):
                self._read(part, place, gauge)
        self._carried = block.last(2)

    def result(self) -> Readings:
        """Readings of the frames so far.

        Raises:
            ValueError: there was none.
        """
        if not self._time:
            raise ValueError("no frames to read forces from")
        frames = self._frames()
        excess = np.max(np.abs(frames.force - self._static), axis=0)
        excess = np.maximum(excess, np.abs(self._largest - self._static))
        largest_error, at_error = self._largest_errors(frames)
        stated = largest_error <= np.maximum(LARGEST_UNCERTAINTY * excess, FAINT)
        risen = stated & self._risen()
        spacing = self.problem.every if len(frames.time) < 2 else float(frames.time[1] - frames.time[0])
        impulse_error = spacing * np.sum(frames.force_error, axis=0) + self._quadrature
        certain = impulse_error <= np.maximum(LARGEST_UNCERTAINTY * self._size, FAINT)
        dwells = self._dwells(frames)
        same_contact = (dwells.earliest <= self._at - at_error) & (self._at + at_error <= dwells.latest) | ~risen
        lasting = stated & same_contact & (dwells.error <= LARGEST_UNCERTAINTY * dwells.duration)
        return Readings(
            gauges=self.gauges,
            time=frames.time,
            force=frames.force,
            static=self._static,
            largest=np.where(stated, self._largest, np.nan),
            at=np.where(risen, self._at, np.nan),
            impulse=np.where(certain, self._impulse, np.nan),
            dwell=np.where(lasting, dwells.duration, np.nan),
            largest_error=np.where(stated, largest_error, np.nan),
            at_error=np.where(risen, at_error, np.nan),
            impulse_error=np.where(certain, impulse_error, np.nan),
            dwell_error=np.where(lasting, dwells.error, np.nan),
            ended=dwells.ended,
            contacts=dwells.contacts,
        )

    def _frames(self) -> _Frames:
        """All frames, with uncertainties around the first and the last frame as around those beside them."""
        time, force = np.concatenate(self._time), np.concatenate(self._force)
        residuals = np.concatenate(self._residuals, axis=1)
        if residuals.shape[1] == 0:
            unknown = np.full(force.shape, np.inf)
            return _Frames(time, force, unknown, unknown)
        strain, size = np.pad(HALF_AS_FAR * residuals, ((0, 0), (1, 1), (0, 0), (0, 0)), mode="edge")
        return _Frames(time, force, size, strain)

    def _risen(self) -> Flags:
        """Whether the force has exceeded the static one by more than the numerical noise, [chain, gauge]."""
        return np.asarray(self._largest - self._static > CLOSED * np.maximum(1.0, self._static))

    def _largest_errors(self, frames: _Frames) -> tuple[Floats, Floats]:
        """Uncertainties of the largest forces and of their times, each [chain, gauge]."""
        error, late = np.full(self._largest.shape, np.inf), np.full(self._largest.shape, np.inf)
        if len(frames.time) < 3:
            return error, late
        for place, blocks in enumerate(self._tops):
            tops = np.concatenate(blocks)
            for chain in range(self.problem.chains):
                error[chain, place], late[chain, place] = self._largest_error(frames, tops[:, chain], chain, place)
        return error, late

    def _largest_error(self, frames: _Frames, tops: Floats, chain: int, place: int) -> tuple[float, float]:
        """Uncertainties of the largest force of one gauge and chain, and of its time.

        Args:
            frames: all of them.
            tops: [interval] largest of the values at borders between two frames.
            chain: number of the chain, from 0.
            place: position of the gauge.
        """
        at, largest = float(self._at[chain, place]), float(self._largest[chain, place])
        spacing, errors = float(frames.time[1] - frames.time[0]), frames.force_error[:, chain, place]
        between = np.maximum(errors[:-1], errors[1:])
        nearest = frames.around(errors, at)
        margin = nearest + HIDDEN * abs(largest - self._static[chain, place])
        possible = tops + between >= largest - margin
        error = float(np.max(between[possible], initial=nearest))
        # about its maximum the force is a parabola
        middle = int(np.clip(round((at - frames.time[0]) / spacing), 1, len(frames.time) - 2))
        bend = -float(np.diff(frames.force[middle - 1 : middle + 2, chain, place], 2)[0])
        width = spacing * min(np.sqrt(4.0 * error / bend), 1.0) if bend > 0.0 else spacing
        neighbours = np.pad(tops, 1, constant_values=-np.inf)
        peaks = possible & (tops >= neighbours[:-2]) & (tops >= neighbours[2:])
        distance = np.abs(frames.time[:-1] + 0.5 * spacing - at) + 0.5 * spacing
        other_peaks = distance[peaks & (distance > 2.0 * spacing)]
        return error, float(np.max(other_peaks, initial=width))

    def _dwells(self, frames: _Frames) -> _Dwells:
        """Contacts in which the force was largest."""
        shape = self._largest.shape
        start, end, error = np.full(shape, np.nan), np.full(shape, np.nan), np.zeros(shape)
        earliest, latest = np.full(shape, -np.inf), np.full(shape, np.inf)
        contacts, risen, time = np.zeros(shape, dtype=np.int64), self._risen(), frames.time
        for chain, place in np.ndindex(*shape):
            strain_error = frames.strain_error[:, chain, place]
            closing, opening = self._moments(chain, place, frames, strain_error)
            contacts[chain, place] = len(closing)
            if not risen[chain, place] or len(closing) == 0:
                continue
            at, static = float(self._at[chain, place]), self._static[chain, place]
            number = max(int(np.searchsorted(closing[:, 0], at, side="right")) - 1, 0)
            first, last = closing[number], opening[number]
            start[chain, place], end[chain, place], error[chain, place] = first[0], last[0], first[1] + last[1]
            if number > 0:
                earliest[chain, place] = opening[number - 1][0]
            if number + 1 < len(closing):
                latest[chain, place] = closing[number + 1][0]
            if static > 0.0:
                above = frames.force[:, chain, place] - static
                level = PULSE * float(self._largest[chain, place] - static)
                span = excursion(time, above, at, level)
                start[chain, place], end[chain, place] = earliest[chain, place], latest[chain, place] = span
                error[chain, place] = _excursion_error(time, above, at, level, span)
        duration = np.where(risen & (contacts > 0), np.minimum(end, time[-1]) - np.maximum(start, time[0]), 0.0)
        return _Dwells(duration, error, earliest, latest, end <= time[-1], contacts)

    def _moments(self, chain: int, place: int, frames: _Frames, strain_error: Floats) -> tuple[Floats, Floats]:
        """Times at which a contact closes and opens, ascending, and their uncertainties, each [change, 0 or 1].

        It opens at infinity where that was not seen.
        """
        closing = [(float(frames.time[0]), 0.0)] if self._closed[chain, place] else []
        opening: list[tuple[float, float]] = []
        for changes in self._changes[place]:
            for entry in np.flatnonzero(changes.chain == chain):
                time, rate = float(changes.time[entry]), float(changes.rate[entry])
                off = frames.around(strain_error, time)
                moment = (time, off / rate if rate > 0.0 else np.inf)
                (closing if changes.closes[entry] else opening).append(moment)
        return np.array(sorted(closing)).reshape(-1, 2), np.array([*sorted(opening), (np.inf, 0.0)])

    def _read(self, block: Trajectory, place: int, gauge: Gauge) -> None:
        """Take in what one gauge reads from the first frame of a block to its last."""
        spacing, chains = block.spacing, np.arange(self.problem.chains)
        curves = [
            ContactCurve.between(probe, ContactFrames.of(block, probe), chains, spacing) for probe in gauge.probes
        ]
        chain = curves[0].chain
        moving = np.flatnonzero(np.any([np.any(curve.polynomial != 0.0, axis=0) for curve in curves], axis=0))
        border = borders(spacing)
        static = gauge.static[chain]
        forces = np.tile(static, (len(border), 1))
        forces[:, moving] = 0.0
        pressing = forces.copy() if gauge.damped else forces
        impulse, quadrature = np.zeros((2, len(chain)))
        for curve in curves:
            single = curve.of(moving)
            at_borders = [np.full(len(moving), s) for s in border]
            forces[:, moving] += np.stack([single(s) for s in at_borders]) / len(curves)
            if gauge.damped:
                pressing[:, moving] += np.stack([single.elastic(s) for s in at_borders]) / len(curves)
            integral, error = single.integral(border)
            impulse[moving] += (integral - curve.probe.static[chain[moving]]) * spacing / len(curves)
            quadrature[moving] += error * spacing / len(curves)
        # term by term: the order must not depend on how many there are at once
        np.add.at(self._impulse[:, place], chain, impulse)
        np.add.at(self._quadrature[:, place], chain, quadrature)

        def mean(entry: Integers, s: Floats) -> Floats:
            """Mean force of the contacts at s in chosen stretches, both [entry]."""
            return np.asarray(sum(curve.of(entry)(s) for curve in curves)) / len(curves)

        shut = pressing > CLOSED
        panel, entry = np.nonzero(shut[:-1] != shut[1:])
        before, changing = shut[panel, entry], [curve.of(entry) for curve in curves]

        def closed(s: Floats) -> Flags:
            """Whether the changing contacts are closed at s, [entry]."""
            return np.asarray(sum(curve.elastic(s) for curve in changing)) / len(curves) > CLOSED

        at = hermite.change(closed, before, border[panel], border[panel + 1])
        start = np.repeat(block.time[:-1], self.problem.chains)[entry]
        rate = np.sum([curve.of(entry).rate(at) for curve in curves], axis=0) / len(curves)
        self._changes[place].append(_Changes(entry % self.problem.chains, start + at * spacing, ~before, np.abs(rate)))
        if gauge.damped:  # a dashpot's force may jump to its largest where a contact closes
            entry, after = entry[~before], np.minimum(at[~before] + _JUST, 1.0)
            self._take_values(place, entry, start[~before] + after * spacing, mean(entry, after))
        np.add.at(self._size[:, place], chain, np.mean(np.abs(forces - static), axis=0) * spacing)
        self._take_largest(place, block, forces.reshape(len(border), -1, self.problem.chains), border, mean)

    def _take_values(self, place: int, entry: Integers, time: Floats, value: Floats) -> None:
        """Take values at times for the largest, where they are larger than those so far."""
        chain = entry % self.problem.chains
        for k in np.argsort(value):
            if value[k] > self._largest[chain[k], place]:
                self._largest[chain[k], place] = value[k]
                self._at[chain[k], place] = time[k]

    def _take_largest(
        self,
        place: int,
        block: Trajectory,
        forces: Floats,
        border: Floats,
        mean: Callable[[Integers, Floats], Floats],
    ) -> None:
        """Refine what is nearly the largest of the values at borders, [border, interval, chain]."""
        value = forces.max(axis=0)
        self._tops[place].append(value)
        largest = np.maximum(value.max(axis=0), self._largest[:, place])
        interval, chain = np.nonzero(value > largest - NEARLY * np.abs(largest))
        top = np.argmax(forces[:, interval, chain], axis=0)
        low, high = border[np.maximum(top - 1, 0)], border[np.minimum(top + 1, len(border) - 1)]
        entry = interval * forces.shape[2] + chain
        at = maximum(lambda s: mean(entry, s), low, high)
        self._take_values(place, entry, block.time[interval] + at * block.spacing, mean(entry, at))


def left_out(block: Trajectory, gauge: Gauge) -> Floats:
    """Errors at each frame of polynomials from the frame before to the frame after it.

    Args:
        block: evenly spaced frames.
        gauge: the gauge whose force and strain are taken.

    Returns:
        Differences of the strain, the largest of any contact, and of the force from those at the frame, of all frames
        but the first and the last, [0 or 1, frame, chain].
    """
    chains = np.arange(block.problem.chains)
    difference = np.zeros((2, max(0, block.frames - 2), len(chains)))
    exact = at_frames(block, (gauge,))[..., 0]
    for first in (0, 1):
        part = block[first::2]
        if part.frames < 2:
            continue
        force = np.zeros((part.frames - 1) * len(chains))
        for probe in gauge.probes:
            curve = ContactCurve.between(probe, ContactFrames.of(part, probe), chains, part.spacing)
            middle = np.full(len(force), 0.5)
            force += curve(middle) / len(gauge.probes)
            between = ContactFrames.of(block, probe).strain[0, first + 1 : block.frames - 1 : 2]
            off = np.abs(hermite.value(curve.polynomial, middle).reshape(between.shape) - between)
            difference[0, first::2] = np.maximum(difference[0, first::2], off)
        between = exact[first + 1 : block.frames - 1 : 2]
        difference[1, first::2] = np.abs(force.reshape(between.shape) - between)
    return difference


def _excursion_error(time: Floats, values: Floats, at: float, level: float, span: tuple[float, float]) -> float:
    """Uncertainty of the duration of an `excursion`: its difference from that of every second frame.

    The larger one, from the first frame or from the second on; NaN where every second frame shows none.
    """
    ends = np.isfinite(span)
    others = [excursion(time[first::2], values[first::2], at, level) for first in (0, 1)]
    return float(np.max([np.sum(np.abs(np.array(other)[ends] - np.array(span)[ends])) for other in others]))
