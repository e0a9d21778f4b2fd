"""Dispersion of small waves in a loaded chain as a run shows it, beside the exact one of its unit cell.

Branches of one wavenumber have mode shapes that are orthogonal, with masses as weights. The velocities of all atoms are
therefore projected on the exact shapes of each branch before its frequency is looked for: a weak branch is not hidden
by strong ones.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from granchain.parts import Floats, Integers, Meter, Part, Problem, physics, quantity, unit_cell

MOST_NUMBERS = 10_000_000
"""Largest number of velocities that are held in memory."""

FAINTEST = 1e-7
"""Least power of a branch at a wavenumber, over the largest of all: the power of errors of 3e-4 of the velocities."""


SIDE = 4.0
"""Power of a wave at its own wavenumber over that at one farther by 2 pi over the number of beads, by Hann's window."""


WITHOUT_MAP = "there is no map"

NO_POWER = "the branch has no power there, or less than other branches have in its mode shape"


@quantity.result
class Bands:
    """Bands of small waves; or the reason why they are unknown."""

    why: str | None = quantity.declare("reason why there is no map", undefined="there is one")
    beads: int | None = quantity.declare(
        "beads of a cell, what repeats along the chains", "beads", WITHOUT_MAP, default=None
    )
    bands: Floats | None = quantity.declare(
        "lowest and highest angular frequency of every branch, exact", "frequency", WITHOUT_MAP, "\\omega", default=None
    )
    measured: Floats | None = quantity.declare(
        "lowest and highest measured angular frequency of every branch (``dispersion.csv``)",
        "frequency",
        f"{WITHOUT_MAP}; of a branch that is measured at no wavenumber",
        default=None,
    )
    bin: float | None = quantity.declare("resolution of measured frequencies", "frequency", WITHOUT_MAP, default=None)


@quantity.result
class Branches:
    """Table of the branches: an entry for each wavenumber and branch."""

    wavenumber: Floats = quantity.declare("wavenumber, radians a bead", "rad/bead", symbol="q")
    branch: Integers = quantity.declare("number of the branch, from the lowest")
    frequency: Floats = quantity.declare("exact angular frequency", "frequency", symbol="\\omega")
    measured: Floats = quantity.declare(
        "angular frequency of the run: that of the largest power of the velocities in the branch's exact mode shape",
        "frequency",
        NO_POWER,
    )
    uncertainty: Floats = quantity.declare(
        "uncertainty of ``measured``: the resolution ``bin``, and the change of the exact frequency over that "
        "of wavenumbers, 2 pi / beads",
        "frequency",
        NO_POWER,
    )


