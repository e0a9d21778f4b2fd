"""Spectra of beads' velocities, and how much of a drive's motion reaches them."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from analysis import quantity
from analysis.figures.panels import Marks, Panel, Sheet, axis_unit, curves_of, shown_chains, title
from analysis.meters import Meter, Part
from analysis.quantity import declare, result
from analysis.shape.unit_cell import bands
from analysis.sharing.run_error import MeasuredError
from analysis.sharing.survey import Survey
from analysis.trajectory import Floats
from lammps_inputs import Problem
from workflow.measures.measurement import MOST_CHAINS, Measurement, Recorded
from workflow.screen import PrintedTable

LEAST_FRAMES = 16

BY_FRAMES = "by the time between frames and by the run (``run_error``)"

MOST_BEADS = 8
"""Beads that the figure shows."""


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
    amplitude_error: float = declare(f"uncertainty of the amplitude {BY_FRAMES}", "velocity", "as ``amplitude``")
    transmissibility_error: float = declare(
        "uncertainty of the transmissibility by those of both amplitudes; 0 at the first chosen bead",
        undefined="as ``transmissibility``, or the first chosen bead moves less than the uncertainty of its amplitude",
    )


@result
class HighestLine:
    """Highest line in the spectrum of one bead."""

    chain: int = declare("number of the chain")
    bead: int = declare("number of the bead")
    frequency: float = declare("frequency of the highest line of the velocity above frequency 0", "cycles", symbol="f")
    amplitude: float = declare("amplitude of that line", "velocity")
    frequency_error: float = declare(
        "uncertainty of ``frequency``: half of the distance of two lines, and distance of the farthest line that may "
        "be the highest by the uncertainties of amplitudes",
        "cycles",
    )
    amplitude_error: float = declare(
        f"uncertainty of ``amplitude`` {BY_FRAMES}: changes with every second frame, from the first or the second on, "
        "and with one frame less at either end",
        "velocity",
    )
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
    transmissibility_error: float = declare(
        "uncertainty of ``transmissibility`` by those of both amplitudes",
        undefined="as ``transmissibility``, or the first chosen bead moves less than the uncertainty of its amplitude",
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
    error: dict[str, Floats] = declare(
        f"uncertainty of each amplitude {BY_FRAMES}, in columns such as ``chain 1 bead 10 error``", "velocity"
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
        amplitude_error, at_drive_error: their uncertainties, of the same shapes.
    """

    DEEPEST: ClassVar[float] = 1e-8
    """Lower end of the axis of amplitudes, over the largest; what is smaller lies below the axis."""

    beads: tuple[int, ...]
    after: float
    frequency: Floats
    amplitude: Floats
    drive: Floats
    at_drive: Floats
    amplitude_error: Floats
    at_drive_error: Floats

    def with_error(self, error: MeasuredError) -> "VelocitySpectra":
        """Spectra whose uncertainties cover the error of the run: amplitudes are twice weighted means of velocity."""
        added = 2.0 * error.velocity
        return replace(self, amplitude_error=self.amplitude_error + added, at_drive_error=self.at_drive_error + added)

    @property
    def transmissibility(self) -> Floats:
        """[drive, chain, bead] amplitude at a drive's frequency over that of the chain's first chosen bead.

        NaN where that does not move.
        """
        first = self.at_drive[..., :1]
        return np.asarray(self.at_drive / np.where(first > 0.0, first, np.nan))

    @property
    def transmissibility_error(self) -> Floats:
        """[drive, chain, bead] uncertainty of the transmissibility; 0 at the first chosen bead.

        NaN where that moves no more than the uncertainty of its amplitude.
        """
        first, off = self.at_drive[..., :1], self.at_drive_error[..., :1]
        least = np.where(first > off, first - off, np.nan)
        error = (self.at_drive_error + self.transmissibility * off) / least
        error[..., 0] = 0.0 * self.transmissibility[..., 0]
        return np.asarray(error)

    @property
    def resolution(self) -> float:
        """Distance of two lines, in cycles in a unit of time."""
        return float(self.frequency[1] - self.frequency[0])

    def found(self, problem: Problem) -> SpectralLines:
        """The highest lines, and those at the drives."""
        passed_on, off = self.transmissibility, self.transmissibility_error
        beads = []
        for chain, place in np.ndindex(problem.chains, len(self.beads)):
            columns = (values[:, chain, place] for values in (self.at_drive, passed_on, self.at_drive_error, off))
            at_drive = [DriveLine(*map(float, line)) for line in zip(self.drive, *columns, strict=True)]
            beads.append(self._highest(chain, place, at_drive))
        first = first_error = np.nan
        for chain, _, frequency in drives(problem)[:1]:
            place = np.searchsorted(self.drive, frequency), chain - 1, -1
            first, first_error = float(passed_on[place]), float(off[place])
        cycles = bands(problem.system)
        in_bands = None if cycles is None else cycles / (2.0 * np.pi)
        return SpectralLines(self.after, self.resolution, beads, first, first_error, in_bands)

    def _highest(self, chain: int, place: int, at_drive: list[DriveLine]) -> HighestLine:
        """Highest line of a bead above frequency 0; chain and bead by position."""
        height, error = self.amplitude[1:, chain, place], self.amplitude_error[1:, chain, place]
        top = int(np.argmax(height))
        possible = height + error >= height[top] - error[top]
        off = 0.5 * self.resolution + float(np.max(np.abs(self.frequency[1:] - self.frequency[1 + top])[possible]))
        return HighestLine(
            chain=chain + 1,
            bead=self.beads[place],
            frequency=float(self.frequency[1 + top]),
            amplitude=float(height[top]),
            frequency_error=off,
            amplitude_error=float(error[top]),
            at_drive=at_drive,
        )

    def table(self) -> SpectrumTable:
        """Table of the spectra, with a row for each frequency and columns for each chain and bead."""
        columns = {
            f"chain {chain + 1} bead {bead}": (slice(None), chain, place)
            for chain in range(self.amplitude.shape[1])
            for place, bead in enumerate(self.beads)
        }
        return SpectrumTable(
            self.frequency,
            {name: self.amplitude[column] for name, column in columns.items()},
            {f"{name} error": self.amplitude_error[column] for name, column in columns.items()},
        )


