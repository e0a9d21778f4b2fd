"""The rows of a window that is ``auto``.

They are found by trials with the reference integrator before anything else runs, within a limit on its processor time.
"""

from dataclasses import replace

from lammps_inputs import Problem, Scene, window
from workflow import screen
from workflow.engines.reference import engine
from workflow.processor_time import LimitReachedError, limited

SECONDS = 4.0
"""Processor time, in s, that the trials may take; the rest is for the time step."""

SAME = 1e-9
"""Largest difference of a leading peak, in units of V, from that in a window twice as wide."""

WIDEST = 1024

_AROUND_KICKS = 32
"""Rows that the reference integrates at the least beyond those between the kicks."""


def with_window(scene: Scene) -> Scene:
    """A scene with the rows of its window written out.

    ``window: auto`` takes the least number of rows, doubled from 64 on, at which the leading pulse is the same as with
    twice as many; where slower pulses trail and come into play again, that is many. No more than 1024 are tried: the
    check of the run gives the remaining error. Where the trials reach the limit on processor time, the window is four
    times as wide as the last that was tried, at most 1024 rows, and a hint says so.
    """
    if scene.window != "auto":
        return scene
    rows = window.LEAST_WINDOW
    kicked = [kick.bead for kick in scene.kicks]
    while window.behind(rows) < max(kicked) - min(kicked) + _AROUND_KICKS:
        rows *= 2
    problem = scene.model_copy(update={"window": rows, "accuracy": None}).problem()
    try:
        with limited(SECONDS):
            leading = _leading(problem, rows)
            while 2 * rows < min(problem.beads, WIDEST + 1):
                wider = _leading(problem, 2 * rows)
                if _difference(leading, wider) <= SAME:
                    break
                rows, leading = 2 * rows, wider
    except LimitReachedError:
        rows = min(WIDEST, 4 * rows)
        screen.hint(
            f"window: {rows} rows by a rule, not by trials, as these take more than {SECONDS:g} s of processor "
            "time; a `window` of so many rows avoids them"
        )
    return scene.model_copy(update={"window": rows})


def _leading(problem: Problem, rows: int) -> engine.LeadingPeaks:
    complete = replace(problem, rows=problem.rows.near_front(None))
    return engine.passages(complete, rows=window.behind(rows))


def _difference(first: engine.LeadingPeaks, second: engine.LeadingPeaks) -> float:
    """Largest difference of the peaks, in units of V; a bead that only one wave has reached differs by its peak."""
    a, b = (
        {(c, n): v for c, n, v in zip(w.chain.tolist(), w.bead.tolist(), w.peak_velocity.tolist(), strict=True)}
        for w in (first, second)
    )
    return max((abs(a.get(place, 0.0) - b.get(place, 0.0)) for place in {*a, *b}), default=0.0)
