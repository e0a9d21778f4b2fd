"""The equation of motion on recorded states: acceleration and its rate, energy and momentum, each a sum over links.

All dimensionless. Which links there are, and their laws, is the problem's (`lammps_inputs.links`). Arrays are
[..., chain, bead] of consecutive beads, which begin with bead ``first``. Where a system has further lines of atoms,
energy, momentum and acceleration take [..., line, bead], these lines after the chains (`Trajectory.atoms`).

Plug-ins take this module for what the states of a run imply: overlaps and forces of contacts, accelerations, energies
of beads and of the system. They give it ``problem.system`` and arrays of a `Trajectory`.

Examples:
    >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem()
    >>> frames = engine.run(problem)
    >>> motion.energy(problem.system, frames.displacement, frames.velocity)[[0, 150, 300]].round(6)  # in m V**2
    array([0.5, 0.5, 0.5])
    >>> motion.overlaps(problem.system, frames.displacement)[100, 0, 5:11].round(3)  # of contacts 6 to 11, in L
    array([-0.003,  0.164,  0.7  ,  0.442,  0.039,  0.   ])
"""

from typing import Any

import numpy as np

from analysis.trajectory import Floats, Integers, Trajectory
from lammps_inputs import System, laws, physics


def overlaps(system: System, displacement: Floats, first: int = 1) -> Floats:
    """Overlap of each bead with the next of its chain, in a ring also of the last with the first; negative if apart.

    Args:
        system: masses and links.
        displacement: [..., chain, bead] in units of L, of consecutive beads.
        first: number of the first of these beads.

    Returns:
        [..., chain, contact] in units of L, the overlap at rest included: one fewer than beads, of a ring as many.
    """
    closing = system.among(system.closing, first, displacement.shape[-1])
    each = [link.overlap(displacement, first) for link in (system.along[0], *closing)]
    return each[0] if len(each) == 1 else np.concatenate(each, axis=-1)


def rest_overlap(system: System, chain: Integers, contact: Integers) -> Any:
    """Overlap at rest, less than 0 where there is a gap, at positions (chain, contact) from 0, of their shape.

    A number where all are the same; beyond the last contact that of the last.
    """
    contacts = system.along[0]
    rest = contacts.law.rest - contacts.gap
    return rest[chain, np.clip(contact, 0, system.beads - 2)] if np.ndim(rest) else rest


def _weighed(system: System, values: Floats, first: int) -> Floats:
    """Values of atoms, [..., line, bead] or of the chains alone, times their masses."""
    mass = physics.mass_from(system, first, values)
    return values if isinstance(mass, float) else values * mass


def kinetic_energy(system: System, velocity: Floats, first: int = 1) -> Floats:
    """Kinetic energy of every bead, [..., chain, bead], at velocities of that shape."""
    return _weighed(system, np.asarray(0.5 * velocity * velocity), first)


def energy(system: System, displacement: Floats, velocity: Floats, first: int = 1) -> Floats:
    """Total energy of states: kinetic, and of every link (eq. 1 integrated).

    Args:
        system: masses and links.
        displacement: [..., line, bead] in units of L, of consecutive beads.
        velocity: [..., line, bead] in units of V.
        first: number of the first of these beads.

    Returns:
        [...] in units of m V**2; NaN of the chains alone where there are further lines of atoms.
    """
    total = np.sum(kinetic_energy(system, velocity, first), axis=(-2, -1))
    if velocity.shape[-2] < physics.lines(system):
        return np.full_like(total, np.nan)
    for link in system.among(system.links, first, displacement.shape[-1]):
        total += np.sum(link.energy(displacement[..., link.lines_among(system.chains), :], first), axis=(-2, -1))
    return np.asarray(total)


def bead_energy(system: System, displacement: Floats, velocity: Floats, first: int = 1) -> Floats:
    """Energy of each bead in its own chain: two beads in contact have half of its energy each.

    The energy of springs between chains is not included.

    Args:
        system: masses and links.
        displacement: [..., chain, bead] in units of L, of consecutive beads.
        velocity: [..., chain, bead] in units of V.
        first: number of the first of these beads.

    Returns:
        [..., chain, bead] in units of m V**2.
    """
    total = kinetic_energy(system, velocity, first)
    links = (*system.contacts, *system.ground, *system.walls)
    for link in system.among(links, first, displacement.shape[-1]):
        link.shared(total, link.energy(displacement, first))
    return total


