"""What a scene may be made of, one ingredient a file; this is the one place that lists them.

An ingredient is a key of the scene (a frozen, validated class), the links between beads that it makes of it, and what
it cannot go with. Which force a link has, and how LAMMPS spells that, is its law's (`lammps_inputs.laws`).

The environment variable ``GRANCHAIN_INGREDIENTS`` may name modules (``mine,theirs``) with ingredients and laws of a
user's own, each with a dictionary ``INGREDIENTS`` of the form of that here.
"""

import importlib
import os

from lammps_inputs.ingredients.base import Ingredient
from lammps_inputs.ingredients.contact import Contact, contacts
from lammps_inputs.ingredients.coupling import Coupling, springs
from lammps_inputs.ingredients.damping import Damping
from lammps_inputs.ingredients.drive import Drive
from lammps_inputs.ingredients.foundation import Foundation
from lammps_inputs.ingredients.preload import Gravity, Precompression
from lammps_inputs.ingredients.push import Push
from lammps_inputs.ingredients.walls import Walls
from lammps_inputs.links import Link

OWN_INGREDIENTS = "GRANCHAIN_INGREDIENTS"
"""Environment variable that names modules with a user's own ingredients."""

__all__ = ["INGREDIENTS", "OWN_INGREDIENTS", "Ingredient", "contacts", "coupled_chains"]

INGREDIENTS: dict[str, type[Ingredient]] = {
    "contact": Contact,
    "coupling": Coupling,
    "damping": Damping,
    "drive": Drive,
    "foundation": Foundation,
    "gravity": Gravity,
    "precompression": Precompression,
    "push": Push,
    "walls": Walls,
}
"""Key of the scene -> what may stand there."""

for _module in filter(None, os.environ.get(OWN_INGREDIENTS, "").split(",")):
    INGREDIENTS |= importlib.import_module(_module).INGREDIENTS


def coupled_chains(chains: int, kappa: float, gap: float = 0.0) -> tuple[Link, ...]:
    """The links of the paper's arrays, dimensionless: contacts, and springs between neighbouring chains."""
    return (*contacts(gap), *springs(kappa, chains))
