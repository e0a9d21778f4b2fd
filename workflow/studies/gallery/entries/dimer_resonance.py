"""Heavy and light alternating beads: mass ratios at which the pulse decays most."""

import math

import numpy as np
from matplotlib.axes import Axes

from analysis.trajectory import Floats
from workflow.studies.gallery.criteria import Measured, at_most, near, state
from workflow.studies.gallery.entries.dimers import dimer
from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Results, each
from workflow.studies.page import Statement

RESONANCE = 0.59
SOURCE = "jayaprakash2013, as quoted"
BEADS, CELLS = 150, (10, 60)
SWEPT = (0.2, 0.24, 0.28, 0.3428, 0.4, 0.44, 0.48, 0.52, 0.55, 0.57, 0.61, 0.63, 0.67, 0.75, 0.85)


def _name(ratio: float) -> str:
    return f"ratio-{ratio:g}"


def _curve(results: Results, cell: int) -> tuple[Floats, Floats]:
    """Velocity of the heavy bead of a cell over the mass ratio."""
    ratio = np.array(sorted((*SWEPT, RESONANCE)))
    return ratio, np.array([results[_name(float(one))]["reference"].peak(2 * cell + 1) for one in ratio])


def _weakest(results: Results, cell: int) -> float:
    """Where that is smallest: of a parabola through the three lowest neighbours."""
    ratio, peak = _curve(results, cell)
    at = int(np.argmin(peak))
    square, slope, _ = np.polyfit(ratio[at - 1 : at + 2], peak[at - 1 : at + 2], 2)
    return float(-slope / (2.0 * square))


def statements(results: Results) -> list[Statement]:
    """Where the pulse is weakest, after how many cells, and how weak."""
    far, near_by = (_weakest(results, cell) for cell in reversed(CELLS))
    at = {ratio: each(results[_name(ratio)], lambda run: run.peak(2 * CELLS[1] + 1)) for ratio in (RESONANCE, 0.3428)}
    weaker = {engine: at[RESONANCE][engine] / at[0.3428][engine] for engine in at[RESONANCE]}
    drift = {"reference": abs(near_by - far)}
    return [
        state(
            Measured(
                f"mass ratio of the weakest pulse in cell {CELLS[1]}", {"reference": far}, near(RESONANCE, 0.01), "3"
            ),
            published=f"The pulse is attenuated most at a mass ratio of {RESONANCE}.",
            source=SOURCE,
            derived="Required within one unit of the last digit.",
        ),
        state(
            Measured(f"its change between cells {CELLS[0]} and {CELLS[1]}", drift, at_most(0.01, math.inf), "3"),
            published="The ratio is quoted without a distance.",
            source=SOURCE,
            correction=f"It depends on the distance: after {CELLS[0]} cells it is {near_by:.2f}.",
        ),
        state(
            Measured(f"velocity in cell {CELLS[1]} over that at the anti-resonance 0.3428", weaker, at_most(0.5), "4"),
            published="At the resonance the pulse is attenuated strongly.",
            source=SOURCE,
        ),
    ]


def draw(axis: Axes, results: Results) -> None:
    """Velocity after some cells over the mass ratio."""
    for place, cell in enumerate(CELLS):
        axis.plot(*_curve(results, cell), "o-", ms=4, color=COLOURS[place], label=f"cell {cell}")
    axis.axvline(RESONANCE, **PUBLISHED)


ENTRY = Entry(
    title="Resonance of dimers",
    introduction="The same chains of heavy and light beads, at the mass ratios at which the pulse loses most energy "
    "to the light beads behind it.",
    sources={
        "jayaprakash2013": "as quoted in the literature; the paper could not be read",
    },
    scenes={_name(ratio): dimer(ratio, BEADS) for ratio in (RESONANCE, 0.3428)},
    swept={_name(ratio): dimer(ratio, BEADS) for ratio in SWEPT if ratio != 0.3428},
    statements=statements,
    axes=("mass of the light beads (m)", "peak velocity of the heavy bead (V)"),
    draw=draw,
    caption="Peak velocity of a heavy bead in two cells over the mass of the light beads (reference); line: 0.59.",
)
