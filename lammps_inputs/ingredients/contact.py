"""Contacts between neighbouring beads of a chain: what every scene has, with or without a gap."""

from lammps_inputs.laws.hertz import Hertz
from lammps_inputs.links import Along


def contacts(gap: float) -> tuple[Along, ...]:
    """Hertzian contacts of equal beads, which begin to touch a clear distance ``gap`` (in units of L) from rest."""
    return (Along("contacts", Hertz(), gap=gap),)
