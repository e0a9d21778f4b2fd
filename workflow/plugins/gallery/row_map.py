"""Relative modes of a synchronised pulse in gapped chains: their map from row to row, and what follows from it.

Equal pulses run in chains whose beads are farther apart than two beads move during a contact. Row n, the beads n of all
chains, then flies freely, and meets row n + 1 in all chains at once. Springs do not act; an elastic contact of equal
beads passes the velocity V_s on without loss.

A relative mode of the rows is an eigenvector of the graph of springs, with eigenvalue mu (2 for two chains) and
frequency omega, omega^2 = mu kappa / m. Small differences (displacement y, velocity u) of the beads of a row in such a
mode are mapped to those of the next row by two matrices: the contact, in which two rows are tied by the slope of
Hertz's law along the symmetric contact, and the flight, a rotation by omega t over the rest of the way, D / V_s less
half a contact. Unit of velocity is V_s; m = A = 1; so that the map depends on ``theta`` = omega D / V_s and on
``stiffness`` = mu kappa V_s^-0.4, omega^2 in these units, alone.

A flight has determinant 1. The determinant of the contact is, to first order in its stiffness,

    det = 1 - 4/45 (omega tau)^2,    tau = 2.4388 V_s^-0.2 the duration of a contact,

whatever the gap: what of a relative mode stays behind in the springs of a row that has come to rest. Multipliers that
are complex have the modulus sqrt(det); near omega (D / V_s + 17/90 tau) = n pi they are real, and one of them is above
1 within about 4/45 omega tau of that, as the flight then turns each row back into itself.
"""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import integrate, optimize, special

from granchain.parts import Floats, laws, library

CONTACT = float(2.0 * (5.0 / 8.0) ** 0.4 * math.sqrt(math.pi) * special.gamma(1.4) / special.gamma(0.9))
"""Duration of the contact of two equal beads, tau V^0.2 = 2.4388, in units of T."""

PAIR = {"name": "pair", "beads": 2, "kick": {"velocity": 1.0}, "duration": 1.0}
"""Scene of two beads that touch, whose contact is that of every row."""

LOSS = 4.0 / 45.0
"""What a contact takes from the determinant of the map, over (omega tau)^2."""

DELAY = 17.0 / 90.0
"""By how much of a contact longer than D / V_s the free motion of a mode lasts from row to row."""


