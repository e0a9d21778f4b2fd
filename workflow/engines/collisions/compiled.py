"""How this package compiles a function."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

from workflow.compiled import compiled as on_disk

F = TypeVar("F", bound=Callable[..., Any])


def compiled(function: F) -> F:
    """The function as machine code with IEEE arithmetic: no reordering, division by zero gives inf.

    Inlined into its callers, since most of the time would go into counting references to the arrays it is handed.
    """
    return cast(F, on_disk(error_model="numpy", forceinline=True)(function))


def inner(function: F) -> F:
    """The same for a function that compiled ones alone call."""
    return cast(F, on_disk(error_model="numpy", forceinline=True, no_cpython_wrapper=True)(function))
