"""Time steps of velocity Verlet: the bound beyond which it is unstable, and a default well below it."""

import math

from lammps_inputs import contact, coupling

DEFAULT = 0.01
"""Leaves an error of about 1.5e-5 of V in the velocities of the paper's scenes (it falls as the step squared)."""

_STEPS_PER_BOUND = 50.0


def stability_bound(total_energy: float, kappa: float, chains: int) -> float:
    """Largest stable time step, ``2 / omega_max``, of velocity Verlet for the dimensionless problem.

    ``omega_max**2 <= 4 * stiffness(largest overlap) + kappa * lambda_max`` (Gershgorin); energy bounds the overlap.
    """
    contacts = 4.0 * float(contact.stiffness(contact.largest_overlap(total_energy)))
    return 2.0 / math.sqrt(contacts + kappa * coupling.largest_eigenvalue(chains))


def default_timestep(total_energy: float, kappa: float, chains: int) -> float:
    """0.01, or less where stiff springs or many kicks need it, in dimensionless time."""
    return min(DEFAULT, stability_bound(total_energy, kappa, chains) / _STEPS_PER_BOUND)
