"""What follows from a system: its energy and momentum, what sets it in motion, and which ingredients it has.

Examples:
    >>> system = granchain.load("two-chains").problem().system
    >>> physics.energy(system), physics.momentum(system)  # in units of m V^2 and m V
    (0.5, 1.0)
    >>> physics.exponent(system), physics.kappa(system)
    (1.5, 0.1)
    >>> physics.largest_excitation(system)  # chain, bead, impulse
    (1, 1, 1.0)
    >>> physics.initial_velocity(system)[:, 0]  # in units of V
    array([1., 0.])
"""

import functools
import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import laws
from lammps_inputs.facts import Fact
from lammps_inputs.laws import Law
from lammps_inputs.laws.dashpot import ContactLoss
from lammps_inputs.links import Links
from lammps_inputs.system import System

Found = TypeVar("Found")

PULSE_RATE = 1.67
"""Angular frequency of a tied atom, in 1 / T, below which it is too slow for a pulse: its half period is the full width
at half maximum, 1.88 T, of the velocity of a bead in a plain chain kicked with V."""

_FASTER = 4.0
"""Velocity that beads beside a driven one are taken to reach at most, in the drive's own; and all beads, in that of the
kicks, on springs whose stiffness varies.
"""


_FALLS = 100
"""Iterations of a bound on the energy of beads that fall, each of which takes a part of what is missing."""


def once(compute: Callable[[System], Found]) -> Callable[[System], Found]:
    """Function that computes its value once for each system and then returns the stored one."""
    name = f"_{compute.__name__}"

    @functools.wraps(compute)
    def stored(system: System) -> Found:
        attributes = vars(system)
        if name not in attributes:
            attributes[name] = compute(system)
        return cast(Found, attributes[name])

    return stored


# --- beads ------------------------------------------------------------------------------------------------------------


def mass_of(system: System, *index: Any) -> Any:
    """Mass of chosen beads, an index of [chain, bead] from 0; the number where all have the same."""
    return system.mass if isinstance(system.mass, float) else system.mass[index]


def mass_from(system: System, first: int, array: NDArray[np.float64], absent: float = 0.0) -> Any:
    """Masses of the atoms of an array [..., line, bead], which may hold the chains alone, and begins with ``first``."""
    mass = masses(system, absent)
    return mass if isinstance(mass, float) else mass[: array.shape[-2], first - 1 : first - 1 + array.shape[-1]]


@once
def alike(system: System) -> bool:
    """Whether all beads, and all their contacts, are the same."""
    return isinstance(system.mass, float) and not any(link.differ for link in system.contacts)


@once
def one_kind(system: System) -> bool:
    """Whether all beads are the same, and all contacts but for their static load."""
    return isinstance(system.mass, float) and not any(np.ndim(laws.strength(link.law)) for link in system.contacts)


def lines(system: System) -> int:
    """Number of lines of atoms: the chains, and further lines after them."""
    return system.chains + len(system.further_lines)


def masses(system: System, absent: float = 0.0) -> float | NDArray[np.float64]:
    """Masses of all atoms, [line, bead], in units of the reference bead's; the number 1 where all have it.

    At places without an atom they are ``absent``.

    Forces over masses that are infinite where there is no atom are 0 there.
    """
    if not system.further_lines:
        return system.mass
    further = np.array([line.mass for line in system.further_lines])
    of_beads = np.broadcast_to(system.mass, (system.chains, system.beads))
    return np.vstack([of_beads, np.where(further > 0.0, further, absent)])


def mass_with_tied(system: System) -> float | NDArray[np.float64]:
    """Masses of beads with the atoms that are tied to them and move with them in slow motion, [chain, bead]."""
    if not system.further_lines:
        return system.mass
    total = np.zeros((system.chains, system.beads))
    np.add.at(total, system.chain_of_line, masses(system))
    return total


def atom_ids(system: System) -> NDArray[np.int64]:
    """Numbers of all atoms, [atom], ascending: line by line, bead by bead.

    The atom at place i of line j is (j - 1) * beads + i; numbers without an atom are left out.
    """
    present = np.broadcast_to(masses(system), (lines(system), system.beads))
    return np.asarray(np.flatnonzero(present) + 1, dtype=np.int64)


