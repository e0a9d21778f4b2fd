"""A wave is reflected by a wall."""

from matplotlib.axes import Axes

from workflow.studies.gallery.entry import COLOURS, Entry, Ran, Results, Statement, chain, claim, each, engines, number

WALLS: dict[str, object] = {"soft": {"stiffness": 0.1}, "bead": "bead", "flat": "flat", "rigid": "rigid"}
BEADS, SEEN = 60, 35


def _ratio(run: Ran) -> float:
    """Largest force on the wall over that in the chain."""
    wall, chain = run.forces(contacts=(SEEN,), wall=True).largest[0]
    return float(wall / chain)


def _back(run: Ran) -> tuple[float, float]:
    """Arrival and velocity of the reflected pulse at a bead."""
    pulse = max(run.pulses(-1, 0.1), key=lambda one: float(one.peak_velocity.max()))
    at = int(list(pulse.bead).index(SEEN))
    return float(pulse.arrival[at]), float(pulse.peak_velocity[at])


def statements(results: Results) -> list[Statement]:
    """Force, what comes back, and when."""
    ratio = {name: each(runs, _ratio) for name, runs in results.items()}
    back = {name: each(runs, lambda run: _back(run)[1] / run.peak(SEEN)) for name, runs in results.items()}
    delay = {
        name: each(runs, lambda run: _back(run)[0] - float(run.waves.at(SEEN).arrival[0]))
        for name, runs in results.items()
    }
    return [
        claim(
            "How a wave is reflected depends on the mechanical properties of the wall.",
            [
                line
                for name in WALLS
                for line in engines(ratio[name], label=f"{name}: force on the wall over that in the chain: ")
            ],
            all(
                later > earlier
                for earlier, later in zip(
                    [min(one.values()) for one in ratio.values()][:-1],
                    [max(one.values()) for one in ratio.values()][1:],
                    strict=True,
                )
            ),
        ),
        claim(
            "Soft walls slow the reflection.",
            [
                line
                for name in ("rigid", "soft")
                for line in engines(delay[name], " T", 3, f"{name}: back at bead {SEEN} after: ")
            ],
            min(delay["soft"].values()) > max(delay["rigid"].values()),
        ),
        number(
            "A rigid flat wall is the mirror of a collision of equal waves in a contact: the reflected wave has "
            f"0.99852 of the peak velocity of the incident one at bead {SEEN}.",
            0.99852,
            back["rigid"],
            within=1e-4,
        ),
        number(
            "A held bead is the mirror of a collision on a bead: the reflected wave has 0.99978 of the peak velocity "
            f"of the incident one at bead {SEEN}.",
            0.99978,
            back["bead"],
            within=1e-4,
        ),
    ]


def draw(axis: Axes, results: Results) -> None:
    """Force on the walls over time."""
    for place, (name, runs) in enumerate(results.items()):
        read = runs["lammps"].forces(wall=True)
        axis.plot(read.time, read.force[:, 0, 0], color=COLOURS[place], label=name)
    axis.set_xlim(64.0, 84.0)


ENTRY = Entry(
    title="Reflection at a wall",
    introduction="A chain ends at a fixed bead, a flat wall of the same material, a rigid flat wall, or a soft one "
    "(a tenth of a contact's constant).",
    sources={
        "job2005": "could not be read",
        "przedborski2015": "abstract read",
    },
    scenes={name: chain(BEADS, 120, walls={"right": wall}) for name, wall in WALLS.items()},
    statements=statements,
    axes=("time (T)", "force on the wall"),
    draw=draw,
    caption="Force on the wall over time (LAMMPS).",
)
