"""Heavy strikers and several beads kicked at once: trains of solitary waves."""

import numpy as np
from matplotlib.axes import Axes

from analysis.trajectory import Floats
from workflow.studies.gallery.criteria import NAMES, Measured, at_least, at_most, near, state
from workflow.studies.gallery.entry import COLOURS, Entry, Results, Runs, chain
from workflow.studies.page import Statement

BEAD = 110
LEAST = 0.05


def _launched(count: int) -> dict[str, object]:
    return chain(200, 220, kick=[{"bead": bead, "velocity": 1.0} for bead in range(1, count + 1)])


def statements(results: Results) -> list[Statement]:
    """As many waves as beads; a heavy striker's decrease, nearly geometrically."""
    trains = {name: _train(runs) for name, runs in results.items()}
    count = {name: {engine: float(len(one)) for engine, one in found.items()} for name, found in trains.items()}
    lines = {
        name: [f"{NAMES[engine]}: " + ", ".join(f"{v:.5f}" for v in one) + " V" for engine, one in found.items()]
        for name, found in trains.items()
    }
    ratios = {engine: one[1:] / one[:-1] for engine, one in trains["striker-4"].items()}
    spread = {engine: float(np.ptp(one) / np.mean(one)) for engine, one in ratios.items()}
    steepest = {engine: float(one.max()) for engine, one in ratios.items()}
    return [
        *(
            state(
                Measured("number of waves", count[f"launched-{beads}"], near(float(beads), 0.0), "0"),
                published="When m grains hit a chain, m solitons are generated.",
                source="multisoliton2003, abstract",
                derived=f"m = {beads}; counted at bead {BEAD}, from {LEAST} V on.",
                also=lines[f"launched-{beads}"],
            )
            for beads in (2, 3)
        ),
        state(
            Measured("number of waves", count["striker-4"], at_least(4.0), "0"),
            Measured("largest ratio of a wave to the one before", steepest, at_most(1.0), "3"),
            published="The impact of a large striker generates a train of solitary waves ordered by decreasing "
            "amplitude.",
            source="job2007, abstract",
            also=lines["striker-4"],
        ),
        state(
            Measured("range of the ratios over their mean", spread, at_most(0.1, 0.25), "3"),
            published="The force at the end of the chain unloads nearly exponentially.",
            source="job2007, abstract",
            derived="Velocities of the train form nearly a geometric series.",
            correction=f"Ratios differ by {spread['reference']:.0%}.",
            also=["ratios " + ", ".join(f"{value:.3f}" for value in ratios["reference"])],
        ),
    ]


def _train(runs: Runs) -> dict[str, Floats]:
    """Velocities of the waves that pass bead `BEAD`, by engine."""
    return {engine: run.train(BEAD, LEAST).peak_velocity for engine, run in runs.items()}


def draw(axis: Axes, results: Results) -> None:
    """Velocity of a bead over time."""
    for place, (name, runs) in enumerate(results.items()):
        run = runs["lammps"].trajectory
        axis.plot(run.time, run.velocity[:, 0, BEAD - 1], color=COLOURS[place], label=name)
    axis.set_xlim(100.0, 220.0)


ENTRY = Entry(
    title="Trains of waves from heavy strikers",
    introduction="A striker of four beads' mass, and two or three beads launched together.",
    sources={
        "multisoliton2003": "abstract read; authors not known here",
        "job2007": "abstract read",
    },
    scenes={
        "striker-4": chain(200, 220, striker={"mass": 4, "velocity": 1}),
        "launched-2": _launched(2),
        "launched-3": _launched(3),
    },
    statements=statements,
    axes=("time (T)", f"velocity of bead {BEAD} (V)"),
    draw=draw,
    caption=f"Velocity of bead {BEAD} as trains pass it (LAMMPS).",
)
