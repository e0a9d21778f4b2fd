"""Velocity of chosen beads while a pulse passes them, collected in a second reading of a run, and what it says.

Each passage is watched for `REACH` beads of travel either side of the peak in at most `SAMPLES` frames, so that memory
depends on the number of passages only, not on how finely a run was recorded.
"""

import math
from dataclasses import dataclass

import numpy as np

from analysis import hermite, motion
from analysis.between_frames import LARGEST_UNCERTAINTY, Instants, Pair, derivatives, interpolated, moments, steps_from
from analysis.columns import Columns
from analysis.shape.exact_wave import wave_of
from analysis.shape.long_waves import length_of
from analysis.trajectory import Flags, Floats, Integers, Trajectory
from lammps_inputs import Problem, laws, physics

REACH = 4.0
"""Half the recorded distance, in beads of travel; the exact wave has fallen to 1e-10 of its peak there."""

COMPARED = 3.0
"""Half the distance over which the shape is compared, in beads; the exact wave has fallen to 1e-5 there."""

LARGER = 0.01
"""Part by which a velocity near a peak may exceed it, by the time between frames, where no larger pulse overlaps."""

SAMPLES = 128
"""Largest number of frames that are held for a passage."""


@dataclass(frozen=True)
class Passages(Columns):
    """Passages that are watched: one entry per passage of a pulse at a recorded bead.

    Attributes:
        chain, bead: counted from 1.
        arrival, peak_velocity, speed, direction, arrival_error: of the passage, see `analysis.tracking.pulses.Pulse`.
    """

    chain: Integers
    bead: Integers
    arrival: Floats
    peak_velocity: Floats
    speed: Floats
    direction: Integers
    arrival_error: Floats


@dataclass(frozen=True)
class Shape(Columns):
    """Quantities of the waveforms of passages, one entry per passage; NaN, but for energy, if not recorded completely.

    Attributes:
        width: full width at half maximum of the velocity, in beads: its duration times the local speed; NaN where that
            is not positive. Its relative error depends on the time between frames: 5e-7 at 0.1 T, 3e-3 at 0.5 T, and
            9e-2 at 1 T, where two frames fall into the width (largest of peak velocities from 0.05 to 1).
        momentum: in units of m V, within `REACH` beads of travel from the peak; NaN where beads differ, or its
            uncertainty exceeds `LARGEST_UNCERTAINTY` of it.
        momentum_error: its uncertainty, see `Waveforms._momentum_error`; NaN as the momentum.
        energy: kinetic and of the contacts, within `reach` beads of the one that is passed, in units of m V**2; where
            only some beads are recorded, from the kinetic energy as in the exact wave (9/5 of it for spheres), and NaN
            where beads differ.
        energy_error: uncertainty of the energy by the time between frames; NaN where only some beads are recorded.
        residual: largest difference from the exact wave of the same peak velocity, in units of that; NaN where a
            larger pulse overlaps.
    """

    width: Floats
    momentum: Floats
    momentum_error: Floats
    energy: Floats
    energy_error: Floats
    residual: Floats

    def entry(self, k: int) -> dict[str, float]:
        """The numbers of one passage, by name."""
        return {name: float(column[k]) for name, column in self.arrays().items()}


def reach(problem: Problem) -> int:
    """Beads on either side of a pulse's peak that hold its energy: three, and more where pulses are longer."""
    return math.ceil(COMPARED * length_of(problem.system) - 1e-6)


