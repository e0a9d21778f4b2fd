"""The first row before its first collision in closed form, for any number of chains (eqs 3-5 of the paper, N = 2).

Written apart from the engine, with the normalised modes of the row, so that each checks the other.
"""

import math

import numpy as np

from analysis.trajectory import Floats
from lammps_inputs import Problem, physics


def motion(problem: Problem, times: Floats) -> tuple[Floats, Floats]:
    """Displacement and velocity [time, chain] of row 1 as if nothing were in front of it.

    With ``c_m(j)`` the normalised cosine modes and ``w = sum over j of c_m(j) v_j(0)``, eq. 3 has the solution ::

        x_j = sum over m of c_m(j) w_m sin(omega_m t) / omega_m,    omega_m = 2 sqrt(kappa) sin(pi m / 2N)

    of which ``V/2 (t +- sin(omega t) / omega)``, eq. 4, is the case N = 2.
    """
    chains = problem.chains
    mode = np.arange(chains)
    shape = np.cos(math.pi / chains * np.outer(mode, np.arange(chains) + 0.5))
    shape /= np.linalg.norm(shape, axis=1, keepdims=True)
    omega = 2.0 * math.sqrt(physics.kappa(problem.system)) * np.sin(math.pi / (2.0 * chains) * mode)
    weight = shape @ physics.initial_velocity(problem.system)[:, 0]
    t = np.asarray(times, dtype=np.float64)[:, None]
    # np.sinc(z) = sin(pi z) / (pi z), so that the mode at rest needs no case of its own
    displacement = (weight * t * np.sinc(omega * t / math.pi)) @ shape
    velocity = (weight * np.cos(omega * t)) @ shape
    return displacement, velocity


def theta(problem: Problem) -> float:
    """The one number of rigid dynamics: omega D / V, with omega = sqrt(2 kappa) of two chains and V = 1.

    With more chains it is the same measure of the coupling, no longer a frequency of the row.
    """
    return math.sqrt(2.0 * physics.kappa(problem.system)) * physics.gap(problem.system)


THETA_OF_EQ_5 = (math.pi + 2.0) / 4.0
"""theta at which bead 1 of chain 1 meets bead 2 at omega t = pi / 2, with 1/2 V: 1.2854."""


def gap_of_eq_5(kappa: float) -> float:
    """D = (pi + 2) / (4 omega), eq. 5, in units of L for V = 1 and N = 2.

    Raises:
        ValueError: without coupling no gap fulfils it.
    """
    if not kappa > 0.0:
        raise ValueError("coupling: eq. 5 gives a gap only with springs (kappa > 0)")
    return THETA_OF_EQ_5 / math.sqrt(2.0 * kappa)
