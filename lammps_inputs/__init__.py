"""What is to be computed: scenes, the dimensionless problem they stand for, and the LAMMPS input that computes it.

Imports nothing of the other two packages. Runs nothing, and reads no results.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from lammps_inputs.errors import InputError
    from lammps_inputs.ingredients.material import Material
    from lammps_inputs.library import find, load
    from lammps_inputs.output import Output
    from lammps_inputs.problem import Problem
    from lammps_inputs.scene import Kick, Scene
    from lammps_inputs.system import System

__all__ = ["InputError", "Kick", "Material", "Output", "Problem", "Scene", "System", "find", "load"]

_PLACES = {
    "InputError": "errors",
    "find": "library",
    "load": "library",
    "Problem": "problem",
    "System": "system",
    "Kick": "scene",
    "Material": "ingredients.material",
    "Output": "output",
    "Scene": "scene",
}
"""Imported on first use: the types of scenes take a while to load, and not every command needs them."""


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{_PLACES[name]}"), name)
