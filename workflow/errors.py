"""Errors of runs that are no bad input, and how a process ended, in words.

Plug-ins take this module to report programs that they started: `how_it_ended` says how a process ended, `complaint`
what it printed before, `first_line` what an error of LAMMPS says.

Examples:
    >>> errors.how_it_ended(-9)
    'was killed by signal SIGKILL'
    >>> errors.complaint(["Traceback (most recent call last):", "  ...", "MemoryError: 8 GB"])
    'MemoryError: 8 GB'
"""

import signal
from collections.abc import Iterable


class RunError(RuntimeError):
    """A run that could not be finished or a result that is not right; its text is one line (exit code 1).

    Examples:
        >>> raise granchain.RunError("LAMMPS was killed by signal SIGKILL")
        Traceback (most recent call last):
            ...
        workflow.errors.RunError: LAMMPS was killed by signal SIGKILL
    """

    def __init__(self, message: str) -> None:
        one_line = " ".join(message.split())
        super().__init__("".join(c if c.isprintable() else ascii(c)[1:-1] for c in one_line))  # no terminal controls


class EndedError(RunError):
    """A run that was ended from outside, by a signal or a full disk, and may be resumed."""


def how_it_ended(code: int) -> str:
    """How a process ended, by its exit code."""
    return f"was killed by signal {signal.Signals(-code).name}" if code < 0 else f"ended with exit code {code}"


def complaint(lines: Iterable[str]) -> str:
    """What a process printed before it died, in one line: its first, of a traceback the last."""
    printed = [line.strip() for line in lines if line.strip()]
    return "" if not printed else printed[-1] if printed[0].startswith("Traceback") else printed[0]


def first_line(error: Exception) -> str:
    """First line of the message of an error of LAMMPS."""
    text = str(vars(error).get("message", error))  # LAMMPS's own exception would print itself in quotes
    return next((line.strip() for line in text.splitlines() if line.strip()), "unknown error")
