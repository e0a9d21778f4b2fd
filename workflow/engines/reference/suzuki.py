"""Suzuki's fourth-order composition of five velocity Verlet steps; step for step what LAMMPS does with ``suzuki4``."""

from itertools import pairwise

from lammps_inputs.scheme import weights
from workflow.engines.reference.scheme import Scheme

_STEPS = weights("suzuki4")

SUZUKI4 = Scheme(
    name="suzuki4",
    order=4,
    kicks=(
        0.5 * _STEPS[0],
        *(0.5 * (before + after) for before, after in pairwise(_STEPS)),
        0.5 * _STEPS[-1],
    ),
    drifts=_STEPS,
    source="Suzuki, Phys. Lett. A 146 (1990) 319, eq. 15",
)
