"""Write the LAMMPS deck of a scene, for any lmp, and a job for it."""

import argparse
from pathlib import Path

from lammps_inputs import file_names, library
from workflow.runs import contacts
from workflow.runs.deck_directory import FurtherFiles, WrittenDeck, write_deck
from workflow.runs.engines import engine_called
from workflow.runs.size import size_of, too_large
from workflow.screen import one_line, print_files, print_heading

EXAMPLES = ("deck two-chains -o deck                                  # then, there: lmp -in in.chains",)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the scene and the directory."""
    parser.add_argument("scene", metavar="SCENE", help="a YAML file, or the name of an installed scene")
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, required=True, help="directory to make")
    parser.add_argument("--overwrite", action="store_true", help="replace an earlier run's files in DIR")
    parser.add_argument("--force", action="store_true", help="even with a time step above the stability bound")


def execute(arguments: argparse.Namespace) -> int:
    """Write deck, data and scene."""
    written = write(arguments)
    print(f"a run on one core has {size_of(written.scene.problem(), engine_called('lammps')).sentence()}")
    print_files(arguments.output, written.files)
    directory = one_line(arguments.output)
    print(f"`lmp -in {file_names.DECK}` there runs the deck; then `granchain analyze {directory}` analyses it")
    return 0


def write(arguments: argparse.Namespace, further: FurtherFiles | None = None) -> WrittenDeck:
    """Write a deck, and files beside it, and print what is known of the run before it starts.

    Args:
        arguments: arguments of the command (`add_arguments`).
        further: gives files beside the deck; see `workflow.runs.deck_directory.write_deck`.

    Returns:
        The scene with its time step, and the names of the files.

    Raises:
        InputError: the scene or the directory cannot be used, or LAMMPS cannot compute the scene.

    Examples:
        >>> import argparse
        >>> scene = "{name: short, beads: 20, kick: {velocity: 1.0}, duration: 30.0, timestep: 0.01}"
        >>> _ = (tmp / "short.yaml").write_text(scene)
        >>> arguments = {"scene": str(tmp / "short.yaml"), "output": tmp / "deck", "overwrite": False, "force": False}
        >>> write(argparse.Namespace(**arguments)).files
        short in reduced units: V = 1 (kick velocity), T = 1, L = 1
        ('scene.yaml', 'in.chains', 'data.chains')
    """
    written = write_deck(
        library.find(arguments.scene),
        arguments.output,
        source=arguments.scene,
        overwrite=arguments.overwrite,
        force=arguments.force,
        further=further,
    )
    scene = written.scene
    print_heading(scene.name, scene.units)
    size = size_of(scene.problem(), engine_called("lammps"))
    for why in filter(None, [*scene.unlikely, too_large(scene, size)]):
        print(f"warning: {why}")
    if written.step is not None:
        print(written.step.sentence(scene.problem()))
    overlaps = contacts.at_most(scene)
    if overlaps is not None:
        print("\n".join(overlaps.lines()))
    return written