@once
def slowest_tied(system: System) -> float:
    """Least angular frequency of a tied atom on a linear spring, its bead held; infinite where there is none."""
    slowest, mass_of_line = math.inf, np.broadcast_to(masses(system), (lines(system), system.beads))
    for link in system.ties:
        if link.law.linear:
            spring = np.broadcast_to(laws.stiffness(link.law, 0.0), (len(link.edges), system.beads))
            mass = mass_of_line[[higher for _, higher in link.edges]]
            present = (spring > 0.0) & (mass > 0.0)
            slowest = min(slowest, math.sqrt(float(np.min(spring[present] / mass[present], initial=math.inf))))
    return slowest


def why_no_pulse(system: System) -> str:
    """Why there is no leading pulse, where `Fact.PULSE` does not hold."""
    if (slowest := slowest_tied(system)) < PULSE_RATE:
        return (
            f"{system.others} of angular frequency {slowest:.3g} / T are slower than a pulse, whose rate is "
            f"{PULSE_RATE} / T"
        )
    if system.start is not None and np.any(system.start.displacement):
        return "beads are displaced at the start, which may send out several pulses"
    if system.weights:
        return "beads fall, and send out a pulse whenever they meet"
    if farthest(system) > 0.0:
        return "pulses are not followed where contacts act at a distance"
    return "no pulse keeps its shape in this scene"


@once
def farthest(system: System) -> float:
    """How much farther apart than at rest neighbours that act at a distance come, at most; 0 where none do."""
    return max((float(link.law.farthest(energy(system))) for link in system.contacts), default=0.0)


def uniform(system: System) -> bool:
    """Whether no law differs from link to link, so that the beads might be more."""
    if system.start is not None or system.weights:
        return False
    return isinstance(masses(system), float) and not any(link.differ for link in system.links)


# --- what sets beads in motion ----------------------------------------------------------------------------------------


def energy(system: System) -> float:
    """Energy of the kicks; with loads an upper bound: that of free beads.

    A load that never ends has no bound; then it is the energy of beads some times faster than the drive, which one
    contact is taken to hold. Runs are checked for overlaps that LAMMPS could not hold.
    """
    if system.start is None:
        kicked = 0.5 * sum(_kicked_mass(system, kick) * kick[2] ** 2 for kick in system.kicks)
    else:
        kicked = _energy_of_start(system)
    if system.weights:
        kicked = _energy_of_fall(system, kicked)
    if varying(system):
        kicked *= _FASTER**2
    if not driven(system) and not system.loads:
        return kicked
    # a force F puts in F v at most F sqrt(2 E / m), so that sqrt(2 E) grows by no more than its impulse / sqrt(m)
    growth = sum(
        load.law.total
        * (0.5 * _FASTER if load.endless else 1.0)
        / math.sqrt(mass_of(system, load.chain - 1, load.bead - 1))
        for load in system.loads
    )
    growth += _FASTER * math.sqrt(np.max(system.mass)) * sum(abs(motion.fastest) for motion in system.motions)
    return 0.5 * (math.sqrt(2.0 * kicked) + growth) ** 2


def energy_at_start(system: System) -> float:
    """Energy at the start: kinetic, and what links store at the displacements, in units of m V**2."""
    return 0.5 * float(np.sum(masses(system) * initial_state(system)[1] ** 2)) + stored_at_start(system)


@once
def _energy_of_start(system: System) -> float:
    """Energy at the start without that of given motions."""
    return 0.5 * float(np.sum(masses(system) * _state_of_start(system)[1] ** 2)) + stored_at_start(system)


@once
def stored_at_start(system: System) -> float:
    """Energy that links store at the displacements at the start, in units of m V**2."""
    return sum(float(np.sum(energies)) for energies in _stored(system))


def released_speed(system: System) -> float:
    """Speed, in units of V, of a bead of mass 1 with the energy of the link that stores most at the start."""
    return math.sqrt(2.0 * max((float(np.max(energies)) for energies in _stored(system)), default=0.0))


def _stored(system: System) -> list[NDArray[np.float64]]:
    """Energies of the links of each kind at the start, [..., link]."""
    if system.start is None or not np.any(system.start.displacement):
        return []
    x, links = system.start.displacement, at(system, 0.0).links
    return [link.energy(x[link.lines_among(system.chains)]) for link in links if not link.law.constant]


