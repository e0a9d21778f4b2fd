"""What some runs show beside their waves, one kind a file; this is the one place that lists them.

Each class says for a run directory what to measure, and declares its quantities, table and figures. The rest of an
analysis (`workflow.verdicts.analyse`) and of what `analyze` prints does not know which there are.
"""

from workflow.verdicts.findings.energy import Budget, Cells, Energy, Window
from workflow.verdicts.findings.finding import Finding
from workflow.verdicts.findings.gauges import Contacts, FarEnd, Forces, PlasticContacts, Spectra
from workflow.verdicts.findings.sound import Dispersion, Sound

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
    PlasticContacts,
    Budget,
)
"""In the order in which they are printed."""
