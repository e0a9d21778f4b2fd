"""How LAMMPS keeps the periodic states of a branch, for entries of the gallery."""

import math

import numpy as np

from workflow.plugins.gallery.criteria import MeasuredQuantity, at_most
from workflow.plugins.modes import family

COMPUTED = "computed"
"""Name of values that no run but `workflow.plugins.modes` has given."""


def stays(branch: family.PeriodicFamily, *places: int) -> MeasuredQuantity:
    """Largest distance of LAMMPS from stable states after a hundred periods, over the size of the state."""
    later = [branch.by_lammps(place)["later"] for place in places]
    sizes = [float(np.linalg.norm(branch.states[place]["x"])) for place in places]
    shares = [math.nan if end is None else end / size for end, size in zip(later, sizes, strict=True)]
    words = f"distance from the start after {family.PERIODS} periods over the size of the state"
    return MeasuredQuantity(words, {"lammps": float(np.max(shares))}, at_most(0.01), "1e")
