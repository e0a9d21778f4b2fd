"""How fast anything in a system can move: bounds on angular frequencies, rates and speeds; and on time steps.

The bounds are Gershgorin's circles, with every contact and spring as stiff as the energy of the system can make it;
all numbers are dimensionless.

Of time steps of LAMMPS there are the bound beyond which they are unstable, and a rule for the error. The rule is the
first guess of a pilot run (`workflow.prepare`), and the time step where none is made. Errors grow in proportion to
time, for every part of the motion keeps its shape and falls behind or runs ahead at a steady rate. A row of coupled
beads that oscillates about its mean with angular frequency omega is late, in velocity Verlet, by ``omega**3 * step**2
/ 24`` a unit of time.

Examples:
    >>> system = granchain.load("two-chains").problem().system
    >>> round(rates.stability_bound(system), 3), round(rates.front_speed(system), 3)  # T, beads / T
    (0.786, 1.0)
    >>> round(rates.modal_frequency(system), 3)  # 1 / T
    0.447
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import laws, physics
from lammps_inputs.laws import Law, dashpot
from lammps_inputs.links import Links, largest_eigenvalue
from lammps_inputs.scheme import LARGEST_PHASE, SchemeName
from lammps_inputs.system import System

FARTHEST = 3.0
"""Strain, in units of L, that springs between chains hardly exceed."""


def fastest(system: System) -> float:
    """Angular frequency, at most, of any motion; energy bounds how stiff a contact can get."""
    elastic = float(np.sqrt(_contacts(system) + _springs(system)))
    springs, loads = ([each.law.omega for each in several] for several in (system.ground, system.loads))
    return float(max((elastic, *springs, *loads, *(motion.omega for motion in system.motions))))


def modal_frequency(system: System) -> float:
    """Angular frequency, at most, of a bead on its springs, those across and those to the ground, and of sound."""
    return float(np.sqrt(_springs(system) + sound_frequency(system) ** 2))


def sound_frequency(system: System) -> float:
    """Angular frequency, at most, of sound: small motions about rest, springs left out; 0 where there is none."""
    if not physics.loaded(system):
        return 0.0
    return float(np.sqrt(_of_lightest(system, lambda law: laws.stiffness(law, 0.0))))


@physics.once
def bending(system: System) -> float:
    """Angular frequency, at most, at which the stiffness of springs across and to the ground changes.

    It is the root of the second derivative of the stiffness in the strain over the largest stiffness, of beads that
    move with V and springs that are strained by `FARTHEST` or as far as energy brings them.
    """
    springs = (*system.across, *physics.at(system, 0.0).ground)
    return max((_bending(link.law, physics.energy(system)) for link in springs), default=0.0)


def _bending(law: Law, energy: float) -> float:
    farthest = np.minimum(law.max_strain(energy, *law), FARTHEST)
    parts = np.linspace(-1.0, 1.0, 65)
    stiffness = np.array([np.broadcast_to(laws.stiffness(law, part * farthest), np.shape(farthest)) for part in parts])
    largest = np.max(np.abs(stiffness), axis=0) * (farthest * (parts[1] - parts[0])) ** 2
    bend = np.max(np.abs(np.diff(stiffness, n=2, axis=0)), axis=0)
    return math.sqrt(float(np.max(np.divide(bend, largest, out=np.zeros_like(bend), where=largest > 0.0))))


def front_speed(system: System) -> float:
    """Beads that a pulse passes in a unit of time, at most.

    It is that of sound at the largest force if any bead is lighter, or any contact under load or harder, than the
    reference's.
    """
    plain = (
        physics.alike(system)
        and not physics.loaded(system)
        and all(laws.strength(link.law) == 1.0 for link in system.contacts)
    )
    return 1.0 if plain else max(1.0, 0.5 * float(np.sqrt(_contacts(system))))


def drag(system: System) -> float:
    """Rate, at most, at which dashpots stop any motion."""
    contacts, others = np.zeros(1), 0.0
    ties = tuple(link for link in system.dampers if system.is_tie(link))
    braked = _at_ends(system, ties, [dashpot.resistance(link.law, 0.0) for link in ties])
    for link in system.dampers:
        if link in ties:
            continue
        if (elastic := physics.beside(system.links, link) if link.touching else None) is not None:
            reached = dashpot.at_max_strain(link.law, elastic.law, physics.energy(system))
            contacts = contacts + _on_beads(system, link, reached)
        else:
            graph = largest_eigenvalue(link, system.chains) if link.edges else 1.0
            others += graph * float(np.max(dashpot.resistance(link.law, 0.0)))
    return float(np.max(contacts / system.mass)) + others / float(np.min(system.mass)) + braked


def _contacts(system: System) -> float:
    if physics.alike(system):
        wall = max((laws.stiffest(link.law, physics.energy(system)) for link in system.walls), default=0.0)
        contacts = sum(4.0 * laws.stiffest(link.law, physics.energy(system)) for link in system.along)
        # a bead at the end has one contact, and a wall
        return max(contacts, 0.5 * contacts + wall) if system.walls else contacts
    return _of_lightest(system, lambda law: laws.stiffest_of_each(law, physics.energy(system)))


def _of_lightest(system: System, stiffness: Callable[[Law], Any]) -> float:
    """Largest sum of the stiffnesses of a bead's contacts, twice for both, and wall, over its mass."""
    total = sum(_on_beads(system, link, stiffness(link.law)) for link in (*system.contacts, *system.walls))
    return float(np.max(total / system.mass))


