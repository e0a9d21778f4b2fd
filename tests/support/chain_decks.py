"""Decks of LAMMPS as their users write them, of one chain of equal beads."""

from collections.abc import Sequence
from pathlib import Path

DECK = """
units {units}
atom_style sphere
boundary f f f
newton off
comm_modify vel yes
region box block {box}
create_box 1 box
{atoms}
set group all diameter {diameter} density {density}
pair_style {pair}
pair_coeff * * {coefficients}
{lines}
"""

USUAL = {
    **{"units": "lj", "box": "-5 40 -2 2 -2 2", "diameter": "1", "density": "1.9098593171"},
    **{"pair": "gran/hertz/history 2000 0 0 0 0 0", "coefficients": ""},
}
"""Beads of mass 1."""


def chain_deck(path: Path, places: Sequence[float], lines: str, axis: str = "x", **changes: object) -> Path:
    """Write a deck of beads at places along an axis, atom after atom, whose last lines move and run them."""
    at = (" ".join(f"{place:.17g}" if letter == axis else "0" for letter in "xyz") for place in places)
    atoms = "\n".join(f"create_atoms 1 single {place}" for place in at)
    path.write_text(DECK.format(**{**USUAL, **changes}, atoms=atoms, lines=lines))
    return path
