"""Lists of beads that a scene names."""

from typing import Any


def each_once(beads: Any, otherwise: str = "") -> Any:
    """The beads of a list, if there are any, and none is named twice.

    Raises:
        ValueError: so; ``otherwise`` says what else could be done.
    """
    if not beads:
        raise ValueError(f"name at least one bead{otherwise}")
    if len(set(beads)) < len(beads):
        raise ValueError("a bead is named twice")
    return beads
