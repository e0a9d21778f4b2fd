"""The leading pulse on top of a static load: how fast it runs, and how much more than at rest contacts bear in it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis import hermite, motion
from analysis.mirror import direction_of
from analysis.shape.loaded_wave import cell_beads, sound_speed, speed_over_sound
from analysis.trajectory import Floats, Trajectory, joined
from lammps_inputs import Problem, laws
from lammps_inputs.limits import rates

CLEAR = 5
"""Contacts from the far end, nearer to which the pulse feels it, and as many that it must have passed at least."""

FRONT = 1.5
"""More of them, over the cube root of the contacts from the start on, for so fronts of sound spread: their speed
feels the end by less than a thousandth there."""

OVER = 10
"""Contacts over which speed and force are measured, as far as the pulse has come; more where whole cells are more."""

SMALLEST = 1e-3
"""Velocity, in units of V, of a pulse whose overlap counts."""


@dataclass(frozen=True)
class LoadedWave:
    """The leading pulse of the chain that was hit hardest, where it was last clear of the ends.

    Attributes:
        chain, first, last: where, counted from 1: between which contacts.
        force_ratio: mean of the largest total force over that at rest, f.
        speed: beads / T.
        sound: speed of sound there, beads / T.
        theory: speed of the long-wave theory's solitary wave of this force ratio over that of sound; NaN where beads
            differ.
    """

    chain: int
    first: int
    last: int
    force_ratio: float
    speed: float
    sound: float
    theory: float

    @property
    def over_sound(self) -> float:
        """Speed over that of sound."""
        return self.speed / self.sound

    @property
    def over_theory(self) -> float:
        """Speed over that of the theory's wave."""
        return self.over_sound / self.theory


class LoadedPulse:
    """Finds the first maximum of every overlap in a run of all beads that is given block by block.

    Between two frames an overlap is the polynomial of degree five through its value and two derivatives there.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        shape = problem.chains, problem.beads - 1
        self._least = SMALLEST / rates.pace(problem)
        self._arrival, self._strain = np.full(shape, np.nan), np.full(shape, np.nan)
        self._carried: Trajectory | None = None

    def add(self, block: Trajectory) -> None:
        """Take the next frames, evenly spaced in time with those before."""
        if self._carried is not None:
            block = joined([self._carried, block])
        self._carried = block[-1:]
        if block.frames < 2:
            return
        x, v = block.displacement, block.velocity
        strain, rate = x[..., :-1] - x[..., 1:], v[..., :-1] - v[..., 1:]
        high = np.maximum(strain[:-1], strain[1:]) > self._least
        top = high & (rate[:-1] > 0.0) & (rate[1:] <= 0.0) & np.isnan(self._arrival)
        frame, chain, contact = np.nonzero(top)
        _, one = np.unique(chain * self._arrival.shape[1] + contact, return_index=True)  # the first of each
        frame, chain, contact = frame[one], chain[one], contact[one]
        if len(frame) == 0:
            return
        data = np.stack([self._state(block, at, chain, contact) for at in (frame, frame + 1)])
        polynomial = hermite.coefficients((0, 1), data, block.spacing)
        at = hermite.falling_zero(hermite.derivative(polynomial), np.zeros(len(frame)), np.ones(len(frame)))
        self._arrival[chain, contact] = block.time[frame] + at * block.spacing
        self._strain[chain, contact] = hermite.value(polynomial, at)

    @staticmethod
    def _state(
        block: Trajectory, frame: NDArray[np.int64], chain: NDArray[np.int64], contact: NDArray[np.int64]
    ) -> Floats:
        x, v = block.displacement, block.velocity
        behind, ahead = (motion.acceleration_and_rate(block, frame, chain, contact + k)[0] for k in (0, 1))
        return np.stack(
            [
                x[frame, chain, contact] - x[frame, chain, contact + 1],
                v[frame, chain, contact] - v[frame, chain, contact + 1],
                behind - ahead,
            ]
        )

    def result(self) -> LoadedWave | None:
        """Of the frames so far; None where the pulse did not come far enough."""
        problem = self._problem
        way = direction_of(problem)
        hit, bead, _ = problem.hardest_blow
        chain, count = hit - 1, problem.beads - 1
        contact = np.arange(count)
        distance = contact - (bead - 1) if way > 0 else (bead - 2) - contact
        ahead = count - contact if way > 0 else contact + 1
        clear = (distance >= 0) & (ahead > CLEAR + FRONT * np.cbrt(distance))
        reached = contact[clear & np.isfinite(self._arrival[chain])]
        if len(reached) < CLEAR:
            return None
        cell = cell_beads(problem)
        over = cell * min(-(-OVER // cell), max(1, (len(reached) - 1) // cell))
        used = reached[-over - 1 :] if way > 0 else reached[: over + 1]
        first, last = (int(used[0]), int(used[-1])) if way > 0 else (int(used[-1]), int(used[0]))
        whole = laws.rest(problem.along[0].law) + np.where(np.isfinite(self._strain), self._strain, 0.0)
        force = motion.contact_force(problem, whole)
        load = np.broadcast_to(laws.load(problem.along[0].law), force.shape)
        if not np.all(load[chain, used] > 0.0):
            return None
        ratio = float(np.mean(force[chain, used] / load[chain, used]))
        taken = float(self._arrival[chain, last] - self._arrival[chain, first])
        sound = float(np.mean(sound_speed(problem)[chain, used]))
        theory = float(speed_over_sound(ratio, problem.exponent or 1.5)) if problem.one_kind else np.nan
        return LoadedWave(hit, first + 1, last + 1, ratio, abs(last - first) / taken, sound, theory)
