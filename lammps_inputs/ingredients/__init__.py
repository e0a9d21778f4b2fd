"""What a scene may be made of, one ingredient a file: those that installed distributions declare (`plugins`).

An ingredient is a key of the scene (a frozen, validated class), the links between beads that it makes of it, and what
it cannot go with. Which force a link has, and how LAMMPS spells that, is its law's (`lammps_inputs.laws`).

The environment variable ``GRANCHAIN_INGREDIENTS`` may name modules (``mine,theirs``) with ingredients and laws of a
user's own, each with a dictionary ``INGREDIENTS`` of the form of that here.
"""

import importlib
import os
import sys
from pathlib import Path

from lammps_inputs import plugins
from lammps_inputs.errors import InputError
from lammps_inputs.ingredients.base import Ingredient
from lammps_inputs.ingredients.contact import contacts
from lammps_inputs.laws.spring import Linear
from lammps_inputs.links import Across, Link

OWN_INGREDIENTS = "GRANCHAIN_INGREDIENTS"
"""Environment variable that names modules with a user's own ingredients."""

__all__ = ["INGREDIENTS", "OWN_INGREDIENTS", "Ingredient", "contacts", "coupled_chains", "environment_of_children"]

INGREDIENTS: dict[str, type[Ingredient]] = {
    name: plugins.load("ingredients", name) for name in plugins.declared("ingredients")
}
"""Key of the scene -> what may stand there."""


def _own(module: str) -> dict[str, type[Ingredient]]:
    """The ingredients of a user's module.

    Raises:
        InputError: it cannot be imported, or has none.
    """
    try:
        found = importlib.import_module(module).INGREDIENTS
    except (Exception, SystemExit) as error:
        said = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        raise InputError(
            f"{OWN_INGREDIENTS}: {module!r} is no module with a dictionary INGREDIENTS on Python's path ({said}); "
            f"valid: `{OWN_INGREDIENTS}=mine,theirs` where mine.py and theirs.py are found by `import`"
        ) from error
    if not isinstance(found, dict) or not all(
        isinstance(key, str) and key.isidentifier() and isinstance(kind, type) and issubclass(kind, Ingredient)
        for key, kind in found.items()
    ):
        raise InputError(
            f"{OWN_INGREDIENTS}: INGREDIENTS of {module!r} should hold keys of a scene and classes derived from "
            'lammps_inputs.ingredients.Ingredient, such as {"bed": Bed}'
        )
    return found


for _module in filter(None, (name.strip() for name in os.environ.get(OWN_INGREDIENTS, "").split(","))):
    INGREDIENTS |= _own(_module)


def environment_of_children() -> dict[str, str]:
    """What a process of Python needs to find the same modules, whatever directory it works in."""
    if not os.environ.get(OWN_INGREDIENTS):
        return {}
    return {"PYTHONPATH": os.pathsep.join(str(Path(place).absolute()) for place in sys.path)}


def coupled_chains(chains: int, kappa: float, gap: float = 0.0) -> tuple[Link, ...]:
    """The links of the paper's arrays, dimensionless: contacts, and springs between neighbouring chains."""
    edges = tuple((chain, chain + 1) for chain in range(chains - 1))
    springs = (Across("coupling", Linear(kappa), edges=edges),) if kappa and edges else ()
    return (*contacts(gap), *springs)
