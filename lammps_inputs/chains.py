"""Links of plain chains: contacts, and linear springs between neighbouring chains."""

from lammps_inputs.laws import Law, Parameter
from lammps_inputs.laws.contact import Hertz
from lammps_inputs.laws.spring import Linear
from lammps_inputs.links import Links


def contacts(gap: Parameter, strength: Parameter = 1.0, law: Law | None = None) -> tuple[Links, ...]:
    """Contacts, which begin to touch a clear distance ``gap`` (in units of L) from rest.

    Args:
        gap: gap of all contacts, or [chain, contact].
        strength: strength over that of two reference beads, a number or [chain, contact].
        law: law of the contacts; Hertz's of this strength by default.
    """
    return (Links.along("contacts", law or Hertz(strength), gap),)


def coupled_chains(chains: int, kappa: float, gap: float = 0.0) -> tuple[Links, ...]:
    """The links of the paper's arrays, dimensionless: contacts, and springs between neighbouring chains."""
    edges = tuple((chain, chain + 1) for chain in range(chains - 1))
    springs = (Links.across("coupling", Linear(kappa), edges),) if kappa and edges else ()
    return (*contacts(gap), *springs)
