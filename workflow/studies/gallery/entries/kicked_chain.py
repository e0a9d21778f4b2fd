"""The first bead of an uncompressed chain is kicked: the leading wave, the last bead, and the rebound of the first."""

from matplotlib.axes import Axes

from workflow.studies.gallery.criteria import NAMES, Measured, near, state
from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Results, chain, each
from workflow.studies.page import Statement

BEAD = 80


def statements(results: Results) -> list[Statement]:
    """Amplitude, last bead, first bead."""
    runs = results["kicked"]
    last, first = (each(runs, lambda run, n=n: float(run.trajectory.velocity[-1, 0, n])) for n in (-1, 0))  # type: ignore[misc]
    peak = each(runs, lambda run: run.peak(BEAD))
    return [
        state(
            Measured(f"velocity of the leading pulse at bead {BEAD}", peak, near(0.682, 5e-4), "5 V"),
            published="The leading solitary wave has the velocity 0.682 V.",
            source="hinch1999, as quoted",
        ),
        state(
            Measured("velocity of the last bead at the end", last, near(0.986, 5e-4), "5 V"),
            published="The last ball leaves the chain with 0.986 V.",
            source="hinch1999, as quoted",
        ),
        state(
            Measured("velocity of bead 1 at the end", first, near(-0.071, 5e-4), "5 V"),
            published="The impacting ball rebounds with 0.071 V.",
            source="hinch1999, as quoted",
        ),
    ]


def draw(axis: Axes, results: Results) -> None:
    """The leading pulse over distance."""
    for place, (engine, run) in enumerate(results["kicked"].items()):
        marks = "-" if place else "o"
        axis.plot(run.waves.bead, run.waves.peak_velocity, marks, ms=3, color=COLOURS[place], label=NAMES[engine])
    axis.axhline(0.682, **PUBLISHED)


ENTRY = Entry(
    title="A kicked chain",
    introduction="One hundred touching beads; the first starts with V = 1.",
    sources={
        "hinch1999": "as quoted in the literature; the paper could not be read",
    },
    scenes={"kicked": chain(100, 150)},
    statements=statements,
    axes=("bead", "velocity of the leading pulse (V)"),
    draw=draw,
    caption="Velocity of the leading pulse along the chain; the line is 0.682 V.",
)
