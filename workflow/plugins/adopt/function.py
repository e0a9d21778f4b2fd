"""Scene of a user's own LAMMPS deck, for scripts and notebooks."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from granchain import InputError
from granchain.parts import Between, checked
from workflow.plugins.adopt.adopt import Adopted
from workflow.plugins.adopt.adopt import adopt as read_deck
from workflow.plugins.adopt.tool import LIMIT, refuse_output, write_scene


@checked
def adopt(
    deck: Path | str,
    output: Path | str | None = None,
    *,
    data: Path | str | None = None,
    var: Mapping[str, Any] | None = None,
    limit: Annotated[float, Between(0.0, above=True)] = LIMIT,
) -> Adopted:
    """Read a LAMMPS deck of one-dimensional chains of spheres into a scene, and run both side by side.

    Args:
        deck: the deck; nothing is written beside it.
        output: file of the scene, which must not exist; not written if it is omitted.
        data: its data file, if that is elsewhere.
        var: variables of LAMMPS and their values, as of ``lmp -var``.
        limit: time that LAMMPS may take, in s.

    Returns:
        The scene, notes on it, and the largest difference of velocities of the two decks in units of V.

    Raises:
        InputError: a command is none of a scene, LAMMPS does not execute the deck, or the file exists.
        RunError: the scene moves otherwise than the deck.

    Examples:
        >>> made = granchain.deck("one-chain", "to-adopt")
        >>> adopted = granchain.adopt(made)
        >>> adopted.scene.beads == granchain.load("one-chain").beads, adopted.difference < 1e-4
        (True, True)
    """
    file = None if output is None else Path(output)
    if file is not None:
        refuse_output(file)
    if not Path(deck).is_file():
        raise InputError(f"deck: {deck}: no such file")
    variables = [(name, str(value)) for name, value in (var or {}).items()]
    adopted = read_deck(Path(deck), None if data is None else Path(data), variables, limit)
    if file is not None:
        write_scene(file, Path(deck), adopted.scene)
    return adopted
