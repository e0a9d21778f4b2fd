"""Heavy strikers and several beads hit at once: trains of solitary waves."""

import numpy as np
from matplotlib.axes import Axes

from workflow.studies.gallery.entry import COLOURS, Entry, Results, Statement, chain, claim

BEAD = 110
LEAST = 0.05


def _launched(count: int) -> dict[str, object]:
    return chain(200, 220, kick=[{"bead": bead, "velocity": 1.0} for bead in range(1, count + 1)])


def statements(results: Results) -> list[Statement]:
    """As many waves as beads; a heavy striker's decrease, nearly geometrically."""
    counted = {name: {engine: run.train(BEAD, LEAST) for engine, run in runs.items()} for name, runs in results.items()}
    lines = {
        name: [
            f"{engine}: " + ", ".join(f"{v:.5f}" for v in train.peak_velocity) + " V" for engine, train in found.items()
        ]
        for name, found in counted.items()
    }
    train = counted["striker-4"]["reference"].peak_velocity
    ratio = train[1:] / train[:-1]
    return [
        *(
            claim(
                f"{count} striking beads make {count} solitary waves.",
                lines[f"launched-{count}"],
                all(len(found) == count for found in counted[f"launched-{count}"].values()),
                f"Counted at bead {BEAD}, from {LEAST} V on.",
            )
            for count in (2, 3)
        ),
        claim(
            "A heavy striker makes a train of solitary waves, each weaker than the one before.",
            lines["striker-4"],
            all(
                len(found) > 3 and bool(np.all(np.diff(found.peak_velocity) < 0))
                for found in counted["striker-4"].values()
            ),
        ),
        claim(
            "The striker unloads nearly exponentially: velocities of the train form nearly a geometric series.",
            ["ratios " + ", ".join(f"{value:.3f}" for value in ratio)],
            float(np.ptp(ratio)) < 0.1 * float(np.mean(ratio)),
            f"Ratios differ by {np.ptp(ratio) / np.mean(ratio):.0%}.",
            partly=float(np.ptp(ratio)) < 0.25 * float(np.mean(ratio)),
        ),
    ]


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
    caption="Trains past one bead (LAMMPS).",
)
