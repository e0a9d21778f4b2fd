"""How far a trajectory is from a reference of the same scene, quantity by quantity, and where it goes wrong.

Plug-ins take this module for errors of a run: `errors_of` has those of all quantities, `matched` chooses the passages
that two runs have in common.

Examples:
    >>> from dataclasses import replace
    >>> frames = engine.run(granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem())
    >>> wrong = replace(frames, velocity=1.001 * frames.velocity)
    >>> errors = difference.errors_of(wrong.blocks(), frames.blocks())
    >>> errors["velocity"].where.words, round(errors["velocity"].largest, 9)  # in units of V
    ('bead 1 of chain 1', 0.001)
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from analysis.compare.common_times import of_common_atoms, paired
from analysis.conservation import Conservation
from analysis.tracking.leading_waves import leading_finder, leading_passages
from analysis.tracking.peaks import THRESHOLD, PeakFinder, Peaks, sharp
from analysis.trajectory import Floats, Integers, Trajectory
from lammps_inputs import Problem
from lammps_inputs.facts import Fact

QUANTITIES = ("velocity", "displacement", "amplitude", "arrival", "energy", "momentum")

MAP_CELLS = 400


def matched(first: Peaks, second: Peaks, beads: int) -> tuple[Peaks, Peaks]:
    """First passages of two runs at the beads that both reached, in chains of so many beads.

    Left out are the kicked beads' start, the last bead of the pulse's way, which flies off, and passages not twice as
    high as `analysis.tracking.peaks.THRESHOLD`: of those, one run may have what the other has not. Each bead has one
    passage at most.

    Args:
        first: first maxima of each bead in one run.
        second: first maxima of each bead in the other run.
        beads: number of beads of a chain.

    Returns:
        The maxima of both at the same beads, entry by entry.
    """
    keys = [peaks.chain * 2**40 + peaks.bead for peaks in (first, second)]
    last = beads if first.direction > 0 else 1
    clear = [
        (peaks.velocity > 2.0 * THRESHOLD) & (peaks.bead != last) & (peaks.time > 0.0) for peaks in (first, second)
    ]
    both = np.intersect1d(keys[0][clear[0]], keys[1][clear[1]])
    return first.where(np.isin(keys[0], both)), second.where(np.isin(keys[1], both))


@dataclass(frozen=True)
class Uncertainty:
    """Bounds on the errors of a reference run, dimensionless.

    Attributes:
        steps_per_frame: steps of the finer run from frame to frame.
        velocity: the largest error of any velocity, of beads and resonators, is below this, in units of V: the largest
            difference from the run with half as many steps, times `workflow.engines.reference.step_halving.SAFETY`.
        arrival: the same bound for arrivals of the leading pulse, in units of T, where `analysis.tracking.peaks.sharp`.
        energy: largest deviation of the energy from that of the kicks.
        momentum: largest deviation of the momentum from that of the kicks.

    Examples:
        >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 5.0}).problem()
        >>> uncertainty = StepHalving(problem).run()
        >>> uncertainty.velocity < 1e-5, uncertainty.arrival < 1e-5  # in units of V and T
        (True, True)
    """

    steps_per_frame: int
    velocity: float
    arrival: float
    energy: float
    momentum: float


@dataclass(frozen=True)
class DeviationPlace:
    """A bead of a chain, or a resonator at it, at a time.

    Attributes:
        chain: number of the chain, from 1.
        bead: number of the bead, from 1.
        time: dimensionless; None for what belongs to no instant.
        resonator: number of the resonator at the bead, in the order of the scene; 0 for the bead itself.
    """

    chain: int
    bead: int
    time: float | None
    resonator: int = 0

    @property
    def words(self) -> str:
        """The bead or resonator in words, such as "bead 7 of chain 2"."""
        bead = f"bead {self.bead} of chain {self.chain}"
        return f"resonator {self.resonator} at {bead}" if self.resonator else bead


@dataclass(frozen=True)
class Deviation:
    """One quantity's difference from the reference.

    Attributes:
        largest: largest size of the difference over all beads and frames, or all waves; dimensionless.
        rms: its root mean square.
        where: place of the largest difference.
        first: first place, in time, where the tolerance is exceeded; None if it never is.
    """

    largest: float
    rms: float
    where: DeviationPlace | None = None
    first: DeviationPlace | None = None


def deviation_of(
    difference: Floats, time: Floats, tolerance: float, place: Callable[[int], DeviationPlace]
) -> Deviation:
    """Deviation of differences [entry] at times [entry]; ``place`` gives the place of an entry by its position."""
    size = np.abs(difference)
    exceeding = np.flatnonzero(~(size <= tolerance))
    first = place(int(exceeding[np.argmin(time[exceeding])])) if len(exceeding) else None
    rms = float(np.sqrt(np.mean(difference**2)))
    return Deviation(float(size.max()), rms, place(int(np.argmax(size))), first)


@dataclass
class _Running:
    """Largest difference, mean square and first excess over the tolerance of one quantity, over blocks."""

    tolerance: float
    largest: float = 0.0
    squares: float = 0.0
    count: int = 0
    where: DeviationPlace | None = None
    first: DeviationPlace | None = None

    def add(self, block: Trajectory, difference: Floats) -> None:
        """Take the differences [frame, line, bead] of the next frames."""
        size = np.abs(difference)
        worst = int(np.argmax(size))
        if not (size.flat[worst] <= self.largest or np.isnan(self.largest)):  # NaN counts as largest
            self.largest = float(size.flat[worst])
            self.where = _place(block, worst, size.shape)
        for square in np.sum(difference * difference, axis=(1, 2)).tolist():  # the order does not depend on blocks
            self.squares += square
        self.count += difference.size
        if self.first is None and not self.largest <= self.tolerance:
            exceeding = ~(size <= self.tolerance)
            self.first = _place(block, int(np.argmax(exceeding)), size.shape)

    def result(self) -> Deviation:
        return Deviation(self.largest, float(np.sqrt(self.squares / max(1, self.count))), self.where, self.first)


def _place(block: Trajectory, position: int, shape: tuple[int, ...]) -> DeviationPlace:
    """Place of a position in the flattened values [frame, line, bead] of a block's atoms."""
    frame, line, bead = np.unravel_index(position, shape)
    resonator, chain = divmod(int(line), block.problem.chains)
    return DeviationPlace(chain + 1, int(block.beads[bead]), float(block.time[frame]), resonator)


