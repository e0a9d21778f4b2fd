"""What the terminal shows: a progress bar, tables. Nothing is computed here.

Examples:
    >>> screen.cell(1.0 / 3.0), screen.cell(None), screen.cell([1, 2])
    ('0.333333', '-', '1 2')
    >>> screen.print_table("Arrivals", ["bead", "time"], [["1", "0.5"], ["2", "1.5"]])
    Arrivals
    bead  time
       1   0.5
       2   1.5
    >>> with screen.count_bar("cases") as show:  # on a terminal
    ...     show(1, 2)
    >>> screen.CommandResult(0, {"cases": 2}).code
    0
"""

import errno
import math
import os
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple, TextIO, TypeVar

from workflow.errors import RunError

if TYPE_CHECKING:
    from lammps_inputs import Problem

T = TypeVar("T")

_bars: ContextVar[bool] = ContextVar("bars", default=True)


class OutputStream:
    """A standard stream that may be closed, full or a pipe that nobody reads.

    Args:
        stream: where text goes; None if it is closed.
        name: its name, for messages.
        needed: whether to raise where text cannot be written; else the first failure is kept in ``failure``, for what a
            command computes is more than what it prints.
    """

    def __init__(self, stream: TextIO | None, name: str, *, needed: bool) -> None:
        self.needed = needed
        self.failure = ""
        self._stream, self._name = stream, name

    def write(self, text: str) -> int:
        """Write text, if that is possible."""
        self._tried("write", text)
        return len(text)

    def flush(self) -> None:
        """Write what is still in memory."""
        if self._stream is not None:
            self._tried("flush")

    def _tried(self, method: str, *arguments: str) -> None:
        try:
            if self._stream is None:
                raise OSError(errno.EBADF, os.strerror(errno.EBADF))
            getattr(self._stream, method)(*arguments)
        except BrokenPipeError:  # whoever read it has seen enough
            if self.needed:
                raise
        except OSError as error:
            self.failure = f"{self._name}: cannot be written ({error.strerror})"
            if self.needed:
                raise RunError(self.failure) from None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


class CommandResult(NamedTuple):
    """Exit code of a command, and its results for scripts."""

    code: int
    data: Any
    """Plain data, which `--json` prints."""


class PrintedTable(NamedTuple):
    """A table as it is printed."""

    title: str
    head: list[str]
    rows: list[list[str]]


@contextmanager
def meanwhile(variable: ContextVar[T], value: T) -> Iterator[None]:
    """Give a variable another value, until the end."""
    token = variable.set(value)
    try:
        yield
    finally:
        variable.reset(token)


def without_bars() -> AbstractContextManager[None]:
    """Show neither progress nor hints meanwhile."""
    return meanwhile(_bars, False)


def _print_hint(text: str, *, anywhere: bool = True) -> None:
    from rich.console import Console

    console = Console(stderr=True, soft_wrap=True, highlight=False)
    if anywhere or console.is_terminal or console.is_jupyter:
        console.print(text, style="dim", markup=False)


_print_where_seen = partial(_print_hint, anywhere=False)

_tell: ContextVar[Callable[[str], None]] = ContextVar("tell", default=_print_where_seen)


def with_hints(tell: Callable[[str], None] = _print_hint) -> AbstractContextManager[None]:
    """Pass hints to a function within a block; by default they are printed also where standard error is no terminal."""
    return meanwhile(_tell, tell)


def hint(text: str) -> None:
    """Print what takes long, in one line on standard error, where progress is shown and in commands."""
    if _bars.get():
        _tell.get()(text)


def print_heading(name: str, units: str) -> None:
    """Print the first line of a command about one scene; the lines below it are sentences without a label.

    Args:
        name: name of the scene.
        units: its `lammps_inputs.scene.BaseScene.units`.
    """
    print(f"{one_line(name)} in {units}", flush=True)


def print_files(directory: object, names: Iterable[str]) -> None:
    """Print the last line of a command: the files that it has written into a directory."""
    print(f"written to {one_line(directory)}: {', '.join(names)}")


