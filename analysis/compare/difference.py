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
from typing import Any, NamedTuple

import numpy as np

from analysis.compare.common_times import of_common_atoms, paired, paired_parts
from analysis.conservation import ConservationMeter
from analysis.meters import Part
from analysis.tracking.leading_passages import leading_meter, leading_passages
from analysis.tracking.peak_bounds import Brackets
from analysis.tracking.peaks import THRESHOLD, Peaks, sharp
from analysis.trajectory import Floats, Integers, Trajectory
from lammps_inputs import Problem
from lammps_inputs.facts import Fact

QUANTITIES = ("velocity", "displacement", "amplitude", "arrival", "energy", "momentum")

MAP_CELLS = 400

_RESONATOR = "resonator"
"""Key of the number of another atom in data of a place, and its noun where they have none."""


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
        velocity: the largest error of any velocity, of beads and other atoms, is below this, in units of V: the largest
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
    """A bead of a chain, or another atom at it, such as a resonator, at a time.

    Attributes:
        chain: number of the chain, from 1.
        bead: number of the bead, from 1.
        time: dimensionless; None for what belongs to no instant.
        noun: what the other atom is called; empty for the bead itself.
        number: number of the other atom among those of its noun at the bead, in the order of the scene.
    """

    chain: int
    bead: int
    time: float | None
    noun: str = ""
    number: int = 0

    @property
    def words(self) -> str:
        """The bead or other atom in words, such as "bead 7 of chain 2"."""
        bead = f"bead {self.bead} of chain {self.chain}"
        return f"{self.noun} {self.number} at {bead}" if self.noun else bead

    def plain(self) -> dict[str, Any]:
        """Data for JSON: the number as ``resonator``; the noun where it is another."""
        noun = {} if self.noun in ("", _RESONATOR) else {"noun": self.noun}
        return {"chain": self.chain, "bead": self.bead, "time": self.time, _RESONATOR: self.number, **noun}

    @classmethod
    def from_plain(cls, chain: int, bead: int, time: float | None = None, **atom: Any) -> "DeviationPlace":
        """The place that has such data."""
        number = atom.get(_RESONATOR, 0)
        return cls(chain, bead, time, atom.get("noun", _RESONATOR) if number else "", number)


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

    def plain(self) -> dict[str, Any]:
        """Data for JSON."""
        places = {"where": self.where and self.where.plain(), "first": self.first and self.first.plain()}
        return {"largest": self.largest, "rms": self.rms, **places}


def deviation_of(
    difference: Floats, time: Floats, tolerance: float, place: Callable[[int], DeviationPlace]
) -> Deviation:
    """Deviation of differences [entry] at times [entry]; ``place`` gives the place of an entry by its position."""
    size = np.abs(difference)
    exceeding = np.flatnonzero(~(size <= tolerance))
    first = place(int(exceeding[np.argmin(time[exceeding])])) if len(exceeding) else None
    rms = float(np.sqrt(np.mean(difference**2)))
    return Deviation(float(size.max()), rms, place(int(np.argmax(size))), first)


class _Differences(NamedTuple):
    """Differences of one quantity in a part of a run.

    Attributes:
        largest: its largest size; NaN counts as the largest.
        where: place of that; None where nothing differs.
        first: first place, in time, where the tolerance is exceeded; None if it never is.
        squares: sum of the squares in each frame, [frame].
        values: number of differences.
    """

    largest: float
    where: DeviationPlace | None
    first: DeviationPlace | None
    squares: Floats
    values: int

    @classmethod
    def of(cls, block: Trajectory, difference: Floats, tolerance: float) -> "_Differences":
        """Those of all atoms, [frame, line, bead]."""
        size = np.abs(difference)
        worst = int(np.argmax(size))
        largest = float(size.flat[worst])
        exceeded = not largest <= tolerance
        return cls(
            largest=largest,
            where=None if largest == 0.0 else _place(block, worst, size.shape),
            first=_place(block, int(np.argmax(~(size <= tolerance))), size.shape) if exceeded else None,
            squares=np.sum(difference * difference, axis=(1, 2)),
            values=difference.size,
        )


