"""The first bead of an uncompressed chain is hit: what runs off, what stays behind, what flies off at the end."""

from matplotlib.axes import Axes

from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Results, Statement, chain, each, number

BEAD = 80


def statements(results: Results) -> list[Statement]:
    """Amplitude, last bead, first bead."""
    runs = results["kicked"]
    return [
        number(
            "The leading solitary wave has a velocity of 0.682 V.",
            0.682,
            each(runs, lambda run: run.peak(BEAD)),
            within=5e-4,
            form="5 V",
        ),
        number(
            "The last ball flies off with 0.986 V.",
            0.986,
            each(runs, lambda run: float(run.trajectory.velocity[-1, 0, -1])),
            within=5e-4,
            form="5 V",
        ),
        number(
            "The kicked ball rebounds with 0.071 V.",
            -0.071,
            each(runs, lambda run: float(run.trajectory.velocity[-1, 0, 0])),
            within=5e-4,
            form="5 V",
        ),
    ]


def draw(axis: Axes, results: Results) -> None:
    """The leading pulse over distance."""
    for place, (engine, run) in enumerate(results["kicked"].items()):
        marks = "-" if place else "o"
        axis.plot(run.waves.bead, run.waves.peak_velocity, marks, ms=3, color=COLOURS[place], label=engine)
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