@dataclass(frozen=True)
class Map:
    """Power of velocity over wavenumber and frequency, and the exact branches.

    Attributes:
        chain: whose velocity, counted from 1.
        wavenumber: [column] ascending, from -pi to pi, radians a bead; positive along higher bead numbers.
        frequency: [row] angular, in 1 / T.
        power: [row, column], relative to the largest.
        cell: the unit cell.
        folded: [wavenumber] from 0 to the edge of the first zone, at which branches were looked for.
        exact, measured: [wavenumber, branch] angular frequencies there; see `measured_branches`.
    """

    chain: int
    wavenumber: Floats
    frequency: Floats
    power: Floats
    cell: unit_cell.UnitCell
    folded: Floats
    exact: Floats
    measured: Floats

    DECADES: ClassVar[float] = 8.0
    """Decades of power that are shown."""

    HIGHEST: ClassVar[float] = 1.25
    """Largest frequency shown, over the highest of the exact branches."""

    @property
    def bin(self) -> float:
        """Distance of two frequencies, 1 / T."""
        return float(self.frequency[1])

    @property
    def top(self) -> float:
        """Angular frequency up to which a map is shown, in 1 / T."""
        return min(self.HIGHEST * float(self.cell.bands().max()), float(self.frequency[-1]))

    def shown_power(self) -> tuple[Floats, tuple[float, float], tuple[float, float]]:
        """Power of a map as it is shown, and the ends of its axes.

        Returns:
            Decadic logarithm of the power over the largest, [frequency, wavenumber], at least minus `DECADES`; ends in
            wavenumber, in radians a bead; ends in angular frequency, in 1 / T.
        """
        shown = self.frequency <= self.HIGHEST * self.cell.bands().max()
        step = float(self.wavenumber[1] - self.wavenumber[0])
        power, last = self.power[shown], float(self.wavenumber[-1])
        if last + 0.75 * step < math.pi:  # -pi, at the left edge, is pi, too
            power, last = np.concatenate([power, power[:, :1]], axis=1), last + step
        across = (float(self.wavenumber[0]) - 0.5 * step, last + 0.5 * step)
        up = (-0.5 * self.bin, float(self.frequency[shown][-1]) + 0.5 * self.bin)
        return np.log10(np.maximum(power, 10.0**-self.DECADES)), across, up

    def bands(self) -> Bands:
        """Bands of all branches, exact and measured."""
        return Bands(None, self.cell.beads, self.cell.bands(), self.measured_bands(), self.bin)

    def branches(self) -> Branches:
        """Table of all branches, wavenumber by wavenumber."""
        count = self.exact.shape[1]
        branch = np.tile(np.arange(1, count + 1), len(self.folded))
        columns = (values.ravel() for values in (self.exact, self.measured, self.uncertainty()))
        return Branches(np.repeat(self.folded, count), branch, *columns)

    def uncertainty(self) -> Floats:
        """Uncertainty of the measured frequencies, [wavenumber, branch] in 1 / T; NaN where there is none."""
        resolved = 2.0 * math.pi / len(self.wavenumber)
        beside = [self.cell.branches(self.folded + change) for change in (-resolved, resolved)]
        change = np.max([np.abs(frequency - self.exact) for frequency in beside], axis=0)
        return np.where(np.isfinite(self.measured), self.bin + change, np.nan)

    def measured_bands(self) -> Floats:
        """Lowest and highest measured frequency of every branch, [branch, 2] in 1 / T; NaN where none was measured."""
        low, high = np.fmin.reduce(self.measured, axis=0), np.fmax.reduce(self.measured, axis=0)
        return np.stack([low, high], axis=-1)


