"""How far a trajectory is from a reference of the same scene: quantity by quantity, with the place where it goes wrong."""

from dataclasses import dataclass, field

import numpy as np

from analysis.conservation import Conservation
from analysis.peaks import PeakFinder
from analysis.trajectory import Floats, Trajectory
from analysis.waves import Waves, leading_waves

MAP_CELLS = 400


@dataclass(frozen=True)
class Place:
    """A bead of a chain at a time (dimensionless); time is None for what belongs to no instant."""

    chain: int
    bead: int
    time: float | None


@dataclass(frozen=True)
class Deviation:
    """One quantity's difference from the reference.

    Attributes:
        largest, rms: over all beads and frames, or all waves; dimensionless.
        where: of the largest.
        first: first place, in time, where the tolerance is exceeded; None if it never is.
    """

    largest: float
    rms: float
    where: Place | None = None
    first: Place | None = None


@dataclass
class _Running:
    """Largest, mean square and first excess of one quantity over blocks."""

    tolerance: float
    largest: float = 0.0
    squares: float = 0.0
    count: int = 0
    where: Place | None = None
    first: Place | None = None

    def add(self, block: Trajectory, difference: Floats) -> None:
        size = np.abs(difference)
        worst = int(np.argmax(size))
        if not size.flat[worst] <= self.largest:  # NaN counts as largest
            self.largest = float(size.flat[worst])
            self.where = _place(block, worst)
        self.squares += float(np.sum(difference * difference))
        self.count += difference.size
        if self.first is None and not self.largest <= self.tolerance:
            exceeding = ~(size <= self.tolerance)
            self.first = _place(block, int(np.argmax(exceeding)))

    def result(self) -> Deviation:
        return Deviation(self.largest, float(np.sqrt(self.squares / max(1, self.count))), self.where, self.first)


def _place(block: Trajectory, position: int) -> Place:
    frame, chain, bead = np.unravel_index(position, block.velocity.shape)
    return Place(int(chain) + 1, int(block.beads[bead]), float(block.time[frame]))


@dataclass
class Comparison:
    """Accumulates the difference of two trajectories over pairs of blocks; `deviations` says how far apart they are.

    Args:
        tolerances: quantity -> largest difference that is let pass, dimensionless; the keys are `QUANTITIES`.
    """

    tolerances: dict[str, float]
    _velocity: _Running = field(init=False)
    _displacement: _Running = field(init=False)

    def __post_init__(self) -> None:
        self._velocity = _Running(self.tolerances["velocity"])
        self._displacement = _Running(self.tolerances["displacement"])
        self._peaks = (PeakFinder(first_only=True), PeakFinder(first_only=True))
        self.conservation = Conservation()
        self._map: list[Floats] = []
        self._times: list[float] = []
        self.frames = 0

    def add(self, block: Trajectory, reference: Trajectory) -> None:
        """Take the next frames of both, at the same times."""
        difference = block.velocity - reference.velocity
        self._velocity.add(block, difference)
        self._displacement.add(block, block.displacement - reference.displacement)
        self._peaks[0].add(block)
        self._peaks[1].add(reference)
        self.conservation.add(block)
        self.frames += block.frames
        self._add_to_map(block, difference)

    def _add_to_map(self, block: Trajectory, difference: Floats) -> None:
        """Keep the largest |velocity difference| over chains, in at most some hundred cells either way."""
        frames_a_cell = max(1, -(-(block.problem.frames + 1) // MAP_CELLS))
        thin = max(1, -(-difference.shape[2] // MAP_CELLS))
        size = np.abs(difference).max(axis=1)
        for start in range(0, len(size), frames_a_cell):
            row = size[start : start + frames_a_cell].max(axis=0)
            self._map.append(np.maximum.reduceat(row, np.arange(0, len(row), thin)))
            self._times.append(float(block.time[start]))

    def waves(self) -> tuple[Waves, Waves]:
        """Leading pulses of the trajectory and of the reference, at the beads that both reached before the free end."""
        own, other = (leading_waves(finder.result()) for finder in self._peaks)
        last = int(max(own.bead.max(initial=0), other.bead.max(initial=0)))
        key_own, key_other = own.chain * 2**40 + own.bead, other.chain * 2**40 + other.bead
        both = np.intersect1d(key_own[own.bead < last], key_other[other.bead < last])
        return own.where(np.isin(key_own, both)), other.where(np.isin(key_other, both))

    def deviations(self) -> dict[str, Deviation]:
        """Deviation of every quantity in `QUANTITIES`."""
        own, other = self.waves()
        result = {"velocity": self._velocity.result(), "displacement": self._displacement.result()}
        for name, difference in (
            ("amplitude", own.peak_velocity - other.peak_velocity),
            ("arrival", own.arrival - other.arrival),
        ):
            result[name] = self._of_waves(name, difference, other)
        result["energy"] = Deviation(self.conservation.energy_drift, float("nan"))
        result["momentum"] = Deviation(self.conservation.momentum_drift, float("nan"))
        return result

    def _of_waves(self, name: str, difference: Floats, waves: Waves) -> Deviation:
        if len(difference) == 0:
            return Deviation(0.0, 0.0)
        size = np.abs(difference)

        def place(k: int) -> Place:
            return Place(int(waves.chain[k]), int(waves.bead[k]), float(waves.arrival[k]))

        exceeding = np.flatnonzero(~(size <= self.tolerances[name]))
        first = place(int(exceeding[np.argmin(waves.arrival[exceeding])])) if len(exceeding) else None
        rms = float(np.sqrt(np.mean(difference**2)))
        return Deviation(float(size.max()), rms, place(int(np.argmax(size))), first)

    @property
    def error_map(self) -> tuple[Floats, Floats]:
        """Times [cell] and largest |velocity difference| over the chains [cell, bead cell]."""
        return np.array(self._times), np.array(self._map)


QUANTITIES = ("velocity", "displacement", "amplitude", "arrival", "energy", "momentum")
