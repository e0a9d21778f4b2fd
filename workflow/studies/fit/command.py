"""Estimate fields of a scene from measured forces or velocities, with confidence intervals."""

import argparse
from pathlib import Path

from lammps_inputs import library, shipped
from workflow.cluster.job_arguments import add_job_arguments, job_options
from workflow.formats import figure_files
from workflow.screen import Answer, one_line, print_table
from workflow.studies.fit import study
from workflow.studies.fit.found import Fit
from workflow.studies.options import add_output
from workflow.sweep.command_job import as_job

ANSWERS = "what fit.json holds"
DRAWS = True
EXAMPLES = (
    "fit scene.yaml --against data.csv --free coupling.stiffness,kick.velocity -o fitted",
    "fit scene.yaml --against data.csv --free material.youngs_modulus --offset 0 -o fitted   # times as the scene's",
    "fit scene.yaml --against data.csv --free coupling.stiffness -o fitted --slurm   # then there: sbatch job.sbatch",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The scene, the data, what is free."""
    parser.add_argument("scene", metavar="SCENE", help="its fields are where the search starts")
    parser.add_argument(
        "--against",
        metavar="FILE",
        type=Path,
        required=True,
        help="table of traces in the scene's units: time, force_wall_right, force_contact_10, force_sensor_20, "
        "velocity_1_55 (chain, bead)",
    )
    parser.add_argument(
        "--free", metavar="FIELD,...", required=True, help="fields to find, such as coupling.stiffness,kick.velocity"
    )
    parser.add_argument(
        "--offset",
        metavar="TIME",
        type=float,
        help="by how much times of FILE are later than the scene's (default: found, too)",
    )
    add_output(parser)
    parser.add_argument("--no-lammps", action="store_true", help="do not run the fitted scene in LAMMPS")
    add_job_arguments(parser)


def execute(arguments: argparse.Namespace) -> Answer:
    """Print what was found; exit code 1 when the search did not converge or the test of fit rejects the model."""
    options = job_options(arguments)
    if options is not None:
        return as_job(options, arguments.output, _words(arguments), cores=1, jobs=1)
    found = study.fit(
        library.find(arguments.scene).plain(),
        arguments.against,
        [name.strip() for name in arguments.free.split(",") if name.strip()],
        arguments.output,
        source=arguments.scene,
        offset=arguments.offset,
        lammps=not arguments.no_lammps,
    )
    _print(found, arguments)
    return Answer(0 if found.converged and found.fits is not False else 1, found.plain())


def _words(arguments: argparse.Namespace) -> list[str]:
    """The command as a job runs it."""
    scene = arguments.scene
    path = scene if scene in shipped.installed() else str(Path(scene).absolute())
    library.find(scene)
    words = ["fit", path, "--against", str(arguments.against.absolute()), "--free", arguments.free, "-o", "."]
    words += [] if arguments.offset is None else [f"--offset={arguments.offset!r}"]
    words += ["--formats", ",".join(arguments.formats)]
    return [*words, *(["--no-lammps"] if arguments.no_lammps else [])]


def _print(found: Fit, arguments: argparse.Namespace) -> None:
    print(found.verdict)
    for note in found.notes():
        print(note)
    for title, head, rows in found.tables():
        fitted = f"{one_line(arguments.scene)} fitted to {one_line(arguments.against)}: {found.rows} values"
        print_table(fitted if title == "fields" else title, head, rows)
    lammps = found.lammps
    if lammps.difference is not None:
        error = "" if lammps.error_velocity is None else f"error of velocities {lammps.error_velocity:.1e} V; "
        print(f"in LAMMPS: {error}traces differ from the fitted ones by {lammps.difference:.2g} sigma at most")
    files = (study.FITTED, study.REPORT, *figure_files(study.FIGURE))
    print(f"{one_line(arguments.output)}: {', '.join(files)}")
