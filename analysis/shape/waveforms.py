"""Velocity of chosen beads while a pulse passes them, collected in a second reading of a run, and what it says.

Each passage is watched for `REACH` beads of travel either side of the peak in at most `SAMPLES` frames, so that memory
depends on the number of passages only, not on how finely a run was recorded.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from analysis import hermite, motion
from analysis.between_frames import (
    LARGEST_UNCERTAINTY,
    Interpolated,
    derivatives,
    interpolated,
    moments,
    pairs_in,
    since_frames,
    steps_from,
)
from analysis.columns import Columns
from analysis.meters import Meter, Part
from analysis.shape.exact_wave import has_wave, wave_of
from analysis.shape.long_waves import length_of
from analysis.trajectory import Flags, Floats, Integers, Trajectory
from lammps_inputs import Problem, laws, physics

REACH = 4.0
"""Half the recorded distance, in beads of travel; the exact wave has fallen to 1e-10 of its peak there."""

COMPARED = 3.0
"""Half the distance over which the shape is compared, in beads; the exact wave has fallen to 1e-5 there."""

LARGER = 0.01
"""Part by which a velocity near a peak may exceed it, by the time between frames, where no larger pulse overlaps."""

MARGIN = 2.0
"""Error of the time at which the velocity falls to half its peak, over what a shift of the samples changes.

Uncertainties of widths then hold in 99 of 100 passages of installed scenes with frames 0.1 T to 1 T apart.
"""

SAMPLES = 128
"""Largest number of frames that are held for a passage."""


@dataclass(frozen=True)
class Passages(Columns):
    """Passages that are watched: one entry per passage of a pulse at a recorded bead.

    Attributes:
        chain, bead: counted from 1.
        arrival, peak_velocity, speed, direction: of the passage, see `analysis.tracking.pulses.Pulse`.
        arrival_error, peak_velocity_error, speed_error: bounds on their errors by the time between frames.
    """

    chain: Integers
    bead: Integers
    arrival: Floats
    peak_velocity: Floats
    speed: Floats
    direction: Integers
    arrival_error: Floats
    peak_velocity_error: Floats
    speed_error: Floats


@dataclass(frozen=True)
class Shape(Columns):
    """Quantities of the waveforms of passages, one entry per passage; NaN, but for energy, if not recorded completely.

    Attributes:
        width: full width at half maximum of the velocity, in beads: its duration times the local speed; NaN where that
            is not positive.
        width_error: its uncertainty by the time between frames, see `Waveforms._durations`, and by that of the speed.
        momentum: in units of m V, within `REACH` beads of travel from the peak; NaN where beads differ, or its
            uncertainty exceeds `LARGEST_UNCERTAINTY` of it.
        momentum_error: its uncertainty, see `Waveforms._momentum_error`; NaN as the momentum.
        energy: kinetic and of the contacts, within `reach` beads of the one that is passed, in units of m V**2; where
            only some beads are recorded, from the kinetic energy as in the exact wave (9/5 of it for spheres), and NaN
            where beads differ.
        energy_error: uncertainty of the energy by the time between frames; NaN where only some beads are recorded.
        residual: largest difference from the exact wave of the same peak velocity, in units of that; NaN where a
            larger pulse overlaps, or there is no exact wave.
        residual_error: its uncertainty by the time between frames, see `Waveforms._between_samples`, and by those of
            the peak velocity and the arrival.
    """

    width: Floats
    width_error: Floats
    momentum: Floats
    momentum_error: Floats
    energy: Floats
    energy_error: Floats
    residual: Floats
    residual_error: Floats

    def entry(self, k: int) -> dict[str, float]:
        """The numbers of one passage, by name."""
        return {name: float(column[k]) for name, column in self.arrays().items()}


def reach(problem: Problem) -> int:
    """Beads on either side of a pulse's peak that hold its energy: three, and more where pulses are longer."""
    return math.ceil(COMPARED * length_of(problem.system) - 1e-6)


