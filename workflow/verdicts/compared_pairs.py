"""Frames of a run beside those that it is compared with, of another run or of the reference."""

from collections.abc import Iterator

from analysis.compare.common_times import paired
from analysis.trajectory import Trajectory
from workflow.engines.reference import engine
from workflow.engines.reference.step_halving import compared_rows
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.validate import Validation
from workflow.verdicts.validate_run import recorded_by_both, where_both_hold


def compared_pairs(runs: tuple[RunDirectory, ...], comparison: Validation) -> Iterator[tuple[Trajectory, Trajectory]]:
    """Blocks of a run, and of what it was compared with, at the beads and times that were compared.

    Args:
        runs: the run, and the other one where it was not compared with the reference.
        comparison: their comparison.
    """
    directory, *others = runs
    for other in others:
        return (where_both_hold(*pair) for pair in recorded_by_both((directory, other)).pairs((directory, other)))
    steps = None if comparison.uncertainty is None else comparison.uncertainty.steps_per_frame
    problem = directory.problem
    reference = engine.blocks(problem, steps_per_frame=steps, window=compared_rows(problem))
    return paired(directory.blocks_so_far(), reference)
