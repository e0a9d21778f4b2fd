"""Two chains on a foundation: energy beats between them."""

import math

from matplotlib.axes import Axes

from analysis.trajectory import Floats
from workflow.studies.gallery.criteria import NAMES, Measured, at_least, at_most, near, state
from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Results, each
from workflow.studies.page import Statement

GROUND, COUPLING = 1.0, 0.1
SCENE = {
    "chains": 2,
    "beads": 40,
    "coupling": {"stiffness": COUPLING},
    "foundation": {"stiffness": GROUND},
    "kick": {"velocity": 0.1},
    "duration": 80,
    "output": {"every": 0.25},
}
OSCILLATORS = math.pi / (math.sqrt(GROUND + 2.0 * COUPLING) - math.sqrt(GROUND))
"""Time in which two oscillators with this coupling exchange their energy."""


def statements(results: Results) -> list[Statement]:
    """How much energy is exchanged, and when."""
    runs = results["beats"]
    share = each(runs, lambda run: run.flow.extremes(1)[1][0])
    when = each(runs, lambda run: run.flow.extremes(1)[1][1] * run.problem.scale.time)
    returned = each(runs, lambda run: _return(run.flow.share[:, 1]))
    return [
        state(
            Measured("largest share of the chain that was not kicked", share, at_least(0.95), "4"),
            Measured("smallest share after that", returned, at_most(0.05), "4"),
            published="Weakly coupled chains on elastic foundations exchange energy in beats.",
            source="starosvetsky2012, title",
            derived="Required: 95% of the energy is exchanged, and 95% returns.",
        ),
        state(
            Measured("time of the largest share", when, near(OSCILLATORS, 0.25, 0.1 * OSCILLATORS), "2"),
            derived="Two linear oscillators, coupled alike, exchange their energy in pi / (sqrt(k_f + 2 k) - "
            f"sqrt(k_f)) = {OSCILLATORS:.1f}; required within one frame.",
            correction="It is later: contacts press on the beads while the pulse spreads.",
        ),
    ]


def _return(share: Floats) -> float:
    """The least share after the largest."""
    return float(share[int(share.argmax()) :].min())


def draw(axis: Axes, results: Results) -> None:
    """Share of the second chain over time."""
    for place, (engine, run) in enumerate(results["beats"].items()):
        time = run.flow.time * run.problem.scale.time
        axis.plot(time, run.flow.share[:, 1], "--" if place else "-", color=COLOURS[place], label=NAMES[engine])
    axis.axvline(OSCILLATORS, **PUBLISHED)


ENTRY = Entry(
    title="Beats on a foundation",
    introduction="Two chains in an elastic matrix (each bead on a spring of stiffness 1), coupled by springs of "
    "0.1; bead 1 of chain 1 is kicked with 0.1.",
    sources={
        "starosvetsky2012": "could not be read; the exchange time is that of two linear oscillators",
    },
    scenes={"beats": SCENE},
    statements=statements,
    axes=("time (reduced)", "share of the energy in chain 2"),
    draw=draw,
    caption="Share of the energy in the chain that was not kicked; the line is half a beat of two oscillators.",
)
