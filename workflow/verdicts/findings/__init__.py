"""What some runs show beside their waves, one kind a class: those that installed distributions declare (`plugins`).

Each class says for a run directory what to measure, and declares its quantities, table and figures. The rest of an
analysis (`workflow.verdicts.analyse`) and of what `analyze` prints does not know which there are.
"""

from lammps_inputs import plugins
from workflow.verdicts.findings.finding import Finding

FINDINGS: tuple[type[Finding], ...] = tuple(plugins.loaded("quantities").values())
"""In the order in which they are printed."""
