"""Dashpots in the contacts: a pulse that decays, and a second, broad one behind it."""

import numpy as np
from matplotlib.axes import Axes

from workflow.studies.gallery.criteria import NAMES, Measured, at_most, near, state
from workflow.studies.gallery.entry import COLOURS, Entry, Ran, Results, chain, each
from workflow.studies.page import Statement

WEAK, TWO_WAVES, STRONG = 0.002, 0.02, 1.0
WHEN = 120.0


def _name(damping: float) -> str:
    return f"damping-{damping:g}"


def _tops(run: Ran) -> list[tuple[int, float]]:
    """Beads at which the velocity over distance has a maximum, some time after the kick, the first one in front."""
    frame = int(np.argmin(np.abs(run.trajectory.time - WHEN)))
    row = run.trajectory.velocity[frame, 0]
    tops = np.flatnonzero((row[1:-1] > row[:-2]) & (row[1:-1] >= row[2:]) & (row[1:-1] > 5e-3)) + 1
    return [(int(place) + 1, float(row[place])) for place in tops[::-1]]


def _decay(run: Ran) -> float:
    """Slope of the peak velocity to the power 1/5 over beads, over the coefficient of the dashpots."""
    beads = np.arange(40, 101)
    return float(np.polyfit(beads, [run.peak(int(bead)) ** 0.2 for bead in beads], 1)[0]) / WEAK


def statements(results: Results) -> list[Statement]:
    """Weak damping, the second wave, strong damping."""
    tops = {
        damping: {engine: _tops(run) for engine, run in results[_name(damping)].items()}
        for damping in (TWO_WAVES, STRONG)
    }
    lines = {
        damping: [
            f"{NAMES[engine]}: " + ", ".join(f"{v:.4f} V at bead {b}" for b, v in one) for engine, one in found.items()
        ]
        for damping, found in tops.items()
    }
    count = {damping: {engine: float(len(one)) for engine, one in found.items()} for damping, found in tops.items()}
    second = {engine: one[-1][1] / one[0][1] for engine, one in tops[TWO_WAVES].items()}
    return [
        state(
            Measured("maxima of the velocity along the chain", count[TWO_WAVES], near(2.0, 0.0), "0"),
            Measured("last over first maximum", second, at_most(1.0), "3"),
            published="At low viscosity the disturbance has two parts: an attenuating solitary wave and a broad "
            "wave behind it.",
            source="rosas2008, abstract",
            derived=f"Here at a coefficient of {TWO_WAVES:g}.",
            also=lines[TWO_WAVES],
        ),
        state(
            Measured("maxima of the velocity along the chain", count[STRONG], near(1.0, 0.0), "0"),
            published="Beyond a critical viscosity the two waves merge into one with a monotonic front.",
            source="rosas2007, abstract",
            derived=f"Here at a coefficient of {STRONG:g}; the critical value is not in the abstract.",
            also=lines[STRONG],
        ),
        state(
            Measured("slope over the coefficient", each(results[_name(WEAK)], _decay), near(-0.10586, 1e-3, 2e-3)),
            derived="For weak damping the peak velocity to the power 1/5 falls linearly along the chain, by 0.10586 "
            f"times the coefficient a bead (exact wave; here {WEAK:g}).",
            correction="Derived for vanishing damping; at this one the amplitude lost is 1% less.",
        ),
    ]


def draw(axis: Axes, results: Results) -> None:
    """Velocity over distance."""
    for place, damping in enumerate((TWO_WAVES, STRONG)):
        run = results[_name(damping)]["lammps"].trajectory
        frame = int(np.argmin(np.abs(run.time - WHEN)))
        axis.semilogy(
            run.beads, np.maximum(run.velocity[frame, 0], 1e-4), color=COLOURS[place], label=f"damping {damping:g}"
        )


ENTRY = Entry(
    title="Dissipation: a second wave",
    introduction="Linear dashpots in the contacts of a kicked chain.",
    sources={
        "rosas2007": "abstract read",
        "rosas2008": "abstract read; the critical viscosity is not in it",
    },
    scenes={_name(damping): chain(140, 130, damping={"contact": damping}) for damping in (WEAK, TWO_WAVES, STRONG)},
    statements=statements,
    axes=("bead", f"velocity at t = {WHEN:g} T (V)"),
    draw=draw,
    caption="Velocity along the chain: a narrow pulse and a broad one behind it, or a single one (LAMMPS).",
)
