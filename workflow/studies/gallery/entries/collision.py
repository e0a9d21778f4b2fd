"""Two equal waves meet head-on."""

from matplotlib.axes import Axes

from workflow.studies.gallery.entry import COLOURS, Entry, Ran, Results, Statement, chain, claim, each, engines

ALONE = chain(100, 108)
SEEN = 80


def _both_ends(beads: int) -> dict[str, object]:
    return {**ALONE, "beads": beads, "kick": [{"bead": 1, "velocity": 1.0}, {"bead": beads, "velocity": -1.0}]}


def _after(run: Ran) -> tuple[float, float]:
    """Arrival and velocity of the pulse that passes bead `SEEN` after the collision."""
    train = run.train(SEEN, 0.3)
    return float(train.arrival[-1]), float(train.peak_velocity[-1])


def _secondary(run: Ran) -> float:
    """Velocity of the strongest pulse behind it, where it was last seen."""
    late = [pulse for pulse in run.pulses(1, 0.003) if pulse.bead[0] > 50 and pulse.peak_velocity.max() < 0.3]
    return max((float(pulse.peak_velocity[len(pulse) // 2]) for pulse in late), default=0.0)


def statements(results: Results) -> list[Statement]:
    """What is lost, what is new, and the phase shift."""
    even, odd = results["even"], results["odd"]
    kept = {
        name: each(runs, lambda run: (_after(run)[1] / run.peak(35)) ** 2)
        for name, runs in (("even", even), ("odd", odd))
    }
    new = {name: each(runs, _secondary) for name, runs in (("even", even), ("odd", odd))}
    early = {
        engine: float(results["alone"][engine].waves.at(SEEN).arrival[0]) - _after(even[engine])[0] for engine in even
    }
    lost = {name: {engine: 1.0 - share for engine, share in found.items()} for name, found in kept.items()}
    return [
        claim(
            "Waves that collide pass almost elastically.",
            [
                *engines(lost["even"], digits=6, label="energy lost by each, even number of beads: "),
                *engines(lost["odd"], digits=6, label="odd: "),
            ],
            max(lost["even"].values()) < 0.01,
        ),
        claim(
            "Two secondary solitary waves emerge from where equal waves meet.",
            [
                *engines(new["even"], " V", label="strongest behind the wave, even: "),
                *engines(new["odd"], " V", label="odd: "),
            ],
            min(new["even"].values()) > 0.01,
        ),
        claim(
            "They are stronger in chains with an even number of beads, where waves meet in a contact.",
            [f"{new['even'][engine] / new['odd'][engine]:.2f} times ({engine})" for engine in even],
            all(new["even"][engine] > new["odd"][engine] for engine in even),
        ),
        claim(
            "The collision shifts the phase.",
            engines(early, " T", 3, f"earlier at bead {SEEN} than a wave alone by: "),
            min(early.values()) > 0.01,
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
    axes=("time (T)", "velocity of bead 62 (V), enlarged"),
    draw=draw,
    caption="After the wave has passed, a secondary wave follows: a bead twelve beads behind the middle.",
)
