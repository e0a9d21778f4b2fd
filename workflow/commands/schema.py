"""Print the JSON schema of scenes, sweeps, designs or sites, for completion and checks in editors."""

import argparse

from lammps_inputs import schema
from lammps_inputs.slurm.site import JobOptions
from workflow.runs.files import as_json

EXAMPLES = (
    "schema > scene.schema.json",
    "schema sweep",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Of what."""
    parser.add_argument(
        "of", choices=("scene", "sweep", "design", "site"), nargs="?", default="scene", help="default scene"
    )


def execute(arguments: argparse.Namespace) -> int:
    """Print it."""
    if arguments.of == "scene":
        made = schema.scene()
    elif arguments.of == "site":
        made = schema.of(JobOptions, "site")
    elif arguments.of == "sweep":
        from workflow.sweep import file as sweep  # takes a while to import

        made = sweep.schema_of_file()
    else:
        from workflow.studies.design import file as design  # likewise

        made = design.schema_of_file()
    print(as_json(made))
    return 0