class Waveforms:
    """Collects the waveforms of passages from a run that is given piece by piece. Frames are evenly spaced.

    Args:
        problem: what was run.
        passages: the passages that are watched.
        weighed: [passage] whether the energy is measured, too; all by default.

    Attributes:
        passages: the passages that are watched.
        time: [passage, sample], in units of T; regularly spaced, also where there is no frame.
        velocity: [passage, sample] along the pulse's direction, in units of V; NaN where there is no frame.
    """

    def __init__(self, problem: Problem, passages: Passages, weighed: Flags | None = None) -> None:
        self.problem = problem
        self.passages = passages
        every = problem.every
        speed = np.where(np.isfinite(passages.speed) & (passages.speed > 0.0), passages.speed, np.nan)
        speed = np.where(np.isnan(speed), wave_of(problem.system).speed_at(passages.peak_velocity), speed)
        self._half = REACH / speed
        frames = np.ceil(self._half / every + 0.5)  # about the frame next to the arrival
        stride = np.maximum(1, np.ceil(2.0 * frames / SAMPLES)).astype(np.int64)
        half = np.minimum(np.ceil(frames / stride), SAMPLES // 2).astype(np.int64)
        centre = np.round(passages.arrival / every).astype(np.int64)
        offset = np.arange(-int(half.max(initial=0)), int(half.max(initial=0)) + 1)
        self._frame = centre[:, np.newaxis] + offset * stride[:, np.newaxis]
        self._frame[np.abs(offset) > half[:, np.newaxis]] = -1
        self._first, self._last = centre - half * stride, centre + half * stride
        self.time = (centre[:, np.newaxis] + offset * stride[:, np.newaxis]) * every
        self.velocity = np.full(self._frame.shape, np.nan)
        arrival = passages.arrival if weighed is None else np.where(weighed, passages.arrival, np.nan)
        self._instants, self._reach = Instants(arrival, problem), reach(problem)
        self._energy = np.full((2, 3, len(passages)), np.nan)
        """Energy and its first two derivatives at the frames before and after a passage."""
        self._column = problem.rows.positions(passages.bead)
        self._frames = 0

    def add(self, block: Trajectory) -> None:
        """Take the next frames, from the first of the run on."""
        if block.problem.forces_known:
            for pair in self._instants.within(block):
                self._measure_energy(pair)
        start, end = self._frames, self._frames + block.frames
        self._frames = end
        passing = np.flatnonzero((self._first < end) & (self._last >= start))
        if len(passing) == 0:
            return
        row, sample = np.nonzero((self._frame[passing] >= start) & (self._frame[passing] < end))
        row = passing[row]
        inside = (self._column[row] >= block.first - 1) & (
            self._column[row] < block.first - 1 + block.velocity.shape[2]
        )
        row, sample = row[inside], sample[inside]
        frame, chain = self._frame[row, sample] - start, self.passages.chain[row] - 1
        bead = self._column[row] - (block.first - 1)
        self.velocity[row, sample] = self.passages.direction[row] * block.velocity[frame, chain, bead]

    def _measure_energy(self, pair: Pair) -> None:
        """Take the energies at the frames around the passages between the frames of a pair."""
        row, frame = pair.entry, np.concatenate([pair.frame, pair.frame + 1])
        step = np.repeat(steps_from(pair.block), len(row))
        energy = self._energies(pair.block, np.concatenate([row, row]), frame, step)
        self._energy[..., row] = np.moveaxis(derivatives(energy, step).reshape((3, 2, len(row))), 1, 0)

    def _energies(self, block: Trajectory, row: Integers, frame: Integers, step: Floats) -> Floats:
        """Energy near the beads of some passages at three moments beside chosen frames, [moment, entry].

        Args:
            block: frames of all beads.
            row: [entry] which passages.
            frame: [entry] positions of the frames.
            step: [entry] time from one moment to the next.
        """
        problem, beads = self.problem, block.velocity.shape[2]
        system = problem.system
        place = (self.passages.bead[row] - block.first)[:, np.newaxis] + np.arange(-self._reach, self._reach + 1)
        exists, near = (place >= 0) & (place < beads), np.clip(place, 0, beads - 1)
        chain = np.broadcast_to((self.passages.chain[row] - 1)[:, np.newaxis], near.shape)
        at, bead = np.broadcast_to(frame[:, np.newaxis], near.shape), block.first - 1 + near
        x, v = (values[at, chain, near] for values in (block.displacement, block.velocity))
        acceleration, rate = motion.acceleration_and_rate(block, at, chain, near)
        x, v = moments(x, v, acceleration, rate, step[:, np.newaxis])
        kinetic = np.where(exists, 0.5 * physics.mass_of(system, chain, bead) * v * v, 0.0)
        overlap = x[..., :-1] - x[..., 1:] - physics.gap(system)
        contact = chain[:, :-1], np.minimum(bead[:, :-1], problem.beads - 2)
        energy = sum(laws.energy(laws.at(link.law, *contact), overlap) for link in system.along)
        stored = np.where(exists[:, :-1] & exists[:, 1:], energy, 0.0)
        left_out = (place[:, 0] < 0) & (block.first > 1)  # by a window
        return np.where(left_out, np.nan, kinetic.sum(axis=-1) + stored.sum(axis=-1))

    def energy(self) -> tuple[Floats, Floats]:
        """Energies at the arrivals and their uncertainties, each [passage], in units of m V**2.

        The time between frames also leaves the arrival uncertain, by that time itself where a bead flies freely. NaN
        where not all beads are recorded, or the uncertainty exceeds `LARGEST_UNCERTAINTY` of the energy.
        """
        at_arrival = interpolated(self._energy, self._instants.share, self.problem.every)
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
        watched = self._frame >= 0
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
        compared = watched & (np.abs(xi) <= COMPARED)
        difference[~compared] = 0.0
        overlapped = np.any(compared & (self.velocity > (1.0 + LARGER) * peak), axis=1)
        return Shape(
            width=self._duration() * forward * sign,
            momentum=np.where(stated, momentum, np.nan),
            momentum_error=np.where(stated, momentum_error, np.nan),
            energy=energy,
            energy_error=error,
            residual=np.where(overlapped, np.nan, np.max(difference, axis=1, initial=0.0) * sign),
        )

    def _momentum_error(self, momentum: Floats, mass: Floats, speed: Floats) -> Floats:
        """Uncertainty of the momentum, in units of m V: of the integral, of the speed, and of where the pulse ends.

        It is the sum of the difference from the integral over every second frame, of the share by which the
        uncertainties of the arrivals at the two neighbours change the speed, and of the momentum of one bead of travel
        at either end: a pulse on a static load has not come to rest there.

        Args:
            momentum, mass, speed: [passage] in units of m V, m, and beads per T.
        """
        late, watched = self.time - self.passages.arrival[:, np.newaxis], self._frame >= 0
        velocity = np.where(watched, self.velocity, 0.0)
        seldom = np.sum(velocity[:, ::2] * self._weights(late[:, ::2], watched[:, ::2]), axis=1) * mass * speed
        step = late[:, 1:2] - late[:, :1] if late.shape[1] > 1 else 0.0
        ends = [
            np.max(np.abs(velocity), axis=1, where=np.abs(sign * late - self._half[:, np.newaxis]) <= step, initial=0.0)
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
        half = self._half[:, np.newaxis]
        start, end = np.clip(late[:, :-1], -half, half), np.clip(late[:, 1:], -half, half)
        length = np.where(watched[:, :-1] & watched[:, 1:], end - start, 0.0)
        later = length * (0.5 * (start + end) - late[:, :-1]) / (late[:, 1:] - late[:, :-1])
        weights = np.zeros(late.shape)
        weights[:, :-1] += length - later
        weights[:, 1:] += later
        return weights

    def _duration(self) -> Floats:
        """Time for which the velocity exceeds half its peak, [passage]; NaN where it does not fall so far."""
        above = self.velocity - 0.5 * self.passages.peak_velocity[:, np.newaxis]
        backwards = self._half_time(above[:, ::-1], (self.passages.arrival[:, np.newaxis] - self.time)[:, ::-1])
        return self._half_time(above, self.time - self.passages.arrival[:, np.newaxis]) + backwards

    def _half_time(self, above: Floats, time: Floats) -> Floats:
        """Time when values first fall through zero after time 0, [passage], by polynomials of six samples; else NaN."""
        nodes = (0, 1, 2, 3, 4, 5)
        row, size = np.arange(len(above)), above.shape[1]
        fallen = (time > 0.0) & (above <= 0.0)
        if size < len(nodes):
            return np.full(len(above), np.nan)
        first = np.where(np.any(fallen, axis=1), np.argmax(fallen, axis=1), 0)
        start = np.clip(first - 3, 0, size - len(nodes))
        data = np.array([above[row, start + node] for node in nodes])[:, np.newaxis]
        step = time[row, start + 1] - time[row, start]
        low = np.maximum((first - 1 - start).astype(float), -time[row, start] / step)
        at = hermite.falling_zero(hermite.coefficients(nodes, data, 1.0), low, (first - start).astype(float))
        falls = np.any(fallen, axis=1) & np.all(np.isfinite(data[:, 0]), axis=0)
        return np.where(falls, time[row, start] + at * step, np.nan)
