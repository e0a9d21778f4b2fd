"""Dispersion of small waves in a loaded chain: exact, from the eigenvalues of a cell, and as a run shows it.

Small motions about rest are those of a lattice of springs, ``omega = 2 sqrt(k / m) |sin(q / 2)|`` for equal beads;
two alternating beads have bands with the edges ``2 k / M``, ``2 k / m`` and ``2 k (1 / m + 1 / M)`` (of omega squared;
Brillouin, Wave Propagation in Periodic Structures, 1946).

Branches of one wavenumber have mode shapes that are orthogonal, with masses as weights. The velocities of all atoms are
therefore projected on the exact shapes of each branch before its frequency is looked for: a weak branch is not hidden
by strong ones.
"""

import itertools
import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from analysis.quantity import declare, result
from analysis.shape.long_waves import repeats
from analysis.trajectory import Floats, Integers, Trajectory
from lammps_inputs import Problem, System, laws, physics

Complexes = NDArray[np.complex128]

MOST_BRANCHES = 60

MOST_NUMBERS = 10_000_000
"""Largest number of velocities that are held in memory."""

FAINTEST = 1e-7
"""Least power of a branch at a wavenumber, over the largest of all: the power of errors of 3e-4 of the velocities."""

NO_SOUND = "no static load, so that the chain transmits no sound (a sonic vacuum)"

SIDE = 4.0
"""Power of a wave at its own wavenumber over that at one farther by 2 pi over the number of beads, by Hann's window."""

_POINTS = 200
"""Intervals of wavenumber, from 0 to the edge of a zone, in each of which a branch has at most one extreme."""

_CROSSING = 1e-7
"""Gap between two branches, of squared frequencies over the largest, below which they cross: the kink of a crossing is
found to the root of the rounding error."""


class NoDispersionError(Exception):
    """A system has no dispersion relation that can be computed; the text says why."""


