"""Two equal waves meet head-on."""

from matplotlib.axes import Axes

from workflow.studies.gallery.criteria import Measured, at_least, at_most, state
from workflow.studies.gallery.entry import COLOURS, Entry, Ran, Results, chain, each
from workflow.studies.page import Statement

ALONE = chain(100, 108)
SEEN = 80


def _both_ends(beads: int) -> dict[str, object]:
    return {**ALONE, "beads": beads, "kick": [{"bead": 1, "velocity": 1.0}, {"bead": beads, "velocity": -1.0}]}


def _after(run: Ran) -> tuple[float, float]:
    """Arrival and velocity of the pulse that passes bead `SEEN` after the collision."""
    train = run.train(SEEN, 0.3)
    return float(train.arrival[-1]), float(train.peak_velocity[-1])


def _lost(run: Ran) -> float:
    """Share of the energy of a wave that it does not have after the collision."""
    return 1.0 - (_after(run)[1] / run.peak(35)) ** 2


def _secondary(run: Ran) -> float:
    """Velocity of the strongest pulse behind it, where it was last seen."""
    late = [pulse for pulse in run.pulses(1, 0.003) if pulse.bead[0] > 50 and pulse.peak_velocity.max() < 0.3]
    return max((float(pulse.peak_velocity[len(pulse) // 2]) for pulse in late), default=0.0)


def statements(results: Results) -> list[Statement]:
    """Energy lost, secondary waves, and the phase shift."""
    even, odd = results["even"], results["odd"]
    lost, new = (
        {name: each(runs, measure) for name, runs in (("even", even), ("odd", odd))} for measure in (_lost, _secondary)
    )
    early = {
        engine: float(results["alone"][engine].waves.at(SEEN).arrival[0]) - _after(even[engine])[0] for engine in even
    }
    ratio = {engine: new["even"][engine] / new["odd"][engine] for engine in even}
    return [
        state(
            Measured("energy lost by each wave, even number of beads", lost["even"], at_most(0.01), "6"),
            Measured("odd number of beads", lost["odd"], at_most(0.01), "6"),
            published="Solitary waves collide almost elastically.",
            source="ahnert2009, abstract",
        ),
        state(
            Measured("largest velocity behind the wave, even number of beads", new["even"], at_least(0.01), "5 V"),
            published="Two secondary solitary waves emerge from the region where equal waves collide.",
            source="santibanez2011, abstract",
            also=[Measured("odd number of beads", new["odd"], at_least(0.0), "5 V").line()],
        ),
        state(
            Measured("velocity for an even over that for an odd number of beads", ratio, at_least(1.0), "2"),
            published="Secondary waves are stronger in chains with an even number of beads, where waves meet in a "
            "contact.",
            source="santibanez2011, abstract",
        ),
        state(
            Measured(f"arrival at bead {SEEN} before that of a single wave by", early, at_least(0.01), "3 T"),
            published="The collision introduces a phase shift.",
            source="santibanez2011, abstract",
        ),
    ]


def draw(axis: Axes, results: Results) -> None:
    """A bead behind the middle over time."""
    for place, name in enumerate(("even", "odd")):
        run = results[name]["lammps"].trajectory
        axis.plot(run.time, run.velocity[:, 0, 61], color=COLOURS[place], label=f"{name} number of beads")
    axis.set_ylim(-0.06, 0.06)
    axis.set_xlim(60.0, 105.0)


ENTRY = Entry(
    title="Collision of equal and opposite waves",
    introduction="Both ends of a chain of 100 or 101 beads are kicked; the waves collide in the middle.",
    sources={
        "santibanez2011": "abstract read, no numbers",
        "ahnert2009": "abstract read: nearly elastic collisions",
    },
    scenes={"even": _both_ends(100), "odd": _both_ends(101), "alone": ALONE},
    statements=statements,
    axes=("time (T)", "velocity of bead 62 (V)"),
    draw=draw,
    caption="Velocity of bead 62, twelve beads behind the middle: after the wave a secondary wave passes.",
)
