"""How wide a window must be for a scene: found by the reference integrator before anything else runs."""

from dataclasses import replace

from lammps_inputs import Problem, Scene, window
from workflow.engines.reference.passages import Passages, passages

SAME = 1e-9
"""Largest difference of a leading peak, in units of V, from that in a window twice as wide."""

WIDEST = 1024

_AROUND_KICKS = 32
"""Rows that the reference integrates at the least beyond those between the kicks."""


def with_window(scene: Scene) -> Scene:
    """The same scene with the rows of its window written out.

    ``window: auto`` takes the least number of rows, doubled from 64 on, at which the leading pulse is the same as with
    twice as many; where slower pulses trail and come into play again, that is many. No more than 1024 are tried: the
    check of the run tells what is then left of the error.
    """
    if scene.window != "auto":
        return scene
    rows = window.LEAST_WINDOW
    kicked = [kick.bead for kick in scene.kicks]
    while window.behind(rows) < max(kicked) - min(kicked) + _AROUND_KICKS:
        rows *= 2
    problem = scene.model_copy(update={"window": rows, "accuracy": None}).problem()
    found = _leading(problem, rows)
    while 2 * rows < min(problem.beads, WIDEST + 1):
        wider = _leading(problem, 2 * rows)
        if _difference(found, wider) <= SAME:
            break
        rows, found = 2 * rows, wider
    return scene.model_copy(update={"window": rows})


def _leading(problem: Problem, rows: int) -> Passages:
    whole = replace(problem, window=None)
    return passages(whole, window=window.behind(rows))


def _difference(first: Passages, second: Passages) -> float:
    """Of the peaks that both have; a bead that only one has reached differs by its peak."""
    a, b = (
        {(c, n): v for c, n, v in zip(w.chain.tolist(), w.bead.tolist(), w.peak_velocity.tolist(), strict=True)}
        for w in (first.waves, second.waves)
    )
    return max((abs(a.get(place, 0.0) - b.get(place, 0.0)) for place in {*a, *b}), default=0.0)