def participation(energy: Floats) -> float:
    """Participation number of energies e: (sum e)^2 / sum e^2, which is N where N beads have the same and others none.

    Args:
        energy: [...] energies of beads, in any unit.

    Returns:
        The number; NaN where no bead has energy.
    """
    total = float(np.sum(energy))
    return 1.0 / float(np.sum((energy / total) ** 2)) if total > 0.0 else np.nan


def contact_energy(system: System, displacement: Floats, first: int = 1) -> Floats:
    """Energy in each contact, [..., chain, bead - 1]."""
    return np.asarray(sum(link.energy(displacement, first) for link in system.along))


def contact_force(system: System, overlap: Floats, *contact: Integers | slice) -> Floats:
    """Total force of chosen contacts; the force at rest is included.

    Args:
        system: its contacts.
        overlap: [...] in units of L.
        contact: positions of the chains, [...], and of the contacts in them, [...], from 0; that which closes a ring is
            among them where none are given, of overlaps [..., chain, contact] of all.

    Returns:
        [...] in units of m V / T.
    """
    if system.closing and not contact:
        parts = (system.along, overlap[..., :-1]), (system.closing, overlap[..., -1:])
        each = [sum(laws.whole_force(link.law, part) for link in links) for links, part in parts]
        return np.concatenate(each, axis=-1)
    return np.asarray(sum(laws.whole_force(laws.at(link.law, *contact), overlap) for link in system.along))


def static_force(system: System, *contact: Any) -> Any:
    """Force of chosen contacts at rest; see `contact_force`."""
    return sum(laws.at(link.law, *contact).load for link in system.along)


def momentum(system: System, velocity: Floats) -> Floats:
    """Total momentum, [...] from [..., line, bead]; NaN of the chains alone where there are further lines."""
    total = np.sum(_weighed(system, velocity, 1), axis=(-2, -1))
    return np.asarray(total) if velocity.shape[-2] == physics.lines(system) else np.full_like(total, np.nan)


def acceleration(
    system: System,
    displacement: Floats,
    first: int = 1,
    *,
    time: Floats | None = None,
    velocity: Floats | None = None,
) -> Floats:
    """Acceleration of every atom (eq. 1); every atom must be recorded.

    Args:
        system: masses, links, dashpots and loads.
        displacement: [..., line, bead] in units of L, of consecutive beads.
        first: number of the first of these beads.
        time: [...] in units of T; without it forces from outside are left out.
        velocity: [..., line, bead] in units of V; without it forces of dashpots are left out.

    Returns:
        [..., line, bead] in units of V / T.
    """
    result = np.zeros_like(displacement)
    links = (system if time is None else physics.at(system, time)).links
    for link in system.among(links, first, displacement.shape[-1]):
        lines = link.lines_among(system.chains)
        link.drive(result[..., lines, :], link.force(displacement[..., lines, :], first))
    dampers = system.dampers if velocity is not None else ()
    for damper in system.among(dampers, first, displacement.shape[-1]):
        assert velocity is not None
        lines = damper.lines_among(system.chains)
        force = damper.damping(displacement[..., lines, :], velocity[..., lines, :], first)
        damper.drive(result[..., lines, :], force)
    for load in system.loads if time is not None else ():
        result[..., load.chain - 1, load.bead - first] += load.force(time)
    mass = physics.mass_from(system, first, result, absent=np.inf)
    if not isinstance(mass, float):
        result = result / mass
    for prescribed in system.motions if time is not None else ():
        result[..., prescribed.chain - 1, prescribed.bead - first] = prescribed.acceleration(time)
    return result


