"""What a scene may be made of, one ingredient a file.

An ingredient is a key of the scene (a frozen, validated class), the links between beads that it makes of it, and what
it cannot go with. Which force a link has, and how LAMMPS spells that, is its law's (`lammps_inputs.laws`). Which
ingredients there are, `registry` says.
"""

from lammps_inputs.ingredients.base import Ingredient
from lammps_inputs.ingredients.contact import contacts
from lammps_inputs.laws.spring import Linear
from lammps_inputs.links import Across, Link

__all__ = ["Ingredient", "contacts", "coupled_chains"]


def coupled_chains(chains: int, kappa: float, gap: float = 0.0) -> tuple[Link, ...]:
    """The links of the paper's arrays, dimensionless: contacts, and springs between neighbouring chains."""
    edges = tuple((chain, chain + 1) for chain in range(chains - 1))
    springs = (Across("coupling", Linear(kappa), edges=edges),) if kappa and edges else ()
    return (*contacts(gap), *springs)
