"""Time steps of LAMMPS: the bound beyond which they are unstable, and a rule for the error.

The rule is the first guess of a pilot run (`workflow.prepare`), and the time step where none is made. Errors grow in
proportion to time, for every part of the motion keeps its shape and falls behind or runs ahead at a steady rate. A row
of coupled beads that oscillates about its mean with angular frequency omega is late, in velocity Verlet, by
``omega**3 * step**2 / 24`` a unit of time.
"""

import math

from lammps_inputs import physics
from lammps_inputs.limits import rates
from lammps_inputs.scheme import SchemeName, largest_phase
from lammps_inputs.system import System

_CONTACTS = 0.003
"""Error over ``time * omega**3 * step**2``, where omega is the largest frequency that contacts alone allow. Measured in
160 scenes (one to nine chains, gaps, loads, exponents, unlike beads): the step is 1.0 to 4 times as short as would just
do in eight of ten, and too long by up to 2 in one of ten, where a bead leaves the free end or meets others again.
"""

_SPRINGS = 1.0 / 48.0
"""The same of a row that oscillates with V / 2, which is the law above."""

_DASHPOTS = 0.04
"""Error over ``(omega + drag) * step`` where dashpots leave one of first order; measured: 0.01 to 0.08 over omega."""

_ORDER_OF_SUZUKI = 2.5
"""In place of 2: contacts that open and close allow no more."""

_USABLE = 0.5
"""Largest part of the stability bound at which errors still fall as the rule says."""

_LATE_DRAG = 1.0 / (12.0 * math.e)
"""Error over ``drag**2 * step**2`` where drag on beads, of order 2, stops them: an exponential of which each step takes
the second order.
"""


def stability_bound(system: System, scheme: SchemeName = "verlet") -> float:
    """Largest stable (mean) Verlet step, ``2 / omega_max`` for velocity Verlet, of a dimensionless system."""
    bound = largest_phase(scheme) / rates.fastest(system)
    if not system.dampers or physics.centred(system):
        return bound
    # the root of (omega h)**2 + 2 drag h = 4, from the characteristic polynomial with velocities of the half step
    drag = 0.5 * bound * rates.drag(system)
    return 2.0 * bound / (drag + math.sqrt(drag * drag + 4.0))


def largest_timestep(accuracy: float, system: System, scheme: SchemeName = "verlet") -> float:
    """The largest step that is taken for an accuracy, however short the run.

    Velocity Verlet's energy varies by a share ``(step / bound)**2`` in the fastest oscillation, whatever the time. That
    is kept within twice the accuracy, of which runs have a sixth at most; half of the bound is never exceeded.
    """
    return min(_USABLE, math.pow(2.0 * accuracy, 1.0 / _order(scheme))) * stability_bound(system, scheme)


def _order(scheme: SchemeName) -> float:
    return 2.0 if scheme == "verlet" else _ORDER_OF_SUZUKI


def timestep_for(accuracy: float, duration: float, system: System, scheme: SchemeName = "verlet") -> float:
    """A (mean) step of Verlet that should end with an error below the accuracy, by the rule; all dimensionless."""
    contacts, springs, drag = rates.of_contacts(system), rates.swing(system), rates.drag(system)
    step = largest_timestep(accuracy, system, scheme)
    if system.dampers and not physics.centred(system):
        step = min(step, accuracy / (_DASHPOTS * (contacts + drag)))
    elif system.dampers:
        step = min(step, math.sqrt(accuracy / _LATE_DRAG) / drag)
    order = _order(scheme)
    rate = _CONTACTS * math.pow(contacts, order + 1.0) + _SPRINGS * math.pow(springs, order + 1.0)
    return min(step, math.pow(accuracy / (duration * rate), 1.0 / order))