def _on_beads(system: System, link: Links, values: Any) -> NDArray[np.float64]:
    """Bound on what links along the chains do to each bead's motion, [chain, bead].

    It is twice the sum of contacts with other beads, and once that of contacts with walls.
    """
    total = np.zeros((system.chains, system.beads))
    for beads, _ in link.ends:
        total[:, beads.rows] += len(link.ends) * np.asarray(values)
    return total


def _springs(system: System) -> float:
    across = (_row(system, link) for link in system.couplings)
    held = (laws.stiffest(link.law, physics.energy(system)) for link in system.ground)
    return sum((*across, *held), 0.0) / float(np.min(system.mass)) + _ties(system)


def _ties(system: System) -> float:
    """Square of the frequency, at most, of a bead and tied atoms: ``k (1 / m + 1 / m2)`` of one, exactly."""
    stiffest = [laws.stiffest_of_each(link.law, physics.energy(system)) for link in system.ties]
    return _at_ends(system, system.ties, stiffest)


def _at_ends(system: System, links: tuple[Links, ...], values: list[Any]) -> float:
    """Largest sum over both ends of a link of the values of all links there over the mass (Anderson & Morley 1985)."""
    if not links:
        return 0.0
    total = np.zeros((physics.lines(system), system.beads))
    edges: list[tuple[tuple[int, int], NDArray[np.float64]]] = []
    for link, value in zip(links, values, strict=True):
        edges += zip(link.edges, np.broadcast_to(value, (len(link.edges), system.beads)), strict=True)
    for ends, of_edge in edges:
        total[list(ends)] += of_edge
    total /= physics.masses(system, absent=np.inf)
    return max(
        (float(np.max((total[first] + total[second])[of > 0.0], initial=0.0)) for (first, second), of in edges),
        default=0.0,
    )


def _row(system: System, link: Links) -> float:
    """Largest eigenvalue of a row of beads on links across, each as stiff as energy can make it anywhere."""
    if not laws.differs(link.law):
        return laws.stiffest(link.law, physics.energy(system)) * largest_eigenvalue(link, system.chains)
    return largest_eigenvalue(
        link, system.chains, link.of_edges(laws.stiffest_of_each(link.law, physics.energy(system)))
    )


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
    bound = LARGEST_PHASE[scheme] / fastest(system)
    if not system.dampers or physics.velocity_at_full_steps(system):
        return bound
    # the root of (omega h)**2 + 2 drag h = 4, from the characteristic polynomial with velocities of the half step
    braked = 0.5 * bound * drag(system)
    return 2.0 * bound / (braked + math.sqrt(braked * braked + 4.0))


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
    contacts, springs, braked = float(np.sqrt(_contacts(system))), modal_frequency(system), drag(system)
    step = largest_timestep(accuracy, system, scheme)
    if system.dampers and not physics.velocity_at_full_steps(system):
        step = min(step, accuracy / (_DASHPOTS * (contacts + braked)))
    elif system.dampers:
        step = min(step, math.sqrt(accuracy / _LATE_DRAG) / braked)
    order = _order(scheme)
    rate = _CONTACTS * math.pow(contacts, order + 1.0) + _SPRINGS * math.pow(springs, order + 1.0)
    return min(step, math.pow(accuracy / (duration * rate), 1.0 / order))
