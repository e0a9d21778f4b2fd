"""Write the LAMMPS deck of a scene, to run with any lmp."""

import argparse
from pathlib import Path

from lammps_inputs import deck, library
from workflow.ending import with_duration
from workflow.run_directory import prepare, write_text


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The scene and where to."""
    parser.add_argument("scene", metavar="SCENE", help="a YAML file, or the name of an installed scene")
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, required=True, help="directory to make")
    parser.add_argument("--overwrite", action="store_true", help="replace an earlier run's files in DIR")


def execute(arguments: argparse.Namespace) -> int:
    """Write deck, data and scene."""
    files = deck.render(with_duration(library.find(arguments.scene)))
    prepare(arguments.output, overwrite=arguments.overwrite)
    for name, content in files.items():
        write_text(arguments.output / name, content)
    print(f"{arguments.output}: {', '.join(files)}")
    print(f"run it there with: lmp -in {deck.DECK}    then: granchain analyze {arguments.output}")
    return 0
