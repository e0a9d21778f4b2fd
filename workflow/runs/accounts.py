"""The energy that the frames of a run have exchanged with what is outside, and with dashpots."""

from lammps_inputs import Problem
from workflow.engines.reference import engine
from workflow.engines.reference.accountant import Accountant
from workflow.engines.reference.certify import MOST_HALVINGS
from workflow.runs.engines import ENGINES
from workflow.runs.run_directory import RunDirectory


def accountant(directory: RunDirectory, problem: Problem) -> Accountant:
    """Of the frames of a run, or of its snapshots, with the steps that the run itself took if it is the reference's.

    Args:
        directory: the run.
        problem: of the frames.
    """
    if ENGINES[directory.engine].own_step:
        return Accountant(problem)
    steps = (directory.record.get("certificate") or {}).get("steps_per_frame")
    most = 2**MOST_HALVINGS * engine.default_steps_per_frame(problem)
    return Accountant(problem, None if steps is None else min(steps, most))
