"""The report on scenes at extremes, from scripts and notebooks."""

from collections.abc import Sequence
from pathlib import Path

from granchain.parts import checked
from workflow.plugins.extremes.cells import refuse_unknown
from workflow.plugins.extremes.study import RunOutcome, carry_out


@checked
def extremes(
    parts: Sequence[str] = (), directory: Path | str | None = None, *, quick: bool = False
) -> list[RunOutcome]:
    """Run scenes at the extremes of every number, on all cores, and check that errors are reported.

    Args:
        parts: parts of the report, such as ``["losses", "loads"]``; all by default.
        directory: new, or resumed; nothing is written if it is omitted.
        quick: whether only cells are run that take about a second.

    Returns:
        The outcome of each cell: its kind, and its errors in units of V.

    Raises:
        InputError: there is no such part, or the directory cannot be used.
        RunError: a process was killed.

    Examples:
        >>> outcomes = granchain.extremes(["drives"], quick=True)
        >>> {outcome.kind for outcome in outcomes} <= {"RIGHT", "REPORTED", "REFUSED"}
        True
    """
    refuse_unknown(parts, "parts")
    return carry_out(parts, None if directory is None else Path(directory), quick=quick)