def hann(count: int) -> Floats:
    """Hann's window, [frame], periodic, of sum 1: little leakage to other frequencies (Harris, Proc. IEEE 66, 1978)."""
    shape = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(count) / count)
    return np.asarray(shape / shape.sum())


def amplitudes(signal: Floats, every: float) -> tuple[Floats, Floats]:
    """Frequencies [line] and amplitudes [line, ...] of a signal [frame, ...] without its mean; ``every`` in T."""
    from scipy.fft import rfft, rfftfreq

    about_mean = signal - signal.mean(axis=0)
    weight = hann(len(signal)).reshape(-1, *(1,) * (signal.ndim - 1))
    return np.asarray(rfftfreq(len(signal), every)), np.asarray(2.0 * np.abs(rfft(weight * about_mean, axis=0)))


def amplitude_errors(height: Callable[[slice], Floats]) -> Floats:
    """Uncertainties of amplitudes, [...], by the time between frames.

    Every second frame shows what higher frequencies add, and a frame less at either end how the time counts that frames
    stand for. The sum of these changes holds in 99 of 100 lines of installed scenes with frames 0.1 T to 1 T apart.

    Args:
        height: amplitudes, [...], of chosen frames.
    """
    amplitude, others = height(slice(None)), (slice(0, None, 2), slice(1, None, 2), slice(0, -1), slice(1, None))
    even, odd, earlier, later = (np.abs(height(frames) - amplitude) for frames in others)
    return np.asarray(np.maximum(even, odd) + earlier + later)


def on_lines(signal: Floats, frames: slice) -> Floats:
    """Amplitudes [line, ...] of chosen frames of a signal [frame, ...] at the lines of all frames."""
    from scipy.fft import rfft

    chosen = signal[frames]
    weight = hann(len(chosen)).reshape(-1, *(1,) * (signal.ndim - 1))
    sparse = np.zeros_like(signal)
    sparse[frames] = weight * (chosen - chosen.mean(axis=0))
    return np.asarray(2.0 * np.abs(rfft(sparse, axis=0)))


def amplitude_at(signal: Floats, every: float, frequency: float) -> Floats:
    """Amplitude [...] at just one frequency of a signal [frame, ...]."""
    turn = np.exp(-2j * np.pi * frequency * every * np.arange(len(signal))) * hann(len(signal))
    return np.asarray(2.0 * np.abs(np.tensordot(turn, signal - signal.mean(axis=0), axes=1)))


def drives(problem: Problem) -> list[tuple[int, int, float]]:
    """(chain, bead, frequency) of every drive."""
    forces = [(load.chain, load.bead, load.law.omega) for load in problem.system.loads if load.law.omega]
    motions = [
        (motion.chain, motion.bead, law.omega) for motion in problem.system.motions for law in motion.laws if law.omega
    ]
    return [(chain, bead, omega / (2.0 * np.pi)) for chain, bead, omega in (*motions, *forces)]


