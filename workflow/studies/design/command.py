"""Find the scene that minimises or maximises a quantity within bounds, such as the force on a wall."""

import argparse
from pathlib import Path
from typing import Any

from lammps_inputs import InputError, file_names
from workflow.cluster.job_arguments import add_job_arguments, job_options
from workflow.engines.lammps.mpi import cores
from workflow.screen import Answer, count_bar, one_line, print_table
from workflow.studies.design import file, study
from workflow.studies.design.found import Found, Verified
from workflow.sweep.command_job import submit_hint, write_job

ANSWERS = "what design.json holds"
EXAMPLES = (
    "design design.yaml -o designed          # the same command resumes; workflow/README.md has such a file",
    "design design.yaml -o designed --slurm --jobs 64   # then there: sbatch job.sbatch",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The design, where to, and how."""
    parser.add_argument("design", metavar="DESIGN.yaml", type=Path, help="a scene, bounds of its fields, an objective")
    parser.add_argument(
        "-o", "--output", metavar="DIR", type=Path, required=True, help="new directory, or one to resume"
    )
    parser.add_argument(
        "--jobs", metavar="N", type=int, help="designs at a time (default all cores; of a job cores_per_node, or 1)"
    )
    add_job_arguments(parser)


def execute(arguments: argparse.Namespace) -> Answer:
    """Search, verify, print the best; exit code 130 when interrupted, with all that was computed kept."""
    if arguments.jobs is not None and not 1 <= arguments.jobs <= 1024:
        raise InputError(f"--jobs: {arguments.jobs} given; 1 to 1024")
    options = job_options(arguments)
    what = file.load(arguments.design)
    if options is not None:
        count = arguments.jobs or options.cores_per_node or 1
        words = ["design", str(arguments.design.absolute()), "-o", ".", "--jobs", str(count)]
        write_job(arguments.output, options, words, cores=count)
        print(submit_hint(arguments.output))
        return Answer(0, {"job": str(arguments.output / file_names.JOB)})
    try:
        with count_bar("design") as progress:
            found = study.carry_out(what, arguments.output, processes=arguments.jobs or cores(), progress=progress)
    except KeyboardInterrupt:
        print("interrupted: computed designs remain; the same command resumes")
        return Answer(130, {})
    _print(found, arguments)
    return Answer(0, found.plain())


def _print(found: Found, arguments: argparse.Namespace) -> None:
    design = found.design
    rows = [_row(str(place), one, design) for place, one in enumerate(found.verified, 1)]
    if found.beside is not None:
        rows.append(_row("beside", found.beside, design))
    fields = [design.heading(variable.field) for variable in design.variables]
    objective, also = design.heading(design.objective), map(design.heading, design.also)
    how = "all there are" if design.exhaustive else "by evolution"
    print_table(
        f"{one_line(arguments.design)}: {len(found.records)} designs, {how}",
        ["", *fields, objective, "LAMMPS / reference - 1", "error / V", *also],
        rows,
    )
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


def _row(place: str, one: Verified, design: file.Design) -> list[str]:
    difference = one.difference(design.objective)
    return [
        place,
        *(_cell(one.values.get(variable.field)) for variable in design.variables),
        _cell(one.reference[design.objective]),
        "-" if difference is None else f"{difference:.1e}",
        f"{one.error:.1e}",
        *(_cell(one.reference[name]) for name in design.also),
    ]


def _cell(value: Any) -> str:
    if value is None:
        return "-"
    if isinstance(value, list):
        return " ".join(_cell(one) for one in value)
    return one_line(value) if isinstance(value, str | dict) else f"{value:.5g}"
