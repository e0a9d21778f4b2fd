"""What a plain chain has, and an ingredient may take away: facts on a problem, which the rest of the house asks for."""

from enum import Enum


class Fact(Enum):
    """What holds unless an ingredient says otherwise."""

    MOMENTUM = "momentum is conserved"
    ENERGY = "energy is conserved"
    SECOND_ORDER = "LAMMPS's error falls as the square of the time step"
    PULSE = "the kick becomes a pulse that leads, and later pulses that follow"
    REST = "no bead moves before its neighbour has"
    SONIC_VACUUM = "beads at rest bear no load and pass on no sound, so that pulses are exact solitary waves"
