"""A pool of processes that do not inherit the state of this one."""

import multiprocessing
from collections.abc import Callable
from concurrent.futures import Future, ProcessPoolExecutor
from typing import Any, TypeVar

T = TypeVar("T")


class SpawnPool(ProcessPoolExecutor):
    """As `ProcessPoolExecutor`, started afresh; whoever imports us may still choose another way for his own processes.

    Args:
        processes: how many.
        initializer: called in each process when it starts.
        initargs: its arguments.
    """

    def __init__(
        self, processes: int, initializer: Callable[..., object] | None = None, initargs: tuple[Any, ...] = ()
    ) -> None:
        super().__init__(processes, multiprocessing.get_context("spawn"), initializer, initargs)

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        """As `ProcessPoolExecutor.submit`."""
        undecided = multiprocessing.get_start_method(allow_none=True) is None
        try:
            return super().submit(fn, *args, **kwargs)
        finally:
            if undecided:  # spawning decides on the default method, and `set_start_method` then refuses any
                multiprocessing.set_start_method(None, force=True)
