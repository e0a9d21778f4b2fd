"""Atoms of the LAMMPS deck from which a scene was adopted: which atom is which bead, and along which axis it moves."""

import re
from typing import Annotated, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator

from lammps_inputs import strict_yaml
from lammps_inputs.ingredients.base import Positive, ScenePart
from lammps_inputs.units import Label, Unit

_PIECE = re.compile(r"(\d{1,10})(?:-(\d{1,10})(?::(\d{1,10}))?)?")

Text = Annotated[str, Field(max_length=200, pattern=r"^[^\x00-\x1f\x7f-\x9f\u2028\u2029]*$")]


class DeckAtoms(ScenePart):
    """Atoms of the deck that `granchain adopt` read, by which dumps of that deck are compared with a run."""

    example: ClassVar[str] = "{deck: in.column, axis: -z, atoms: ['20-2'], timestep: 1.0e-07}"

    deck: Text
    """Name of the deck."""
    axis: Literal["x", "y", "z", "-x", "-y", "-z"]
    """Axis of the deck along which bead numbers grow, with a minus where they grow against it."""
    atoms: tuple[str, ...]
    """Atom of each bead, a text for each chain: `2-29`, `29-2`, every third `1-58:3`, or several with commas."""
    timestep: Annotated[Positive, Unit("s"), Label("time step of the adopted deck")]
    """Time step of the deck."""
    first_step: Annotated[int, Field(ge=0), Label("first step of the adopted deck")] = 0
    """Step at which the deck's first run begins."""
    left_wall: Text | None = None
    """What the left wall is in the deck."""
    right_wall: Text | None = None
    """What the right wall is in the deck."""

    _from_list = field_validator("atoms", mode="before")(strict_yaml.as_tuple)

    def refuse(self, chains: int, beads: int) -> None:
        """Refuse atoms that are not those of the scene's beads.

        Raises:
            ValueError: naming the key.
        """
        if len(self.atoms) != chains:
            raise ValueError(f"adopted.atoms: has {len(self.atoms)} entries; one for each of {chains} chains")
        for number, text in enumerate(self.atoms, 1):
            count = sum(len(piece) for piece in _pieces(text))
            if count != beads:
                raise ValueError(f"adopted.atoms: chain {number} has {count} atoms, not {beads}; such as '1-{beads}'")

    @property
    def numbers(self) -> NDArray[np.int64]:
        """Number of the atom of each bead, [chain, bead]."""
        return np.array([[atom for piece in _pieces(text) for atom in piece] for text in self.atoms], dtype=np.int64)

    @property
    def sign(self) -> float:
        """1 where bead numbers grow along the axis, -1 where against it."""
        return -1.0 if self.axis.startswith("-") else 1.0


def _pieces(text: str) -> list[range]:
    """Ranges of atoms that a text names.

    Raises:
        ValueError: it is no such text.
    """
    ranges = []
    for part in text.split(","):
        match = _PIECE.fullmatch(part.strip())
        if match is None:
            raise ValueError(
                f"adopted.atoms: {part.strip()!r} is no number or range of atoms; such as '2-29' or '58-1:3'"
            )
        first, last, step = (None if number is None else int(number) for number in match.groups())
        assert first is not None
        last, step = first if last is None else last, max(1, step or 1)
        ranges.append(range(first, last + 1, step) if last >= first else range(first, last - 1, -step))
    return ranges
