"""Job of a deck: options of ``granchain deck``."""

import argparse
from collections.abc import Callable

from granchain import Scene
from granchain.parts import screen, write
from workflow.plugins.jobs.job import render_job
from workflow.plugins.jobs.options import add_job_arguments, job_options
from workflow.plugins.jobs.ranks import sentence, too_many, with_ranks
from workflow.plugins.jobs.registry import JOB_FILES

EXAMPLES = (
    "deck my/scene.yaml -o job --slurm --nodes 2 --time 12:00:00   # then, there: sbatch job.sbatch",
    "deck my/scene.yaml -o job --scheduler pbs --partition long   # then, there: qsub job.pbs",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of a job."""
    add_job_arguments(parser)


def execute(arguments: argparse.Namespace, command: Callable[[argparse.Namespace], int]) -> int:
    """Write a job beside the deck where one is asked for."""
    options = job_options(arguments)
    if options is None:
        return command(arguments)

    def job_files(scene: Scene) -> dict[str, str | None]:
        problem = scene.problem()
        return {**dict.fromkeys(JOB_FILES), **render_job(with_ranks(options, problem), problem, arguments.output)}

    written = write(arguments, job_files)
    problem = written.scene.problem()
    ranks = with_ranks(options, problem).ranks
    print(sentence(problem, ranks))
    slower = too_many(problem, ranks)
    if slower:
        print(slower)
    screen.print_files(arguments.output, written.files)
    directory = screen.one_line(arguments.output)
    print(f"`{options.of_scheduler.by_hand}` there submits the job; `granchain status {directory}` shows its state")
    return 0