@once
def _energies_of_fall(system: System) -> tuple[float, float]:
    """Energy that weights can supply to all contacts but one, and the largest weight on one.

    Raises:
        ValueError: contacts whose overlap under a weight is not known.
    """
    if any(link.law.overlap_under is None for link in system.along):
        raise ValueError("gravity.settled: falls are known for contacts whose force is a power of the overlap")
    x = initial_state(system)[0, : system.chains]
    supports = [wall for wall in system.walls if wall.side > 0.0]
    if not supports:  # all fall alike
        return 0.0, 0.0
    carried = np.cumsum(-sum((link.force(x) for link in system.weights), np.zeros_like(x)), axis=-1)  # ahead of a bead
    gaps = np.broadcast_to(system.along[0].gap, (system.chains, system.beads - 1))
    # a bead falls through all gaps ahead of it: the weight on each gap through that gap
    falls = np.sum(carried[:, :-1] * gaps) + np.sum(carried[:, -1] * supports[0].gap)
    supplied = float(falls + weight_energy(system, -x))
    touching = [(link.law, carried[:, :-1]) for link in system.along]
    for law, load in [*touching, (supports[0].law, carried[:, -1:])]:
        rest = law.overlap_under(load)
        supplied += float(np.sum(load * rest - laws.energy(law, rest)))
    return supplied, float(np.max(carried))


def _energy_of_fall(system: System, start: float) -> float:
    """Bound on the energy of one contact of beads that fall onto each other and a wall, in units of m V**2.

    ``sum over contacts of U(s) - F s`` is at most the energy at the start and that of free falls until all beads touch,
    where F is the weight on a contact; every other contact takes ``F s - U(s)`` at its overlap under F at most.
    """
    supplied, heaviest = _energies_of_fall(system)
    bound = least = max(start + supplied, 0.5)  # V is the velocity of a fall, if of nothing faster
    touching = [link.law for link in (*system.contacts, *system.walls)]
    for _ in range(_FALLS if heaviest else 0):
        bound = least + heaviest * max(laws.max_strain(law, bound) for law in touching)
    return bound


def weight_energy(system: System, displacement: NDArray[np.float64]) -> Any:
    """Work of the weights on the way from rest to displacements [..., chain, bead], [...] in units of m V**2."""
    chains = displacement[..., : system.chains, :]
    return sum((-np.sum(link.energy(chains), axis=(-2, -1)) for link in system.weights), 0.0)


def momentum(system: System) -> float:
    """Momentum of the kicks, and of all velocities at the start."""
    if system.start is not None:
        return float(np.sum(masses(system) * _state_of_start(system)[1]))
    return sum(_kicked_mass(system, kick) * kick[2] for kick in system.kicks)


def kick_momenta(system: System) -> float:
    """Sum of the sizes of the kicks' momenta, and of those of other velocities at the start.

    Where displacements alone set beads in motion, the momentum of one bead with their energy.
    """
    if system.start is not None:
        sizes = np.abs(masses(system) * _state_of_start(system)[1])
        return float(np.sum(sizes)) or math.sqrt(2.0 * stored_at_start(system))
    return sum(_kicked_mass(system, kick) * abs(kick[2]) for kick in system.kicks)


def _kicked_mass(system: System, kick: tuple[int, int, float]) -> float:
    return float(mass_of(system, kick[0] - 1, kick[1] - 1))


def initial_velocity(system: System) -> NDArray[np.float64]:
    """Velocities at the start, [chain, bead], in units of V."""
    velocity: NDArray[np.float64] = initial_state(system)[1, : system.chains]
    return velocity


def initial_state(system: System) -> NDArray[np.float64]:
    """Displacements and velocities of all atoms at the start, [2, line, bead], in units of L and V."""
    state = _state_of_start(system)
    for motion in system.motions:
        state[:, motion.chain - 1, motion.bead - 1] = motion.displacement(0.0), motion.velocity(0.0)
    return state


def _state_of_start(system: System) -> NDArray[np.float64]:
    """The initial state, [2, line, bead], without given motions."""
    state = np.zeros((2, lines(system), system.beads))
    if system.start is not None:
        state[:] = system.start.displacement, system.start.velocity
    for chain, bead, value in system.kicks:
        state[1, chain - 1, bead - 1] += value
    return state


