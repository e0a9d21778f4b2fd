"""Spectra of beads' velocities, and how much of a drive's motion reaches them."""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from analysis import quantity
from analysis.quantity import declare, result
from analysis.shape.unit_cell import bands
from analysis.sharing.survey import Survey
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem
from lammps_inputs.laws.in_time import Sine
from workflow.measures.measurement import MOST_CHAINS, Measurement, Meter, Recorded
from workflow.screen import PrintedTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LEAST_FRAMES = 16

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

    DEEPEST: ClassVar[float] = 1e-8
    """Lower end of the axis of amplitudes, over the largest; what is smaller lies below the axis."""

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


def amplitude_at(signal: Floats, every: float, frequency: float) -> Floats:
    """Amplitude [...] at just one frequency of a signal [frame, ...]."""
    turn = np.exp(-2j * np.pi * frequency * every * np.arange(len(signal))) * hann(len(signal))
    return np.asarray(2.0 * np.abs(np.tensordot(turn, signal - signal.mean(axis=0), axes=1)))


def drives(problem: Problem) -> list[tuple[int, int, float]]:
    """(chain, bead, frequency) of every drive."""
    forces = [(load.chain, load.bead, load.law.omega) for load in problem.system.loads if isinstance(load.law, Sine)]
    motions = [(motion.chain, motion.bead, motion.omega) for motion in problem.system.motions]
    return [(chain, bead, omega / (2.0 * np.pi)) for chain, bead, omega in (*motions, *forces)]


class SpectrumMeter(Meter):
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
        self._velocity: list[Floats] = []

    def add(self, block: Trajectory) -> None:
        """Take the next frames."""
        self._velocity.append(
            block.velocity[block.time >= self.after * (1.0 - 1e-12)][:, :, block.positions(self.beads)]
        )

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

    def finish(self, survey: Survey) -> "SpectrumMeasurement | None":
        """The spectra and their highest lines; None of too few frames."""
        del survey
        spectra = self.result()
        return None if spectra is None else SpectrumMeasurement(self.problem, spectra.found(self.problem), spectra)


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

    def draw(self) -> "Figure":
        """One panel a bead (the first eight), a line for each chain of other figures, and frequencies of drives."""
        from analysis.figures import style  # matplotlib takes half a second to import

        problem, spectra = self.problem, self.spectra
        velocity = style.axis_unit(problem, "velocity", float(np.max(spectra.amplitude)))
        frequency = style.axis_unit(problem, "cycles", float(np.max(spectra.frequency)))
        count, chains = min(len(spectra.beads), MOST_BEADS), style.shown_chains(problem)
        top = float(np.max(spectra.amplitude, initial=1e-30)) * velocity.worth
        with style.settings():
            figure = style.new_figure(max(2.8, 1.0 + 1.6 * count))
            axes = np.atleast_1d(figure.subplots(count, 1, sharex=True, sharey=True))
            axes[0].set_ylim(spectra.DEEPEST * top, 2.0 * top)  # before the scale is logarithmic: a bead may be at rest
            for place, axis in enumerate(axes):
                height = spectra.amplitude[:, chains, place] * velocity.worth
                style.draw_chains(axis, chains, spectra.frequency * frequency.worth, height)
                axis.set_yscale("log")
                for number, drive in enumerate(spectra.drive):
                    label = None if number else "drive"
                    look = {"color": "0.4", "linewidth": 0.9, "linestyle": ":"}
                    axis.axvline(drive * frequency.worth, label=label, **look)
                axis.set_title(f"bead {spectra.beads[place]}", loc="left")
            figure.supylabel(velocity.label(SpectrumTable, "amplitude", "amplitude of the velocity"), fontsize="medium")
            axes[-1].set_xlabel(frequency.label(SpectrumTable, "frequency"))
            style.finish(figure, problem, axes)
        return figure

    @classmethod
    def meter(cls, run: Recorded) -> SpectrumMeter | None:
        """Spectra of the beads that the scene names."""
        wanted, problem = run.scene.output.spectra, run.problem
        if wanted is None:
            return None
        after = None if wanted.after is None else wanted.after / problem.scale.time
        return SpectrumMeter(problem, wanted.beads, after)
