"""Lines of a deck that say what a law on a link is to LAMMPS, sorted by the place where LAMMPS wants them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Lines:
    """What one law adds to a deck, also to its continuation; nothing by default.

    Attributes:
        variables: numbers at the top, which ``-var`` changes.
        interactions: of atoms with each other, a section of their own.
        motion: fixes that act beside the integration, once the beads are read and at rest.
        bonds: whether the beads of a row are tied by bonds of type 1.
    """

    variables: tuple[str, ...] = ()
    interactions: tuple[str, ...] = ()
    motion: tuple[str, ...] = ()
    bonds: bool = False


def atoms_by_value(values: NDArray[np.float64]) -> list[tuple[tuple[float, ...], str]]:
    """Distinct values of atoms, and which atoms have them, as LAMMPS's ``group ... id`` takes it.

    Args:
        values: [chain, bead, value]; atom = (chain - 1) * beads + bead.

    Returns:
        Values and ranges such as ``1:60 121:180``, without atoms whose values are all 0.
    """
    flat = values.reshape(-1, values.shape[-1])
    starts = np.flatnonzero(np.r_[True, np.any(flat[1:] != flat[:-1], axis=1)])
    ends = np.r_[starts[1:], len(flat)]
    ranges: dict[tuple[float, ...], list[str]] = {}
    for start, end in zip(starts.tolist(), ends.tolist(), strict=True):
        value = tuple(flat[start].tolist())
        if any(value):
            ranges.setdefault(value, []).append(f"{start + 1}:{end}")
    return [(value, " ".join(found)) for value, found in ranges.items()]
