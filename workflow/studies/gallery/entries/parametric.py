"""Beads on a foundation whose stiffness is modulated: oscillations grow near twice their frequency."""

import functools
import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from workflow.studies.gallery.criteria import NAMES, Measured, near, state
from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Ran, Results, each
from workflow.studies.page import Statement

GROUND, DEPTH = 1.0, 0.1
OFFSETS = (-0.07, -0.045, -0.03, -0.015, 0.015, 0.03, 0.045, 0.07)
"""Of the angular frequency of the modulation from twice that of the beads; the runs at 0 are by both engines."""

PERIODS, FRAMES = 12, 4
"""Of the modulation in a run, and frames in each."""


def first_order(offset: float) -> float:
    """Rate at which the amplitude grows; 0 outside the resonance."""
    return 0.5 * math.sqrt(max(0.0, (0.5 * DEPTH * math.sqrt(GROUND)) ** 2 - offset**2))


def _name(offset: float) -> str:
    return f"modulated-at-{2.0 + offset:g}"


def _period(offset: float) -> float:
    return 2.0 * math.pi / (2.0 * math.sqrt(GROUND) + offset)


@functools.cache
def floquet(offset: float) -> float:
    """The rate from the trace of the monodromy matrix of one bead, by scipy's DOP853."""
    from scipy.integrate import solve_ivp

    period = _period(offset)

    def rates(time: float, state: Any) -> list[float]:
        stiffness = GROUND * (1.0 + DEPTH * math.sin(2.0 * math.pi * time / period))
        return [state[1], -stiffness * state[0], state[3], -stiffness * state[2]]

    end = solve_ivp(rates, (0.0, period), [1.0, 0.0, 0.0, 1.0], "DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
    return _rate(float(end[0] + end[3]), period)


def _rate(trace: float, period: float) -> float:
    return math.acosh(max(1.0, 0.5 * abs(trace))) / period


def scene(offset: float) -> dict[str, Any]:
    """Two beads that are kicked alike, so that their contact is never loaded."""
    period = _period(offset)
    return {
        "beads": 2,
        "foundation": {"stiffness": GROUND, "modulation": {"depth": DEPTH, "frequency": 1.0 / period}},
        "kick": [{"bead": 1, "velocity": 1.0}, {"bead": 2, "velocity": 1.0}],
        "duration": PERIODS * period,
        "timestep": period / 1000.0,
        "output": {"every": period / FRAMES},
    }


CHAIN = {
    "beads": 60,
    "foundation": {"stiffness": 0.2, "modulation": {"depth": 0.5, "frequency": 0.2}},
    "kick": {"velocity": 1.0},
    "duration": 60.0,
    "timestep": 0.001,
    "output": {"every": 0.5},
}
CHAIN_ENERGY = 0.668106
"""Kinetic energy of this chain at its end, by scipy's DOP853."""


def _growth(run: Ran) -> float:
    """States a period apart follow s'' = trace s' - s, whatever the start."""
    velocity = run.trajectory.velocity[::FRAMES, 0, 0]
    middle, sides = velocity[1:-1], velocity[2:] + velocity[:-2]
    return _rate(float(np.sum(middle * sides) / np.sum(middle * middle)), _period_of(run))


def _period_of(run: Ran) -> float:
    return FRAMES * run.problem.every * run.problem.scale.time


def _kinetic(run: Ran) -> float:
    return float(0.5 * np.sum(run.trajectory.velocity[-1] ** 2))


def statements(results: Results) -> list[Statement]:
    """Rate of growth at the resonance and beside it, and a chain with contacts."""
    rate = each(results["resonance"], _growth)
    beside = [_growth(results[_name(offset)]["reference"]) - floquet(offset) for offset in OFFSETS]
    return [
        state(
            Measured("rate of growth of the amplitude", rate, near(first_order(0.0), 1e-3 * first_order(0.0)), "8"),
            published="The amplitude grows as exp(s t), s = h omega_0 / 4 at twice the frequency omega_0, to first "
            "order in the depth h of the modulation of omega^2.",
            source="landau1976",
            derived=f"s = e sqrt(k_0) / 4 = {first_order(0.0):g}; required within 0.1%.",
        ),
        state(
            Measured("rate of growth of the amplitude", rate, near(floquet(0.0), 2e-7), "8"),
            derived=f"The monodromy matrix of one bead gives {floquet(0.0):.8f} (Floquet).",
        ),
        state(
            Measured("largest difference from Floquet", {"reference": max(map(abs, beside))}, near(0.0, 1e-6), "1e"),
            derived="Beside the resonance, and outside of it, where nothing grows.",
        ),
        state(
            Measured("kinetic energy at the end", each(results["chain"], _kinetic), near(CHAIN_ENERGY, 5e-6), "6"),
            derived=f"A chain of 60 beads in contact, k = 0.2, e = 0.5, f = 0.2: {CHAIN_ENERGY:g} at t = 60, by "
            "another integrator.",
        ),
    ]


def draw(axis: Axes, results: Results) -> None:
    """Rate of growth over the frequency of the modulation."""
    fine = np.linspace(1.1 * OFFSETS[0], 1.1 * OFFSETS[-1], 400)
    axis.plot(2.0 + fine, [first_order(offset) for offset in fine], label="first order", **PUBLISHED)
    found = [_growth(results[_name(offset)]["reference"]) for offset in OFFSETS]
    axis.plot(2.0 + np.array(OFFSETS), found, "o", color=COLOURS[1], label=NAMES["reference"])
    axis.plot(2.0, _growth(results["resonance"]["lammps"]), "o", color=COLOURS[0], label=NAMES["lammps"])


ENTRY = Entry(
    title="Parametric growth on a modulated foundation",
    introduction="The stiffness of a foundation is modulated near twice the frequency of the beads on it: their "
    "oscillations grow exponentially, by the work of the ground.",
    sources={"landau1976": "textbook: parametric resonance"},
    scenes={"resonance": scene(0.0), "chain": CHAIN},
    swept={_name(offset): scene(offset) for offset in OFFSETS},
    statements=statements,
    axes=("angular frequency of the modulation / that of the beads", "rate of growth of the amplitude (reduced)"),
    draw=draw,
    caption="Rate of growth over the frequency of the modulation; the line is the theory of first order in the depth.",
)