def excitations(system: System) -> tuple[tuple[int, int, float], ...]:
    """(chain, bead, impulse), counted from 1, of every kick, load and motion: what sets the beads in motion.

    Of a start, the velocity of every bead that has one, and the bead that displacements push most, with the speed that
    the energy of one link gives. Where beads fall, the last bead of each chain with the speed of `fall_speeds`.
    """
    loads = ((load.chain, load.bead, load.total_impulse) for load in system.loads)
    motions = ((motion.chain, motion.bead, motion.fastest) for motion in system.motions)
    falls = ((chain, system.beads, speed) for chain in range(1, system.chains + 1) for speed in fall_speeds(system))
    return (*system.kicks, *loads, *motions, *_of_start(system), *falls)


def fall_speeds(system: System) -> list[float]:
    """Speed, in units of V, of a fall through the gap and the overlap under a bead's weight; none without weights."""
    laws_of_weights: list[Any] = [link.law for link in system.weights]
    accelerations = [float(np.max(np.abs(law.acceleration))) for law in laws_of_weights]
    return [math.sqrt(2.0 * g * (gap(system) + g ** (1.0 / (exponent(system) or 1.5)))) for g in accelerations]


@once
def _of_start(system: System) -> tuple[tuple[int, int, float], ...]:
    if system.start is None:
        return ()
    velocity = system.start.velocity[: system.chains]
    moving = [(chain + 1, bead + 1, float(velocity[chain, bead])) for chain, bead in np.argwhere(velocity).tolist()]
    if not (speed := released_speed(system)):
        return tuple(moving)
    force = force_at_start(system)[: system.chains]
    chain, bead = np.unravel_index(int(np.argmax(np.abs(force))), force.shape)
    return (*moving, (int(chain) + 1, int(bead) + 1, math.copysign(speed, float(force[chain, bead]))))


def force_at_start(system: System) -> NDArray[np.float64]:
    """Force of all links on each atom at the start, [line, bead] in units of m V / T; loads are left out."""
    x: NDArray[np.float64] = initial_state(system)[0]
    force = np.zeros_like(x)
    for link in at(system, 0.0).links:
        among = link.lines_among(system.chains)
        link.drive(force[among], link.force(x[among]))
    return force


def span_at_start(system: System) -> tuple[int, int]:
    """First and last bead, counted from 1, that move at the start, or that loads or links to the ground may move later.

    All others feel no force until a neighbour moves.
    """
    if system.closing:
        return 1, system.beads
    beads = [bead for _, bead, _ in excitations(system)] + _moved_by_ground(system)
    if system.start is not None:
        displaced = np.flatnonzero(np.any(system.start.displacement, axis=0) | np.any(system.start.velocity, axis=0))
        beads += (displaced[[0, -1]] + 1).tolist()
    return min(beads), max(beads)


@once
def _moved_by_ground(system: System) -> list[int]:
    """First and last bead, counted from 1, on which links to the ground act at rest at any time; none if on no bead."""
    rest, acting = np.zeros((system.chains, system.beads)), np.zeros(system.beads, dtype=bool)
    for link in (*system.ground, *system.weights):
        for time in _sampled_times(link.law) if link.law.varies else [0.0]:
            acting |= np.any(link.at(time).force(rest) != 0.0, axis=0)
    beads = np.flatnonzero(acting)
    return (beads[[0, -1]] + 1).tolist() if len(beads) else []


def _sampled_times(law: Any) -> list[float]:
    """Times at some of which a law acts at rest if it ever does: of all sizes, over a period, at and between bends."""
    bends = np.array([0.0, *filter(math.isfinite, law.bends)])
    period = 2.0 * math.pi / float(np.max(law.omega)) if np.any(law.omega) else 0.0
    return [*bends, *(bends[1:] + bends[:-1]) / 2.0, *np.linspace(0.0, period, 33), *np.geomspace(1e-6, 1e9, 16)]


def largest_excitation(system: System) -> tuple[int, int, float]:
    """(chain, bead, impulse), counted from 1, of what sets most in motion: where the leading pulse starts."""
    return max(excitations(system), key=lambda excitation: abs(excitation[2]))


def acted_on(system: System) -> bool:
    """Whether there are pushes, drives or springs whose stiffness varies in time."""
    return bool(system.loads) or bool(system.motions) or varying(system)


def driven(system: System) -> bool:
    """Whether anything outside moves or pushes beads for ever, or springs that vary may do so much work."""
    return bool(system.motions) or any(load.endless for load in system.loads) or varying(system)