def acceleration_and_rate(block: Trajectory, frame: Integers, chain: Integers, bead: Integers) -> tuple[Floats, Floats]:
    """Second and third derivative of displacement at chosen (frame, chain, bead) positions of a block.

    Every bead must be recorded. Indices count from 0 and have one shape, which both results have.
    """
    problem, (x, v) = block.problem, block.atoms
    system = problem.system
    bead_x, bead_v = x[frame, chain, bead], v[frame, chain, bead]
    acceleration, rate = np.zeros_like(bead_x), np.zeros_like(bead_x)

    before = block.first - 1
    for link in system.links:
        for near in link.of_beads(chain, bead, x.shape[1:]):
            law = block.law(link, frame, near.line, before + near.place)
            law = law.now(block.time[frame]) if law.varies else law
            strain, closing = (
                near.apart(bead_x, x, frame) - link.gap_at(near.line, before + near.place),
                near.apart(bead_v, v, frame),
            )
            acceleration -= np.where(near.exists, near.sign * laws.force(law, strain), 0.0)
            change = laws.stiffness(laws.on_branch(law, closing), strain) * closing + law.change(strain, *law)
            rate -= np.where(near.exists, near.sign * change, 0.0)
    row = before + bead
    for load in system.loads:
        at_bead, time = (chain == load.chain - 1) & (row == load.bead - 1), block.time[frame]
        acceleration += np.where(at_bead, load.force(time), 0.0)
        rate += np.where(at_bead, load.rate(time), 0.0)
    if system.dampers:
        drag, drag_rate = _drag_and_rate(block)
        acceleration += drag[frame, chain, bead]
        rate += drag_rate[frame, chain, bead]
    if not isinstance(system.mass, float):
        mass = physics.mass_of(system, chain, row)
        acceleration, rate = acceleration / mass, rate / mass
    for prescribed in system.motions:
        at_bead, time = (chain == prescribed.chain - 1) & (row == prescribed.bead - 1), block.time[frame]
        acceleration = np.where(at_bead, prescribed.acceleration(time), acceleration)
        rate = np.where(at_bead, prescribed.jerk(time), rate)
    return acceleration, rate


def strain_and_rates(block: Trajectory, frame: Integers, chain: Integers, bead: Integers) -> Floats:
    """Strain between chosen beads and the next recorded, and its derivatives.

    Args:
        block: frames.
        frame, chain, bead: [entry] positions of the beads in the arrays of the frames, from 0.

    Returns:
        [derivative, entry] in units of L and T; the second derivative is there where the frames determine the forces.
    """
    ends = [[values[frame, chain, bead + k] for k in (0, 1)] for values in (block.displacement, block.velocity)]
    if block.forces_known:
        ends.append([acceleration_and_rate(block, frame, chain, bead + k)[0] for k in (0, 1)])
    return np.array([behind - ahead for behind, ahead in ends])


def _drag_and_rate(block: Trajectory) -> tuple[Floats, Floats]:
    """Force of all dashpots on every bead, and how fast it changes, [frame, chain, bead]."""
    problem, (x, v) = block.problem, block.atoms
    a = acceleration(block.system, x, block.first, time=block.time, velocity=v)
    drag, rate = np.zeros_like(x), np.zeros_like(x)
    for link in problem.system.dampers:
        lines = link.lines_among(problem.chains)
        lines_x, lines_v, lines_a = (values[:, lines] for values in (x, v, a))
        link.drive(drag[:, lines], link.damping(lines_x, lines_v, block.first))
        link.drive(rate[:, lines], link.damping_rate(lines_x, lines_v, lines_a, block.first))
    return drag, rate


def pressing(block: Trajectory, frame: Integers, chain: Integers, bead: Integers) -> Floats:
    """Force of a bead's contact times its overlap, over the bead's mass: the larger of its two, negative if apart.

    Over the velocity squared it is the same for a pulse of any amplitude in contacts of any strength.

    Args:
        block: frames.
        frame, chain, bead: positions in it, from 0, of one shape.

    Returns:
        [...] of that shape, in units of V squared; NaN where not all beads are recorded.
    """
    result = np.full(frame.shape, np.nan)
    if block.problem.rows.neighbours:
        x, system = block.displacement, block.problem.system
        row = block.first - 1 + bead
        for link in system.closing:
            for near in link.of_beads(chain, bead, x.shape[1:]):
                overlap = (
                    near.apart(x[frame, chain, bead], x, frame) + link.law.rest - link.gap_at(near.line, near.place)
                )
                force = laws.whole_force(laws.at(link.law, near.line, near.place), overlap)
                result = np.fmax(result, np.where(near.exists, _over_apart(overlap, force), -np.inf))
        for side in (-1, 1):
            other = np.clip(bead + side, 0, x.shape[2] - 1)
            contact = np.clip(row + min(side, 0), 0, system.beads - 2)
            overlap = side * (x[frame, chain, bead] - x[frame, chain, other]) + rest_overlap(system, chain, contact)
            work = _over_apart(overlap, contact_force(system, overlap, chain, contact))
            result = np.fmax(result, np.where(other == bead, -np.inf, work))
        result /= physics.mass_of(system, chain, row)
    return result


def _over_apart(overlap: Floats, force: Floats) -> Floats:
    """Force times overlap where beads overlap; the overlap, which is negative, where they are apart."""
    return np.where(overlap > 0.0, force * overlap, overlap)