class Difference:
    """Accumulates the difference of two trajectories over pairs of blocks; `deviations` says how far apart they are.

    Args:
        tolerances: quantity -> largest difference that is let pass, dimensionless; the keys are `QUANTITIES`.
        counted: gives frames of the first their exchange; see `analysis.conservation.Conservation`.
    """

    def __init__(self, tolerances: dict[str, float], counted: Callable[[Trajectory], Trajectory] | None = None) -> None:
        self.tolerances = tolerances
        self.conservation = Conservation(counted)
        self.frames = 0
        self._velocity, self._displacement = (_Running(tolerances[name]) for name in ("velocity", "displacement"))
        self._peaks: tuple[PeakFinder, PeakFinder] | None = None
        self._map: list[Floats] = []
        self._times: list[float] = []
        self._last_time, self._cell_beads = 0.0, np.zeros(0, dtype=np.int64)
        self._problem: Problem | None = None

    def add(self, block: Trajectory, reference: Trajectory) -> None:
        """Take the next frames of both, at the same times."""
        with np.errstate(over="ignore", invalid="ignore"):  # of a run that blew up
            (x, v), (right_x, right_v) = of_common_atoms(block, reference)
            difference = v - right_v
            self._velocity.add(block, difference)
            self._displacement.add(block, x - right_x)
            if self._peaks is None:
                self._peaks = leading_finder(block.problem), leading_finder(reference.problem)
            for finder, frames in zip(self._peaks, (block, reference), strict=True):
                finder.add(frames)
            self.conservation.add(block)
        self.frames += block.frames
        self._problem = block.problem
        self._add_to_map(block, difference)

    def _add_to_map(self, block: Trajectory, difference: Floats) -> None:
        """Add largest |velocity difference| [frame, line, bead] of rows to a map of some hundred cells a side."""
        frames_a_cell = max(1, -(-(block.problem.frames + 1) // MAP_CELLS))
        beads = block.problem.rows.numbers
        thin = max(1, -(-len(beads) // MAP_CELLS))
        size = np.full((block.frames, len(beads)), np.nan)
        size[:, block.first - 1 : block.first - 1 + difference.shape[2]] = np.abs(difference).max(axis=1)
        for start in range(0, len(size), frames_a_cell):
            row = size[start : start + frames_a_cell].max(axis=0)
            self._map.append(np.fmax.reduceat(row, np.arange(0, len(row), thin)))
            self._times.append(float(block.time[start]))
        self._last_time, self._cell_beads = float(block.time[-1]), np.append(beads[::thin], beads[-1] + 1)

    def deviations(self) -> dict[str, Deviation]:
        """Deviation of every quantity in `QUANTITIES`; amplitudes and arrivals are the leading pulse's.

        The latter two are left out where no passage was found in both, or no pulse leads (`Fact.PULSE`). Energy is the
        difference of the budget where dashpots dissipate energy, or forces from outside do work.

        Returns:
            Quantity -> its deviation.

        Raises:
            ValueError: there was no frame.
        """
        problem = self._problem
        if problem is None or self._peaks is None:
            raise ValueError("no frames to compare")
        system = problem.system
        with np.errstate(over="ignore", invalid="ignore"):
            passages, right = (leading_passages(finder.result(), problem).first() for finder in self._peaks)
            passages, right = matched(passages, right, problem.beads)
        timed = sharp(right)
        result = {"velocity": self._velocity.result(), "displacement": self._displacement.result()}
        leads = system.holds(Fact.PULSE)
        if len(passages) and leads:
            result["amplitude"] = self._of_peaks("amplitude", passages.velocity - right.velocity, right)
        if np.any(timed) and leads:
            result["arrival"] = self._of_peaks("arrival", (passages.time - right.time)[timed], right.where(timed))
        if problem.rows.complete and (system.holds(Fact.ENERGY) or system.dampers):
            result["energy"] = Deviation(self.conservation.energy_drift, math.nan)
        if problem.rows.complete and system.holds(Fact.MOMENTUM):
            result["momentum"] = Deviation(self.conservation.momentum_drift, math.nan)
        return result

    def _of_peaks(self, name: str, difference: Floats, peaks: Peaks) -> Deviation:
        def place(k: int) -> DeviationPlace:
            return DeviationPlace(int(peaks.chain[k]), int(peaks.bead[k]), float(peaks.time[k]))

        return deviation_of(difference, peaks.time, self.tolerances[name], place)

    @property
    def error_map(self) -> "ErrorMap":
        """Differences of the velocities in cells of some frames by some beads."""
        times = np.array([*self._times, self._last_time])
        each = self._problem is None or len(self._problem.rows.numbers) <= MAP_CELLS
        return ErrorMap(times, self._cell_beads, np.array(self._map), each)


def errors_of(blocks: Iterable[Trajectory], reference: Iterable[Trajectory]) -> dict[str, Deviation]:
    """Deviations of a run from a reference at the same times, without tolerances; see `Difference.deviations`.

    Args:
        blocks: frames of the run.
        reference: frames of the reference.

    Returns:
        Quantity -> its deviation.

    Raises:
        OtherFramesError: their beads or times differ.
        ValueError: there was no frame.
    """
    difference = Difference(dict.fromkeys(QUANTITIES, math.inf))
    for pair in paired(blocks, reference):
        difference.add(*pair)
    return difference.deviations()


@dataclass(frozen=True)
class ErrorMap:
    """Largest |velocity difference| of any chain, resonators included, in cells of space and time.

    Attributes:
        time: of the first frame of each cell and of the last frame of all, [cell + 1].
        bead: first bead of each cell, counted from 1, and the one after the last bead of all, [bead cell + 1].
        velocity: [cell, bead cell].
        each: whether each cell is of one bead.
    """

    time: Floats
    bead: Integers
    velocity: Floats
    each: bool = True
