"""Arrays side by side, whose entries at one place belong to one passage, wave or pulse."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from analysis.trajectory import Flags, Integers


@dataclass(frozen=True)
class Columns:
    """Base of dataclasses whose arrays have their entries along the last axis; other fields hold for all entries."""

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Name -> array, [..., entry].

        Returns:
            The arrays.

        Examples:
            >>> list(granchain.analyze("out").waves.arrays())[:2]
            ['chain', 'bead']
        """
        return {name: value for name, value in vars(self).items() if isinstance(value, np.ndarray)}

    def __len__(self) -> int:
        return int(next(value.shape[-1] for value in vars(self).values() if isinstance(value, np.ndarray)))

    def where(self, chosen: Flags | Integers | slice | list[int]) -> Self:
        """The entries that a mask [entry], positions or a slice choose.

        Args:
            chosen: mask, positions or slice.

        Returns:
            The chosen entries.

        Examples:
            >>> waves = granchain.analyze("out").waves
            >>> waves.where(waves.bead > 118).bead
            array([119, 120, 119, 120])
        """
        return replace(self, **{name: column[..., chosen] for name, column in self.arrays().items()})


Kind = TypeVar("Kind", bound=Columns)


def together(parts: Sequence[Kind]) -> Kind:
    """The entries of all parts, one part after the other."""
    names = parts[0].arrays()
    return replace(parts[0], **{n: np.concatenate([getattr(part, n) for part in parts], axis=-1) for n in names})
