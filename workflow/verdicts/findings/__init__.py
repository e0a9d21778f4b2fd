"""What some runs show beside their waves, one kind a file; this is the one place that lists them.

Each class says for a run directory what to measure, and declares its quantities, table and figures. The rest of an
analysis (`workflow.verdicts.analyse`) and of what `analyze` prints does not know which there are.
"""

from workflow.verdicts.findings.budget import Budget
from workflow.verdicts.findings.cells import Cells
from workflow.verdicts.findings.contacts import Contacts
from workflow.verdicts.findings.dispersion import Dispersion
from workflow.verdicts.findings.energy import Energy
from workflow.verdicts.findings.far_end import FarEnd
from workflow.verdicts.findings.finding import Finding
from workflow.verdicts.findings.forces import Forces
from workflow.verdicts.findings.sound import Sound
from workflow.verdicts.findings.spectra import Spectra
from workflow.verdicts.findings.window import Window

FINDINGS: tuple[type[Finding], ...] = (
    Energy,
    Sound,
    Dispersion,
    Cells,
    Forces,
    Spectra,
    FarEnd,
    Window,
    Contacts,
    Budget,
)
"""In the order in which they are printed."""
