"""The one way in which this package compiles a function.

numba's cache on disk notices a change of the file that holds a function, not of the files of those that it calls:
whoever edits one of these modules deletes ``__pycache__`` of this folder.
"""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., Any])


def compiled(function: F) -> F:
    """The function as machine code with IEEE arithmetic: no reordering, division by zero gives inf.

    Inlined into its callers, since most of the time would go into counting references to the arrays it is handed.
    """
    return cast(F, numba.njit(cache=True, error_model="numpy", forceinline=True)(function))
