"""Dispersion of small waves in a loaded chain: exact, from the eigenvalues of a cell, and as a run shows it.

Small motions about rest are those of a lattice of springs, ``omega = 2 sqrt(k / m) |sin(q / 2)|`` for equal beads;
two alternating beads have bands with the edges ``2 k / M``, ``2 k / m`` and ``2 k (1 / m + 1 / M)`` (of omega squared;
Brillouin, Wave Propagation in Periodic Structures, 1946).
"""

import math
from dataclasses import dataclass

import numpy as np

from analysis.quantity import declare, result
from analysis.shape.long_waves import repeats
from analysis.trajectory import Floats, Integers, Trajectory, direction_of
from lammps_inputs import Problem, System, laws, physics

MOST_BRANCHES = 60

MOST_NUMBERS = 20_000_000
"""Velocities that are held."""

FAINTEST = 1e-9
"""Share of the largest power that a ridge must have."""

NO_SOUND = "no static load, so that the chain transmits no sound (a sonic vacuum)"

_POINTS = 200
"""Wavenumbers from 0 to the edge of a zone at which bands are looked for."""


class NoDispersionError(Exception):
    """A system has none that could be drawn; says why."""


@dataclass(frozen=True)
class Cell:
    """What repeats along the chains: stiffness at rest and masses of a few rows.

    Attributes:
        mass: [line, bead] of the chains, and of inner atoms after them; 0 where there is none.
        along: [chain, bead] of each bead's contact with the next; the last one's with the next cell.
        row: [bead, line, line] stiffness of the springs across, to the ground and to inner atoms.
    """

    mass: Floats
    along: Floats
    row: Floats

    @property
    def beads(self) -> int:
        """Of a chain in the cell."""
        return int(self.mass.shape[1])

    def branches(self, wavenumber: Floats) -> Floats:
        """Angular frequencies, ascending, [wavenumber, branch]; wavenumbers in radians a bead."""
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
        there = np.flatnonzero(self.mass)
        root = np.sqrt(self.mass.ravel()[there])
        matrix = matrix.reshape(len(wavenumber), lines * beads, -1)[:, there[:, np.newaxis], there]
        squares = np.linalg.eigvalsh(matrix / (root[:, np.newaxis] * root))
        return np.sqrt(np.maximum(squares, 0.0))

    def ratio(self, frequency: float) -> float:
        """Displacement of a bead over that of the one before, of a motion of an angular frequency in a gap.

        Of a single chain whose beads, with their inner atoms, are the same. NaN within a band.

        Raises:
            NoDispersionError: it is another.
        """
        if self.along.shape != (1, 1):
            raise NoDispersionError("the ratio from bead to bead is known of a single chain of equal beads")
        stiffness = self.row[0] - frequency**2 * np.diag(self.mass[:, 0])
        there = np.flatnonzero(self.mass[1:, 0]) + 1
        own = stiffness[0, 0]
        if len(there):
            own -= stiffness[0, there] @ np.linalg.solve(stiffness[np.ix_(there, there)], stiffness[there, 0])
        half = 1.0 + 0.5 * own / float(self.along[0, 0])
        return math.nan if abs(half) < 1.0 else math.copysign(math.exp(-math.acosh(abs(half))), half)

    def bands(self) -> Floats:
        """Lowest and highest frequency of every branch, [branch, 2]."""
        found = self.branches(np.linspace(0.0, math.pi / self.beads, _POINTS + 1))
        return np.stack([found.min(axis=0), found.max(axis=0)], axis=-1)


def cell_of(system: System) -> Cell:
    """The shortest piece that repeats, the first and last rows left out.

    Raises:
        NoDispersionError: there is no sound, or nothing repeats.
    """
    if not physics.loaded(system):
        raise NoDispersionError(NO_SOUND)
    if physics.varying(system):
        raise NoDispersionError("springs to the ground vary in time")
    chains, beads, lines = system.chains, system.beads, physics.lines(system)
    inner = np.zeros((0, beads)) if system.inner_mass is None else system.inner_mass
    mass = np.vstack([np.broadcast_to(system.mass, (chains, beads)), inner])
    along = np.zeros((chains, beads))
    for link in system.along:
        along[:, :-1] += laws.stiffness(link.law, 0.0)
    row = np.zeros((beads, lines, lines))
    for tie in (*system.across, *system.inner_links):
        stiff = np.broadcast_to(laws.stiffness(tie.law, 0.0), (len(tie.edges), beads))
        for k, (one, other) in enumerate(tie.edges):
            for here, there in ((one, other), (other, one)):
                row[:, here, here] += stiff[k]
                row[:, here, there] -= stiff[k]
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
    return Cell(mass[:, 1 : period + 1], along[:, 1 : period + 1], row[1 : period + 1])


WITHOUT_MAP = "there is no map"


@result
class Bands:
    """Of small waves; or why they are not known."""

    why: str | None = declare("reason why there is no map", undefined="there is one")
    beads: int | None = declare("beads of a cell, what repeats along the chains", "beads", WITHOUT_MAP, default=None)
    bands: Floats | None = declare(
        "lowest and highest angular frequency of every branch, exact", "frequency", WITHOUT_MAP, "\\omega", default=None
    )
    measured: Floats | None = declare(
        "lowest and highest angular frequency of every branch as the run shows them",
        "frequency",
        f"{WITHOUT_MAP}; of a branch without power in the run",
        default=None,
    )
    bin: float | None = declare("resolution of measured frequencies", "frequency", WITHOUT_MAP, default=None)


