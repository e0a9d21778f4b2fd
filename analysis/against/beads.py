"""How heavy the beads of a trajectory were felt to be, how strong their contacts, and what pushed them.

What is measured is the change of every bead's momentum between frames, against the impulses of all links on it
(`analysis.against.impulses`).
"""

from dataclasses import dataclass

import numpy as np

from analysis.against import impulses
from analysis.trajectory import Floats, Trajectory
from lammps_inputs.links import Along
from lammps_inputs.loads import Load

MOST = 4000
"""Beads in all chains that are looked at one by one."""

TELLING = 1e-3
"""Share of the largest squared impulses of a chain's contacts that those of a contact must have."""

SAME = 0.01
"""How near factors must be to count as the same."""


@dataclass(frozen=True)
class Felt:
    """Factors on the problem's own numbers, 1 being right; NaN where too little moved.

    The masses and contacts of a chain could all be so many times larger without a difference. As many as possible are
    taken to be right.

    Attributes:
        mass: [chain, bead].
        strength: of the contacts, [chain, contact].
    """

    mass: Floats
    strength: Floats


def identify_beads(trajectory: Trajectory) -> Felt | None:
    """Fit masses and contacts bead by bead; None for fewer than ten frames, not all beads, or more than `MOST`.

    On a bead the two contacts are felt as ``A / m``. So a mass that is wrong shows on one bead in both of its contacts,
    a contact that is wrong on both of its beads.
    """
    problem = trajectory.problem
    system = problem.system
    if not problem.forces_known or trajectory.frames < 10 or problem.chains * problem.beads > MOST:
        return None
    change = impulses.unexplained(trajectory)
    contacts, others = np.zeros(change[:, :, 1:].shape), []
    for link in system.links:
        impulse = impulses.of_link(link, trajectory)
        if isinstance(link, Along):
            contacts += impulse
        else:
            others.append(impulses.on_beads(link, impulse, trajectory))
    for damper in system.dampers:
        others.append(impulses.on_beads(damper, impulses.of_damper(damper, trajectory), trajectory))
    # of every contact, as felt by the bead behind it and by the one before it
    behind, ahead = np.full((2, problem.chains, problem.beads - 1), np.nan)
    power = np.sum(contacts**2, axis=0)
    telling = power > TELLING * power.max(axis=1, keepdims=True)
    told = {(motion.chain, motion.bead) for motion in system.motions}  # how they move, whatever they weigh
    for chain, bead in np.ndindex(problem.chains, problem.beads):
        columns = [column[:, chain, bead] for column in others]
        sides = [(ahead, bead - 1, 1.0)] if bead > 0 else []
        sides += [(behind, bead, -1.0)] if bead < problem.beads - 1 else []
        columns += [sign * contacts[:, chain, contact] for _, contact, sign in sides]
        factors = np.linalg.lstsq(np.array(columns).T, change[:, chain, bead], rcond=1e-9)[0]
        for (side, contact, _), factor in zip(sides, factors[len(others) :], strict=True):
            if telling[chain, contact] and (chain + 1, bead + 1) not in told:
                side[chain, contact] = factor
    mass, strength = np.full(change.shape[1:], np.nan), np.full(behind.shape, np.nan)
    for chain in range(problem.chains):
        mass[chain], strength[chain] = _apart(behind[chain], ahead[chain])
    return Felt(mass, strength)


def _apart(behind: Floats, ahead: Floats) -> tuple[Floats, Floats]:
    """Masses, [bead], and contacts of one chain, from ``A / m`` as felt behind and ahead of each contact, [contact]."""
    mass, strength = np.full(len(behind) + 1, np.nan), np.full(len(behind), np.nan)
    good = np.flatnonzero((behind > 0.0) & (ahead > 0.0))
    if len(good) == 0:
        return mass, strength
    # from the first contact that tells on, as far as all of them do
    run = good[: int(np.argmax(np.r_[np.diff(good) > 1, True])) + 1]
    steps = np.log(behind[run]) - np.log(ahead[run])
    heavy = np.r_[0.0, np.cumsum(steps)]
    strong = np.log(behind[run]) + heavy[:-1]
    both = np.concatenate([heavy, strong])
    near = np.abs(both[:, np.newaxis] - both) < SAME
    usual = float(np.median(both[near[int(np.argmax(near.sum(axis=1)))]]))
    mass[run[0] : run[-1] + 2], strength[run] = np.exp(heavy - usual), np.exp(strong - usual)
    return mass, strength


def given(trajectory: Trajectory, load: Load) -> Floats:
    """Impulse from outside until each frame, [frame], on the bead of a load: what the links on it do not explain."""
    problem = trajectory.problem
    change = impulses.unexplained(trajectory, problem.system.links, problem.system.dampers, loads=False)
    return np.concatenate([[0.0], np.cumsum(change[:, load.chain - 1, load.bead - 1])])
