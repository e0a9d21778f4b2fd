"""Stability of periodic states: Floquet multipliers.

Multipliers are the eigenvalues of the derivative of the map over a period, the monodromy matrix. The motion over the
second half of the period is the first in reverse, step by step also in the computed map, so that the derivative A over
half a period gives the matrix: ``R A^-1 R A``, with R reversing the momenta, and ``A^-1 = -J A^T J`` since A is
symplectic. How far it is from that measures the rounding.

A conservative system has a double multiplier 1, of the state's own motion and of its energy, with one eigenvector: an
error e of the matrix moves such a pair by the root of e. It is left out exactly: the changes along the motion and
across the surfaces of energy are taken out of the matrix before its eigenvalues are computed.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from granchain.parts import Floats
from workflow.plugins.modes.continuation import PeriodicState
from workflow.plugins.modes.shooting import Shooting

KINDS = ("+1", "-1", "collision")
"""Where multipliers leave the unit circle: at 1, at -1, and in pairs elsewhere on it."""

_FACTOR = 2.0


@dataclass(frozen=True)
class Multipliers:
    """Floquet multipliers of a state, of a conservative one without the pair at 1 of its own motion.

    Attributes:
        values: [multiplier] complex, in no order.
        asymmetry: largest deviation of the derivative over half a period from a symplectic matrix; 0 of a driven state.
        error: largest change of the known eigenvectors of the pair at 1 by the matrix; of a driven state its rounding.
        tolerance: deviation of a modulus from 1 that errors can cause: that of a pair, by the root of the error.
    """

    values: Any
    asymmetry: float
    error: float
    tolerance: float

    @property
    def largest(self) -> float:
        """Largest modulus, 1 where there is no multiplier."""
        return float(np.max(np.abs(self.values), initial=1.0))

    @property
    def stable(self) -> bool:
        """Whether no multiplier is outside the unit circle by more than the tolerance."""
        return self.largest <= 1.0 + self.tolerance

    def outside(self) -> tuple[int, int, int]:
        """Numbers of multipliers outside the unit circle: above 1, below -1, and off the real axis (`KINDS`)."""
        values = self.values[np.abs(self.values) > 1.0 + self.tolerance]
        real = np.abs(values.imag) <= self.tolerance * np.abs(values)
        positive = values.real > 0.0
        return tuple(int(np.count_nonzero(group)) for group in (real & positive, real & ~positive, ~real))  # type: ignore[return-value]


def half_monodromy(shooting: Shooting, state: PeriodicState) -> Floats:
    """Derivative of the map over half a period, [coordinate, coordinate]: displacements, then momenta.

    Coordinates are canonical: modal coordinates times, and momenta over, the root of the frequency.
    """
    count = len(state.y)
    root = np.sqrt(shooting.modes.frequency)
    shapes = shooting.modes.shapes
    flow = shooting.flow(state.y, state.period, 2 * count)
    vectors = np.zeros((2 * count, 2, *shapes.shape[1:]))
    vectors[:count, 0] = shapes / root[:, np.newaxis, np.newaxis]
    vectors[count:, 1] = shapes * root[:, np.newaxis, np.newaxis]
    flow.put(vectors)
    flow.advance(0, shooting.steps)
    displacement, velocity = (shooting.momenta(part) for part in np.swapaxes(flow.vectors, 0, 1))
    return np.vstack([(displacement * root).T, (velocity / root).T])


def monodromy(shooting: Shooting, state: PeriodicState) -> tuple[Floats, float]:
    """Derivative of the map over a period, [coordinate or momentum, same], and the asymmetry (`Multipliers`)."""
    half = half_monodromy(shooting, state)
    count = len(state.y)
    unit, zero = np.eye(count), np.zeros((count, count))
    turn = np.block([[zero, unit], [-unit, zero]])
    reverse = np.repeat([1.0, -1.0], count)
    asymmetry = float(np.max(np.abs(half.T @ turn @ half - turn)))
    inverse = -turn @ half.T @ turn
    return (reverse[:, np.newaxis] * inverse * reverse) @ half, asymmetry


def multipliers(shooting: Shooting, state: PeriodicState) -> Multipliers:
    """Floquet multipliers of a state."""
    matrix, asymmetry = monodromy(shooting, state)
    count = len(state.y)
    # at the start all beads are at rest: the state's own motion changes momenta alone, by the forces, and the energy
    # changes with displacements alone, by the same numbers
    force = shooting.force(state.y) / np.sqrt(shooting.modes.frequency)
    force /= np.linalg.norm(force)
    along, across = np.append(np.zeros(count), force), np.append(force, np.zeros(count))
    error = max(float(np.linalg.norm(matrix @ along - along)), float(np.linalg.norm(across @ matrix - across)))
    others = np.linalg.svd(force[np.newaxis])[2][1:].T  # orthonormal, and perpendicular to the force
    zero = np.zeros_like(others)
    basis = np.block([[others, zero], [zero, others]])
    values = np.linalg.eigvals(basis.T @ matrix @ basis)
    size = float(np.linalg.norm(matrix, 2))
    return Multipliers(values, asymmetry, error, _FACTOR * math.sqrt(size * max(asymmetry, error)))
