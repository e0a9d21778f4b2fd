"""Dispersion of small waves in a loaded chain, exact, from the eigenvalues of a unit cell.

Small motions about rest are those of a lattice of springs, ``omega = 2 sqrt(k / m) |sin(q / 2)|`` for equal beads;
two alternating beads have bands with the edges ``2 k / M``, ``2 k / m`` and ``2 k (1 / m + 1 / M)`` (of omega squared;
Brillouin, Wave Propagation in Periodic Structures, 1946).

Plug-ins take this module for small waves in loaded chains: `bands` has the frequencies at which they pass, `cell_of`
the `UnitCell`, with branches and modes at any wavenumber, or a `NoDispersionError` that says why there is none.

Examples:
    >>> system = granchain.load("precompressed").system
    >>> unit_cell.bands(system).round(3)  # [branch, 2] in 1 / T
    array([[0.   , 2.479]])
    >>> unit_cell.bands(granchain.load("one-chain").system) is None  # without a load there is no sound
    True
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.shape.long_waves import repeats
from analysis.trajectory import Floats
from lammps_inputs import System, laws, physics

Complexes = NDArray[np.complex128]

MOST_BRANCHES = 60

NO_SOUND = "no static load, so that the chain transmits no sound (a sonic vacuum)"

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
        """Angular frequencies of all branches.

        Args:
            wavenumber: [wavenumber] in units of radians a bead.

        Returns:
            [wavenumber, branch] in units of 1 / T, ascending.
        """
        squares = np.linalg.eigvalsh(self._dynamical_matrix(wavenumber))
        return np.asarray(np.sqrt(np.maximum(squares, 0.0)))

    def modes(self, wavenumber: Floats) -> tuple[Floats, Complexes]:
        """Angular frequencies of all branches, and their mode shapes.

        A shape is that of the velocities over ``exp(i q n)``, n counting the beads, times the root of the masses:
        shapes of one wavenumber are orthonormal. It is 0 where there is no atom.

        Args:
            wavenumber: [wavenumber] in units of radians a bead.

        Returns:
            [wavenumber, branch] in units of 1 / T, ascending; [wavenumber, branch, line, bead] dimensionless.
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
        """Lowest and highest angular frequency of every branch, [branch, 2] in units of 1 / T.

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
    for spring in system.ground:
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


def bands(system: System) -> Floats | None:
    """Lowest and highest angular frequency of every branch of small waves.

    Args:
        system: masses and links.

    Returns:
        [branch, 2] in units of 1 / T; None where there is no dispersion relation (`cell_of`).
    """
    try:
        return cell_of(system).bands()
    except NoDispersionError:
        return None