class _Watched(NamedTuple):
    """What a part of a run shows of passages.

    Attributes:
        row, sample: [entry] positions of what is seen of them.
        velocity: [entry] along the pulse's direction, in units of V.
        weighed: [weighed] positions of the passages between two of the part's frames.
        energy: [frame before or after, derivative, weighed] energy near them, in units of m V**2 and T.
    """

    row: Integers
    sample: Integers
    velocity: Floats
    weighed: Integers
    energy: Floats


@dataclass(frozen=True, eq=False)
class WaveformMeter(Meter[_Watched, "Waveforms"]):
    """Waveforms of passages. Frames are evenly spaced.

    Attributes:
        problem: what was run.
        passages: the passages that are watched.
        weighed: [passage] whether the energy is measured, too; None for all.
    """

    problem: Problem
    passages: Passages
    weighed: Flags | None = None

    @cached_property
    def half(self) -> Floats:
        """Time of `REACH` beads of travel, [passage] in units of T."""
        passages = self.passages
        speed = np.where(np.isfinite(passages.speed) & (passages.speed > 0.0), passages.speed, np.nan)
        speed = np.where(np.isnan(speed), wave_of(self.problem.system).speed_at(passages.peak_velocity), speed)
        return np.asarray(REACH / speed)

    @cached_property
    def samples(self) -> tuple[Integers, Flags]:
        """Number of the frame of each sample, [passage, sample], and whether it is watched."""
        every = self.problem.every
        frames = np.ceil(self.half / every + 0.5)  # about the frame next to the arrival
        stride = np.maximum(1, np.ceil(2.0 * frames / SAMPLES)).astype(np.int64)
        half = np.minimum(np.ceil(frames / stride), SAMPLES // 2).astype(np.int64)
        centre = np.round(self.passages.arrival / every).astype(np.int64)
        offset = np.arange(-int(half.max(initial=0)), int(half.max(initial=0)) + 1)
        number = centre[:, np.newaxis] + offset * stride[:, np.newaxis]
        return number, (np.abs(offset) <= half[:, np.newaxis]) & (number >= 0)

    @cached_property
    def _ends(self) -> tuple[Integers, Integers]:
        """Numbers of the first and the last frame that are watched, each [passage]."""
        number, watched = self.samples
        largest = np.iinfo(np.int64).max
        first = np.min(np.where(watched, number, largest), axis=1, initial=largest)
        return first, np.max(np.where(watched, number, -1), axis=1, initial=-1)

    @cached_property
    def _column(self) -> Integers:
        """Position of each passage's bead, [passage], among those that are recorded."""
        return self.problem.rows.positions(self.passages.bead)

    @cached_property
    def _weighed_at(self) -> Floats:
        """Time at which the energy of a passage is measured, [passage]; NaN where it is not."""
        arrival = self.passages.arrival
        return arrival if self.weighed is None else np.where(self.weighed, arrival, np.nan)

    def of_part(self, part: Part) -> _Watched:
        """Velocities at frames of a part, and energies near passages between them."""
        block, start, end = part.frames, part.start, part.start + part.count
        first, last = self._ends
        passing = np.flatnonzero((first < end) & (last >= start))
        number, watched = (values[passing] for values in self.samples)
        row, sample = np.nonzero(watched & (number >= start) & (number < end))
        frame, row = number[row, sample] - start, passing[row]
        bead = self._column[row] - (block.first - 1)
        held = (bead >= 0) & (bead < block.velocity.shape[2])
        frame, row, sample, bead = frame[held], row[held], sample[held], bead[held]
        velocity = self.passages.direction[row] * block.velocity[frame, self.passages.chain[row] - 1, bead]
        return _Watched(row, sample, velocity, *self._weigh(part))

    def _weigh(self, part: Part) -> tuple[Integers, Floats]:
        """Passages between the frames of a part, [weighed], and energies near them, [frame, derivative, weighed]."""
        pairs = pairs_in(part, self._weighed_at)
        row = pairs.entry
        if not (self.problem.forces_known and len(row)):
            return np.zeros(0, dtype=np.int64), np.zeros((2, 3, 0))
        step = np.repeat(steps_from(pairs.block), len(row))
        frame = np.concatenate([pairs.frame, pairs.frame + 1])
        energy = self._energies(pairs.block, np.concatenate([row, row]), frame, step)
        return row, np.moveaxis(derivatives(energy, step).reshape((3, 2, len(row))), 1, 0)

    def result(self, pieces: list[_Watched]) -> "Waveforms":
        """The waveforms; NaN where there is no frame."""
        number, watched = self.samples
        velocity, energy = np.full(number.shape, np.nan), np.full((2, 3, len(self.passages)), np.nan)
        for piece in pieces:
            velocity[piece.row, piece.sample] = piece.velocity
            energy[..., piece.weighed] = piece.energy
        _, share = since_frames(self._weighed_at, self.problem.every)
        at_arrival = interpolated(energy, share, self.problem.every)
        time = np.asarray(number * self.problem.every, dtype=np.float64)
        return Waveforms(self.problem, self.passages, time, velocity, watched, self.half, at_arrival)

    def _energies(self, block: Trajectory, row: Integers, frame: Integers, step: Floats) -> Floats:
        """Energy near the beads of some passages at three moments beside chosen frames, [moment, entry].

        Args:
            block: frames of all beads.
            row: [entry] which passages.
            frame: [entry] positions of the frames.
            step: [entry] time from one moment to the next.
        """
        problem, beads = self.problem, block.velocity.shape[2]
        system, far = problem.system, reach(problem)
        place = (self.passages.bead[row] - block.first)[:, np.newaxis] + np.arange(-far, far + 1)
        exists, near = (place >= 0) & (place < beads), np.clip(place, 0, beads - 1)
        chain = np.broadcast_to((self.passages.chain[row] - 1)[:, np.newaxis], near.shape)
        at, bead = np.broadcast_to(frame[:, np.newaxis], near.shape), block.first - 1 + near
        x, v = (values[at, chain, near] for values in (block.displacement, block.velocity))
        acceleration, rate = motion.acceleration_and_rate(block, at, chain, near)
        x, v = moments(x, v, acceleration, rate, step[:, np.newaxis])
        kinetic = np.where(exists, 0.5 * physics.mass_of(system, chain, bead) * v * v, 0.0)
        apart = x[..., :-1] - x[..., 1:]
        contact = chain[:, :-1], np.minimum(bead[:, :-1], problem.beads - 2)
        energy = sum(laws.energy(laws.at(link.law, *contact), apart - link.gap_at(*contact)) for link in system.along)
        stored = np.where(exists[:, :-1] & exists[:, 1:], energy, 0.0)
        left_out = (place[:, 0] <= 0) & (block.first > 1)  # by a window, or the bead behind, which pushes the first
        return np.where(left_out, np.nan, kinetic.sum(axis=-1) + stored.sum(axis=-1))


@dataclass(frozen=True, eq=False)
class Waveforms:
    """Velocity of beads while pulses pass them.

    Attributes:
        problem: what was run.
        passages: the passages that are watched.
        time: [passage, sample], in units of T; regularly spaced, also where there is no frame.
        velocity: [passage, sample] along the pulse's direction, in units of V; NaN where there is no frame.
        watched: [passage, sample] whether a sample is within the time of the passage.
        half: half that time, [passage] in units of T.
        near: [passage] energy near the bead at the arrival, in units of m V**2; NaN where not measured.
    """

    problem: Problem
    passages: Passages
    time: Floats
    velocity: Floats
    watched: Flags
    half: Floats
    near: Interpolated

    def energy(self) -> tuple[Floats, Floats]:
        """Energies at the arrivals and their uncertainties, each [passage], in units of m V**2.

        The time between frames also leaves the arrival uncertain, by that time itself where a bead flies freely. NaN
        where not all beads are recorded, or the uncertainty exceeds `LARGEST_UNCERTAINTY` of the energy.
        """
        at_arrival = self.near
        late = self.passages.arrival_error
        error = at_arrival.uncertainty + np.where(np.isfinite(late), late, self.problem.every) * np.abs(at_arrival.rate)
        stated = error <= LARGEST_UNCERTAINTY * at_arrival.value
        return np.where(stated, at_arrival.value, np.nan), np.where(stated, error, np.nan)

    def shape(self) -> Shape:
        """Quantities of the waveforms, entry by entry of the passages."""
        passages, exact = self.passages, wave_of(self.problem.system)
        # beads may peak at one time or in reverse order, which is no speed of a wave
        forward = np.where(np.isfinite(passages.speed) & (passages.speed > 0.0), passages.speed, np.nan)
        peak = passages.peak_velocity[:, np.newaxis]
        late = self.time - passages.arrival[:, np.newaxis]
        watched = self.watched
        weight = self._weights(late, watched)
        complete = ~np.any(watched & np.isnan(self.velocity), axis=1)
        sign = np.where(complete, 1.0, np.nan)

        def travelled(values: Floats) -> Floats:
            """Integral of values [passage, sample] over the distance that the pulse travels, [passage]."""
            return np.asarray(np.sum(np.where(watched, values, 0.0) * weight, axis=1) * forward * sign)

        mass = np.reshape(physics.mass_of(self.problem.system, passages.chain - 1, passages.bead - 1), (-1, 1))
        kinetic_share = (exact.exponent + 1.0) / (exact.exponent + 3.0)
        kinetic = travelled(0.5 * mass * self.velocity**2)
        momentum = travelled(mass * self.velocity) if physics.alike(self.problem.system) else np.nan * kinetic
        momentum_error = self._momentum_error(momentum, mass[:, 0], forward)
        stated = momentum_error <= LARGEST_UNCERTAINTY * np.abs(momentum)
        alone = kinetic / kinetic_share if physics.alike(self.problem.system) else np.nan * kinetic
        energy, error = self.energy() if self.problem.rows.neighbours else (alone, np.full_like(alone, np.nan))
        xi = exact.speed_at(peak) * late
        difference = np.abs(self.velocity / peak - exact.velocity(xi))
        compared = watched & (np.abs(xi) <= COMPARED) & (np.abs(late) <= self.half[:, np.newaxis])
        overlapped = np.any(compared & (self.velocity > (1.0 + LARGER) * peak), axis=1)
        duration, duration_error = self._durations()
        residual = np.max(difference, axis=1, where=compared, initial=0.0)
        residual[overlapped | (not has_wave(self.problem.system))] = np.nan
        of_samples = (self._between_samples(difference, compared) - residual) * sign
        of_peak = passages.peak_velocity_error / passages.peak_velocity
        of_arrival = exact.steepest * exact.speed_at(passages.peak_velocity) * passages.arrival_error
        return Shape(
            width=duration * forward * sign,
            width_error=(duration_error * forward + (duration + duration_error) * passages.speed_error) * sign,
            momentum=np.where(stated, momentum, np.nan),
            momentum_error=np.where(stated, momentum_error, np.nan),
            energy=energy,
            energy_error=error,
            residual=residual * sign,
            residual_error=of_samples + 2.0 * of_peak + of_arrival,
        )

    def _between_samples(self, difference: Floats, compared: Flags) -> Floats:
        """Largest difference from the exact wave that a passage may have between its samples, [passage].

        That is the largest at the samples that are compared, with half of what it changes to a neighbouring sample,
        and at those beside them. It holds in 98 of 100 passages of installed scenes, with frames 0.1 T to 1 T apart.

        Args:
            difference: [passage, sample] size of the difference, over the peak velocity; NaN where there is no frame.
            compared: [passage, sample] whether the sample is compared.
        """
        before, after = ((0, 0), (1, 0)), ((0, 0), (0, 1))
        change = np.nan_to_num(np.abs(np.diff(difference, axis=1)))
        change = np.maximum(np.pad(change, before), np.pad(change, after))
        beside = self.watched & (np.pad(compared[:, :-1], before) | np.pad(compared[:, 1:], after))
        largest = np.max(np.nan_to_num(difference), axis=1, where=beside, initial=0.0)
        between = np.max(difference + 0.5 * change, axis=1, where=compared, initial=0.0)
        return np.asarray(np.maximum(largest, between))

    def _momentum_error(self, momentum: Floats, mass: Floats, speed: Floats) -> Floats:
        """Uncertainty of the momentum, in units of m V: of the integral, of the speed, and of where the pulse ends.

        It is the sum of the difference from the integral over every second frame, of the share by which the
        uncertainties of the arrivals at the two neighbours change the speed, and of the momentum of one bead of travel
        at either end: a pulse on a static load has not come to rest there.

        Args:
            momentum, mass, speed: [passage] in units of m V, m, and beads per T.
        """
        late, watched = self.time - self.passages.arrival[:, np.newaxis], self.watched
        velocity = np.where(watched, self.velocity, 0.0)
        seldom = np.sum(velocity[:, ::2] * self._weights(late[:, ::2], watched[:, ::2]), axis=1) * mass * speed
        step = late[:, 1:2] - late[:, :1] if late.shape[1] > 1 else 0.0
        ends = [
            np.max(np.abs(velocity), axis=1, where=np.abs(sign * late - self.half[:, np.newaxis]) <= step, initial=0.0)
            for sign in (-1.0, 1.0)
        ]
        of_speed = np.abs(momentum) * speed * self.passages.arrival_error
        return np.asarray(np.abs(momentum - seldom) + of_speed + mass * (ends[0] + ends[1]))

    def _weights(self, late: Floats, watched: Flags) -> Floats:
        """Weights [passage, sample] of the trapezoidal rule over `REACH` beads of travel before and after the peak.

        Args:
            late: [passage, sample] time since the arrival.
            watched: [passage, sample] whether there is a frame; the run begins with the first.
        """
        half = self.half[:, np.newaxis]
        start, end = np.clip(late[:, :-1], -half, half), np.clip(late[:, 1:], -half, half)
        length = np.where(watched[:, :-1] & watched[:, 1:], end - start, 0.0)
        later = length * (0.5 * (start + end) - late[:, :-1]) / (late[:, 1:] - late[:, :-1])
        weights = np.zeros(late.shape)
        weights[:, :-1] += length - later
        weights[:, 1:] += later
        return weights

    def _durations(self) -> tuple[Floats, Floats]:
        """Time for which the velocity exceeds half its peak, [passage], and its uncertainty; NaN where there is none.

        The uncertainty is what the error of the peak velocity changes, and at either end `MARGIN` times the largest
        change where the polynomial goes through samples that are shifted by one; where the velocity may have fallen so
        far between samples before, also the time since then.
        """
        above = self.velocity - 0.5 * self.passages.peak_velocity[:, np.newaxis]
        late = self.time - self.passages.arrival[:, np.newaxis]
        duration, error = np.zeros((2, len(above)))
        for values, time in ((above, late), (above[:, ::-1], -late[:, ::-1])):
            end, slope = hermite.first_fall(values, time)
            duration += end
            error += 0.5 * self.passages.peak_velocity_error / slope
            error += MARGIN * np.fmax(*(np.abs(hermite.first_fall(values, time, shift)[0] - end) for shift in (-1, 1)))
            error += self._since_dips(values, time, end)
        return duration, error

    def _since_dips(self, above: Floats, time: Floats, end: Floats) -> Floats:
        """Time from the first minimum that may lie below half the peak between samples to the end, [passage]; else 0.

        A parabola through a least sample and its neighbours is lower than that by an eighth of their second difference
        at most; twice as much counts.
        """
        before, least, after = above[:, :-2], above[:, 1:-1], above[:, 2:]
        bend, at = before - 2.0 * least + after, time[:, 1:-1]
        low = least - 0.25 * bend < 0.5 * self.passages.peak_velocity_error[:, np.newaxis]
        dips = low & (least <= before) & (least <= after) & (at > 0.0) & (at < end[:, np.newaxis])
        first = np.min(at, axis=1, where=dips, initial=np.inf)
        step = time[:, 1] - time[:, 0] if time.shape[1] > 1 else 0.0
        return np.where(np.isfinite(first), end - first + step, 0.0)
