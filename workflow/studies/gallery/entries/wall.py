"""A wave is reflected by a wall."""

from itertools import pairwise

from matplotlib.axes import Axes

from workflow.studies.gallery.criteria import NAMES, Measured, at_least, near, state
from workflow.studies.gallery.entry import COLOURS, Entry, Ran, Results, chain, each
from workflow.studies.page import Statement

WALLS: dict[str, object] = {"soft": {"stiffness": 0.1}, "bead": "bead", "flat": "flat", "rigid": "rigid"}
MIRRORS = (
    ("rigid", 0.99852, "A rigid flat wall mirrors the collision of equal waves in a contact"),
    ("bead", 0.99978, "A fixed bead mirrors the collision of equal waves on a bead"),
)
"""Wall, reflected over incident velocity, and why."""
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
    """Force, reflected velocity, and delay."""
    ratio = {name: each(runs, _ratio) for name, runs in results.items()}
    back = {name: each(runs, lambda run: _back(run)[1] / run.peak(SEEN)) for name, runs in results.items()}
    delay = {
        name: each(runs, lambda run: _back(run)[0] - float(run.waves.at(SEEN).arrival[0]))
        for name, runs in results.items()
    }
    return [
        state(
            *(
                Measured(
                    f"{name}: force on the wall over that in the chain",
                    ratio[name],
                    at_least(max(ratio[softer].values())),
                )
                for softer, name in pairwise(WALLS)
            ),
            published="The reflection of a wave depends on the mechanical properties of the wall.",
            source="job2005, as quoted",
            derived="The stiffer the wall, the larger the force on it; required is more than on the softer one.",
            also=[f"soft, {NAMES[engine]}: {value:.5f}" for engine, value in ratio["soft"].items()],
        ),
        state(
            Measured(
                f"time to return to bead {SEEN}, soft", delay["soft"], at_least(max(delay["rigid"].values())), "3 T"
            ),
            published="Soft walls slow the reflection.",
            source="przedborski2015, abstract",
            also=[f"rigid, {NAMES[engine]}: {value:.3f} T" for engine, value in delay["rigid"].items()],
        ),
        *(
            state(
                Measured("reflected over incident velocity", back[wall], near(value, 1e-4)),
                derived=f"{says}: by mirror symmetry the reflected wave has {value} of the velocity of the incident "
                f"one at bead {SEEN}, as in the entry on collisions.",
            )
            for wall, value, says in MIRRORS
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
    axes=("time (T)", "force on the wall (m V / T)"),
    draw=draw,
    caption="Force on the wall over time (LAMMPS).",
)
