"""Which ingredients there are: those that installed distributions declare (`lammps_inputs.plugins`), and a user's.

The environment variable ``GRANCHAIN_INGREDIENTS`` may name modules (``mine,theirs``) with ingredients and laws of a
user's own that are not installed, each with a dictionary ``INGREDIENTS`` from keys of a scene to classes.

Examples:
    >>> registry.INGREDIENTS["walls"].__name__
    'Walls'
    >>> sorted(registry.SEVERAL)
    ['drive', 'initial', 'kick', 'push', 'replace', 'resonators']
"""

import importlib
import os
import sys
from pathlib import Path

from lammps_inputs import plugins
from lammps_inputs.errors import InputError
from lammps_inputs.ingredients.base import Ingredient

OWN_INGREDIENTS = "GRANCHAIN_INGREDIENTS"
"""Environment variable that names modules with a user's own ingredients."""


NEEDED = "# needs "
"""Begin of a comment at the head of a scene's file that names a module or package of one of its ingredients."""


def _is_ingredient(key: object, kind: object) -> bool:
    return isinstance(key, str) and key.isidentifier() and isinstance(kind, type) and issubclass(kind, Ingredient)


def _of_distributions() -> dict[str, type[Ingredient]]:
    """Ingredients that installed distributions declare.

    Raises:
        InputError: one of them is no class of an ingredient, or its name cannot be a key of a scene.
    """
    ingredients = plugins.loaded("ingredients")
    for key, kind in ingredients.items():
        if not _is_ingredient(key, kind):
            raise InputError(
                f"granchain.ingredients: {key} = {plugins.declared('ingredients')[key].value} should be a key of a "
                "scene and a class derived from lammps_inputs.ingredients.Ingredient, such as `bed = beds:Bed`"
            )
    return ingredients


def _of_module(module: str) -> dict[str, type[Ingredient]]:
    """The ingredients of a user's module.

    Raises:
        InputError: it cannot be imported, or has none.
    """
    try:
        ingredients = importlib.import_module(module).INGREDIENTS
    except (Exception, SystemExit) as error:
        reason = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        raise InputError(
            f"{OWN_INGREDIENTS}: {module!r} is no module with a dictionary INGREDIENTS on Python's path ({reason}); "
            f"valid: `{OWN_INGREDIENTS}=mine,theirs` where mine.py and theirs.py are found by `import`"
        ) from error
    if not isinstance(ingredients, dict) or not all(_is_ingredient(*item) for item in ingredients.items()):
        raise InputError(
            f"{OWN_INGREDIENTS}: INGREDIENTS of {module!r} should hold keys of a scene and classes derived from "
            'lammps_inputs.ingredients.Ingredient, such as {"bed": Bed}'
        )
    return ingredients


INGREDIENTS: dict[str, type[Ingredient]] = _of_distributions()
"""Key of the scene -> what may stand there."""
NEEDS = {key: f"the package {name}" for key in INGREDIENTS if (name := plugins.provider("ingredients", key))}
"""Key of an ingredient that granchain does not bring -> what a scene with it needs, in words."""
for _module in filter(None, (name.strip() for name in os.environ.get(OWN_INGREDIENTS, "").split(","))):
    _own = _of_module(_module)
    INGREDIENTS |= _own
    NEEDS |= dict.fromkeys(_own, f"{OWN_INGREDIENTS}={_module}")

SEVERAL = {"kick", "replace", *(key for key, ingredient in INGREDIENTS.items() if ingredient.several)}
"""Keys that may hold a list of parts."""


def environment_of_children() -> dict[str, str]:
    """Environment variables by which a process of Python finds the same modules in any working directory."""
    if not os.environ.get(OWN_INGREDIENTS):
        return {}
    return {"PYTHONPATH": os.pathsep.join(str(Path(place).absolute()) for place in sys.path)}
