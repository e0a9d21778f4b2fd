"""Contacts between neighbouring beads of a chain: what every scene has, with or without a gap."""

from lammps_inputs.laws import Parameter
from lammps_inputs.laws.hertz import Hertz
from lammps_inputs.links import Along


def contacts(gap: float, strength: Parameter = 1.0) -> tuple[Along, ...]:
    """Hertzian contacts, which begin to touch a clear distance ``gap`` (in units of L) from rest.

    Args:
        gap: the same everywhere.
        strength: in that of two reference beads, a number or [chain, contact].
    """
    return (Along("contacts", Hertz(strength), gap=gap),)
