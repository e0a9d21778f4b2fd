"""What repeats along the chains: masses and contacts of cells of beads."""

import numpy as np

from analysis.shape.loaded_wave import LONGEST_CELL
from analysis.trajectory import Floats
from lammps_inputs import System

MOSTLY = 0.9
"""Share of the beads that must be alike a cell farther on: single beads may be of another kind."""

_SAME = 1e-9


def period_of(system: System) -> int:
    """Beads of a cell: after how many masses and contacts repeat, but for single beads; 1 where they do not."""
    columns = np.concatenate([_columns(system, chain) for chain in range(system.chains)])
    for period in range(1, min(LONGEST_CELL, system.beads // 3) + 1):
        if np.mean(np.all(_alike(columns, period), axis=0)) > MOSTLY:
            return period
    return 1


def length_of(system: System) -> float:
    """How much longer pulses are, in beads, than in a chain of equal ones.

    The length of a solitary wave follows from the dispersion of long waves, ``omega**2 = c**2 q**2 (1 - beta q**2)``,
    as the root of beta, which is 1/12 for equal beads and springs; here with springs as strong as the contacts.
    """
    period = period_of(system)
    if period == 1:
        return 1.0
    longest = 1.0
    for chain in range(system.chains):
        mass, strength = _columns(system, chain)[:2]
        cells = len(mass) // period
        # the cell that most are like, single beads aside
        typical = (np.median(of[: cells * period].reshape(cells, period), axis=0) for of in (mass, strength))
        longest = max(longest, float(np.sqrt(12.0 * _dispersion(*typical))))
    return longest


def _dispersion(mass: Floats, stiffness: Floats) -> float:
    """The coefficient beta of a cell of two beads or more: masses, and the spring of each to the next."""
    period, after = len(mass), np.roll(np.arange(len(mass)), -1)
    wavenumber = np.array([0.1, 0.2]) / period
    squares = []
    for q in wavenumber:
        matrix = np.diag(stiffness + np.roll(stiffness, 1)).astype(complex)
        np.add.at(matrix, (np.arange(period), after), -stiffness * np.exp(1j * q))
        np.add.at(matrix, (after, np.arange(period)), -stiffness * np.exp(-1j * q))
        matrix /= np.sqrt(np.outer(mass, mass))
        squares.append(np.linalg.eigvalsh(matrix)[0] / q**2)
    fall = (squares[0] - squares[1]) / (wavenumber[1] ** 2 - wavenumber[0] ** 2)
    return float(fall / (squares[0] + fall * wavenumber[0] ** 2))


def repeats_between(system: System, chain: int, first: int, last: int, period: int) -> bool:
    """Whether masses, contacts and loads of a chain, from 0, repeat without exception between two beads, from 1."""
    columns = _columns(system, chain)[:, max(first - 1, 0) : last]
    return bool(np.all(_alike(columns, period)))


def _alike(columns: Floats, period: int) -> Floats:
    scale = np.maximum(np.max(np.abs(columns), axis=1, keepdims=True), 1e-300)
    return np.asarray(np.abs(columns[:, period:] - columns[:, :-period]) <= _SAME * scale)


def _columns(system: System, chain: int) -> Floats:
    """Of a chain, [what, bead]: the mass of each bead, and what its contact with the next is by; the last has none."""
    contacts = [
        np.broadcast_to(parameter, (system.chains, system.beads - 1))[chain]
        for link in system.along
        for parameter in link.law
    ]
    mass = np.broadcast_to(system.mass, (system.chains, system.beads))[chain, :-1]
    return np.stack([mass, *contacts])
