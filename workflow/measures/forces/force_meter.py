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
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from analysis import hermite
from analysis.columns import Columns, together
from analysis.gauges.contact_curve import ContactCurve, ContactFrames, borders, excursion, maximum
from analysis.gauges.gauge import PULSE, Gauge, at_frames
from analysis.meters import Meter, Part
from analysis.trajectory import Flags, Floats, Integers, Trajectory
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
"""Share of the largest force above the static one that a panel's ends may be below it for the largest to be looked for
in it: forces are round enough for a panel to hide 0.2%.
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


@dataclass(frozen=True)
class _Changes(Columns):
    """Moments at which contacts close or open, each [change].

    Attributes:
        chain: number of the chain, from 0.
        place: position of the gauge.
        time: time of the change, in units of T.
        closes: whether the contact closes.
        rate: size of the rate of the strain then, in units of L / T.
    """

    chain: Integers
    place: Integers
    time: Floats
    closes: Flags
    rate: Floats


@dataclass(frozen=True)
class _Values(Columns):
    """Forces that may be the largest, each [value].

    Attributes:
        chain: number of the chain, from 0.
        place: position of the gauge.
        time: time of the value, in units of T.
        force: the force, in units of m V / T.
        error: uncertainty of a force that jumps, beside that of polynomials; 0 of others.
    """

    chain: Integers
    place: Integers
    time: Floats
    force: Floats
    error: Floats


class PartReadings(NamedTuple):
    """What gauges read in a part of a run.

    Attributes:
        time: [frame] in units of T.
        force: [frame, chain, gauge] at the frames.
        left_out: [0 or 1, frame, chain, gauge] differences of strain and force at frames that polynomials leave out;
            of all frames but the first and the last of the run.
        closed: [chain, gauge] whether the contact is closed at the first frame.
        between: [0 to 3, interval, chain, gauge] largest of the forces at borders of panels from a frame to the next,
            integral of the force above the static one, its uncertainty by the Gauss rules, integral of its size.
        values: forces that may be the largest.
        changes: moments at which contacts close or open.
    """

    time: Floats
    force: Floats
    left_out: Floats
    closed: Flags
    between: Floats
    values: _Values
    changes: _Changes


@dataclass(frozen=True)
class _Dwells:
    """Contacts, or times above the static force, in which the force was largest; each array [chain, gauge].

    Attributes:
        duration: of the contact, so far where it has not ended; 0 where the force never exceeds the static one.
        error: uncertainty of the duration: of its ends, and where the force may have been largest in others, of these.
        ended: whether the contact has ended by the last frame.
        contacts: how often the contact has closed.
    """

    duration: Floats
    error: Floats
    ended: Flags
    contacts: Integers


class _Contact(NamedTuple):
    """A contact, or time above the static force: start and end in units of T, and the uncertainty of their difference.

    The force belongs to another contact before ``earliest`` and after ``latest``.
    """

    start: float
    end: float
    error: float
    earliest: float
    latest: float


@dataclass(frozen=True)
class _Forces:
    """Forces of a run at frames, and what is known of them between frames.

    Attributes:
        time: [frame] in units of T.
        force: [frame, chain, gauge] at the frames.
        force_error, strain_error: [frame, chain, gauge] uncertainties of force and strain around each frame.
        top: [interval, chain, gauge] largest of the forces at borders of panels from a frame to the next.
        changes: moments at which contacts close or open.
        closed: [chain, gauge] whether the contact is closed at the first frame.
        largest, at: [chain, gauge] largest force, and its time.
        jump_error: [chain, gauge] uncertainty of the largest force where it jumps, beside that of polynomials.
        static: [chain, gauge] force at rest.
    """

    time: Floats
    force: Floats
    force_error: Floats
    strain_error: Floats
    top: Floats
    changes: _Changes
    closed: Flags
    largest: Floats
    at: Floats
    jump_error: Floats
    static: Floats

    def around(self, errors: Floats, time: float) -> float:
        """Larger one of errors, [frame], at the two frames around a time."""
        second = int(np.clip(np.searchsorted(self.time, time), 1, len(self.time) - 1))
        return float(np.max(errors[second - 1 : second + 1]))

    @property
    def risen(self) -> Flags:
        """Whether the force has exceeded the static one by more than the numerical noise, [chain, gauge]."""
        return np.asarray(self.largest - self.static > CLOSED * np.maximum(1.0, self.static))

    def largest_errors(self) -> tuple[Floats, Floats]:
        """Uncertainties of the largest forces and of their times, each [chain, gauge]."""
        error, late = np.full(self.largest.shape, np.inf), np.full(self.largest.shape, np.inf)
        if len(self.time) > 2:
            for chain, place in np.ndindex(*self.largest.shape):
                error[chain, place], late[chain, place] = self._largest_error(chain, place)
        return error + self.jump_error, late

    def _largest_error(self, chain: int, place: int) -> tuple[float, float]:
        """Uncertainties of the largest force of one chain and gauge, both by position, and of its time."""
        at, spacing = float(self.at[chain, place]), float(self.time[1] - self.time[0])
        possible, errors = self._possible(chain, place)
        error = float(np.max(errors[possible], initial=self.around(self.force_error[:, chain, place], at)))
        # about its maximum the force is a parabola
        middle = int(np.clip(round((at - self.time[0]) / spacing), 1, len(self.time) - 2))
        bend = -float(np.diff(self.force[middle - 1 : middle + 2, chain, place], 2)[0])
        width = spacing * min(np.sqrt(4.0 * error / bend), 1.0) if bend > 0.0 else spacing
        distance = np.abs(self._middles - at) + 0.5 * spacing
        other_peaks = distance[possible & self._peaks(chain, place) & (distance > 2.0 * spacing)]
        return error, float(np.max(other_peaks, initial=width))

    def _possible(self, chain: int, place: int) -> tuple[Flags, Floats]:
        """Whether the largest force may lie from a frame to the next, and its uncertainty there, each [interval]."""
        errors = self.force_error[:, chain, place]
        between, largest = np.maximum(errors[:-1], errors[1:]), float(self.largest[chain, place])
        nearest = self.around(errors, float(self.at[chain, place]))
        margin = nearest + HIDDEN * abs(largest - self.static[chain, place])
        return self.top[:, chain, place] + between >= largest - margin, between

    def _peaks(self, chain: int, place: int) -> Flags:
        """Whether the force is not larger in the intervals on either side, [interval]."""
        tops = self.top[:, chain, place]
        neighbours = np.pad(tops, 1, constant_values=-np.inf)
        return np.asarray((tops >= neighbours[:-2]) & (tops >= neighbours[2:]))

    @property
    def _middles(self) -> Floats:
        """Times halfway from a frame to the next, [interval]."""
        return 0.5 * (self.time[:-1] + self.time[1:])

    def dwells(self, late: Floats) -> _Dwells:
        """Contacts in which the force was largest; ``late`` is the uncertainty of its time, [chain, gauge]."""
        shape = self.largest.shape
        duration, error, ended = np.zeros(shape), np.zeros(shape), np.zeros(shape, dtype=bool)
        contacts, risen = np.zeros(shape, dtype=np.int64), self.risen
        for chain, place in np.ndindex(*shape):
            moments, at = self._moments(chain, place), float(self.at[chain, place])
            contacts[chain, place] = len(moments[0])
            if not risen[chain, place] or contacts[chain, place] == 0:
                continue
            contact = self._contact(chain, place, moments, at)
            duration[chain, place], ended[chain, place] = self._lasted(contact), contact.end <= self.time[-1]
            alike = [contact]
            if not (contact.earliest <= at - late[chain, place] and at + late[chain, place] <= contact.latest):
                peaks = self._middles[self._possible(chain, place)[0] & self._peaks(chain, place)]
                alike += [self._contact(chain, place, moments, time) for time in peaks.tolist()]
            errors = [abs(self._lasted(other) - self._lasted(contact)) + other.error for other in alike]
            error[chain, place] = np.max(errors)
        return _Dwells(duration, error, ended, contacts)

    def _lasted(self, contact: _Contact) -> float:
        """Duration of a contact within the record."""
        return min(contact.end, float(self.time[-1])) - max(contact.start, float(self.time[0]))

    def _contact(self, chain: int, place: int, moments: tuple[Floats, Floats], at: float) -> _Contact:
        """The contact, or time above the static force, about a time."""
        closing, opening = moments
        static = self.static[chain, place]
        if static > 0.0:
            above, level = self.force[:, chain, place] - static, PULSE * float(self.largest[chain, place] - static)
            span = excursion(self.time, above, at, level)
            return _Contact(*span, _excursion_error(self.time, above, at, level, span), *span)
        number = max(int(np.searchsorted(closing[:, 0], at, side="right")) - 1, 0)
        (start, early), (end, late) = closing[number].tolist(), opening[number].tolist()
        earliest = float(opening[number - 1, 0]) if number > 0 else -np.inf
        latest = float(closing[number + 1, 0]) if number + 1 < len(closing) else np.inf
        return _Contact(start, end, early + late, earliest, latest)

    def _moments(self, chain: int, place: int) -> tuple[Floats, Floats]:
        """Times at which a contact closes and opens, ascending, and their uncertainties, each [change, 0 or 1].

        It opens at infinity where that was not seen.
        """
        closing = [(float(self.time[0]), 0.0)] if self.closed[chain, place] else []
        opening: list[tuple[float, float]] = []
        changes = self.changes.where((self.changes.chain == chain) & (self.changes.place == place))
        for time, closes, rate in zip(changes.time.tolist(), changes.closes, changes.rate.tolist(), strict=True):
            off = self.around(self.strain_error[:, chain, place], time)
            (closing if closes else opening).append((time, off / rate if rate > 0.0 else np.inf))
        return np.array(sorted(closing)).reshape(-1, 2), np.array([*sorted(opening), (np.inf, 0.0)])


@dataclass(frozen=True)
class _Stretches:
    """Force of one gauge from frame to frame, [stretch]: those of all chains between two frames, and the next two.

    Attributes:
        gauge: the gauge.
        place: its position.
        curves: forces of its contacts.
        start: [stretch] time of the first frame, in units of T.
        spacing: time between frames, in units of T.
    """

    gauge: Gauge
    place: int
    curves: list[ContactCurve]
    start: Floats
    spacing: float

    @property
    def chain(self) -> Integers:
        """[stretch] number of the chain, from 0."""
        return self.curves[0].chain

    @property
    def border(self) -> Floats:
        """[border] from 0 to 1."""
        return borders(self.spacing)

    @cached_property
    def moving(self) -> Integers:
        """Positions of the stretches in which anything moves, [moving]."""
        return np.flatnonzero(np.any([np.any(curve.polynomial != 0.0, axis=0) for curve in self.curves], axis=0))

    @cached_property
    def forces(self) -> Floats:
        """Forces at borders of panels, [border, stretch]."""
        return self._at_borders(lambda curve, s: curve(s))

    @cached_property
    def elastic(self) -> Floats:
        """Forces without those of dashpots, [border, stretch]."""
        return self._at_borders(lambda curve, s: curve.elastic(s)) if self.gauge.damped else self.forces

    def _at_borders(self, force: Callable[[ContactCurve, Floats], Floats]) -> Floats:
        forces = np.tile(self.gauge.static[self.chain], (len(self.border), 1))
        forces[:, self.moving] = 0.0
        for curve in self.curves:
            single = curve.of(self.moving)
            at_borders = [force(single, np.full(len(self.moving), s)) for s in self.border]
            forces[:, self.moving] += np.stack(at_borders) / len(self.curves)
        return forces

    def mean(self, entry: Integers, s: Floats) -> Floats:
        """Mean force of the contacts at s in chosen stretches, both [entry]."""
        return np.asarray(sum(curve.of(entry)(s) for curve in self.curves)) / len(self.curves)

    def totals(self) -> Floats:
        """Largest at borders of panels, and integrals as of `PartReadings`, [0 to 3, stretch]."""
        chain, moving = self.chain, self.moving
        impulse, quadrature = np.zeros((2, len(chain)))
        for curve in self.curves:
            integral, error = curve.of(moving).integral(self.border)
            static = curve.probe.static[chain[moving]]
            impulse[moving] += (integral - static) * self.spacing / len(self.curves)
            quadrature[moving] += error * self.spacing / len(self.curves)
        size = np.mean(np.abs(self.forces - self.gauge.static[chain]), axis=0) * self.spacing
        return np.stack([self.forces.max(axis=0), impulse, quadrature, size])

    def changes(self) -> _Changes:
        """Moments at which contacts close or open; of a sensor, when the first closes and the last opens."""
        shut, count = self.elastic > CLOSED, len(self.curves)
        panel, entry = np.nonzero(shut[:-1] != shut[1:])
        before, changing = shut[panel, entry], [curve.of(entry) for curve in self.curves]

        def closed(s: Floats) -> Flags:
            """Whether the changing contacts are closed at s, [entry]."""
            return np.asarray(sum(curve.elastic(s) for curve in changing)) / count > CLOSED

        at = hermite.change(closed, before, self.border[panel], self.border[panel + 1])
        rate = np.abs(np.sum([curve.rate(at) for curve in changing], axis=0) / count)
        time = self.start[entry] + at * self.spacing
        return _Changes(self.chain[entry], np.full(len(entry), self.place), time, ~before, rate)

    def jumps(self) -> _Values:
        """Forces where any of the contacts closes: that of its dashpot may jump to its largest there."""
        entries, instants = [self.moving[:0]], [self.border[:0]]
        for curve in self.curves if self.gauge.damped else ():
            moving = curve.of(self.moving)
            shut = np.stack([moving.elastic(np.full(len(self.moving), s)) for s in self.border]) > CLOSED
            panel, place = np.nonzero(~shut[:-1] & shut[1:])
            closing = moving.of(place)
            at = hermite.change(
                lambda s, closing=closing: closing.elastic(s) > CLOSED,  # type: ignore[misc]
                np.False_,
                self.border[panel],
                self.border[panel + 1],
            )
            entries.append(self.moving[place])
            instants.append(np.minimum(at + _JUST, 1.0))
        entry, s = np.concatenate(entries), np.concatenate(instants)
        values = self._values(entry, s)
        # polynomials go through the jump of the acceleration, and those of the frame before do not
        before = replace(self, curves=[curve.up_to_a_jump() for curve in self.curves])
        return replace(values, error=np.abs(before.mean(entry, s) - values.force))

    def nearly_largest(self, so_far: Floats) -> _Values:
        """Maxima between frames where borders are nearly the largest, or what is already known, [chain]."""
        values = self.forces.max(axis=0).reshape(-1, len(so_far))
        largest = np.maximum(values.max(axis=0), so_far)
        above = np.abs(largest - self.gauge.static)
        entry = np.flatnonzero(values > largest - NEARLY * above)
        top = np.argmax(self.forces[:, entry], axis=0)
        low, high = self.border[np.maximum(top - 1, 0)], self.border[np.minimum(top + 1, len(self.border) - 1)]
        return self._values(entry, maximum(lambda s: self.mean(entry, s), low, high))

    def _values(self, entry: Integers, s: Floats) -> _Values:
        """Forces at s in chosen stretches, both [entry]."""
        place, time = np.full(len(entry), self.place), self.start[entry] + s * self.spacing
        return _Values(self.chain[entry], place, time, self.mean(entry, s), np.zeros(len(entry)))


@dataclass(frozen=True)
class ForceMeter(Meter[PartReadings, Readings]):
    """Readings of gauges.

    Attributes:
        problem: what was run.
        gauges: the gauges.
    """

    problem: Problem
    gauges: tuple[Gauge, ...]

    def of_part(self, part: Part) -> PartReadings:
        """What the gauges read at the frames of a part, and from each to the next."""
        before = min(part.before, 1)
        block = part.around[part.before - before : part.before + part.count + 1]
        every_force = at_frames(block, self.gauges)
        time, force = (values[before : before + part.count].copy() for values in (block.time, every_force))
        highest = np.max(force, axis=0)
        chain, place = (index.ravel() for index in np.indices(highest.shape))
        values = [_Values(chain, place, time[np.argmax(force, axis=0)].ravel(), highest.ravel(), 0.0 * chain)]
        changes = [_Changes(chain[:0], place[:0], time[:0], time[:0] > 0.0, time[:0])]
        intervals, step = block.frames - 1 - before, max(1, MOST_ENTRIES // self.problem.chains)
        between = np.zeros((4, intervals, *highest.shape))
        off = np.zeros((2, max(0, block.frames - 2), *highest.shape))
        for number, gauge in enumerate(self.gauges):
            contacts = [ContactFrames.of(block, probe) for probe in gauge.probes]
            off[..., number] = _left_out(gauge, contacts, every_force[..., number], block)
            for start in range(0, intervals, step):
                frames = slice(before + start, before + start + step + 1)
                stretches = _stretches(gauge, number, contacts, block, frames)
                between[:, start : start + step, :, number] = stretches.totals().reshape(4, -1, len(highest))
                changes.append(stretches.changes())
                jumps = stretches.jumps()
                so_far = highest[:, number].copy()
                np.maximum.at(so_far, jumps.chain, jumps.force)
                values += [jumps, stretches.nearly_largest(so_far)]
        closed = at_frames(part.frames[:1], self.gauges, dashpots=False)[0] > CLOSED
        return PartReadings(time, force, off, closed, between, together(values), together(changes))

    def result(self, pieces: list[PartReadings]) -> Readings:
        """Readings of all frames."""
        forces = self._joined(pieces)
        impulse, quadrature, size = _in_order([piece.between[1:] for piece in pieces])
        excess = np.max(np.abs(forces.force - forces.static), axis=0)
        excess = np.maximum(excess, np.abs(forces.largest - forces.static))
        largest_error, at_error = forces.largest_errors()
        stated = largest_error <= np.maximum(LARGEST_UNCERTAINTY * excess, FAINT)
        risen = stated & forces.risen
        spacing = self.problem.every if len(forces.time) < 2 else float(forces.time[1] - forces.time[0])
        impulse_error = spacing * np.sum(forces.force_error, axis=0) + quadrature
        certain = impulse_error <= np.maximum(LARGEST_UNCERTAINTY * size, FAINT)
        dwells = forces.dwells(at_error)
        lasting = stated & (dwells.error <= LARGEST_UNCERTAINTY * dwells.duration)
        return Readings(
            gauges=self.gauges,
            time=forces.time,
            force=forces.force,
            static=forces.static,
            largest=np.where(stated, forces.largest, np.nan),
            at=np.where(risen, forces.at, np.nan),
            impulse=np.where(certain, impulse, np.nan),
            dwell=np.where(lasting, dwells.duration, np.nan),
            largest_error=np.where(stated, largest_error, np.nan),
            at_error=np.where(risen, at_error, np.nan),
            impulse_error=np.where(certain, impulse_error, np.nan),
            dwell_error=np.where(lasting, dwells.error, np.nan),
            ended=dwells.ended,
            contacts=dwells.contacts,
        )

    def _joined(self, pieces: list[PartReadings]) -> _Forces:
        """Forces of all parts; uncertainties around the first and the last frame are those around the frame beside."""
        time, force = (np.concatenate(values) for values in list(zip(*pieces, strict=True))[:2])
        off = np.concatenate([piece.left_out for piece in pieces], axis=1)
        if off.shape[1]:
            strain_error, force_error = np.pad(HALF_AS_FAR * off, ((0, 0), (1, 1), (0, 0), (0, 0)), mode="edge")
        else:
            strain_error = force_error = np.full(force.shape, np.inf)
        values = together([piece.values for piece in pieces])
        values = values.where(np.lexsort((-values.time, values.force)))
        largest, at, jump_error = np.empty((3, *force.shape[1:]))
        for kept, column in ((largest, values.force), (at, values.time), (jump_error, values.error)):
            kept[values.chain, values.place] = column  # the last stay
        return _Forces(
            time,
            force,
            force_error,
            strain_error,
            np.concatenate([piece.between[0] for piece in pieces]),
            together([piece.changes for piece in pieces]),
            pieces[0].closed,
            largest,
            at,
            jump_error,
            np.stack([gauge.static for gauge in self.gauges], axis=-1),
        )


def _in_order(parts: list[Floats]) -> Floats:
    """Sums over intervals, [quantity, ...] from [quantity, interval, ...], one by one: wherever parts begin."""
    total = np.zeros_like(parts[0][:, :1])
    for part in parts:
        total = np.add.accumulate(np.concatenate([total, part], axis=1), axis=1)[:, -1:]
    return total[:, 0]


def _stretches(gauge: Gauge, place: int, contacts: list[ContactFrames], block: Trajectory, frames: slice) -> _Stretches:
    """Force of a gauge from some frames of a block to the next, by the frames of its contacts."""
    chains = np.arange(block.problem.chains)
    curves = [
        ContactCurve.between(probe, contact.near(frames, chains), chains, block.spacing)
        for probe, contact in zip(gauge.probes, contacts, strict=True)
    ]
    return _Stretches(gauge, place, curves, np.repeat(block.time[frames][:-1], len(chains)), block.spacing)


def _left_out(gauge: Gauge, contacts: list[ContactFrames], force: Floats, block: Trajectory) -> Floats:
    """Errors at each frame of polynomials from the frame before to the frame after it.

    Args:
        gauge: the gauge whose force and strain are taken.
        contacts: frames of its contacts.
        force: [frame, chain] its force.
        block: the frames, evenly spaced.

    Returns:
        Differences of the strain, the largest of any contact, and of the force from those at the frame, of all frames
        but the first and the last, [0 or 1, frame, chain].
    """
    chains = np.arange(force.shape[1])
    difference = np.zeros((2, max(0, len(force) - 2), len(chains)))
    for first in range(min(2, len(force) - 2)):
        frames = slice(first + 1, len(force) - 1, 2)
        between = np.zeros_like(force[frames])
        for probe, contact in zip(gauge.probes, contacts, strict=True):
            every_second = contact.near(slice(first, None, 2), chains)
            curve = ContactCurve.between(probe, every_second, chains, 2.0 * block.spacing)
            middle = np.full(curve.chain.shape, 0.5)
            between += curve(middle).reshape(between.shape) / len(contacts)
            strain = contact.strain[0, frames]
            off = np.abs(hermite.value(curve.polynomial, middle).reshape(strain.shape) - strain)
            difference[0, first::2] = np.maximum(difference[0, first::2], off)
        difference[1, first::2] = np.abs(between - force[frames])
    return difference


def _excursion_error(time: Floats, values: Floats, at: float, level: float, span: tuple[float, float]) -> float:
    """Uncertainty of the duration of an `excursion`: its difference from that of every second frame.

    The larger one, from the first frame or from the second on; NaN where every second frame shows none.
    """
    ends = np.isfinite(span)
    others = [excursion(time[first::2], values[first::2], at, level) for first in (0, 1)]
    return float(np.max([np.sum(np.abs(np.array(other)[ends] - np.array(span)[ends])) for other in others]))
