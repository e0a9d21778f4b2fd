"""Types of measurements that installed distributions declare (`plugins`)."""

from lammps_inputs import plugins
from workflow.measures.measurement import Measurement

MEASUREMENTS: tuple[type[Measurement], ...] = tuple(plugins.loaded("quantities").values())
"""Types of measurements, in the order in which `analyze` prints them."""
