"""Places from which displacements are counted, where beads of a deck start away from rest.

They are those of static equilibrium, under a load or at the rest of springs; or, where beads fall or fly, places at
which no contact is closed, so that nothing but weights acts on them.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import spsolve

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Bools = NDArray[np.bool_]

MOST_STEPS = 120
"""Steps of Newton's method; contacts that open as an overlap to the power 3/2 need some 30."""

STALLED = 15
"""Steps after which the method ends where forces did not fall by half."""

WEAK = 1e-10
"""Stiffness over the largest that is added, so that beads that nothing holds stay where they are."""

ROUNDED = 1e-9
"""Force over the largest at the start that is none."""


@dataclass(frozen=True)
class Lines:
    """Atoms of a deck in lines, and what LAMMPS says about them.

    Attributes:
        forces: forces on all atoms along the chains, [atom], of those displaced from the start, [atom].
        start: places at the start along the chains, [atom].
        mass: [atom].
        lines: atoms of each chain, then of those inside beads, [line, row]; -1 where there is none.
        radius: radii of the beads, [chain, bead].
        free: whether forces move an atom, [atom].
        limits: lowest and highest place that an atom can have.
    """

    forces: Callable[[Floats], Floats]
    start: Floats
    mass: Floats
    lines: Integers
    radius: Floats
    free: Bools
    limits: tuple[float, float]

    def overlaps(self, place: Floats) -> Floats:
        """Overlaps of neighbouring beads, [chain, contact]."""
        places = place[self.lines[: len(self.radius)]]
        return np.asarray(self.radius[:, :-1] + self.radius[:, 1:] - np.diff(places, axis=1))

    def at(self, place: Floats) -> Floats:
        """Forces on all atoms, [atom], 0 on those that are not free."""
        return np.where(self.free, self.forces(place - self.start), 0.0)


def acceleration(force: Floats, mass: Floats, free: Bools, least: float) -> float | None:
    """Acceleration that all free atoms have, 0 without forces; None where it differs.

    Args:
        force: [atom].
        mass: [atom].
        free: [atom].
        least: force that is rounding.
    """
    if np.max(np.abs(force)) <= least:
        return 0.0
    each = force[free] / mass[free]
    return float(np.mean(each)) if np.ptp(each) <= ROUNDED * np.max(np.abs(each)) + least / np.min(mass) else None


def reference(lines: Lines) -> Floats | None:
    """Places of all atoms along the chains, [atom], from which displacements are counted; None where there are none."""
    least = ROUNDED * float(np.max(np.abs(lines.at(lines.start))))
    opened: dict[float | None, Floats] = {}
    for place in _opened(lines):
        opened.setdefault(acceleration(lines.at(place), lines.mass, lines.free, least), place)
    if 0.0 in opened:
        return opened.pop(0.0)
    falling = next((place for each, place in opened.items() if each is not None), None)
    pressed = bool(np.all(lines.overlaps(lines.start) > 0.0))
    if falling is not None and not pressed:
        return falling
    place, stiffest = _equilibrium(lines)
    rounding = stiffest * float(np.finfo(float).eps * np.max(np.abs([place, lines.start])))
    at_rest = float(np.max(np.abs(lines.at(place)))) <= 100.0 * max(least, rounding)
    return place if at_rest else falling


def _opened(lines: Lines) -> Iterator[Floats]:
    """Places of the start at which overlapping beads just touch, each row moved as one, also away from walls."""
    overlaps = np.maximum(lines.overlaps(lines.start), 0.0)
    shift = np.concatenate([[0.0], np.cumsum(np.max(overlaps, axis=0))])
    away = 2.0 * float(np.max(overlaps)) + 0.01 * float(np.min(lines.radius))
    for step in (0.0, away, -away):
        for rows in (shift, shift - shift[-1]):
            place = lines.start.copy()
            for line in lines.lines:
                present = line >= 0
                place[line[present]] += np.where(lines.free[line], rows + step, 0.0)[present]
            if lines.limits[0] <= np.min(place) and np.max(place) <= lines.limits[1]:
                yield place


def _equilibrium(lines: Lines) -> tuple[Floats, float]:
    """Places at which forces are least, by Newton's method from the start, and the largest stiffness there."""
    place = best = lines.start.copy()
    width = float(np.min(lines.radius))
    smallest, since, move, stiffest = np.inf, 0, 1e-6 * width, 0.0
    for _ in range(MOST_STEPS):
        force = lines.at(place)
        size = float(np.max(np.abs(force)))
        since = 0 if size < 0.5 * smallest else since + 1
        if size < smallest:
            smallest, best = size, place
        if since > STALLED or size == 0.0:
            break
        matrix = _stiffness(lines, place, force, float(np.clip(0.01 * move, 1e-9 * width, 1e-6 * width)))
        stiffest = float(np.max(np.abs(matrix.data), initial=0.0))
        if stiffest == 0.0:
            break
        step = spsolve((matrix + WEAK * stiffest * sparse.identity(len(place))).tocsc(), force)
        after = np.clip(place + step, *lines.limits)
        place, move = after, max(float(np.max(np.abs(after - place))), 1e-15 * width)
    return best, stiffest


def _stiffness(lines: Lines, place: Floats, force: Floats, step: float) -> sparse.csr_matrix:
    """Change of the forces against a displacement of each atom, which acts on its row and on neighbours in its line."""
    shape = (len(place), len(place))
    entries: list[tuple[Floats, Integers, Integers]] = []
    rows = np.arange(lines.lines.shape[1])
    for number, line in enumerate(lines.lines):
        for colour in range(3):
            moved = (rows % 3 == colour) & (line >= 0) & lines.free[line]
            if not np.any(moved):
                continue
            displaced = place.copy()
            displaced[line[moved]] += step
            change = (force - lines.at(displaced)) / step
            for other, atoms in enumerate(lines.lines):
                for offset in (-1, 0, 1) if other == number else (0,):
                    beside = rows[moved] + offset
                    inside = (beside >= 0) & (beside < len(rows))
                    inside[inside] &= atoms[beside[inside]] >= 0
                    target = atoms[beside[inside]]
                    entries.append((change[target], target, line[rows[moved][inside]]))
    if not entries:
        return sparse.csr_matrix(shape)
    values, first, second = (np.concatenate(parts) for parts in zip(*entries, strict=True))
    return sparse.csr_matrix((values, (first, second)), shape=shape)
