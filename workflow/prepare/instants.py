"""Which frames of a run are compared with a reference, where all would be more than it takes."""

import math

from lammps_inputs import Problem
from lammps_inputs.limits import rates

SPACING = 0.4
"""Time between the frames that are compared, in units of T: waves are found between them to 1e-5."""

FEW = 100
"""As many frames are all compared: an error can grow much from one to the next."""


def stride(problem: Problem, spacing: float = SPACING) -> int:
    """Frames from one that is compared to the next, so that the last is among them or nearly; 1 if there are few.

    In a swing of stiff springs four are compared, lest all show the same phase of it; and four in the time in which
    dashpots stop a bead, for the error is largest when they begin to.
    """
    if problem.frames <= FEW:
        return 1
    swing, drag = rates.swing(problem.system), rates.drag(problem.system)
    if swing > 0.0:
        spacing = min(spacing, 0.5 * math.pi / swing)
    if drag > 0.0:
        spacing = min(spacing, 0.25 / drag)
    most = max(1, min(math.floor(spacing / problem.every * (1.0 + 1e-9)), problem.frames))
    return min(range(most, most // 2, -1), key=lambda step: problem.frames % step)
