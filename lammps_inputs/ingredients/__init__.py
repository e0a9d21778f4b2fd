"""What a scene may be made of, one ingredient a file.

An ingredient is a key of the scene (a frozen, validated class), the links between beads that it makes of it, and what
it cannot go with. Which force a link has, and how LAMMPS spells that, is its law's (`lammps_inputs.laws`). Which
ingredients there are, `registry` says.
"""

from lammps_inputs.ingredients.base import Ingredient

__all__ = ["Ingredient"]