@dataclass(frozen=True)
class UnitCell:
    """Unit cell that repeats along the chains: stiffness at rest and masses of a few rows.

    Attributes:
        mass: [line, bead] of the chains, and of further lines of atoms after them; 0 where there is none.
        along: [chain, bead] of each bead's contact with the next; the last one's with the next cell.
        row: [bead, line, line] stiffness of the springs across and to the ground.
    """

    mass: Floats
    along: Floats
    row: Floats

    @property
    def beads(self) -> int:
        """Number of beads of a chain in the cell."""
        return int(self.mass.shape[1])

    def branches(self, wavenumber: Floats) -> Floats:
        """Angular frequencies in 1 / T, ascending, [wavenumber, branch]; wavenumbers in radians a bead."""
        squares = np.linalg.eigvalsh(self._dynamical_matrix(wavenumber))
        return np.asarray(np.sqrt(np.maximum(squares, 0.0)))

    def modes(self, wavenumber: Floats) -> tuple[Floats, Complexes]:
        """Angular frequencies [wavenumber, branch] in 1 / T, ascending; mode shapes [wavenumber, branch, line, bead].

        A shape is that of the velocities over ``exp(i q n)``, n counting the beads, times the root of the masses:
        shapes of one wavenumber are orthonormal. It is 0 where there is no atom.
        """
        squares, vectors = np.linalg.eigh(self._dynamical_matrix(wavenumber))
        shapes = np.zeros((*squares.shape, self.mass.size), dtype=complex)
        shapes[:, :, np.flatnonzero(self.mass)] = np.swapaxes(vectors, 1, 2)
        return np.sqrt(np.maximum(squares, 0.0)), shapes.reshape(*squares.shape, *self.mass.shape)

    def _dynamical_matrix(self, wavenumber: Floats) -> Complexes:
        """Stiffness over the root of both masses, [wavenumber, atom, atom]; its eigenvalues are squared frequencies."""
        lines, beads = self.mass.shape
        matrix = np.zeros((len(wavenumber), lines, beads, lines, beads), dtype=complex)
        phase = np.exp(1j * wavenumber)
        chain = np.arange(len(self.along))
        for bead in range(beads):
            after, spring = (bead + 1) % beads, self.along[:, bead]
            matrix[:, chain, bead, chain, bead] += spring
            matrix[:, chain, after, chain, after] += spring
            matrix[:, chain, bead, chain, after] -= spring * phase[:, np.newaxis]
            matrix[:, chain, after, chain, bead] -= spring * phase.conj()[:, np.newaxis]
            matrix[:, :, bead, :, bead] += self.row[bead]
        atoms = np.flatnonzero(self.mass)
        root = np.sqrt(self.mass.ravel()[atoms])
        matrix = matrix.reshape(len(wavenumber), lines * beads, -1)[:, atoms[:, np.newaxis], atoms]
        return np.asarray(matrix / (root[:, np.newaxis] * root))

    def ratio(self, frequency: float) -> float:
        """Displacement of a bead over that of the one before, in motion of an angular frequency in a gap.

        It is defined for a single chain whose beads, with the atoms tied to them, are the same. NaN within a band.

        Raises:
            NoDispersionError: it is another system.
        """
        if self.along.shape != (1, 1):
            raise NoDispersionError("the ratio from bead to bead is known of a single chain of equal beads")
        stiffness = self.row[0] - frequency**2 * np.diag(self.mass[:, 0])
        tied = np.flatnonzero(self.mass[1:, 0]) + 1
        effective = stiffness[0, 0]
        if len(tied):
            effective -= stiffness[0, tied] @ np.linalg.solve(stiffness[np.ix_(tied, tied)], stiffness[tied, 0])
        half = 1.0 + 0.5 * effective / float(self.along[0, 0])
        return math.nan if abs(half) < 1.0 else math.copysign(math.exp(-math.acosh(abs(half))), half)

    def bands(self) -> Floats:
        """Lowest and highest angular frequency of every branch, [branch, 2] in 1 / T.

        Branches are numbered by their frequency at each wavenumber. Where two of them cross, the end of the lower band
        is the beginning of the upper one.
        """
        wavenumber = np.linspace(0.0, math.pi / self.beads, _POINTS + 1)
        branches = self.branches(wavenumber)
        bands = np.stack([branches.min(axis=0), branches.max(axis=0)], axis=-1)
        for branch, values in enumerate(branches.T):
            for side, sign in enumerate((1.0, -1.0)):
                bands[branch, side] = self._least(wavenumber, branch, sign * values, sign)
        for lower, upper in itertools.pairwise(bands):
            if abs(upper[0] ** 2 - lower[1] ** 2) <= _CROSSING * bands.max() ** 2:
                lower[1] = upper[0] = 0.5 * (lower[1] + upper[0])
        return bands

    def _least(self, wavenumber: Floats, branch: int, values: Floats, sign: float) -> float:
        """Least ``sign`` times frequency of a branch, which has these values at wavenumbers, times the sign again."""
        from scipy.optimize import minimize_scalar

        def value(place: float) -> float:
            return sign * float(self.branches(np.array([place]))[0, branch])

        least = float(values.min())
        steepest = float(np.abs(np.diff(values)).max())
        for point in np.flatnonzero(values <= least + steepest).tolist():
            around = slice(max(point - 1, 0), point + 2)
            if values[point] <= values[around].min():
                bounds = wavenumber[around][[0, -1]]
                least = min(least, float(minimize_scalar(value, bounds=bounds, options={"xatol": 1e-12}).fun))
        return sign * least


def cell_of(system: System) -> UnitCell:
    """The shortest unit cell that repeats along the chains, the first and last rows left out.

    Raises:
        NoDispersionError: there is no sound, or nothing repeats.
    """
    if not physics.loaded(system):
        raise NoDispersionError(NO_SOUND)
    if physics.varying(system):
        raise NoDispersionError("springs to the ground vary in time")
    chains, beads, lines = system.chains, system.beads, physics.lines(system)
    mass = np.broadcast_to(physics.masses(system), (lines, beads))
    along = np.zeros((chains, beads))
    for link in system.along:
        along[:, :-1] += laws.stiffness(link.law, 0.0)
    row = np.zeros((beads, lines, lines))
    for across in system.across:
        stiff = np.broadcast_to(laws.stiffness(across.law, 0.0), (len(across.edges), beads))
        for k, (first, second) in enumerate(across.edges):
            for line, partner in ((first, second), (second, first)):
                row[:, line, line] += stiff[k]
                row[:, line, partner] -= stiff[k]
    for spring in physics.ground_springs(system):
        held = np.broadcast_to(laws.stiffness(spring.law, 0.0), (chains, beads))
        row[:, np.arange(chains), np.arange(chains)] += held.T
    columns = np.concatenate([mass, along, row.reshape(beads, -1).T])[:, 1:-1]
    period = repeats(columns)
    if period is None:
        raise NoDispersionError("beads and their loads do not repeat along the chains in three unit cells or more")
    branches = int(np.count_nonzero(mass[:, 1 : period + 1]))
    if branches > MOST_BRANCHES:
        raise NoDispersionError(f"the chains have {branches} branches; at most {MOST_BRANCHES}")
    return UnitCell(mass[:, 1 : period + 1], along[:, 1 : period + 1], row[1 : period + 1])


