"""What a plain chain has, and an ingredient may take away: facts on a problem, which other modules ask for."""

from enum import Enum


class Fact(Enum):
    """Property of a plain chain that holds unless an ingredient removes it.

    Work from outside, of pushes, given motions and laws in time, removes no energy: the budget has it. Dashpots do.
    Springs to the ground and given motions remove momentum.

    Examples:
        >>> chains, damped = (granchain.load(name).problem().system for name in ("two-chains", "damped-contacts"))
        >>> chains.holds(Fact.ENERGY), damped.holds(Fact.ENERGY)
        (True, False)
    """

    MOMENTUM = "momentum is conserved"
    ENERGY = "energy is conserved"
    SECOND_ORDER = "LAMMPS's error falls as the square of the time step"
    PULSE = "the kick becomes a pulse that leads, and later pulses that follow"
    REST = "no bead moves before its neighbour has"
    FRONT = "what happens behind the leading pulse never reaches it again, so that a window may remove it"
    REVERSIBLE = "forces are smooth and depend on neither time nor velocity, so that a scheme may step back in time"
    FRAMES = "displacements and velocities of the beads determine the forces on them"
    OVERLAPS = "contacts close by overlapping, with forces that follow from the overlaps"
    SONIC_VACUUM = "beads at rest carry no load and transmit no sound, so that pulses are exact solitary waves"