@dataclass(frozen=True)
class SpectrumMeter(Meter[Floats, VelocitySpectra | None]):
    """Spectra of the velocities of a few beads.

    Attributes:
        problem: what was run.
        beads: numbers of the beads, from 1.
        after: time from which on frames count, in units of T; None for half of the duration.
    """

    problem: Problem
    beads: tuple[int, ...]
    after: float | None = None

    @property
    def start(self) -> float:
        """Time from which on frames count, in units of T."""
        return 0.5 * self.problem.duration if self.after is None else self.after

    def of_part(self, part: Part) -> Floats:
        """Velocities of the beads in the frames that count, [frame, chain, bead]."""
        block, columns = part.frames, part.frames.positions(self.beads)
        return np.asarray(block.velocity[block.time >= self.start * (1.0 - 1e-12)][:, :, columns])

    def result(self, pieces: list[Floats]) -> VelocitySpectra | None:
        """Spectra of velocities [frame, chain, bead] in all frames that count; None if they are too few."""
        velocity = np.concatenate(pieces)
        if len(velocity) < LEAST_FRAMES:
            return None
        every = self.problem.every
        frequency, amplitude = amplitudes(velocity, every)
        drive = np.unique([each[2] for each in drives(self.problem)])
        at_drive, at_drive_error = np.full((2, len(drive), *velocity.shape[1:]), np.nan)
        for k in np.flatnonzero(drive < 0.5 / every):

            def height(frames: slice, of: float = float(drive[k])) -> Floats:
                """Amplitudes, [chain, bead], at the drive's frequency in chosen frames."""
                return amplitude_at(velocity[frames], every * (frames.step or 1), of)

            at_drive[k], at_drive_error[k] = height(slice(None)), amplitude_errors(height)
        errors = amplitude_errors(lambda frames: on_lines(velocity, frames))
        return VelocitySpectra(self.beads, self.start, frequency, amplitude, drive, at_drive, errors, at_drive_error)


@dataclass(frozen=True, repr=False)
class SpectrumMeasurement(Measurement):
    """Spectra of the velocities of chosen beads."""

    key, kind, figure = "spectra", SpectralLines, "spectra"
    table = "spectra.csv", SpectrumTable

    values: SpectralLines
    spectra: VelocitySpectra

    def lines(self) -> Iterator[PrintedTable]:
        """The highest line of every bead, and what it has of the drives."""
        spectra, highest, scale = self.spectra, self.values, self.problem.scale
        words = {"frequency": "highest line at", "amplitude": "its velocity"}
        head = ["bead", "chain", *quantity.headings(HighestLine, scale, words)]
        for frequency in spectra.drive:
            at = scale.heading(f"at {frequency / scale.time:.5g}", "cycles")
            head.append(f"{at}, over bead {spectra.beads[0]}")
        rows = []
        for peak in sorted(highest.beads, key=lambda line: (spectra.beads.index(line.bead), line.chain)):
            if peak.chain <= MOST_CHAINS:
                line = [quantity.written(peak, name, scale, ".5g") for name in words]
                passed_on = [quantity.cell(drive.transmissibility, ".5g") for drive in peak.at_drive]
                rows.append([str(peak.bead) if peak.chain == 1 else "", str(peak.chain), *line, *passed_on])
        start = scale.written(highest.after, "time", ".5g")
        yield PrintedTable(f"spectra from t = {start} on", head, rows)

    def rows(self) -> SpectrumTable:
        """All lines."""
        return self.spectra.table()

    def sheet(self) -> Sheet:
        """One panel a bead (the first eight), a line for each chain of other figures, and frequencies of drives."""
        problem, spectra = self.problem, self.spectra
        velocity = axis_unit(problem, "velocity", float(np.max(spectra.amplitude)))
        frequency = axis_unit(problem, "cycles", float(np.max(spectra.frequency)))
        top = float(np.max(spectra.amplitude, initial=1e-30)) * velocity.worth
        ends = spectra.DEEPEST * top, 2.0 * top
        x = frequency.axis(SpectrumTable, "frequency")
        y = velocity.axis(SpectrumTable, "amplitude", "velocity amplitude", ends=ends, log=True)
        look = {"color": "0.4", "linewidth": 0.9, "linestyle": ":"}
        drive = Marks(spectra.drive * frequency.worth, "frequency of the drive", look)
        chains, lines = shown_chains(problem), spectra.frequency * frequency.worth
        shown = [
            Panel(
                x,
                y,
                curves_of(chains, lines, spectra.amplitude[:, chains, place] * velocity.worth),
                f"bead {bead}",
                marks=(drive,),
            )
            for place, bead in enumerate(spectra.beads[:MOST_BEADS])
        ]
        heading = title(problem, each_chain=True)
        return Sheet(heading, [[panel] for panel in shown], max(2.8, 1.0 + 1.6 * len(shown)), same_y="all")

    @classmethod
    def meter(cls, run: Recorded) -> SpectrumMeter | None:
        """Spectra of the beads that the scene names."""
        wanted, problem = run.scene.output.spectra, run.problem
        if wanted is None:
            return None
        after = None if wanted.after is None else wanted.after / problem.scale.time
        return SpectrumMeter(problem, wanted.beads, after)

    @classmethod
    def of_run(cls, run: Recorded, survey: Survey, measured: VelocitySpectra | None) -> Self | None:
        """The spectra and their highest lines; None of too few frames."""
        del survey
        if measured is None:
            return None
        spectra = measured.with_error(run.error)
        return cls(run.problem, spectra.found(run.problem), spectra)
