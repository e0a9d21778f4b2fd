"""Lines of text of what a report holds, for golden texts."""

from collections.abc import Iterator
from typing import Any


def leaves(value: Any, place: str = "") -> Iterator[str]:
    """Lines of all numbers and words of a report; of many numbers of a list the first, the last and how many."""
    if isinstance(value, dict):
        for key, part in value.items():
            yield from leaves(part, f"{place}.{key}" if place else key)
    elif isinstance(value, list) and len(value) > 6:
        yield f"{place}: {len(value)}"
        yield from leaves(value[0], f"{place}[first]")
        yield from leaves(value[-1], f"{place}[last]")
    elif isinstance(value, list):
        for number, part in enumerate(value, 1):
            yield from leaves(part, f"{place}[{number}]")
    else:
        yield f"{place}: {value:.6g}" if isinstance(value, float) else f"{place}: {value}"
