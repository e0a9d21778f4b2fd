"""How one cell ended: right, told, refused, stopped, or silently wrong."""

from dataclasses import dataclass

KINDS = ("RIGHT", "TOLD", "REFUSED", "STOPPED", "WRONG")
"""In words:

- RIGHT: the largest error of any velocity is what was asked for, or less;
- TOLD: it is more, and the run says so itself;
- REFUSED: nothing was run, and one line says why;
- STOPPED: the run ended itself, and one line says why;
- WRONG: none of these. The run came to its end and let its user believe more than is true, or it crashed.
"""

TRUE_WITHIN = 1.5
"""A run's word on its own error is true if the error is no larger than this times it. A run compares frames 0.4 T
apart, which may miss the largest error of a wave by 7%, and more of a faster swing, of which it meets four phases.
"""

LEAST_ERROR = 1e-8
"""Smaller errors are not told apart, in units of V."""


@dataclass(frozen=True)
class Told:
    """What a run says of its velocities, in units of V: their largest error, and how sure that is."""

    error: float
    sure: float


@dataclass(frozen=True)
class TrueError:
    """What the judge found: the largest error, how sure that is (units of V), and how it was found."""

    error: float
    sure: float
    by: str


@dataclass(frozen=True)
class Outcome:
    """One cell of the report.

    Attributes:
        axis, value: which cell.
        kind: one of `KINDS`.
        why: in words, what the kind rests on.
        asked: largest error that was asked for, in units of V.
        error, sure: as the judge found; None where nothing came to its end.
        told, told_sure: what the run itself said.
        judge: "reference", or "leading pulse" where all beads were too many.
        steps: time steps of the run.
        seconds: what running and judging took.
    """

    axis: str
    value: str
    kind: str
    why: str
    asked: float
    error: float | None = None
    sure: float | None = None
    told: float | None = None
    told_sure: float | None = None
    judge: str | None = None
    steps: int | None = None
    seconds: float = 0.0


def classify(asked: float, told: Told | None, truth: TrueError) -> tuple[str, str]:
    """Kind and reason of a run that came to its end. NaN counts as an infinite error.

    Args:
        asked: largest error that was asked for, in units of V.
        told: what the run says of itself; None if it says nothing.
        truth: what is true of it.
    """
    if told is not None:
        most = TRUE_WITHIN * (told.error + told.sure) + LEAST_ERROR
        if most < truth.error - truth.sure or (truth.error != truth.error and most == most):
            return "WRONG", f"says {told.error:.1e} V (sure to {told.sure:.1e}), is {truth.error:.1e} V"
    if truth.error <= asked:
        return "RIGHT", ""
    if told is not None and not told.error + told.sure <= asked:
        return "TOLD", f"more than {asked:.0e} V, and says so"
    return "WRONG", f"is {truth.error:.1e} V, more than {asked:.0e} V, and says nothing"
