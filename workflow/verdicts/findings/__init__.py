"""What some runs tell beside their waves, one kind a file; this is the one place that lists them.

Each file has a function that says for a run directory what to measure, or None where the run has none of it. The rest
of an analysis (`workflow.verdicts.analyse`) and of what `analyze` prints does not know which there are.
"""

from collections.abc import Callable

from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.findings import (
    cells,
    contacts,
    dispersion,
    energy,
    far_end,
    forces,
    sound,
    spectra,
    window,
)
from workflow.verdicts.findings.finding import Measure

MEASURES: tuple[Callable[[RunDirectory], Measure | None], ...] = (
    energy.measure,
    sound.measure,
    dispersion.measure,
    cells.measure,
    forces.measure,
    spectra.measure,
    far_end.measure,
    window.measure,
    contacts.measure,
)
"""In the order in which they are told."""
