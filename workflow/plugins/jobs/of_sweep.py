"""Array of jobs for the cases of a sweep: options of ``granchain sweep``."""

import argparse
from collections.abc import Callable

from granchain.parts import screen
from workflow.plugins.jobs.options import add_job_arguments, job_options

EXAMPLES = ("sweep sweep.yaml -o swept --slurm --time 02:00:00   # then, there: sbatch job.sbatch",)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of a job, and how many cases a task of the array has."""
    group = add_job_arguments(parser)
    group.add_argument(
        "--cases-per-task", metavar="N", type=int, help="cases of a task of the array, one after the other (default 1)"
    )


def execute(
    arguments: argparse.Namespace, command: Callable[[argparse.Namespace], screen.CommandResult]
) -> screen.CommandResult:
    """Write decks and the array where a job is asked for, in place of running the cases here."""
    options = job_options(arguments)
    if options is None:
        return command(arguments)
    from workflow.plugins.jobs.array import write_array  # takes half a second to import

    output = arguments.output
    written = write_array(arguments, options)
    under_way = f", {written.under_way} in the queue or running" if written.under_way else ""
    print(f"{output}: {written.tasks} of {written.cases} cases to do{under_way}")
    if written.tasks:
        ranks, scheduler = f"{written.ranks} rank{'s' * (written.ranks > 1)}", options.of_scheduler
        print(f"`{scheduler.by_hand}` there submits one array, each case on {ranks}")
        if written.numbers > scheduler.max_tasks:
            print(
                f"numbers of its tasks go to {written.numbers - 1}; {scheduler.title}'s {scheduler.max_tasks_setting} "
                f"is often {scheduler.max_tasks}"
            )
    print(f"`granchain status {output}` shows the state, `granchain collect {output}` makes the table")
    return screen.CommandResult(0, {"cases": written.cases, "to_do": written.tasks, "under_way": written.under_way})
