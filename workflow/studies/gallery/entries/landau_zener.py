"""Two coupled chains whose foundations change in opposite directions: the share of the action that stays in a chain."""

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from workflow.studies.gallery.criteria import NAMES, Measured, near, state
from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Ran, Results, each
from workflow.studies.page import Statement

GROUND, COUPLING, SWEEP = 1.0, 0.02, 0.8
"""Stiffness of the foundations where they cross, of the springs, and difference of the foundations at either end."""

RATE = 0.002
RATES = (0.0007, 0.001, 0.0014, 0.004, 0.008)
"""Of that difference: of the runs by both engines, and of those by the reference alone."""

BEADS = 3


def formula(rate: float) -> float:
    """Share of the action that stays."""
    return math.exp(-math.pi * COUPLING**2 / (math.sqrt(GROUND + COUPLING) * rate))


def scene(rate: float, *, mode: bool, every: float) -> dict[str, Any]:
    """All beads of chain 1 are kicked alike, so that no contact is loaded; in the mode those of chain 2 are, too."""
    low, high = GROUND - 0.5 * SWEEP, GROUND + 0.5 * SWEEP
    duration = 2.0 * SWEEP / rate
    slower = np.linalg.eigh([[low + COUPLING, -COUPLING], [-COUPLING, high + COUPLING]])[1][:, 0]
    kicks = [1.0, float(slower[1] / slower[0])] if mode else [1.0]
    times = [0.0, duration]
    return {
        "chains": 2,
        "beads": BEADS,
        "coupling": {"stiffness": COUPLING},
        "foundation": {
            "stiffness": [{"from": low, "to": high, "times": times}, {"from": high, "to": low, "times": times}]
        },
        "kick": [
            {"chain": chain, "bead": bead, "velocity": velocity}
            for chain, velocity in enumerate(kicks, 1)
            for bead in range(1, BEADS + 1)
        ],
        "duration": duration,
        "timestep": 0.02,
        "output": {"every": every},
    }


def _stays(run: Ran) -> float:
    """Chain 1 has the slower mode at the start, and the faster one at the end."""
    found = run.flow.fastest_mode_action
    return math.nan if found is None else found


def statements(results: Results) -> list[Statement]:
    """Share of the action that stays, from a pure mode and from a kick of one chain, and over the rate."""
    expected = formula(RATE)
    finite = 2.0 * COUPLING / SWEEP * math.sqrt(expected * (1.0 - expected))
    mode, kick = (each(results[name], _stays) for name in ("mode", "kick"))
    swept = {f"rate {rate:g}": _stays(results[f"rate-{rate:g}"]["reference"]) / formula(rate) for rate in RATES}
    return [
        state(
            Measured("share of the action that stays", mode, near(expected, 0.003 * expected), "6"),
            published="A classical analog of the Landau-Zener formula holds for two coupled oscillators.",
            source="novotny2010, abstract",
            derived="From a pure mode of the coupled pair, exp(-pi kappa^2 / (omega_0 alpha)) of the action E / omega "
            f"stays in the chain, {expected:.6f} here, with omega_0^2 = k_0 + kappa and the rate alpha of k_1 - k_2; "
            "required within 0.3%, for a sweep of k_1 - k_2 from -D to D with D = 40 kappa.",
        ),
        state(
            Measured("share of the action that stays", kick, near(expected, 0.003 * expected, 1.05 * finite), "6"),
            derived="The same where chain 1 alone is kicked.",
            correction="Its beads then are not in a pure mode: the finite start adds up to "
            f"2 (kappa / D) sqrt(P (1 - P)) = {finite:.3f}.",
        ),
        state(
            Measured("largest share over the formula's", {"reference": max(swept.values())}, near(1.0, 0.003), "5"),
            Measured("smallest share over the formula's", {"reference": min(swept.values())}, near(1.0, 0.003), "5"),
            derived=f"Likewise from a pure mode at rates from {RATES[0]:g} to {RATES[-1]:g}.",
        ),
    ]


def draw(axis: Axes, results: Results) -> None:
    """Share of the action over the rate."""
    rates = np.geomspace(0.5 * RATES[0], 2.0 * RATES[-1], 100)
    axis.semilogx(rates, [formula(rate) for rate in rates], label="Landau-Zener", **PUBLISHED)
    found = [_stays(results[f"rate-{rate:g}"]["reference"]) for rate in RATES]
    axis.semilogx(RATES, found, "o", color=COLOURS[1], label=NAMES["reference"])
    for name, marker in (("mode", "o"), ("kick", "s")):
        share = _stays(results[name]["lammps"])
        axis.semilogx(RATE, share, marker, color=COLOURS[0], label=f"{NAMES['lammps']}, {name}")


ENTRY = Entry(
    title="Landau-Zener tunnelling between two chains",
    introduction="Two weakly coupled chains on foundations, one of which stiffens while the other softens: where "
    "they cross, part of the action goes over to the other chain. All beads of a chain are kicked alike, so that its "
    "contacts are never loaded.",
    sources={
        "zener1932": "could not be read; the formula as stated by novotny2010 and textbooks",
        "novotny2010": "abstract read: derives a classical analog of the formula",
    },
    scenes={
        "mode": scene(RATE, mode=True, every=2.0),
        "kick": scene(RATE, mode=False, every=2.0),
    },
    swept={f"rate-{rate:g}": scene(rate, mode=True, every=2.0) for rate in RATES},
    statements=statements,
    axes=("rate of the difference of the stiffnesses (reduced)", "share of the action that stays"),
    draw=draw,
    caption="Share of the action that stays in the chain over the rate at which the foundations change.",
)
