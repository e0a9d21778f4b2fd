"""Time steps of LAMMPS: the bound beyond which they are unstable, a default well below it, and a law for the error.

The laws are what a scheme leaves in the velocities, measured: it grows in proportion to time, for every part of the
motion keeps its shape and falls behind or runs ahead at a steady rate. A pulse's part does not depend on much; a row
of coupled beads that swings about its mean with angular frequency omega is late, in velocity Verlet, by
``omega**3 * step**2 / 24`` a unit of time.
"""

import math

from lammps_inputs.facts import Fact
from lammps_inputs.limits import rates
from lammps_inputs.problem import System
from lammps_inputs.scheme import SchemeName, largest_phase

DEFAULT = 0.01
"""Leaves an error of about 1.5e-5 of V in the velocities of the paper's scenes, and ten times as much for a moment
where a bead leaves the free end (it falls as the step squared).
"""

SHORTEST_LOAD = 1e-4
"""Shorter forces from outside are kicks to any step: their beads are late by half of their duration at most."""

_STEPS_PER_BOUND = 50.0

_STEPS_PER_BOUND_UNLIKE = 120.0
"""Where beads differ, and light ones may swing faster; what is left behind rattles, which asks for half as many again
as `DEFAULT` is to the paper's. And where contacts are harder, at their hardest, than those of spheres.
"""

_STEPS_PER_SOUND = 200.0
"""The same over the bound of small motions about a loaded state: sound of all frequencies follows the pulse, and what
is left of its phase after some hundred beads is 1e-4 of V.
"""

_DRAG, _MOST_FOR_DRAG = 0.01, 10.0
"""Dashpots on links leave an error of first order in the step. A default step shorter by 1 + drag / 0.01 leaves no more
than there would be without them, by 10 at most, where it is 1e-4 of V or so (measured: all laws, drag 4e-3 to 4).
"""

_STEPS_PER_BOUND_OF_DRAG = 20.0
"""Leaves 7e-5 of V in chains whose beads hardly move for drag (400), and 2e-3 between (40)."""

_DRAG_IN_A_STEP = 0.05
"""Part of its velocity that drag on beads, of order 2, may take from a bead in a step: what it leaves then, the square
of that over 12 e, is 8e-5 of V.
"""

_STIFF = 5e-3
"""A default step of this over ``omega**1.5`` leaves 1e-4 of V, at t = 200, in a row that swings with V / 2."""

_STIFF_SUZUKI = 0.035
"""The same of Suzuki's composition, over ``omega**1.25``."""

_MOST_STEPS_PER_BOUND = 5000.0
"""Springs of kappa = 1e4 need as many; those still stiffer swing out of step rather than take for ever."""

_PULSE, _SWING = 0.03, 1.0 / 48.0
"""Laws of velocity Verlet: pulse's error where it leaves the free end, over ``time * step**2`` (measured: 0.004 to
0.027), and error of a row that swings with V / 2, over ``time * omega**3 * step**2``.
"""

_PULSE_OF_SUZUKI, _SWING_OF_SUZUKI = 0.03, 0.28
"""The same of Suzuki's composition, over ``time * step**2.5`` (measured: 0.004 to 0.05; contacts open and close), and
over ``time * omega**5 * step**4``.
"""

_USABLE = 0.5
"""Largest part of the stability bound at which errors still fall as the law says."""


def stability_bound(system: System, scheme: SchemeName = "verlet") -> float:
    """Largest stable (mean) Verlet step, ``2 / omega_max`` for velocity Verlet, of a dimensionless system."""
    bound = largest_phase(scheme) / rates.fastest(system)
    if not system.dampers or system.centred:
        return bound
    # the root of (omega h)**2 + 2 drag h = 4, from the characteristic polynomial with velocities of the half step
    drag = 0.5 * bound * rates.drag(system)
    return 2.0 * bound / (drag + math.sqrt(drag * drag + 4.0))


def default_timestep(system: System, scheme: SchemeName = "verlet") -> float:
    """0.01, or less where stiff springs, many kicks or short forces from outside need it, in dimensionless time."""
    bound = largest_phase("verlet") / rates.fastest(system)
    step = min(DEFAULT, bound / (_STEPS_PER_BOUND if _as_spheres(system) else _STEPS_PER_BOUND_UNLIKE))
    if system.loaded:
        step = min(step, largest_phase("verlet") / rates.sound_frequency(system) / _STEPS_PER_SOUND)
    if not system.holds(Fact.SECOND_ORDER) and system.dampers:
        step /= min(_MOST_FOR_DRAG, 1.0 + rates.drag(system) / _DRAG)
        step = min(step, stability_bound(system) / _STEPS_PER_BOUND_OF_DRAG)
    elif system.dampers:
        step = min(step, _DRAG_IN_A_STEP / rates.drag(system))
    for load in system.loads:  # an impulse of 1 that begins within a step leaves up to step**2 / (8 duration)
        if SHORTEST_LOAD < load.end < math.inf:
            step = min(step, DEFAULT * math.sqrt(load.end))
    if rates.stiffest_spring(system) <= 1.0:
        return step
    if scheme == "suzuki4":
        return min(step, _STIFF_SUZUKI / math.pow(rates.swing(system), 1.25))
    return min(step, max(_STIFF / math.pow(rates.swing(system), 1.5), bound / _MOST_STEPS_PER_BOUND))


def _as_spheres(system: System) -> bool:
    """Whether the beads are alike, and their contacts no harder, at their hardest, than those of spheres."""
    return system.one_kind and (system.exponent or 0.0) <= 1.5


def largest_timestep(system: System, scheme: SchemeName = "verlet") -> float:
    """Half the stability bound: the largest step that is taken where an accuracy is asked for."""
    return _USABLE * stability_bound(system, scheme)


def timestep_for(accuracy: float, duration: float, system: System, scheme: SchemeName = "verlet") -> float:
    """A (mean) step of Verlet that ends with an error below the accuracy, by the laws; all dimensionless.

    Measured over one to five chains, kappa from 0 to 1e3, with and without a gap, kicks at one end and at both: the
    step of velocity Verlet is 1.0 to 3.1 times as small as would just do; that of Suzuki's composition 1.5 to 4.1
    times, but with a gap it is up to 2.5 times too large. It knows no stability bound.
    """
    swing = rates.swing(system)
    plain = _as_spheres(system) and not system.loaded
    faster = 1.0 if plain else max(1.0, DEFAULT * _STEPS_PER_BOUND_UNLIKE / stability_bound(system))
    if system.dampers and not system.centred:
        # measured: 9e-4 of V at the default step from a drag of 0.4 on, less before
        return accuracy / min(1.5 * rates.drag(system), 0.1 + 0.06 * rates.drag(system))
    if scheme == "verlet":
        return math.sqrt(accuracy / (duration * (_PULSE * faster**3 + _SWING * swing**3)))
    twice = 2.0 * duration / accuracy  # each part is given half of the accuracy
    pulse = math.pow(_PULSE_OF_SUZUKI * twice * faster**3.5, 1.0 / 2.5)
    return 1.0 / max(pulse, math.pow(_SWING_OF_SUZUKI * twice * math.pow(swing, 5.0), 1.0 / 4.0))
