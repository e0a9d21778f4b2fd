"""A study as a job that runs its command: options of ``granchain design`` and ``granchain fit``.

A study that can be a job has a function ``words(arguments)`` in its module: words of the same command in the study's
own directory, with absolute paths. It is repeated by further jobs where it resumes from a cache (`Study`).
"""

import argparse
import sys
from collections.abc import Callable
from dataclasses import dataclass

from granchain.parts import output_directory, plugins, screen, write_text
from workflow.plugins.jobs import job_files
from workflow.plugins.jobs.job import render_command
from workflow.plugins.jobs.options import add_job_arguments, job_options
from workflow.plugins.jobs.registry import SCRIPTS

Command = Callable[[argparse.Namespace], screen.CommandResult]


@dataclass(frozen=True)
class StudyJob:
    """Options of one study's command."""

    EXAMPLES: tuple[str, ...]

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Add the options of a job."""
        add_job_arguments(parser)

    def execute(self, arguments: argparse.Namespace, command: Command) -> screen.CommandResult:
        """Write the command as a job on one node where one is asked for, and say how to submit it.

        Raises:
            InputError: the directory cannot be written, or holds a file of such a name that is not a study's.
        """
        options = job_options(arguments)
        if options is None:
            return command(arguments)
        study, directory, cores = plugins.load("studies", arguments.command), arguments.output, 1
        if "jobs" in arguments:
            cores = arguments.jobs = arguments.jobs or options.cores_per_node or 1
        # -P: Python imports no modules from the working directory
        words = [sys.executable, "-P", "-m", "workflow", *study.words(arguments)]
        jobs = None if study.STUDY.cache else 1
        name = f"granchain-{arguments.command}"
        text = render_command(options, name, words, cores=cores, jobs=jobs, directory=directory)
        scheduler = options.of_scheduler
        output_directory.make_directory(directory)
        output_directory.record_files(directory, (scheduler.script, job_files.OUTPUT), outdated=SCRIPTS)
        write_text(directory / scheduler.script, text)
        print(f"`{scheduler.by_hand}` in {directory} submits the job; {job_files.OUTPUT} holds its output")
        return screen.CommandResult(0, {"job": str(directory / scheduler.script)})


DESIGN = StudyJob(("design design.yaml -o designed --slurm --jobs 64   # then there: sbatch job.sbatch",))
FIT = StudyJob(
    ("fit scene.yaml --against data.csv --free coupling.stiffness -o fitted --slurm   # then there: sbatch job.sbatch",)
)