def _together(pieces: tuple[_Differences, ...]) -> Deviation:
    """Deviation of one quantity, by its differences in all parts of a run."""
    worst = pieces[int(np.argmax([piece.largest for piece in pieces]))]
    squares = np.sum(np.concatenate([piece.squares for piece in pieces]))
    return Deviation(
        largest=worst.largest,
        rms=float(np.sqrt(squares / sum(piece.values for piece in pieces))),
        where=worst.where,
        first=next((piece.first for piece in pieces if piece.first is not None), None),
    )


def _place(block: Trajectory, position: int, shape: tuple[int, ...]) -> DeviationPlace:
    """Place of a position in the flattened values [frame, line, bead] of a block's atoms."""
    frame, line, bead = np.unravel_index(position, shape)
    system = block.problem.system
    place = int(system.chain_of_line[line]) + 1, int(block.beads[bead]), float(block.time[frame])
    return DeviationPlace(*place, *system.atom_at_bead(int(line)))


class _Compared(NamedTuple):
    """What a comparison takes from a part of each of two runs.

    Attributes:
        problem: of the frames of the first run.
        velocity: differences of velocities.
        displacement: differences of displacements.
        peaks: brackets of the leading maxima of the first run.
        reference_peaks: those of the second run.
        conservation: what the conservation of the first run follows from.
        cells: time of the first frame of each cell of the map of errors, [cell], and the cells' errors, [cell, bead
            cell].
    """

    problem: Problem
    velocity: _Differences
    displacement: _Differences
    peaks: Brackets
    reference_peaks: Brackets
    conservation: Any
    cells: tuple[Floats, Floats]


@dataclass(frozen=True)
class Difference:
    """Difference of two runs.

    Attributes:
        deviations: deviation of every quantity in `QUANTITIES`; amplitudes and arrivals are the leading pulse's, and
            are left out where no passage was found in both, or no pulse leads (`Fact.PULSE`). Energy is the difference
            of the budget where dashpots dissipate energy, or forces from outside do work.
        error_map: differences of the velocities in cells of some frames by some beads.
        frames: number of frames.
        last_time: time of the last of them, in units of T.
    """

    deviations: dict[str, Deviation]
    error_map: "ErrorMap"
    frames: int
    last_time: float


@dataclass(frozen=True)
class DifferenceMeter:
    """Difference of two runs, by pairs of parts with the same times and beads.

    Frames of the first run have their exchange where their energy budget is wanted.

    Attributes:
        tolerances: quantity -> largest difference that is let pass, dimensionless; the keys are `QUANTITIES`.
    """

    tolerances: dict[str, float]

    def of_parts(self, part: Part, reference: Part) -> _Compared:
        """Differences in a part of the run from the same part of the reference."""
        block, problem = part.frames, part.around.problem
        with np.errstate(over="ignore", invalid="ignore"):  # of a run that blew up
            (x, v), (right_x, right_v) = of_common_atoms(block, reference.frames)
            difference = v - right_v
            return _Compared(
                problem,
                _Differences.of(block, difference, self.tolerances["velocity"]),
                _Differences.of(block, x - right_x, self.tolerances["displacement"]),
                leading_meter(problem).of_part(part),
                leading_meter(reference.around.problem).of_part(reference),
                ConservationMeter(problem).of_part(part),
                _cells(block, difference),
            )

    def result(self, pieces: list[_Compared]) -> Difference:
        """Difference of the runs.

        Args:
            pieces: what `of_parts` gave for each pair of parts, in order.

        Returns:
            The difference.

        Raises:
            ValueError: there was no frame.
        """
        if not pieces:
            raise ValueError("no frames to compare")
        (problem, *_), velocity, displacement, peaks, reference_peaks, drifts, cells = zip(*pieces, strict=True)
        conservation, system = ConservationMeter(problem).result(list(drifts)), problem.system
        deviations = {"velocity": _together(velocity), "displacement": _together(displacement)}
        if system.holds(Fact.PULSE):
            deviations |= self._of_peaks(problem, list(peaks), list(reference_peaks))
        if problem.rows.complete and (system.holds(Fact.ENERGY) or system.dampers):
            deviations["energy"] = Deviation(conservation.energy_drift, math.nan)
        if problem.rows.complete and system.holds(Fact.MOMENTUM):
            deviations["momentum"] = Deviation(conservation.momentum_drift, math.nan)
        error_map = _error_map(problem, cells, conservation.last_time)
        return Difference(deviations, error_map, conservation.frames, conservation.last_time)

    def _of_peaks(self, problem: Problem, *brackets: list[Brackets]) -> dict[str, Deviation]:
        """Deviations of peak velocities and arrivals, by brackets in both runs, where a passage was found in both."""
        deviations = {}
        with np.errstate(over="ignore", invalid="ignore"):
            passages, right = (
                leading_passages(leading_meter(problem).result(of_run), problem).first() for of_run in brackets
            )
            passages, right = matched(passages, right, problem.beads)
        timed = sharp(right)
        if len(passages):
            deviations["amplitude"] = self._at_peaks("amplitude", passages.velocity - right.velocity, right)
        if np.any(timed):
            deviations["arrival"] = self._at_peaks("arrival", (passages.time - right.time)[timed], right.where(timed))
        return deviations

    def _at_peaks(self, name: str, difference: Floats, peaks: Peaks) -> Deviation:
        def place(k: int) -> DeviationPlace:
            return DeviationPlace(int(peaks.chain[k]), int(peaks.bead[k]), float(peaks.time[k]))

        return deviation_of(difference, peaks.time, self.tolerances[name], place)

    def read(self, pairs: Iterable[tuple[Part, Part]]) -> Difference:
        """Difference of two runs that are given as pairs of parts.

        Args:
            pairs: parts of both runs with the same times and beads, in order.

        Returns:
            The difference.

        Raises:
            ValueError: there was no frame.
        """
        return self.result([self.of_parts(*pair) for pair in pairs])


