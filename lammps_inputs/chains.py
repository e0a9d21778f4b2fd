"""Links of plain chains: contacts, and linear springs between neighbouring chains."""

import numpy as np

from lammps_inputs import laws
from lammps_inputs.laws import Law, Parameter
from lammps_inputs.laws.contact import Hertz
from lammps_inputs.laws.spring import Linear
from lammps_inputs.links import Links


def contacts(
    gap: Parameter, strength: Parameter = 1.0, law: Law | None = None, *, name: str = "contacts", closed: bool = False
) -> tuple[Links, ...]:
    """Contacts, which begin to touch a clear distance ``gap`` (in units of L) from rest.

    Args:
        gap: gap of all contacts, or [chain, contact].
        strength: strength over that of two reference beads, a number or [chain, contact].
        law: law of the contacts; Hertz's of this strength by default.
        name: name for users.
        closed: whether the last contact is that of the last bead with the first.
    """
    law = law or Hertz(strength)
    if not closed:
        return (Links.along(name, law, gap),)
    between, last = (
        (laws.at(law, Ellipsis, part), gap[..., part] if isinstance(gap, np.ndarray) else gap)
        for part in (slice(None, -1), slice(-1, None))
    )
    return Links.along(name, *between), Links.closing(f"closing_{name}", *last)


def coupled_chains(chains: int, kappa: float, gap: float = 0.0) -> tuple[Links, ...]:
    """The links of the paper's arrays, dimensionless: contacts, and springs between neighbouring chains."""
    edges = tuple((chain, chain + 1) for chain in range(chains - 1))
    springs = (Links.across("coupling", Linear(kappa), edges),) if kappa and edges else ()
    return (*contacts(gap), *springs)
