"""Measurements that only some runs have, one kind a class: those that installed distributions declare (`plugins`).

Each class says for a run what to measure in its frames, and declares its quantities, table and figures. The rest of an
analysis (`workflow.verdicts.analyse`) and of what `analyze` prints does not know which there are.
"""

from lammps_inputs import plugins
from workflow.measures.base import Measurement

MEASUREMENTS: tuple[type[Measurement], ...] = tuple(plugins.loaded("quantities").values())
"""Types of measurements, in the order in which `analyze` prints them."""
