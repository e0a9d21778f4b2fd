"""Run a scene with LAMMPS."""

import argparse
from pathlib import Path

from lammps_inputs import library
from workflow import run as running
from workflow.ending import with_duration
from workflow.screen import progress_bar


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The scene, where to, and how."""
    parser.add_argument("scene", metavar="SCENE", help="a YAML file, or the name of an installed scene")
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, required=True, help="run directory to make")
    parser.add_argument("--ranks", metavar="N", type=int, default=1, help="MPI ranks (default 1)")
    parser.add_argument("--overwrite", action="store_true", help="replace an earlier run's files in DIR")


def execute(arguments: argparse.Namespace) -> int:
    """Run, with a progress bar on a terminal; exit code 1 when interrupted."""
    scene = with_duration(library.find(arguments.scene))
    with progress_bar(scene.name, scene.problem()) as progress:
        result = running.run(
            scene, arguments.output, ranks=arguments.ranks, overwrite=arguments.overwrite, progress=progress
        )
    record = result.directory.record
    if result.outcome == "interrupted":
        print(f"{arguments.output}: interrupted at step {record['steps_done']} of {record['steps']}; frames are kept")
        return 1
    print(
        f"{arguments.output}: {record['steps']} steps in {record['lammps_seconds']:.2f} s "
        f"(LAMMPS {record['lammps']}, {arguments.ranks} rank{'s' * (arguments.ranks > 1)})"
    )
    return 0