def one_line(text: object) -> str:
    """A name as it may be printed: what is not printable, such as a line break or ESC, is escaped."""
    return "".join(sign if sign.isprintable() else ascii(sign)[1:-1] for sign in str(text))


def cell(value: Any, digits: str = ".6g") -> str:
    """A value of a scene or a quantity in a table; ``-`` where it is undefined."""
    if isinstance(value, list | tuple):
        return " ".join(map(cell, value))
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return "-"
    return f"{value:{digits}}" if isinstance(value, float) else one_line(value)


@contextmanager
def progress_bar(name: str, problem: "Problem") -> Iterator[Callable[[int, int], None]]:
    """A bar of steps done, with the bead that the front has reached; on standard error, and only on a terminal."""
    with _bar("step {task.completed:.0f}/{task.total:.0f}  bead {task.fields[bead]}") as bar:
        task = bar.add_task(name, total=problem.steps, bead=1)

        def show(step: int, bead: int) -> None:
            bar.update(task, completed=step, bead=bead)

        yield show


@contextmanager
def count_bar(name: str) -> Iterator[Callable[..., None]]:
    """A bar of cases done, and how many of them failed or what else is to be said.

    On standard error, and only on a terminal.
    """
    with _bar("{task.fields[count]}") as bar:
        task = bar.add_task(name, total=None, count="")

        def show(done: int, total: int, failed: int | str = 0) -> None:
            remark = f"{failed} failed" if isinstance(failed, int) and failed else failed or ""
            label = f"{name}, {remark}" if remark else name
            bar.update(task, completed=done, total=total, count=f"{done}/{total}", description=label)

        yield show


class _NotebookLine:
    """Line in the output of a notebook's cell that says how much is done, with the methods of rich's bar."""

    def __init__(self) -> None:
        from IPython.display import display

        self._handle: Any = display({"text/plain": ""}, raw=True, display_id=True)
        self._fields: dict[str, Any] = {}
        self._next = 0.0

    def add_task(self, name: str, **fields: Any) -> int:
        """Begin with a name and how much there is to do."""
        self._fields = {"description": name, "completed": 0, **fields}
        return 0

    def update(self, _task: int, **fields: Any) -> None:
        """Replace the line, at most a few times a second."""
        self._fields |= fields
        if time.monotonic() >= self._next:
            self._next = time.monotonic() + _SECONDS_A_LINE
            total = self._fields["total"]
            share = f" {self._fields['completed'] / total:.0%}" if total else ""
            self.show(f"{self._fields['description']}{share}")

    def show(self, line: str) -> None:
        """Replace the line."""
        self._handle.update({"text/plain": line}, raw=True)


_SECONDS_A_LINE = 0.25


@contextmanager
def _bar(done: str) -> Iterator[Any]:
    """A bar that says by a template how much is done, and disappears at its end; in a notebook one line."""
    from rich.console import Console  # rich takes a tenth of a second to import
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    if console.is_jupyter and _bars.get():
        line = _NotebookLine()
        try:
            yield line
        finally:
            line.show("")
        return
    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn(done), TimeRemainingColumn(compact=True))
    shown = _bars.get() and console.is_terminal
    drawing = None
    try:
        with Progress(*columns, console=console, transient=True, disable=not shown) as bar:
            drawing = bar.live._refresh_thread
            yield bar
    finally:
        if drawing is not None:
            drawing.join()  # rich only asks it to end


def print_table(title: str, head: list[str], rows: list[list[str]]) -> None:
    """A table on standard output; numbers are right-aligned."""
    from rich import table as rich
    from rich.console import Console

    table = rich.Table(title=title, title_justify="left", box=None, pad_edge=False, header_style="bold")
    for name in head:
        table.add_column(name, justify="right")
    for row in rows:
        table.add_row(*row)
    console = Console(width=None if Console().is_terminal else 140, highlight=False)
    console.print(table)
