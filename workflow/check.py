"""The error of a run, measured when it has ended, by the reference at some of its frames."""

import math
import time
from dataclasses import asdict, dataclass

from analysis.comparison import Comparison, Place
from analysis.pairing import paired
from lammps_inputs import Problem
from workflow.engines.reference import engine
from workflow.engines.reference.certify import Certificate, Certifier
from workflow.run_directory import RunDirectory

SPACING = 0.4
"""Time between the frames that are compared, in units of T: waves are found between them to 1e-5."""


@dataclass(frozen=True)
class Check:
    """What a run's error was found to be, dimensionless.

    Attributes:
        velocity: largest error of any velocity.
        where: at which bead and time.
        arrival: largest error of an arrival of the leading pulse, where `analysis.comparison.sharp`.
        amplitude: largest error of a peak velocity of the leading pulse.
        reference: how sure the reference is of itself.
        seconds: what the check cost.
    """

    velocity: float
    where: Place | None
    arrival: float
    amplitude: float
    reference: Certificate
    seconds: float

    def plain(self) -> dict[str, object]:
        """For ``run.json``."""
        return asdict(self)


def stride(problem: Problem) -> int:
    """Frames from one that is compared to the next."""
    return max(1, min(math.floor(SPACING / problem.every * (1.0 + 1e-9)), problem.frames))


def check(directory: RunDirectory) -> Check:
    """Compare a run with the certified reference.

    Raises:
        InputError: the run has no frames.
    """
    engine.load()  # takes its time once in a process, whatever is checked
    started = time.perf_counter()
    step = stride(directory.problem)
    certifier = Certifier(directory.problem.coarser(step))
    comparison = Comparison(dict.fromkeys(("velocity", "displacement", "amplitude", "arrival"), math.inf))
    for block, reference in paired(directory.blocks(step), certifier.blocks()):
        comparison.add(block, reference)
    found = comparison.deviations()
    return Check(
        velocity=found["velocity"].largest,
        where=found["velocity"].where,
        arrival=found["arrival"].largest,
        amplitude=found["amplitude"].largest,
        reference=certifier.certificate,
        seconds=time.perf_counter() - started,
    )
