"""List the scenes that come with granchain."""

import argparse

from lammps_inputs import library


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """No arguments."""


def execute(arguments: argparse.Namespace) -> int:  # noqa: ARG001
    """Print a name and a line for each."""
    scenes = {name: library.load(path) for name, path in library.installed().items()}
    width = max(map(len, scenes))
    for name, scene in scenes.items():
        print(f"{name:{width}}  {scene.description}")
    return 0
