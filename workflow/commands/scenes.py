"""List the installed scenes."""

import argparse

from lammps_inputs import installed_scenes
from workflow.screen import CommandResult

PRINTS = True
ANSWERS = "name -> description"
EXAMPLES = (
    "scenes",
    "scenes --json",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add nothing: the command has no arguments."""


def execute(arguments: argparse.Namespace) -> CommandResult:  # noqa: ARG001
    """Print the name and a line of description of each scene."""
    scenes = installed_scenes.descriptions()
    width = max(map(len, scenes))
    for name, description in scenes.items():
        print(f"{name:{width}}  {description}")
    return CommandResult(0, scenes)
