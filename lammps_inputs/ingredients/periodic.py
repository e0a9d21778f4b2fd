"""Chains closed to rings: the last bead of each chain touches the first, by a contact like the others.

All that a chain's ends have is refused. As no bead is anywhere else than beside its neighbours, the overlaps and gaps
of a ring, each counted from rest, add up to 0 at any time: where a pulse compresses beads, a gap opens elsewhere.

Examples:
    >>> ring = granchain.load("one-chain", {"periodic": True}).system
    >>> [link.name for link in ring.links], ring.closing[0].first.rows, ring.closing[0].second.rows
    (['contacts', 'closing_contacts'], slice(-1, None, None), slice(0, 1, None))
"""

from collections.abc import Mapping
from typing import Any

LEAST_BEADS = 3
"""Beads of a ring: two would have both contacts with each other."""

REFUSED = {
    "walls": "stand at the ends of chains, and rings have none",
    "precompression": "is a force on the ends of chains, and rings have none",
    "gravity": "points along a chain, and a ring has no such direction",
    "window": "follows a pulse from one end of the chains to the other, and rings have none",
}
"""Keys that need an end, and why."""


def refuse(beads: int, parts: Mapping[str, Any]) -> None:
    """Refuse what a ring cannot have.

    Args:
        beads: number of beads of each chain.
        parts: what the scene names, by key.

    Raises:
        ValueError: naming the key, what was found and what to do.
    """
    if beads < LEAST_BEADS:
        raise ValueError(f"beads: {beads} of a ring given; at least {LEAST_BEADS}, or leave `periodic` out")
    for key, reason in REFUSED.items():
        if parts.get(key) is not None:
            raise ValueError(f"{key}: {reason}; leave `{key}` or `periodic` out")
