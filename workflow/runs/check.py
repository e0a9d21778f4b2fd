"""The error of a run, measured when it has ended, by the reference at some of its frames."""

import math
import time
from dataclasses import asdict, dataclass

from analysis.against.difference import Difference, Place
from analysis.against.pairing import paired
from workflow.engines.reference import engine
from workflow.engines.reference.certify import Certificate
from workflow.prepare.instants import SPACING, stride
from workflow.prepare.settings import Settings, certifiers
from workflow.prepare.twin import CADENCE
from workflow.runs.run_directory import RunDirectory


@dataclass(frozen=True)
class Check:
    """What a run's error was found to be, dimensionless.

    Attributes:
        velocity: largest error of any velocity.
        where: at which bead and time.
        arrival: largest error of an arrival of the leading pulse, where `analysis.tracking.peaks.sharp`; NaN where none
            is.
        amplitude: largest error of a peak velocity of the leading pulse; NaN where none was seen.
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


def check(directory: RunDirectory, settings: Settings | None = None) -> Check:
    """Compare a run with the certified reference.

    Args:
        directory: the run.
        settings: the accuracy that was asked for, if one was: the reference is then surer than that by far, and the
            frames are compared as closely spaced as when the time step was chosen.

    Raises:
        InputError: the run has no frames.
    """
    engine.load()  # takes its time once in a process, whatever is checked
    started = time.perf_counter()
    step = stride(directory.problem, SPACING if settings is None else CADENCE)
    for certifier in certifiers(directory.problem.coarser(step), settings):
        difference = Difference(dict.fromkeys(("velocity", "displacement", "amplitude", "arrival"), math.inf))
        for block, reference in paired(directory.blocks(step), certifier.blocks()):
            difference.add(block, reference)
    found = difference.deviations()
    return Check(
        velocity=found["velocity"].largest,
        where=found["velocity"].where,
        arrival=found["arrival"].largest if "arrival" in found else math.nan,
        amplitude=found["amplitude"].largest if "amplitude" in found else math.nan,
        reference=certifier.certificate,
        seconds=time.perf_counter() - started,
    )
