"""Theory of long waves: cells that repeat along the chains, how long pulses are in them, sound and waves on a load.

| Nesterenko (2001), chapter 1 | here                       | unit                                |
|------------------------------|----------------------------|-------------------------------------|
| c_0                          | ``sound_speed``            | beads / T                           |
| V_s                          | ``speed_over_sound * c_0`` | beads / T                           |
| F_m / F_0                    | ``ratio``                  | largest total force over that at rest |

The theory takes the chain for a continuum; the waves of the discrete one are faster, by 1.0004 at a ratio of 1.955 and
by 1.0085 at 67.7.

Plug-ins take this module for loaded chains: `sound_speed` at every bead, `speed_over_sound` of a pulse of some force,
and `cell_beads`, the number of beads after which a chain repeats.

Examples:
    >>> system = granchain.load("precompressed").system
    >>> long_waves.sound_speed(system)[0, 10:12].round(4)  # of chain 1 at beads 11 and 12, in beads / T
    array([1.2393, 1.2393])
    >>> round(float(long_waves.speed_over_sound(2.0)), 4), long_waves.cell_beads(system)
    (1.0449, 1)
"""

import functools

import numpy as np

from analysis.trajectory import Floats, Integers
from lammps_inputs import System, laws, physics

LONGEST_CELL = 12
"""Beads that are looked for to repeat along the chains."""

MOSTLY = 0.9
"""Share of the beads that must be alike a cell farther on: single beads may be of another kind."""

_SAME = 1e-9

_NEAR = 2
"""Beads on either side over which masses and contacts are averaged, at least; whole cells where beads repeat."""

_ABOVE = np.logspace(-4.0, 13.0, 2000)
"""Force ratios above 1 of the table of amplitudes."""


def speed_over_sound(ratio: Floats | float, exponent: float = 1.5) -> Floats:
    """Speed of the solitary wave over that of sound (Nesterenko 2001, eq. 1.113; Daraio et al. 2006, eq. 3).

    ``sqrt{(4/15) (3 + 2 f^(5/3) - 5 f^(2/3))} / (f^(2/3) - 1)`` for spheres; 1 for a ratio of 1. For contacts of any
    exponent p: ``sqrt{2 / (p (p + 1)) (p + f^(1 + 1/p) - (p + 1) f^(1/p))} / (f^(1/p) - 1)``.

    Args:
        ratio: [...] largest total force of a contact over that at rest, f; dimensionless.
        exponent: exponent p of the contact force.

    Returns:
        [...] dimensionless.
    """
    return _amplitude(ratio, exponent) / np.maximum(_strain(ratio, exponent) - 1.0, 1e-300)


def _strain(ratio: Floats | float, exponent: float) -> Floats:
    return np.asarray(np.cbrt(ratio) ** 2 if exponent == 1.5 else np.asarray(ratio) ** (1.0 / exponent))


def _amplitude(ratio: Floats | float, exponent: float) -> Floats:
    """Peak velocity of the solitary wave over ``c0 d0``, with the overlap d0 at rest, of the shape of ``ratio``."""
    strain, p = _strain(ratio, exponent), exponent
    squared = 2.0 / (p * (p + 1.0)) * (p + ratio * strain - (p + 1.0) * strain)
    return np.sqrt(np.maximum(squared, 0.0))


@functools.cache
def _table(exponent: float) -> tuple[Floats, Floats]:
    """Logarithms of amplitudes, and speeds over that of sound, each [ratio]."""
    with np.errstate(divide="ignore"):
        return np.log(_amplitude(1.0 + _ABOVE, exponent)), speed_over_sound(1.0 + _ABOVE, exponent)