def exchanges(system: System) -> bool:
    """Whether energy is exchanged after the start: work input, or dissipation."""
    return acted_on(system) or bool(system.dampers)


# --- contacts ---------------------------------------------------------------------------------------------------------


@once
def gap(system: System) -> float:
    """Clear distance between neighbouring beads, the largest if they differ; 0 where all touch."""
    return max(float(np.max(link.gap)) for link in system.contacts)


def one_gap(system: System) -> bool:
    """Whether all neighbouring beads are the same clear distance apart, or touch."""
    return all(np.ndim(link.gap) == 0 for link in system.contacts)


def exponent(system: System) -> float | None:
    """Exponent of the overlap in the force of all contacts; None where that is no power, or contacts differ."""
    powers = [link.law.exponent for link in system.contacts]
    alike = len(system.along) == 1 and not any(isinstance(power, np.ndarray) for power in powers)
    return powers[0] if alike else None


def law_of_contacts(system: System) -> Any:
    """Law of the contacts of chains; of rings also of those that close them, which are the last of each chain."""
    law = system.along[0].law
    for link in system.closing:
        law = laws.joined(law, link.law, (system.chains, system.beads - 1))
    return law


@once
def loaded(system: System) -> bool:
    """Whether contacts are loaded at rest, so that there is sound."""
    return any(np.any(link.law.load) for link in system.along)


def even(system: System) -> bool:
    """Whether all neighbouring beads are equally far apart at rest."""
    return one_gap(system) and not any(np.ndim(link.law.rest) for link in system.along)


@once
def contacts_with_state(system: System) -> tuple[Links, ...]:
    """The contacts and walls whose force depends on a state of each (`lammps_inputs.laws.ContactState`).

    Arrays of states are [..., chain, bead + 1]: of the wall before the first bead, of the contact behind each other,
    and of the wall behind the last.
    """
    return tuple(link for link in (*system.contacts, *system.walls) if laws.has_state(link.law))


def taken_by_state(law: Law) -> frozenset[Fact]:
    """Facts that do not hold where the force of contacts depends on the past; none for other laws.

    Raises:
        ValueError: the law is incomplete.
    """
    laws.refuse_incomplete(law)
    lost = {Fact.FRAMES, Fact.ENERGY, Fact.FRONT, Fact.REVERSIBLE}
    return frozenset(lost if laws.has_state(law) else ())


def state_headings(system: System) -> tuple[str, ...]:
    """Headings of the columns of frames with the states of contacts: of that behind each bead, and of that ahead.

    The latter is there where a wall is behind the last bead; none without states.
    """
    links = contacts_with_state(system)
    if not links:
        return ()
    walled = any(link.between == slice(-1, None) for link in links)
    heading = laws.state_heading(links[0].law)
    return (heading, f"{heading}_ahead")[: 1 + walled]


def contact_state(system: System) -> NDArray[np.float64]:
    """States of contacts at the start, [chain, bead + 1]; 0 where there is none."""
    states = np.zeros((system.chains, system.beads + 1))
    for link in contacts_with_state(system):
        states[:, link.between] = laws.contact_state(link.law)
    return states


def at_contact_state(system: System, states: NDArray[np.float64]) -> System:
    """The system at other states of its contacts, [..., chain, bead + 1] (`contacts_with_state`)."""

    def at(link: Links) -> Links:
        if not link.touching:
            return link
        return replace(link, law=laws.at_state(link.law, states[..., link.between]))

    return replace(system, links=tuple(map(at, system.links)))


def dissipated_by_contacts(system: System) -> Any:
    """Energy dissipated by contacts and walls, [...], in their states; 0.0 where they have none."""
    links = contacts_with_state(system)
    energies = [link.law.dissipated(*link.law) for link in links]
    return sum((np.sum(energy, axis=(-2, -1)) if np.ndim(energy) else energy for energy in energies), 0.0)


def contact_loss(system: System) -> ContactLoss | None:
    """Dashpot law of the contacts; None if they are undamped."""
    return next((cast(ContactLoss, link.law) for link in system.dampers if link.kind == "along"), None)


# --- walls and the ground ---------------------------------------------------------------------------------------------


def loss_beside(system: System, contacts: Links) -> Any:
    """Dashpot law beside contacts or walls; None if they are undamped."""
    dashpots = beside(system.dampers, contacts)
    return None if dashpots is None else dashpots.law