@dataclass(frozen=True)
class DispersionMeter(Meter[Floats, Map | str]):
    """Map of the velocities of all atoms, taken as often as the highest frequency of their cell needs.

    Attributes:
        problem: what was run.
    """

    problem: Problem

    @cached_property
    def cell(self) -> unit_cell.UnitCell | str:
        """Unit cell of the chains; the reason where frames can show no map of it."""
        problem = self.problem
        try:
            cell = unit_cell.cell_of(problem.system)
        except unit_cell.NoDispersionError as error:
            return str(error)
        if not problem.rows.complete:
            return f"it takes the velocities of all beads, and {problem.rows.missing}"
        top = float(cell.bands().max())
        if problem.every * top > math.pi:
            limit = math.pi / top * problem.scale.time
            return (
                f"frames are farther apart than half a period of its highest frequency, {limit:.3g}; record more often"
            )
        return cell

    @cached_property
    def stride(self) -> int:
        """Number of frames from one that is taken to the next."""
        assert not isinstance(self.cell, str)
        return max(1, int(0.7 * math.pi / (self.problem.every * float(self.cell.bands().max()))))

    def of_part(self, part: Part) -> Floats:
        """Velocities in the frames that are taken, as many as `MOST_NUMBERS` allows, [frame, line, bead]."""
        if isinstance(self.cell, str):
            return np.zeros((0, 0, 0))
        limit = max(2, MOST_NUMBERS // (self.problem.beads * physics.lines(self.problem.system)))
        taken = -(-part.start // self.stride)
        return part.frames[part.every(self.stride)].atoms[1][: max(0, limit - taken)].copy()

    def result(self, pieces: list[Floats]) -> Map | str:
        """Map and branches of velocities [frame, line, bead]; the reason where there are none."""
        if isinstance(self.cell, str):
            return self.cell
        velocity = np.concatenate(pieces)
        frames, _, beads = velocity.shape
        if frames < 16:
            return f"{frames} frames are too few"
        chain, every = physics.largest_excitation(self.problem.system)[0], self.problem.every * self.stride
        velocity *= np.hanning(frames + 2)[1:-1, np.newaxis, np.newaxis] * np.hanning(beads + 2)[1:-1]
        transform = np.fft.fft(np.fft.rfft(velocity[:, chain - 1], axis=0), axis=1)
        # exp(i (q n - omega t)) runs forward
        power: Floats = np.fft.fftshift(np.abs(transform[:, -np.arange(beads) % beads]) ** 2, axes=1)
        wavenumber = np.fft.fftshift(2.0 * math.pi * np.fft.fftfreq(beads))
        frequency = np.asarray(2.0 * math.pi * np.fft.rfftfreq(frames, every))
        power /= np.max(power) or 1.0
        folded, exact, projected = projected_power(self.cell, velocity)
        measured = measured_branches(frequency, projected, exact)
        return Map(chain, wavenumber, frequency, power, self.cell, folded, exact, measured)


def projected_power(cell: unit_cell.UnitCell, velocity: Floats) -> tuple[Floats, Floats, Floats]:
    """Power of velocities in the mode shapes of a cell, waves of both directions together.

    Args:
        cell: the unit cell, which repeats from bead 2 on.
        velocity: [frame, line, bead] of all atoms in units of V, tapered to 0 at both ends of frames and beads.

    Returns:
        Wavenumbers from 0 to the edge of the first zone, radians a bead; exact angular frequencies
        [wavenumber, branch]; power [wavenumber, branch, frequency] at the frequencies of `numpy.fft.rfftfreq`.
    """
    frames, lines, beads = velocity.shape
    before = cell.beads - 1  # bead 1 is the last one of a cell
    cells = -(-(beads + before) // cell.beads)
    padded = np.zeros((frames, lines, cells * cell.beads))
    padded[..., before : before + beads] = velocity
    # twice as many wavenumbers as cells: those of the standing waves of a free chain, and the edge of the zone
    spectrum = np.fft.rfft(padded.reshape(frames, lines, cells, cell.beads), n=2 * cells, axis=2)
    wavenumber = np.linspace(0.0, math.pi / cell.beads, cells + 1)
    exact, shapes = cell.modes(wavenumber)
    to_cell = np.exp(-1j * wavenumber[:, np.newaxis] * np.arange(cell.beads))
    weights = shapes.conj() * np.sqrt(cell.mass) * to_cell[:, np.newaxis, np.newaxis]
    count = frames // 2 + 1
    power = np.empty((*exact.shape, count))
    for place, weight in enumerate(weights):
        amplitude = np.fft.fft(np.tensordot(spectrum[:, :, place], weight, axes=((1, 2), (1, 2))), axis=0)
        both = np.abs(amplitude[:count]) ** 2 + np.abs(amplitude[-np.arange(count)]) ** 2
        power[place] = both.T
    return wavenumber, exact, power


def measured_branches(frequency: Floats, power: Floats, exact: Floats) -> Floats:
    """Frequencies at which branches have their largest power, [wavenumber, branch]; NaN where that is not their own.

    Power leaks from other branches, as mode shapes change with the wavenumber, and from the same branch at other
    wavenumbers, as a chain has only so many beads. A largest power is a branch's own if the exact frequency is within
    the resolution, or no other branch is nearer, and if no other wavenumber, with another exact frequency, has more
    than `SIDE` times this power there.

    Args:
        frequency: [line] angular in 1 / T, evenly spaced.
        power: [wavenumber, branch, line], see `projected_power`.
        exact: [wavenumber, branch] angular frequencies in 1 / T.
    """
    top = 1 + np.argmax(power[..., 1:-1], axis=-1)
    measured = np.full(exact.shape, np.nan)
    resolution, least = float(frequency[1]), FAINTEST * float(power.max())
    for place, branch in np.ndindex(exact.shape):
        peak = power[place, branch, top[place, branch] - 1 : top[place, branch] + 2]
        if peak[1] <= least or peak[1] < peak.max():
            continue
        ridge = float(frequency[top[place, branch]]) + resolution * _summit(peak)
        distance = np.abs(ridge - exact[place])
        at_ridge = power[:, branch, top[place, branch]]
        source = int(np.argmax(at_ridge))
        elsewhere = abs(exact[source, branch] - exact[place, branch]) > resolution and at_ridge[source] > SIDE * peak[1]
        if distance[branch] <= max(resolution, float(distance.min())) and not elsewhere:
            measured[place, branch] = ridge
    return measured


def _summit(peak: Floats) -> float:
    """Place of the maximum of a parabola through the logarithms of three values, in steps from the middle one."""
    before, middle, after = np.log(np.maximum(peak, 1e-300))
    bent = before - 2.0 * middle + after
    return float(0.5 * (before - after) / bent) if bent < 0.0 else 0.0