def repeats(columns: Floats) -> int | None:
    """Number of beads after which an array [quantity, bead] repeats; None where it does not, or is too short."""
    for period in range(1, min(LONGEST_CELL, columns.shape[1] // 3) + 1):
        if np.all(_alike(columns, period)):
            return period
    return None


def _alike(columns: Floats, period: int) -> Floats:
    scale = np.maximum(np.max(np.abs(columns), axis=1, keepdims=True, initial=0.0), 1e-300)
    return np.asarray(np.abs(columns[:, period:] - columns[:, :-period]) <= _SAME * scale)


def cell_beads(system: System) -> int:
    """Number of beads after which masses and contacts repeat, loads aside; 1 where they do not."""
    if physics.one_kind(system) and isinstance(physics.masses(system), float):
        return 1
    shape = system.chains, system.beads - 1
    strength = [np.broadcast_to(laws.strength(link.law), shape) for link in system.along]
    mass = np.broadcast_to(physics.mass_with_tied(system), (system.chains, system.beads))[:, :-1]
    # the first may be a striker
    return repeats(np.concatenate([mass, *strength])[:, 1:]) or 1


def sound_speed(system: System) -> Floats:
    """Speed of long waves at every bead, from the masses and contacts near it.

    ``sqrt(1 / (mean mass * mean compliance))``, exact where all beads, or all cells of beads, are the same.

    Args:
        system: masses and contacts.

    Returns:
        [chain, bead] in units of beads / T; 0 without a static load.
    """
    stiffness = np.broadcast_to(
        sum(laws.stiffness(link.law, 0.0) for link in system.along), (system.chains, system.beads - 1)
    )
    mass, near = np.broadcast_to(physics.mass_with_tied(system), (system.chains, system.beads)), _near(system)
    with np.errstate(divide="ignore"):
        compliance = 1.0 / stiffness
    return np.asarray(1.0 / np.sqrt(_smooth(mass, near) * _at_beads(_smooth(compliance, near))))


class LoadedSpeed:
    """Speed of pulses of an amplitude in a loaded chain by the long-wave theory.

    With the direction -1 beads are counted from the last.

    Attributes:
        sound: [chain, bead] speed of sound, in beads / T.
        rest: [chain, bead] mean overlap at rest, in units of L.
    """

    def __init__(self, system: System, direction: int = 1) -> None:
        rest = np.broadcast_to(sum(link.law.rest for link in system.along), (system.chains, system.beads - 1))
        self.sound = sound_speed(system)[:, ::direction]
        self.rest = _at_beads(_smooth(rest, _near(system)))[:, ::direction]
        self._table = _table(physics.exponent(system) or 1.5)

    def at(self, chain: int, bead: Integers, peak_velocity: Floats) -> Floats:
        """Speed in beads / T, to some per cent, at beads and peak velocities in V, all [passage]; numbers from 1."""
        place = bead - 1
        sound, rest = self.sound[chain - 1, place], self.rest[chain - 1, place]
        with np.errstate(divide="ignore"):
            amplitude = np.log(np.abs(peak_velocity) / (sound * rest))
        return np.asarray(sound * np.interp(amplitude, *self._table))


def _near(system: System) -> int:
    """Beads on either side over which to average: twice as many are whole cells."""
    cell = cell_beads(system)
    return cell * -(-_NEAR // cell)


def _smooth(values: Floats, near: int) -> Floats:
    """Means over so many on either side along the last axis, the outermost with half their weight.

    At the ends they are those of the nearest place that has as many.
    """
    near = min(near, (values.shape[-1] - 1) // 2)
    if near == 0:
        return values
    weight = np.full(2 * near + 1, 0.5 / near)
    weight[[0, -1]] *= 0.5
    windows = np.lib.stride_tricks.sliding_window_view(values, len(weight), axis=-1)
    means = np.sum(windows * weight, axis=-1)
    return np.pad(means, [(0, 0)] * (values.ndim - 1) + [(near, near)], mode="edge")


def _at_beads(contacts: Floats) -> Floats:
    """Mean over the contacts on either side of each bead, [..., bead] from [..., contact]."""
    padded = np.concatenate([contacts[..., :1], contacts, contacts[..., -1:]], axis=-1)
    return np.asarray(0.5 * (padded[..., 1:] + padded[..., :-1]))


def period_of(system: System) -> int:
    """Number of beads after which masses and contacts repeat, but for single beads; 1 where they do not."""
    columns = np.concatenate([_columns(system, chain) for chain in range(system.chains)])
    for period in range(1, min(LONGEST_CELL, system.beads // 3) + 1):
        if np.mean(np.all(_alike(columns, period), axis=0)) > MOSTLY:
            return period
    return 1


def length_of(system: System) -> float:
    """Length of pulses, in beads, over that in a chain of equal beads.

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


def _columns(system: System, chain: int) -> Floats:
    """Mass of each bead of a chain but the last, and parameters of its contact with the next, [quantity, bead]."""
    contacts = [
        np.broadcast_to(parameter, (system.chains, system.beads - 1))[chain]
        for link in system.along
        for parameter in link.law
    ]
    mass = np.broadcast_to(system.mass, (system.chains, system.beads))[chain, :-1]
    return np.stack([mass, *contacts])
