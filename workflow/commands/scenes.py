"""List the scenes that come with granchain."""

import argparse

from lammps_inputs import library
from workflow.screen import Answer

ANSWERS = "name -> description"
EXAMPLES = (
    "scenes",
    "scenes --json",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """No arguments."""


def execute(arguments: argparse.Namespace) -> Answer:  # noqa: ARG001
    """Print a name and a line for each."""
    scenes = {name: library.load(path) for name, path in library.installed().items()}
    width = max(map(len, scenes))
    for name, scene in scenes.items():
        print(f"{name:{width}}  {scene.description}")
    return Answer(0, {name: scene.description for name, scene in scenes.items()})
