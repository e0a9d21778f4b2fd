"""Find the scene that minimises or maximises a quantity within bounds, such as the force on a wall."""

import argparse
import functools
from pathlib import Path

from workflow.cluster.job_arguments import add_job_arguments, job_options
from workflow.screen import Answer, one_line, print_table
from workflow.studies.design import file, study
from workflow.studies.design.found import Found
from workflow.studies.options import add_jobs, add_output, on_cores
from workflow.sweep.command_job import as_job

ANSWERS = "what design.json holds"
EXAMPLES = (
    "design design.yaml -o designed          # the same command resumes; workflow/README.md has such a file",
    "design design.yaml -o designed --slurm --jobs 64   # then there: sbatch job.sbatch",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The design, where to, and how."""
    parser.add_argument("design", metavar="DESIGN.yaml", type=Path, help="a scene, bounds of its fields, an objective")
    add_output(parser)
    add_jobs(parser, "designs at a time (default all cores; of a job cores_per_node, or 1)")
    add_job_arguments(parser)


def execute(arguments: argparse.Namespace) -> Answer:
    """Search, verify, print the best; exit code 130 when interrupted, with all that was computed kept."""
    options = job_options(arguments)
    what = file.load(arguments.design)
    if options is not None:
        count = arguments.jobs or options.cores_per_node or 1
        words = ["design", str(arguments.design.absolute()), "-o", ".", "--jobs", str(count)]
        return as_job(options, arguments.output, words, cores=count)
    found = on_cores("design", arguments.jobs, functools.partial(study.carry_out, what, arguments.output))
    if found is None:
        return Answer(130, {})
    _print(found, arguments)
    return Answer(0, found.plain())


def _print(found: Found, arguments: argparse.Namespace) -> None:
    design = found.design
    how = "all there are" if design.exhaustive else "by evolution"
    print_table(f"{one_line(arguments.design)}: {len(found.records)} designs, {how}", *found.table())
    if found.undefined:
        print(
            f"{found.undefined} designs do not count: {design.objective} or a quantity with a limit is undefined there "
            "(for one at the far end: its largest value is not reached within the duration)"
        )
    for warning in found.warnings:
        print(f"warning: {one_line(warning)}")
    print(found.tolerance)
    print(f"{found.seconds * 1e3:.3g} ms of processor time a design")
    print(f"{one_line(arguments.output)}: {study.PAGE}, {study.BEST}, {study.TABLE}")