@cache
def contact_map(stiffness: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Map of a relative mode (y, u) of a row over its contact with the next one, to (y, u) of that.

    Args:
        stiffness: mu kappa V_s^-0.4, the square of the frequency of the mode, in units of V_s.

    Returns:
        The matrix, row by row; by DOP853 with a relative tolerance of 1e-12.
    """

    def motion(_: float, state: Floats) -> Floats:
        """Rates of change of overlap, its rate, and (y, u) of two rows for each of two starts, [10]."""
        overlap, closing = state[:2]
        slope = laws.stiffness(law, overlap)
        rate = [closing, -2.0 * laws.force(law, overlap)]
        for y, u, y_next, u_next in state[2:].reshape(2, 4):
            push = slope * (y - y_next)
            rate += [u, -stiffness * y - push, u_next, -stiffness * y_next + push]
        return np.array(rate)

    law = library.from_plain(PAIR, "pair").problem().system.along[0].law
    start = [0.0, 1.0, *(1.0, 0.0, 0.0, 0.0), *(0.0, 1.0, 0.0, 0.0)]
    end = integrate.solve_ivp(motion, (0.0, CONTACT), start, method="DOP853", rtol=1e-12, atol=1e-13).y[2:, -1]
    of_displacement, of_velocity = end.reshape(2, 4)
    return (float(of_displacement[2]), float(of_velocity[2])), (float(of_displacement[3]), float(of_velocity[3]))


def row_map(theta: float, stiffness: float) -> Floats:
    """Map of a relative mode (y, u) from the arrival of a row to that of the next one, [2, 2].

    Args:
        theta: omega D / V_s.
        stiffness: as for `contact_map`.
    """
    omega = math.sqrt(stiffness)
    turned = theta - 0.5 * omega * CONTACT
    cos, sin = math.cos(turned), math.sin(turned)
    flight = np.array([[cos, sin / omega], [-omega * sin, cos]])
    return np.asarray(flight @ np.array(contact_map(stiffness)))


def decay(trace: float, determinant: float) -> float:
    """Decay of the slowest part of a mode from row to row, -log |multiplier|: below 0 where it grows.

    Args:
        trace, determinant: of the map.
    """
    roots = np.roots([1.0, -trace, determinant])
    return -math.log(float(np.max(np.abs(roots))))


def predicted_decay(theta: float, stiffness: float) -> float:
    """Decay of a relative mode from row to row by `row_map`."""
    matrix = row_map(theta, stiffness)
    return decay(float(np.trace(matrix)), float(np.linalg.det(matrix)))


def typical_decay(stiffness: float) -> float:
    """Decay from row to row of a mode with complex multipliers, at any gap: -log(det) / 2."""
    return -0.5 * math.log(float(np.linalg.det(contact_map(stiffness))))


def weak_decay(stiffness: ArrayLike) -> NDArray[np.float64]:
    """Closed form of `typical_decay` to first order: 2/45 (omega tau)^2, [stiffness]."""
    return np.asarray(0.5 * LOSS * CONTACT**2 * np.asarray(stiffness, dtype=np.float64))


@dataclass(frozen=True)
class Tongue:
    """Range of gaps at which a synchronised pulse is unstable, omega D / V_s within a half width of n pi - shift.

    Attributes:
        shift: of its middle below n pi.
        half_width: 0 where the pulse is stable at every gap.
        growth: of the mode from row to row in its middle, as a logarithm; below 0 where it decays.
    """

    shift: float
    half_width: float
    growth: float


def tongue(stiffness: float) -> Tongue:
    """The range of gaps at which contacts of a stiffness make the pulse unstable, to first order in y and u."""
    (a, b), (c, d) = contact_map(stiffness)
    omega = math.sqrt(stiffness)
    # trace of flight times contact: largest * cos(turned - phase)
    even, odd = a + d, c / omega - omega * b
    largest, phase = math.hypot(even, odd), math.atan2(odd, even)
    determinant = a * d - b * c
    inside = (1.0 + determinant) / largest
    half_width = math.acos(inside) if inside < 1.0 else 0.0
    middle = phase + 0.5 * omega * CONTACT
    shift = -math.remainder(middle, math.pi)
    return Tongue(shift, half_width, -decay(largest, determinant))


@cache
def stable_at_any_gap() -> float:
    """Stiffness from which on the pulse is stable at every gap, where the middle of the ranges no longer grows."""
    return float(optimize.brentq(lambda stiffness: tongue(stiffness).growth, 0.1, 2.0, xtol=1e-10))


@dataclass(frozen=True)
class Recurrence:
    """Trace and determinant of a map, measured in the rows of a run.

    Attributes:
        trace, determinant: of the map.
        residual: largest relative deviation of a row from the recurrence.
    """

    trace: float
    determinant: float
    residual: float

    @property
    def decay(self) -> float:
        """Decay from row to row, -log |multiplier|."""
        return decay(self.trace, self.determinant)


def recurrence(mode: Floats, smallest: float = 1e-7, largest: float = 0.02) -> Recurrence | None:
    """Least squares of mode[n + 1] = trace mode[n] - determinant mode[n - 1], which every map of two numbers obeys.

    Args:
        mode: a relative mode, [row].
        smallest, largest: sizes of the mode in the rows that count.

    Returns:
        None with fewer than six such rows.
    """
    size = np.max(np.abs([mode[:-2], mode[1:-1], mode[2:]]), axis=0)
    used = (size > smallest) & (size < largest)
    if np.count_nonzero(used) < 6:
        return None
    weight = 1.0 / size[used]
    earlier, middle, later = (values[used] * weight for values in (mode[:-2], mode[1:-1], mode[2:]))
    (trace, determinant), *_ = np.linalg.lstsq(np.stack([middle, -earlier], axis=1), later, rcond=None)
    off = later - trace * middle + determinant * earlier
    return Recurrence(float(trace), float(determinant), float(np.max(np.abs(off))))
