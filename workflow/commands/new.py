"""Write a commented scene to start from."""

import argparse
from pathlib import Path

from lammps_inputs import InputError, library
from workflow.runs.files import write_text
from workflow.screen import one_line

EXAMPLES = (
    "new my.yaml               # then: granchain run my.yaml -o out",
    "new my.yaml --from dimer",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the file to write and the scene to copy."""
    parser.add_argument("file", metavar="FILE.yaml", type=Path, help="the scene to write; must not exist")
    parser.add_argument("--from", dest="source", metavar="SCENE", help="an installed scene to copy, with its comments")


def execute(arguments: argparse.Namespace) -> int:
    """Write the scene to a file that does not exist yet."""
    file = arguments.file
    if file.suffix not in (".yaml", ".yml"):
        raise InputError(f"new: {file}: scenes are files that end in .yaml")
    if file.exists() or file.is_symlink():
        raise InputError(f"new: {file}: exists already; choose another name")
    if not file.parent.is_dir():
        raise InputError(f"new: {file.parent}: no such directory")
    write_text(file, library.to_start_from(arguments.source))
    print(f"{one_line(file)}: a scene; try `granchain show {one_line(file)}`, `granchain help scene`")
    return 0
