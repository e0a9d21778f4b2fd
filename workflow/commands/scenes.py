"""List the installed scenes."""

import argparse

from lammps_inputs import installed_scenes
from workflow.screen import CommandResult

ANSWERS = "name -> description"
EXAMPLES = (
    "scenes",
    "scenes --json",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """No arguments."""


def execute(arguments: argparse.Namespace) -> CommandResult:  # noqa: ARG001
    """Print a name and a line for each."""
    scenes = installed_scenes.descriptions()
    width = max(map(len, scenes))
    for name, description in scenes.items():
        print(f"{name:{width}}  {description}")
    return CommandResult(0, scenes)