def _beads_a_cell(problem: Problem) -> int:
    return max(1, -(-len(problem.rows.numbers) // MAP_CELLS))


def _cells(block: Trajectory, difference: Floats) -> tuple[Floats, Floats]:
    """Largest |velocity difference| [frame, line, bead] of rows in a map of some hundred cells a side.

    Returns:
        Time of the first frame of each cell, [cell]; the largest difference in each, [cell, bead cell].
    """
    frames_a_cell = max(1, -(-(block.problem.frames + 1) // MAP_CELLS))
    beads = len(block.problem.rows.numbers)
    size = np.full((block.frames, beads), np.nan)
    size[:, block.first - 1 : block.first - 1 + difference.shape[2]] = np.abs(difference).max(axis=1)
    rows = np.maximum.reduceat(size, np.arange(0, block.frames, frames_a_cell), axis=0)
    cells = np.fmax.reduceat(rows, np.arange(0, beads, _beads_a_cell(block.problem)), axis=1)
    return block.time[::frames_a_cell], cells


def _error_map(problem: Problem, cells: tuple[tuple[Floats, Floats], ...], last_time: float) -> "ErrorMap":
    """Map of the cells of all parts."""
    beads = problem.rows.numbers
    times, sizes = zip(*cells, strict=True)
    return ErrorMap(
        time=np.array([*np.concatenate(times), last_time]),
        bead=np.append(beads[:: _beads_a_cell(problem)], beads[-1] + 1),
        velocity=np.concatenate(sizes),
        each=len(beads) <= MAP_CELLS,
    )


def errors_of(blocks: Iterable[Trajectory], reference: Iterable[Trajectory]) -> dict[str, Deviation]:
    """Deviations of a run from a reference at the same times, without tolerances; see `Difference`.

    Args:
        blocks: frames of the run.
        reference: frames of the reference.

    Returns:
        Quantity -> its deviation.

    Raises:
        OtherFramesError: their beads or times differ.
        ValueError: there was no frame.
    """
    meter = DifferenceMeter(dict.fromkeys(QUANTITIES, math.inf))
    return meter.read(paired_parts(paired(blocks, reference))).deviations


@dataclass(frozen=True)
class ErrorMap:
    """Largest |velocity difference| of any chain, other atoms included, in cells of space and time.

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
