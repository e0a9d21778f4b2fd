"""Lines of a deck that say what a law on a link is to LAMMPS, sorted by the place where LAMMPS wants them."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from lammps_inputs.links import Across


@dataclass(frozen=True)
class Lines:
    """What one law adds to a deck, also to its continuation; nothing by default.

    Attributes:
        variables: numbers at the top, which ``-var`` changes.
        interactions: of atoms with each other, a section of their own.
        motion: fixes that act beside the integration, once the beads are read and at rest.
        bonds: type of the bond that is each link across, [edge, row], counted from 1; 0 for none.
    """

    variables: tuple[str, ...] = ()
    interactions: tuple[str, ...] = ()
    motion: tuple[str, ...] = ()
    bonds: NDArray[np.int64] | None = None


MOST_GROUPS = 24
"""Of atoms that differ; LAMMPS has room for 32."""


def atoms_by_value(law: Iterable[Any], shape: tuple[int, int]) -> list[tuple[tuple[float, ...], str]]:
    """Distinct values of a law's parameters, and which atoms have them, as LAMMPS's ``group ... id`` takes it.

    Args:
        law: parameters, numbers or [chain, bead].
        shape: chains and beads; atom = (chain - 1) * beads + bead.

    Returns:
        Values and ranges such as ``1:60 121:180``, without atoms whose values are all 0.

    Raises:
        ValueError: more values than LAMMPS has groups for.
    """
    flat = np.stack([np.broadcast_to(parameter, shape).reshape(-1) for parameter in law], axis=-1)
    starts = np.flatnonzero(np.r_[True, np.any(flat[1:] != flat[:-1], axis=1)])
    ends = np.r_[starts[1:], len(flat)]
    ranges: dict[tuple[float, ...], list[str]] = {}
    for start, end in zip(starts.tolist(), ends.tolist(), strict=True):
        value = tuple(flat[start].tolist())
        if any(value):
            ranges.setdefault(value, []).append(f"{start + 1}:{end}")
    if len(ranges) > MOST_GROUPS:
        raise ValueError(f"{len(ranges)} different values; LAMMPS has room for {MOST_GROUPS}")
    return [(value, " ".join(found)) for value, found in ranges.items()]


def bonds_by_value(law: Iterable[Any], shape: tuple[int, int]) -> tuple[list[tuple[float, ...]], NDArray[np.int64]]:
    """Distinct values of a law's parameters, ascending, and which links have them, as types of LAMMPS's bonds.

    Args:
        law: parameters, numbers or [edge, row].
        shape: edges and rows.

    Returns:
        Values without those that are all 0, and the types [edge, row], from 1; 0 where all are 0.
    """
    if not any(np.ndim(parameter) for parameter in law):
        return [tuple(map(float, law))], np.broadcast_to(1, shape)
    table = np.stack([np.broadcast_to(parameter, shape).reshape(-1) for parameter in law], axis=-1)
    values, kind = np.unique(table, axis=0, return_inverse=True)
    nothing = int(not values[0].any())
    return [tuple(value) for value in values[nothing:].tolist()], (kind + 1 - nothing).reshape(shape)


def whole_contacts(link: "Across") -> tuple[str, ...]:
    """What keeps contacts between beads that are tied by way of others, which LAMMPS leaves out by default.

    Ties of an open row of chains never lead to a bead within reach.
    """
    return () if link.open_row else ("special_bonds lj/coul 1 1 1      # no contact is left out for a spring",)
