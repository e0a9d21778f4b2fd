"""Exact motion of one row between collisions, by the modes of its springs.

Bead j of a row obeys ``x_j'' = -kappa * sum over lateral neighbours m of (x_j - x_m)``. The open row of N beads has the
modes of the discrete cosine transform (Strang, SIAM Review 41, 1999, "DCT-2"):

| symbol      | here                  | value                                     | shape             |
|-------------|-----------------------|-------------------------------------------|-------------------|
| omega_m     | ``omega``             | 2 sqrt(kappa) sin(pi m / 2N), m = 1..N-1  | [mode]            |
| e_m(j)      | ``shape``             | cos(pi m (j - 1/2) / N), largest set to 1 | [mode, chain]     |
| 1 / abs(e_m)^2 | ``weight``         |                                           | [mode]            |

Mode 0 is the free motion of the centre of mass. Without springs no mode oscillates and the three are empty.
"""

import math
from typing import NamedTuple

import numpy as np

from granchain.parts import Floats, compiled


class Modes(NamedTuple):
    """Oscillating modes of a row; not normalised, so that N = 2 has exactly (1, -1) and weight 1/2."""

    omega: Floats
    shape: Floats
    weight: Floats


def make_modes(chains: int, kappa: float) -> Modes:
    """Oscillating modes of a row of beads of mass 1 tied by springs kappa >= 0 (units m / T**2)."""
    if kappa == 0.0:
        return Modes(np.empty(0), np.empty((0, chains)), np.empty(0))
    mode = np.arange(1, chains)[:, None]
    raw = np.cos(math.pi / chains * mode * (np.arange(chains) + 0.5))
    mirrored = np.where(mode % 2 == 0, 1.0, -1.0) * raw[:, ::-1]
    shape = (raw + mirrored) / 2.0  # exactly even or odd, so that rounding prefers no side of the array
    shape /= np.abs(shape).max(axis=1, keepdims=True)
    omega = 2.0 * math.sqrt(kappa) * np.sin(math.pi / (2.0 * chains) * mode[:, 0])
    return Modes(omega, shape, 1.0 / (shape**2).sum(axis=1))


@compiled.ieee_called_by_compiled
def advance(x: Floats, v: Floats, row: int, elapsed: float, modes: Modes, later: Floats, side: int) -> None:
    """Write the motion of one row after a time without collisions into ``later[:, side]``.

    Args:
        x: displacements of all rows, [row, chain].
        v: velocities of all rows, [row, chain].
        row: position of the row.
        elapsed: time since the state of the row, in units of T.
        modes: modes of a row.
        later: displacement and velocity, [x and v, side, chain].
        side: second index of ``later`` to write to.
    """
    chains = x.shape[1]
    omega, shape, weight = modes.omega, modes.shape, modes.weight
    oscillating = len(omega)
    if elapsed == 0.0 or oscillating == 0:
        for j in range(chains):
            later[0, side, j] = x[row, j] + v[row, j] * elapsed
            later[1, side, j] = v[row, j]
        return
    position, velocity = 0.0, 0.0
    for j in range(chains):
        position += x[row, j]
        velocity += v[row, j]
    position /= chains
    velocity /= chains
    for j in range(chains):
        later[0, side, j] = position + velocity * elapsed
        later[1, side, j] = velocity
    for m in range(oscillating):
        q, p = 0.0, 0.0
        for j in range(chains):
            q += shape[m, j] * x[row, j]
            p += shape[m, j] * v[row, j]
        q *= weight[m]
        p *= weight[m]
        cos, sin = math.cos(omega[m] * elapsed), math.sin(omega[m] * elapsed)
        q_later = q * cos + p / omega[m] * sin
        p_later = p * cos - q * omega[m] * sin
        for j in range(chains):
            later[0, side, j] += shape[m, j] * q_later
            later[1, side, j] += shape[m, j] * p_later
