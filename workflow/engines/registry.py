"""Engines that installed distributions declare as entry points (`lammps_inputs.plugins`), loaded when they are used."""

import re
from typing import TYPE_CHECKING, Any, Literal

from lammps_inputs import InputError, plugins


def _entries() -> dict[str, str]:
    """Name of each engine, without the number that places it -> name of its entry point."""
    return {re.sub(r"^[0-9]+-", "", entry): entry for entry in plugins.declared("engines")}


def engine_names() -> tuple[str, ...]:
    """Names of the engines, in the order in which they are listed."""
    return tuple(_entries())


def load_engine(name: str) -> Any:
    """The engine of a name, a `workflow.runs.engines.Engine`.

    Raises:
        InputError: there is none.
    """
    entries = _entries()
    if name not in entries:
        *others, last = entries
        raise InputError(f"--engine: {name!r} given; {', '.join(others)} or {last}")
    return plugins.load("engines", entries[name])


if TYPE_CHECKING:
    EngineName = str
else:
    EngineName = Literal[engine_names()]
    """Type of an argument or a key that holds the name of an engine."""