WITHOUT_MAP = "there is no map"

NO_POWER = "the branch has no power there, or less than other branches have in its mode shape"


@result
class Bands:
    """Bands of small waves; or the reason why they are unknown."""

    why: str | None = declare("reason why there is no map", undefined="there is one")
    beads: int | None = declare("beads of a cell, what repeats along the chains", "beads", WITHOUT_MAP, default=None)
    bands: Floats | None = declare(
        "lowest and highest angular frequency of every branch, exact", "frequency", WITHOUT_MAP, "\\omega", default=None
    )
    measured: Floats | None = declare(
        "lowest and highest measured angular frequency of every branch (``dispersion.csv``)",
        "frequency",
        f"{WITHOUT_MAP}; of a branch that is measured at no wavenumber",
        default=None,
    )
    bin: float | None = declare("resolution of measured frequencies", "frequency", WITHOUT_MAP, default=None)


@result
class Branches:
    """Table of the branches: an entry for each wavenumber and branch."""

    wavenumber: Floats = declare("wavenumber, radians a bead", "rad/bead", symbol="q")
    branch: Integers = declare("number of the branch, from the lowest")
    frequency: Floats = declare("exact angular frequency", "frequency", symbol="\\omega")
    measured: Floats = declare(
        "angular frequency of the run: that of the largest power of the velocities in the branch's exact mode shape",
        "frequency",
        NO_POWER,
    )
    uncertainty: Floats = declare(
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
    cell: UnitCell
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


class Dispersion:
    """Collects the velocities of all atoms, as often as the highest frequency of their cell needs.

    Raises:
        NoDispersionError: see `cell_of`; or not all beads are recorded, or frames are too far apart.
    """

    def __init__(self, problem: Problem) -> None:
        self.cell = cell_of(problem.system)
        if not problem.whole:
            raise NoDispersionError("it takes the velocities of all beads; record them all")
        top = float(self.cell.bands().max())
        if problem.every * top > math.pi:
            limit = math.pi / top * problem.scale.time
            raise NoDispersionError(
                f"frames are farther apart than half a period of its highest frequency, {limit:.3g}; record more often"
            )
        self._stride = max(1, int(0.7 * math.pi / (problem.every * top)))
        self._chain = physics.largest_excitation(problem.system)[0]
        self._every = problem.every * self._stride
        self._limit = max(2, MOST_NUMBERS // (problem.beads * physics.lines(problem.system)))
        self._velocity: list[Floats] = []
        self._passed = self._frames = 0

    def add(self, block: Trajectory) -> None:
        """Take the next frames."""
        velocity = block[-self._passed % self._stride :: self._stride].atoms[1]
        self._passed += block.frames
        velocity = velocity[: max(0, self._limit - self._frames)].copy()
        self._frames += len(velocity)
        self._velocity.append(velocity)

    def result(self) -> Map:
        """Map and branches of the frames so far.

        Raises:
            NoDispersionError: they are too few.
        """
        velocity = np.concatenate(self._velocity)
        frames, _, beads = velocity.shape
        if frames < 16:
            raise NoDispersionError(f"{frames} frames are too few")
        velocity *= np.hanning(frames + 2)[1:-1, np.newaxis, np.newaxis] * np.hanning(beads + 2)[1:-1]
        transform = np.fft.fft(np.fft.rfft(velocity[:, self._chain - 1], axis=0), axis=1)
        # exp(i (q n - omega t)) runs forward
        power: Floats = np.fft.fftshift(np.abs(transform[:, -np.arange(beads) % beads]) ** 2, axes=1)
        wavenumber = np.fft.fftshift(2.0 * math.pi * np.fft.fftfreq(beads))
        frequency = np.asarray(2.0 * math.pi * np.fft.rfftfreq(frames, self._every))
        power /= np.max(power) or 1.0
        folded, exact, projected = projected_power(self.cell, velocity)
        measured = measured_branches(frequency, projected, exact)
        return Map(self._chain, wavenumber, frequency, power, self.cell, folded, exact, measured)


def projected_power(cell: UnitCell, velocity: Floats) -> tuple[Floats, Floats, Floats]:
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
