"""A system whose atoms start away from rest: displacements are rounded to what LAMMPS can distinguish at any place.

So both engines start from the same numbers, to the last bit.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import physics
from lammps_inputs.layout import layout_of
from lammps_inputs.numbers import power_of_two_at_least
from lammps_inputs.system import Start, System


def with_start(system: System, entries: NDArray[np.float64]) -> System:
    """System with displacements and velocities at the start; unchanged where all are 0.

    Args:
        system: system at rest, but for kicks and given motions.
        entries: [atom, column] of line and bead, counted from 1, displacement in units of L and velocity in units of V;
            entries of one atom add.

    Raises:
        ValueError: an atom outside the lines.
    """
    line, bead = entries[:, :2].astype(np.int64).T - 1
    if np.any(line >= physics.lines(system)):
        raise ValueError(
            f"initial: chain {np.max(line) + 1} is outside the array (1 to {physics.lines(system)}; lines of atoms "
            "that are no beads count on from the chains)"
        )
    if not np.any(entries[:, 2:]):
        return system
    state = np.zeros((2, physics.lines(system), system.beads))
    for values, column in zip(state, entries[:, 2:].T, strict=True):
        np.add.at(values, (line, bead), column)
    if not np.any(state):
        return system
    return replace(system, start=Start(*state))


def rounded(system: System) -> System:
    """The system with displacements that LAMMPS holds exactly beside its places at rest."""
    if system.start is None:
        return system
    displacement, layout = system.start.displacement, layout_of(system)
    farthest = float(np.max(layout.places)) + float(np.max(np.abs(displacement)))
    grid = float(np.spacing(0.75 * power_of_two_at_least(farthest)))
    return replace(system, start=replace(system.start, displacement=np.round(displacement / grid) * grid))
