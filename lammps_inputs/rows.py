"""Rows: the beads of each chain that exist in LAMMPS, and those of them that a frame holds.

Plug-ins take them from a problem or its frames. There are three kinds: all beads, a list of recorded ones, and rows
near the front, which follow the pulse.

Examples:
    >>> rows = granchain.load("one-chain").problem().rows
    >>> rows.complete, rows.count
    (True, 120)
    >>> rows.only((3, 40)).positions([40])  # along the last axis of a frame
    array([1])
    >>> rows.near_front(64).missing
    'frames hold 64 of 120 beads of each chain; without `window` they hold all'
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Rows:
    """Beads of each chain that exist in LAMMPS, and those that a frame holds; without more than ``beads`` all.

    Attributes:
        beads: number of beads of each chain.
        listed: recorded beads, ascending; None where frames hold all beads that exist.
        width: number of beads that exist near the front, which they follow; None where all exist.
    """

    beads: int
    listed: tuple[int, ...] | None = None
    width: int | None = None

    def only(self, beads: Iterable[int] | None) -> "Rows":
        """Rows of which frames hold some beads, ascending, or all that exist: with None, and where all are listed."""
        listed = None if beads is None else tuple(int(bead) for bead in beads)
        every = listed is not None and listed == tuple(range(1, self.beads + 1))
        return replace(self, listed=None if every else listed)

    def near_front(self, width: int | None) -> "Rows":
        """Rows of which so many exist, and follow the front; all exist with None, or where the chains have no more."""
        return replace(self, width=None if width is None or width >= self.beads else width)

    @property
    def follow(self) -> bool:
        """Whether the rows follow the front, so that frames hold different beads."""
        return self.width is not None

    @property
    def existing(self) -> int:
        """Number of beads of each chain that exist in LAMMPS."""
        return self.width or self.beads

    @property
    def count(self) -> int:
        """Number of beads of each chain that a frame holds."""
        return self.existing if self.listed is None else len(self.listed)

    @property
    def numbers(self) -> NDArray[np.int64]:
        """Numbers of the beads that frames hold, [bead] from 1; all where the rows follow the front."""
        return np.arange(1, self.beads + 1) if self.listed is None else np.array(self.listed, dtype=np.int64)

    @property
    def neighbours(self) -> bool:
        """Whether a frame holds the neighbours of its beads, but for those at the ends of rows that follow the front:
        not so where beads are listed.
        """
        return self.listed is None

    @property
    def complete(self) -> bool:
        """Whether every frame holds every bead, so that the states obey the conservation laws."""
        return self.listed is None and self.width is None

    @property
    def missing(self) -> str:
        """Sentence for users where a number needs all beads and frames do not hold them; empty where they do."""
        if self.complete:
            return ""
        key = "window" if self.follow else "output.beads"
        return f"frames hold {self.count} of {self.beads} beads of each chain; without `{key}` they hold all"

    def positions(self, beads: Any, first: int = 1) -> NDArray[np.int64]:
        """Positions of beads along the last axis of a frame.

        Args:
            beads: numbers of beads, from 1; where some are listed, these are among them.
            first: bead that the frame begins with, where the rows follow the front.

        Returns:
            Positions from 0, in the shape of ``beads``; outside the axis where the frame does not hold a bead.
        """
        along = np.asarray(beads) - 1 if self.listed is None else np.searchsorted(self.numbers, beads)
        return np.asarray(along - (first - 1), dtype=np.int64)

    def shared(self, other: "Rows") -> "Rows":
        """Rows that frames of two problems both hold, of chains of one length; none is listed where there is none."""
        numbers = np.intersect1d(self.numbers, other.numbers)
        widths = [rows.width for rows in (self, other) if rows.width is not None]
        return Rows(self.beads, width=min(widths, default=None)).only(numbers)