@result
class Branches:
    """Table of the branches: an entry for each wavenumber and branch."""

    wavenumber: Floats = declare("wavenumber, radians a bead", "rad/bead", symbol="q")
    branch: Integers = declare("number of the branch, from the lowest")
    frequency: Floats = declare("exact angular frequency", "frequency", symbol="\\omega")
    measured: Floats = declare("angular frequency of the run", "frequency", "the run has no power there")


@dataclass(frozen=True)
class Map:
    """Power of velocity over wavenumber and frequency, and the exact branches.

    Attributes:
        chain: whose velocity, counted from 1.
        wavenumber: [column] ascending, from -pi to pi, radians a bead; positive along higher bead numbers.
        frequency: [row] angular, in 1 / T.
        power: [row, column], in that of the largest.
        cell: what repeats.
        folded: [wavenumber] from 0 to the edge of the first zone, at which branches were looked for.
        exact, measured: [wavenumber, branch] angular frequencies there; measured NaN where there was no power.
    """

    chain: int
    wavenumber: Floats
    frequency: Floats
    power: Floats
    cell: Cell
    folded: Floats
    exact: Floats
    measured: Floats

    @property
    def bin(self) -> float:
        """Of frequency."""
        return float(self.frequency[1])

    def bands(self) -> Bands:
        """Of all branches."""
        return Bands(None, self.cell.beads, self.cell.bands(), self.measured_bands(), self.bin)

    def branches(self) -> Branches:
        """Wavenumber by wavenumber."""
        count = self.exact.shape[1]
        branch = np.tile(np.arange(1, count + 1), len(self.folded))
        return Branches(np.repeat(self.folded, count), branch, self.exact.ravel(), self.measured.ravel())

    def measured_bands(self) -> Floats:
        """Lowest and highest measured frequency of every branch, [branch, 2]; NaN where none was seen."""
        known = np.isfinite(self.measured)
        low = np.where(known, self.measured, np.inf).min(axis=0)
        high = np.where(known, self.measured, -np.inf).max(axis=0)
        seen = known.any(axis=0)
        return np.stack([np.where(seen, low, np.nan), np.where(seen, high, np.nan)], axis=-1)


class Dispersion:
    """Collects the velocity of the chain with the largest excitation, as often as its highest frequency needs.

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
        self._most = max(2, MOST_NUMBERS // problem.beads)
        self._velocity: list[Floats] = []
        self._seen = self._kept = 0
        self._way = direction_of(problem)

    def add(self, block: Trajectory) -> None:
        """Take the next frames."""
        found = block.velocity[-self._seen % self._stride :: self._stride, self._chain - 1]
        self._seen += block.frames
        found = found[: max(0, self._most - self._kept)].copy()
        self._kept += len(found)
        self._velocity.append(found)

    def result(self) -> Map:
        """Of the frames so far.

        Raises:
            NoDispersionError: they are too few.
        """
        velocity = np.concatenate(self._velocity)
        frames, beads = velocity.shape
        if frames < 16:
            raise NoDispersionError(f"{frames} frames are too few")
        windows = [np.hanning(count + 2)[1:-1] for count in (frames, beads)]
        transform = np.fft.fft(np.fft.rfft(velocity * windows[0][:, np.newaxis] * windows[1], axis=0), axis=1)
        # exp(i (q n - omega t)) runs forward
        power: Floats = np.fft.fftshift(np.abs(transform[:, -np.arange(beads) % beads]) ** 2, axes=1)
        wavenumber = np.fft.fftshift(2.0 * math.pi * np.fft.fftfreq(beads))
        frequency = 2.0 * math.pi * np.fft.rfftfreq(frames, self._every)
        power /= np.max(power) or 1.0
        return self._mapped(wavenumber, np.asarray(frequency, dtype=np.float64), power)

    def _mapped(self, wavenumber: Floats, frequency: Floats, power: Floats) -> Map:
        zone = 2.0 * math.pi / self.cell.beads
        step = float(wavenumber[1] - wavenumber[0])
        reduced = np.abs(wavenumber - zone * np.round(wavenumber / zone))
        place = np.round(reduced / step).astype(np.int64)
        folded = np.arange(place.max() + 1) * step
        summed = np.zeros((len(folded), len(frequency)))
        np.add.at(summed, place, power.T)
        folded = np.minimum(folded, 0.5 * zone)
        exact = self.cell.branches(folded)
        middle = 0.5 * (exact[:, 1:] + exact[:, :-1])
        low = np.concatenate([np.zeros((len(folded), 1)), middle], axis=1)
        high = np.concatenate([middle, np.full((len(folded), 1), frequency[-1])], axis=1)
        measured = np.full(exact.shape, np.nan)
        for q in range(len(folded)):
            for branch in range(exact.shape[1]):
                inside = np.flatnonzero((frequency > low[q, branch]) & (frequency <= high[q, branch]))
                if len(inside):
                    measured[q, branch] = _ridge(frequency, summed[q], inside)
        return Map(self._chain, wavenumber, frequency, power, self.cell, folded, exact, measured)


def _ridge(frequency: Floats, power: Floats, inside: Integers) -> float:
    """Where the power is largest, by a parabola through its logarithm; NaN at the border of what is looked at."""
    top = int(inside[np.argmax(power[inside])])
    if not 0 < top < len(frequency) - 1 or power[top] < FAINTEST:
        return math.nan
    if power[top] < power[top - 1] or power[top] < power[top + 1]:
        return math.nan
    before, here, after = np.log(np.maximum(power[top - 1 : top + 2], 1e-300))
    bent = before - 2.0 * here + after
    shift = 0.5 * (before - after) / bent if bent < 0.0 else 0.0
    return float(frequency[top] + shift * frequency[1])