def beside(links: Iterable[Links], other: Links) -> Links | None:
    """Those of some links that are at the places of others along the chains; None where there are none."""
    return next((link for link in links if link.touching and link.between == other.between), None)


def at_place(links: Iterable[Links], place: int, beads: int) -> Iterator[tuple[Links, int]]:
    """Links along the chains at a place among those before, between and behind their beads, from 0.

    Yields:
        The links, and the position there of those at the place.
    """
    for link in links:
        if link.touching and place in (places := range(beads + 1)[link.between]):
            yield link, place - places.start


@once
def varying(system: System) -> bool:
    """Whether any spring to the ground depends on time."""
    return any(link.law.varies for link in system.ground)


def at(system: System, time: Any) -> System:
    """The system at a time, [...]: of links that depend on it as they are then, so that states [..., chain, bead] have
    forces and energies.
    """
    if not varying(system):
        return system
    shape = (*np.shape(time), system.chains, system.beads)

    def at_time(link: Links) -> Links:
        law: Any = link.at(time).law
        return replace(link, law=type(law)(*(np.broadcast_to(value, shape) for value in law)))

    return replace(system, links=tuple(at_time(link) if link.law.varies else link for link in system.links))


# --- dashpots ---------------------------------------------------------------------------------------------------------


def dissipation_names(system: System) -> tuple[str | None, ...]:
    """Names of what dissipates: dashpots along, across, to the ground and of walls, contacts; None where none does."""

    def names(kind: str) -> str | None:
        return " and ".join(dict.fromkeys(link.name for link in system.dampers if link.kind == kind)) or None

    dashpots = map(names, ("along", "across", "ground", "wall"))
    return (*dashpots, "plastic contacts" if contacts_with_state(system) else None)


def velocity_at_full_steps(system: System) -> bool:
    """Whether LAMMPS's step is of order 2 by masses that are larger (`lammps_inputs.laws.dashpot.Dashpot`)."""
    return bool(system.dampers) and system.holds(Fact.SECOND_ORDER)


# --- springs between chains -------------------------------------------------------------------------------------------


def coupled(system: System) -> bool:
    """Whether any spring between chains exists."""
    return bool(system.couplings)


def kappa(system: System) -> float:
    """Stiffness at rest of the springs between chains, the largest if they differ; 0 where there are none."""
    return max((float(np.max(laws.stiffness(link.law, 0.0))) for link in system.couplings), default=0.0)


def pulse_time(system: System) -> float:
    """Factor on times and overlaps of pulses: ``A**(-1 / (n + 1))``, of contacts of one strength A and exponent n."""
    strength, n = laws.strength(system.along[0].law), exponent(system)
    return 1.0 if n is None or np.ndim(strength) else float(strength) ** (-1.0 / (n + 1.0))


def kappa_of_pulses(system: System) -> float:
    """`kappa` in the time in which pulses pass, see `pulse_time`."""
    return kappa(system) * pulse_time(system) ** 2


def open_row(system: System) -> bool:
    """Whether the chains stand in a row, each tied to the next by equal linear springs; or none to another."""
    return all(
        link.law.linear and not laws.differs(link.law) and link.open_row and len(link.edges) == system.chains - 1
        for link in system.couplings
    )


def simply_coupled(system: System) -> bool:
    """Whether every row oscillates by the known modes of equal linear springs in an open row of chains, or freely.

    Its beads have the mass 1.
    """
    others = system.ground or system.walls or system.closing or system.weights or system.start is not None
    free = isinstance(masses(system), float) and not others
    return free and open_row(system) and not acted_on(system) and not system.dampers


@once
def groups(system: System) -> tuple[frozenset[int], ...]:
    """Chains, counted from 0, that are tied to each other, directly or by others; each in one group."""
    group = {chain: {chain} for chain in range(system.chains)}
    for first, second in (edge for link in system.couplings for edge in link.edges):
        small, large = sorted((group[first], group[second]), key=len)
        if small is not large:
            large |= small
            group.update(dict.fromkeys(small, large))
    return tuple(map(frozenset, {id(members): members for members in group.values()}.values()))


def tied_to(system: System, chain: int) -> list[int]:
    """Chains, counted from 0, of the group that a chain is in, ascending."""
    return sorted(next(group for group in groups(system) if chain in group))
