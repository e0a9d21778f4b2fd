"""Beats of two chains under a static load as a sum of two modes; computed by `workflow.plugins.modes`."""

import functools
import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from workflow.plugins.gallery.criteria import MeasuredQuantity, at_least, at_most, near, state
from workflow.plugins.gallery.entry import Entry, Ran, Results, Statements, chain, each, line
from workflow.plugins.gallery.periodic_family import COMPUTED
from workflow.plugins.modes.family import PeriodicFamily, follow

LOAD = {"force": 1.0}
STIFFNESS = 1.5
"""Slope k of a contact at rest under that load."""

KAPPA = 0.02
PAIR: dict[str, Any] = {
    "chains": 2,
    "precompression": LOAD,
    "walls": {"left": "rigid", "right": "rigid"},
    "foundation": {"stiffness": 1.0},
    "coupling": {"stiffness": KAPPA},
}
IN_PHASE = math.sqrt(1.0 + 4.0 * STIFFNESS)
BEAT = math.sqrt(1.0 + 4.0 * STIFFNESS + 2.0 * KAPPA) - IN_PHASE
"""Difference of the linear frequencies of the modes in which neighbours move oppositely."""

SPEEDS = {"weak": 0.1, "strong": 0.75, "trapped": 0.95}
"""Scene -> velocity with which bead 1 of chain 1 is kicked, bead 2 oppositely; its square is the energy."""


def _kicked(speed: float) -> dict[str, Any]:
    kicks = [{"bead": 1, "velocity": speed}, {"bead": 2, "velocity": -speed}]
    return chain(2, 2500.0, timestep=0.01, every=2.0, kick=kicks, **PAIR)


@functools.cache
def _pair(mode: int) -> PeriodicFamily:
    """Branch of one of the two modes: -2 in phase, -1 out of phase."""
    return follow(chain(2, 1.0, name="pair", **PAIR), mode, 0.6)


def _threshold() -> float:
    """Energy at which the in-phase mode loses its stability; NaN where it does not."""
    changes = _pair(-2).changes("+1")
    return 0.5 * sum(changes[0]["energies"]) if changes else math.nan


def _slowing(speed: float) -> float:
    """Frequency of the exchange over that of weak motion, for two oscillators with a cubic force, by averaging."""
    from scipy.special import ellipk

    return float(0.5 * math.pi / ellipk((0.5 * speed**2 / _threshold()) ** 2))


def _exchange(run: Ran) -> float:
    """Angular frequency of the exchange: half periods are between instants at which both chains have one half."""
    time, excess = run.flow.time * run.problem.scale.time, run.flow.share[:, 1] - 0.5
    before = np.flatnonzero(excess[:-1] * excess[1:] < 0.0)
    if len(before) < 2:
        return math.nan
    crossings = time[before] - excess[before] * np.diff(time)[before] / np.diff(excess)[before]
    return float(math.pi / np.polyfit(np.arange(len(crossings)), crossings, 1)[0])


def _largest(run: Ran) -> float:
    """Largest share of the energy in chain 2."""
    return run.flow.extremes(1)[1][0]


def _mode_beats(results: Results) -> Statements:
    """Frequency of the exchange against those of the modes, and where the exchange ends."""
    linear = [float(_pair(-1).linear.frequency[mode]) for mode in (-2, -1)]
    frequencies = [
        np.interp(0.5 * SPEEDS["weak"] ** 2, _pair(mode).values("energy"), _pair(mode).frequency) for mode in (-2, -1)
    ]
    between, slower = float(frequencies[1] - frequencies[0]), _slowing(SPEEDS["strong"]) * BEAT
    trap = 2.0 * _threshold()
    yield state(
        MeasuredQuantity(
            "difference of the linear frequencies", {COMPUTED: linear[1] - linear[0]}, near(BEAT, 1e-9), "7"
        ),
        MeasuredQuantity("frequency of the exchange", each(_exchange, results["weak"]), near(BEAT, 1e-3 * BEAT), "7"),
        derived="The chains in phase and out of phase have the frequencies sqrt(k_f + 4 k) and sqrt(k_f + 4 k + 2 "
        f"kappa); weak motion of one chain is the sum of both, and the energy is exchanged at their difference, "
        f"{BEAT:.7f}; required within 0.1%.",
    )
    yield state(
        MeasuredQuantity(
            "frequency of the exchange", each(_exchange, results["weak"]), near(between, 1e-3 * between), "7"
        ),
        derived=f"The periodic states in phase and out of phase of half the energy each differ by {between:.7f}.",
    )
    yield state(
        MeasuredQuantity(
            "frequency of the exchange", each(_exchange, results["strong"]), near(slower, 0.03 * slower), "6"
        ),
        derived="By averaging, two oscillators that soften exchange all of the energy E at the frequency "
        f"{BEAT:.6f} pi / (2 K(E / E_t)), with the complete elliptic integral K of that modulus, up to E_t, twice the "
        f"energy at which the in-phase mode loses its stability, {_threshold():.4f}: {slower:.6f} at E / E_t = "
        f"{SPEEDS['strong'] ** 2 / trap:.2f}; required within 3%, as averaging is of first order.",
    )
    yield state(
        MeasuredQuantity("largest share of chain 2 below", each(_largest, results["strong"]), at_least(0.95), "3"),
        MeasuredQuantity("largest share of chain 2 above", each(_largest, results["trapped"]), at_most(0.5), "3"),
        derived=f"Above E_t = {trap:.4f} more than half of the energy stays in the kicked chain: E / E_t = "
        f"{SPEEDS['strong'] ** 2 / trap:.2f} and {SPEEDS['trapped'] ** 2 / trap:.2f}.",
    )


def _draw_mode_beats(axis: Axes, results: Results) -> None:
    """Share of the second chain over time."""
    for number, (name, speed) in enumerate(SPEEDS.items()):
        run = results[name]["lammps"]
        label = f"energy {speed**2:.3g}"
        axis.plot(run.flow.time * run.problem.scale.time, run.flow.share[:, 1], label=label, **line(number))
    axis.set_ylim(0.0, 1.35)


MODE_BEATS = Entry(
    title="Beats as a sum of two modes",
    introduction="Two chains of two beads on foundations of stiffness 1, under a static force of 1 between rigid "
    f"walls, coupled by springs of {KAPPA:g}; the beads of chain 1 are kicked oppositely.",
    sources={"starosvetsky2012": "could not be read; all numbers are derived here"},
    scenes={name: _kicked(speed) for name, speed in SPEEDS.items()},
    statements=_mode_beats,
    axes=("time $t$ (reduced)", "share of the energy in chain 2"),
    draw=_draw_mode_beats,
    caption="Share of the energy in the chain that was not kicked, in LAMMPS; the exchange ends at the energy of twice "
    "that at which the in-phase mode becomes unstable.",
)
