"""Spectra of beads' velocities, and how much of a drive's motion reaches them."""

import itertools
from dataclasses import dataclass

import numpy as np

from analysis.quantity import declare, result
from analysis.shape.unit_cell import bands
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem
from lammps_inputs.laws.in_time import Sine

LEAST_FRAMES = 16


@result
class DriveLine:
    """Amplitude of one bead at the frequency of a drive."""

    frequency: float = declare("frequency of the drive", "cycles", symbol="f")
    amplitude: float = declare(
        "amplitude of the velocity at the drive's frequency", "velocity", "frames are too far apart for it"
    )
    transmissibility: float = declare(
        "that amplitude over the one of the chain's first chosen bead",
        undefined="that bead does not move, or frames are too far apart",
    )


@result
class HighestLine:
    """Highest line in the spectrum of one bead."""

    chain: int = declare("number of the chain")
    bead: int = declare("number of the bead")
    frequency: float = declare("frequency of the highest line of the velocity above frequency 0", "cycles", symbol="f")
    amplitude: float = declare("amplitude of that line", "velocity")
    at_drive: list[DriveLine] = declare("of each drive: the line at its frequency")


@result
class SpectralLines:
    """What is found in the spectra of a run."""

    after: float = declare("time from which on frames were taken", "time")
    resolution: float = declare("distance of two lines; frequencies nearer than two of it are not resolved", "cycles")
    beads: list[HighestLine] = declare("chosen beads of every chain")
    transmissibility: float = declare(
        "of the last chosen bead in the chain of the first drive, at its frequency: amplitude of the velocity over "
        "that of the first chosen bead",
        undefined="there is no drive, the first chosen bead does not move, or frames are too far apart",
        column="velocity at the drive's frequency, last bead / first",
    )
    bands: Floats | None = declare(
        "lowest and highest frequency of every branch of small waves, exact",
        "cycles",
        "the chains pass on no sound, or nothing repeats along them",
    )


@result
class SpectrumTable:
    """Table of spectra."""

    frequency: Floats = declare("frequency of the line", "cycles", symbol="f")
    amplitude: dict[str, Floats] = declare(
        "amplitude of the velocity of each chosen bead, in columns such as ``chain 1 bead 10``: that of a sine whose "
        "frequency falls on a line is the height of the line (Hann's window)",
        "velocity",
        symbol="\\hat v",
    )


@dataclass(frozen=True)
class VelocitySpectra:
    """Amplitudes of the velocities of chosen beads, dimensionless.

    Attributes:
        beads: counted from 1; the others are compared with the first.
        after: time from which on frames were taken, in units of T.
        frequency: [line] cycles in a unit of time.
        amplitude: [line, chain, bead] of an oscillation of that frequency: a sine of amplitude a has height a, if
            it falls on one (down to 0.85 a between two), and half of that in the lines beside it.
        drive: [drive] frequencies of the drives.
        at_drive: [drive, chain, bead] amplitude at just that frequency; NaN where frames are too far apart for it.
    """

    beads: tuple[int, ...]
    after: float
    frequency: Floats
    amplitude: Floats
    drive: Floats
    at_drive: Floats

    @property
    def transmissibility(self) -> Floats:
        """[drive, chain, bead] amplitude at a drive's frequency over that of the chain's first chosen bead.

        NaN where that does not move.
        """
        first = self.at_drive[..., :1]
        return np.asarray(self.at_drive / np.where(first > 0.0, first, np.nan))

    def found(self, problem: Problem) -> SpectralLines:
        """The highest lines, and those at the drives."""
        passed_on, beads = self.transmissibility, []
        for chain, (place, bead) in itertools.product(range(problem.chains), enumerate(self.beads)):
            height = self.amplitude[:, chain, place]
            lines = zip(self.drive, self.at_drive[:, chain, place], passed_on[:, chain, place], strict=True)
            at_drive = [DriveLine(*map(float, line)) for line in lines]
            top = 1 + int(np.argmax(height[1:]))
            beads.append(HighestLine(chain + 1, bead, float(self.frequency[top]), float(height[top]), at_drive))
        first = np.nan
        for chain, _, frequency in drives(problem)[:1]:
            first = float(passed_on[np.searchsorted(self.drive, frequency), chain - 1, -1])
        resolution = float(self.frequency[1] - self.frequency[0])
        cycles = bands(problem.system)
        return SpectralLines(self.after, resolution, beads, first, None if cycles is None else cycles / (2.0 * np.pi))

    def table(self) -> SpectrumTable:
        """Table of the spectra, with a row for each frequency and a column for each chain and bead."""
        amplitude = {
            f"chain {chain + 1} bead {bead}": self.amplitude[:, chain, place]
            for chain in range(self.amplitude.shape[1])
            for place, bead in enumerate(self.beads)
        }
        return SpectrumTable(self.frequency, amplitude)


