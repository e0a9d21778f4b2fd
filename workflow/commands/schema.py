"""Print the JSON schema of scenes, sweeps or sites, which editors use for completion and checking."""

import argparse

from lammps_inputs import schema
from lammps_inputs.slurm.site import JobOptions
from workflow.runs.whole_files import as_json

EXAMPLES = (
    "schema > scene.schema.json",
    "schema sweep",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Of what."""
    parser.add_argument("of", choices=("scene", "sweep", "site"), nargs="?", default="scene", help="default scene")


def execute(arguments: argparse.Namespace) -> int:
    """Print it."""
    if arguments.of == "scene":
        made = schema.scene()
    elif arguments.of == "site":
        made = schema.of(JobOptions, "site")
    else:
        from workflow.sweep import file  # takes a while to import

        made = file.schema_of_file()
    print(as_json(made))
    return 0
