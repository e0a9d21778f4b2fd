"""Write the scene of your own LAMMPS deck, and run both side by side."""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

from granchain import InputError, Scene
from granchain.parts import screen, strict_yaml, write_text
from workflow.plugins.adopt.adopt import RefusedDeckError, adopt

LIMIT = 120.0
"""Seconds that LAMMPS may take by default."""

EXAMPLES = (
    "adopt in.chain -o chain.yaml                # then: granchain run chain.yaml -o out",
    "adopt in.chain --var kn 1e5 -o chain.yaml   # as lmp -in in.chain -var kn 1e5",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the deck, the scene to write, and the options of LAMMPS."""
    parser.add_argument("deck", metavar="IN.FILE", type=Path, help="a LAMMPS deck of one-dimensional chains of spheres")
    parser.add_argument("data", metavar="DATA", type=Path, nargs="?", help="its data file, if that is elsewhere")
    parser.add_argument(
        "-o", "--output", metavar="FILE.yaml", type=Path, required=True, help="the scene to write; must not exist"
    )
    parser.add_argument(
        "--var", metavar=("NAME", "VALUE"), nargs=2, action="append", default=[], help="a variable, as of `lmp -var`"
    )
    parser.add_argument(
        "--limit", metavar="SECONDS", type=float, default=LIMIT, help=f"time that LAMMPS may take (default {LIMIT:g})"
    )


def refuse_output(file: Path) -> None:
    """See that a scene can be written to a file.

    Raises:
        InputError: it is no name of a scene, exists, or its directory does not.
    """
    if file.suffix not in (".yaml", ".yml"):
        raise InputError(f"-o: {file}: scenes are files that end in .yaml")
    if file.exists() or file.is_symlink():
        raise InputError(f"-o: {file}: exists already; choose another name")
    if not file.parent.is_dir():
        raise InputError(f"-o: {file.parent}: no such directory")


def write_scene(file: Path, deck: Path, scene: Scene) -> None:
    """Write the scene of a deck."""
    head = f"# from the LAMMPS deck {screen.one_line(deck.name)}\n"
    write_text(file, head + strict_yaml.dump(scene.plain()))


MOST_CHAINS = 3
"""Chains whose atoms are printed."""


def _atoms(scene: Scene) -> Iterator[str]:
    """Lines that say which atom of the deck is which bead."""
    deck = scene.adopted
    assert deck is not None
    yield f"chains along {deck.axis[-1]}: {scene.chains} of {scene.beads} beads"
    against = f", against {deck.axis[-1]} (velocities have the other sign)" if deck.sign < 0.0 else ""
    for number, atoms in enumerate(deck.atoms[:MOST_CHAINS], 1):
        yield f"beads 1 to {scene.beads} of chain {number} are the atoms {atoms}{against}"
    if len(deck.atoms) > MOST_CHAINS:
        yield f"atoms of chains {MOST_CHAINS + 1} to {len(deck.atoms)}: key `adopted` of the scene"
    for side, wall in (("left", deck.left_wall), ("right", deck.right_wall)):
        if wall is not None:
            yield f"{side} wall: {wall}"


def execute(arguments: argparse.Namespace) -> int:
    """Write the scene, or print every line that no scene can have."""
    file = arguments.output
    refuse_output(file)
    try:
        adopted = adopt(arguments.deck, arguments.data, list(map(tuple, arguments.var)), arguments.limit)
    except RefusedDeckError as error:
        for line in error.lines:
            print(f"granchain: {line}", file=sys.stderr)
        return 2
    scene = adopted.scene
    screen.print_heading(scene.name, scene.units)
    for line in _atoms(scene):
        print(line)
    for note in adopted.notes:
        print(f"note: {note}")
    part = "" if adopted.steps == adopted.of else f" of {adopted.of}"
    deck = screen.one_line(arguments.deck)
    print(
        f"over {adopted.steps}{part} steps velocities of the scene's deck and of {deck} differ by at most "
        f"{adopted.difference:.1e} V"
    )
    write_scene(file, arguments.deck, scene)
    print(f"{screen.one_line(file)}: a scene; `granchain run {screen.one_line(file)} -o out` runs it")
    return 0
