"""What is to be computed: scenes, the dimensionless problem they stand for, and the LAMMPS input that computes it.

Imports nothing of the other two packages. Runs nothing, and reads no results.
"""

from lammps_inputs.errors import InputError
from lammps_inputs.ingredients.coupling import Coupling
from lammps_inputs.library import find, load
from lammps_inputs.problem import Problem, System
from lammps_inputs.scene import Kick, Material, Output, Scene

__all__ = ["Coupling", "InputError", "Kick", "Material", "Output", "Problem", "Scene", "System", "find", "load"]
