"""Energy that the frames of a run have exchanged with what is outside, and with dashpots, until each of them."""

from analysis.conservation import FrameAccountant
from lammps_inputs import Problem
from workflow.runs.engines import engine_called
from workflow.runs.run_directory import RunDirectory


def accountant(directory: RunDirectory, problem: Problem) -> FrameAccountant:
    """Accountant of frames of a run: the reference follows each frame to the next.

    Args:
        directory: the run.
        problem: of the frames, all of the run or some.

    Returns:
        Accountant that gives these frames their exchanged energy.
    """
    return engine_called("reference").accountant(problem, directory.problem, directory.account)