def window(count: int) -> Floats:
    """Hann's window, [frame], periodic, of sum 1: little leakage to other frequencies (Harris, Proc. IEEE 66, 1978)."""
    shape = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(count) / count)
    return np.asarray(shape / shape.sum())


def amplitudes(signal: Floats, every: float) -> tuple[Floats, Floats]:
    """Frequencies [line] and amplitudes [line, ...] of a signal [frame, ...] without its mean; ``every`` in T."""
    from scipy.fft import rfft, rfftfreq

    about_mean = signal - signal.mean(axis=0)
    weight = window(len(signal)).reshape(-1, *(1,) * (signal.ndim - 1))
    return np.asarray(rfftfreq(len(signal), every)), np.asarray(2.0 * np.abs(rfft(weight * about_mean, axis=0)))


def amplitude_at(signal: Floats, every: float, frequency: float) -> Floats:
    """Amplitude [...] at just one frequency of a signal [frame, ...]."""
    turn = np.exp(-2j * np.pi * frequency * every * np.arange(len(signal))) * window(len(signal))
    return np.asarray(2.0 * np.abs(np.tensordot(turn, signal - signal.mean(axis=0), axes=1)))


def drives(problem: Problem) -> list[tuple[int, int, float]]:
    """(chain, bead, frequency) of every drive."""
    forces = [(load.chain, load.bead, load.law.omega) for load in problem.system.loads if isinstance(load.law, Sine)]
    motions = [(motion.chain, motion.bead, motion.omega) for motion in problem.system.motions]
    return [(chain, bead, omega / (2.0 * np.pi)) for chain, bead, omega in (*motions, *forces)]


class SpectrumMeter:
    """Collects the velocities of a few beads from a run that is given block by block, all frames of which it holds.

    Args:
        problem: what was run.
        beads: numbers of the beads, from 1.
        after: time from which on frames count, in units of T; half of the duration by default.
    """

    def __init__(self, problem: Problem, beads: tuple[int, ...], after: float | None = None) -> None:
        self.problem = problem
        self.beads = beads
        self.after = 0.5 * problem.duration if after is None else after
        self._columns = np.searchsorted(problem.recorded_beads, beads)
        self._velocity: list[Floats] = []

    def add(self, block: Trajectory) -> None:
        """Take the next frames."""
        self._velocity.append(block.velocity[block.time >= self.after * (1.0 - 1e-12)][:, :, self._columns])

    def result(self) -> VelocitySpectra | None:
        """Spectra of the frames so far; None if they are too few."""
        velocity = np.concatenate(self._velocity)
        if len(velocity) < LEAST_FRAMES:
            return None
        every = self.problem.every
        frequency, amplitude = amplitudes(velocity, every)
        drive = np.unique([each[2] for each in drives(self.problem)])
        unknown = np.full(velocity.shape[1:], np.nan)
        at_drive = [amplitude_at(velocity, every, of) if of < 0.5 / every else unknown for of in drive.tolist()]
        return VelocitySpectra(
            self.beads, self.after, frequency, amplitude, drive, np.reshape(at_drive, (-1, *unknown.shape))
        )
