"""Waves that meet: two equal ones head-on, and one with its reflection at a wall."""

from itertools import pairwise

from matplotlib.axes import Axes

from workflow.plugins.gallery.criteria import MeasuredQuantity, at_least, at_most, by_engine, near, state
from workflow.plugins.gallery.entry import Entry, Ran, Results, Statements, chain, each, line

# --- a collision of equal waves ---------------------------------------------------------------------------------------

PASSED = 80
"""Bead at which a wave is measured after the collision."""


def _both_ends(beads: int) -> dict[str, object]:
    return chain(beads, 108, kick=[{"bead": 1, "velocity": 1.0}, {"bead": beads, "velocity": -1.0}])


def _after(run: Ran) -> tuple[float, float]:
    """Arrival and velocity of the pulse that passes bead `PASSED` after the collision."""
    train = run.survey.train(1, PASSED, 0.3)
    return float(train.arrival[-1]), float(train.peak_velocity[-1])


def _lost(run: Ran) -> float:
    """Share of the energy of a wave that it loses in the collision."""
    return 1.0 - (_after(run)[1] / run.peak(35)) ** 2


def _secondary(run: Ran) -> float:
    """Velocity of the strongest pulse behind the wave, in the middle of its path."""
    pulses = run.survey.pulses_towards(1, 0.003)
    late = [pulse for pulse in pulses if pulse.bead[0] > 50 and pulse.peak_velocity.max() < 0.3]
    return max((float(pulse.peak_velocity[len(pulse) // 2]) for pulse in late), default=0.0)


def _collision(results: Results) -> Statements:
    """Energy loss, secondary waves, and phase shift."""
    alone, even, odd = (results[name] for name in ("alone", "even", "odd"))
    early = each(lambda single, two: single.arrival(PASSED) - _after(two)[0], alone, even)
    ratio = each(lambda single, other: _secondary(single) / _secondary(other), even, odd)
    secondary_odd = MeasuredQuantity("odd number of beads", each(_secondary, odd), at_least(0.0), "5 V")
    yield state(
        MeasuredQuantity("energy lost by each wave, even number of beads", each(_lost, even), at_most(0.01), "6"),
        MeasuredQuantity("odd number of beads", each(_lost, odd), at_most(0.01), "6"),
        published="Solitary waves collide almost elastically.",
        source="ahnert2009, abstract",
    )
    yield state(
        MeasuredQuantity(
            "largest velocity behind the wave, even number of beads", each(_secondary, even), at_least(0.01), "5 V"
        ),
        published="Two secondary solitary waves emerge from the region where equal waves collide.",
        source="santibanez2011, abstract",
        also=[secondary_odd.line()],
    )
    yield state(
        MeasuredQuantity("velocity for an even over that for an odd number of beads", ratio, at_least(1.0), "2"),
        published="Secondary waves are stronger in chains with an even number of beads, where waves meet in a contact.",
        source="santibanez2011, abstract",
    )
    yield state(
        MeasuredQuantity(f"arrival at bead {PASSED} before that of a single wave by", early, at_least(0.01), "3 T"),
        published="The collision introduces a phase shift.",
        source="santibanez2011, abstract",
    )


def _draw_collision(axis: Axes, results: Results) -> None:
    """A bead behind the middle over time."""
    for place, name in enumerate(("even", "odd")):
        run = results[name]["lammps"].trajectory
        axis.plot(run.time, run.velocity[:, 0, 61], label=f"{name} number of beads", **line(place))
    axis.set_ylim(-0.01, 0.06)
    axis.set_xlim(60.0, 105.0)


COLLISION = Entry(
    title="Collision of equal and opposite waves",
    introduction="Both ends of a chain of 100 or 101 beads are kicked; the waves collide in the middle.",
    sources={
        "santibanez2011": "abstract read, no numbers",
        "ahnert2009": "abstract read: nearly elastic collisions",
    },
    scenes={"even": _both_ends(100), "odd": _both_ends(101), "alone": chain(100, 108)},
    statements=_collision,
    axes=("time $t / T$", "velocity of bead 62 $v / V$"),
    draw=_draw_collision,
    caption="Velocity of bead 62, twelve beads behind the middle: after the wave (cut off) a secondary wave passes.",
)

# --- a wall -----------------------------------------------------------------------------------------------------------

WALLS: dict[str, object] = {"soft": {"stiffness": 0.1}, "bead": "bead", "flat": "flat", "rigid": "rigid"}
MIRRORS = (
    ("rigid", 0.99852, "A rigid flat wall mirrors the collision of equal waves in a contact"),
    ("bead", 0.99978, "A fixed bead mirrors the collision of equal waves on a bead"),
)
"""Wall, reflected over incident velocity, and reason."""
SEEN = 35


def _force_ratio(run: Ran) -> float:
    """Largest force on the wall over that in the chain."""
    wall, chain = run.forces(contacts=(SEEN,), wall=True).largest[0]
    return float(wall / chain)


def _back(run: Ran) -> tuple[float, float]:
    """Time from the incident to the reflected pulse at a bead, and the ratio of their velocities."""
    pulse = max(run.survey.pulses_towards(-1, 0.1), key=lambda candidate: float(candidate.peak_velocity.max()))
    at = int(list(pulse.bead).index(SEEN))
    return float(pulse.arrival[at]) - run.arrival(SEEN), float(pulse.peak_velocity[at]) / run.peak(SEEN)


def _wall(results: Results) -> Statements:
    """Force, reflected velocity, and delay."""
    ratio = {name: each(_force_ratio, runs) for name, runs in results.items()}
    soft, rigid = (each(lambda run: _back(run)[0], results[name]) for name in ("soft", "rigid"))
    yield state(
        *(
            MeasuredQuantity(
                f"{name}: force on the wall over that in the chain", ratio[name], at_least(max(ratio[softer].values()))
            )
            for softer, name in pairwise(WALLS)
        ),
        published="The reflection of a wave depends on the mechanical properties of the wall.",
        source="job2005, as quoted",
        derived="The stiffer the wall, the larger the force on it; required is more than on the softer one.",
        also=by_engine(ratio["soft"], "{:.5f}".format, "soft, "),
    )
    yield state(
        MeasuredQuantity(f"time to return to bead {SEEN}, soft", soft, at_least(max(rigid.values())), "3 T"),
        published="Soft walls slow the reflection.",
        source="przedborski2015, abstract",
        also=by_engine(rigid, "{:.3f} T".format, "rigid, "),
    )
    for wall, value, says in MIRRORS:
        back = each(lambda run: _back(run)[1], results[wall])
        yield state(
            MeasuredQuantity("reflected over incident velocity", back, near(value, 1e-4)),
            derived=f"{says}: by mirror symmetry the reflected wave has {value} of the velocity of the incident "
            f"one at bead {SEEN}, as in the entry on collisions.",
        )


def _draw_wall(axis: Axes, results: Results) -> None:
    """Force on the walls over time."""
    for place, (name, runs) in enumerate(results.items()):
        read = runs["lammps"].forces(wall=True)
        axis.plot(read.time, read.force[:, 0, 0], label=name, **line(place))
    axis.set_xlim(64.0, 84.0)


WALL = Entry(
    title="Reflection at a wall",
    introduction="A chain ends at a fixed bead, a flat wall of the same material, a rigid flat wall, or a soft one "
    "(a tenth of a contact's constant).",
    sources={
        "job2005": "could not be read",
        "przedborski2015": "abstract read",
    },
    scenes={name: chain(60, 120, walls={"right": wall}) for name, wall in WALLS.items()},
    statements=_wall,
    axes=("time $t / T$", "force on the wall $F / (m V / T)$"),
    draw=_draw_wall,
    caption="Force on the wall over time (LAMMPS).",
)
