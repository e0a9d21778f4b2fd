"""Beads on foundations: beats between two chains, a modulated stiffness, and stiffnesses that cross in time."""

import functools
import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from workflow.plugins.gallery.criteria import NAMES, MeasuredQuantity, at_least, at_most, near, state
from workflow.plugins.gallery.entry import COLOURS, PUBLISHED, Entry, Ran, Results, Statements, chain, each, line

# --- beats ------------------------------------------------------------------------------------------------------------

HALF_BEAT = math.pi / (math.sqrt(1.0 + 2.0 * 0.1) - math.sqrt(1.0))
"""Time in which two oscillators exchange their energy: foundations of stiffness 1, coupled by 0.1."""


BEATING: dict[str, Any] = {"chains": 2, "coupling": {"stiffness": 0.1}, "foundation": {"stiffness": 1.0}}


def _returned(run: Ran) -> float:
    """Smallest share of the energy in chain 2 after the largest."""
    share = run.flow.share[:, 1]
    return float(share[int(share.argmax()) :].min())


def _beats(results: Results) -> Statements:
    """Largest share of the energy that is exchanged, and its time."""
    runs = results["beats"]
    share = each(lambda run: run.flow.extremes(1)[1][0], runs)
    when = each(lambda run: run.flow.extremes(1)[1][1] * run.problem.scale.time, runs)
    yield state(
        MeasuredQuantity("largest share of the chain that was not kicked", share, at_least(0.95), "4"),
        MeasuredQuantity("smallest share after that", each(_returned, runs), at_most(0.05), "4"),
        published="Weakly coupled chains on elastic foundations exchange energy in beats.",
        source="starosvetsky2012, title",
        derived="Required: 95% of the energy is exchanged, and 95% returns.",
    )
    yield state(
        MeasuredQuantity("time of the largest share", when, near(HALF_BEAT, 0.25, 0.1 * HALF_BEAT), "2"),
        derived="Two linear oscillators, coupled alike, exchange their energy in pi / (sqrt(k_f + 2 k) - "
        f"sqrt(k_f)) = {HALF_BEAT:.1f}; required within one frame.",
        correction="It is later: contacts press on the beads while the pulse spreads.",
    )


def _draw_beats(axis: Axes, results: Results) -> None:
    """Share of the second chain over time."""
    for place, (engine, run) in enumerate(results["beats"].items()):
        time = run.flow.time * run.problem.scale.time
        axis.plot(time, run.flow.share[:, 1], label=NAMES[engine], **line(place))
    axis.axvline(HALF_BEAT, label="half a beat of two oscillators", **PUBLISHED)


BEATS = Entry(
    title="Beats on a foundation",
    introduction="Two chains in an elastic matrix (each bead on a spring of stiffness 1), coupled by springs of "
    "0.1; bead 1 of chain 1 is kicked with 0.1.",
    sources={"starosvetsky2012": "could not be read; the exchange time is that of two linear oscillators"},
    scenes={"beats": chain(40, 80, timestep=None, every=0.25, kick={"velocity": 0.1}, **BEATING)},
    statements=_beats,
    axes=("time $t$ (reduced)", "share of the energy in chain 2"),
    draw=_draw_beats,
    caption="Share of the energy in the chain that was not kicked.",
)

# --- parametric growth ------------------------------------------------------------------------------------------------

DEPTH = 0.1
OFFSETS = {
    f"modulated-at-{2.0 + offset:g}": offset for offset in (-0.07, -0.045, -0.03, -0.015, 0.015, 0.03, 0.045, 0.07)
}
"""Scene -> angular frequency of the modulation minus 2, twice that of the beads; both engines run that at 0."""

PERIODS, FRAMES = 12, 4
"""Number of periods of the modulation in a run, and number of frames in each."""


def _first_order(offset: float) -> float:
    """Rate of growth of the amplitude, to first order in the depth; 0 outside the resonance."""
    return 0.5 * math.sqrt(max(0.0, (0.5 * DEPTH) ** 2 - offset**2))


def _period(offset: float) -> float:
    return 2.0 * math.pi / (2.0 + offset)


def _rate(trace: float, period: float) -> float:
    """Rate of growth of the amplitude, from the trace of the matrix that maps a state to that a period later."""
    return math.acosh(max(1.0, 0.5 * abs(trace))) / period


@functools.cache
def _floquet(offset: float) -> float:
    """Rate of growth from the monodromy matrix of one bead, by scipy's DOP853."""
    from scipy.integrate import solve_ivp

    period = _period(offset)

    def rates(time: float, state: Any) -> list[float]:
        stiffness = 1.0 + DEPTH * math.sin(2.0 * math.pi * time / period)
        return [state[1], -stiffness * state[0], state[3], -stiffness * state[2]]

    end = solve_ivp(rates, (0.0, period), [1.0, 0.0, 0.0, 1.0], "DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
    return _rate(float(end[0] + end[3]), period)


def _modulated(offset: float) -> dict[str, Any]:
    """Scene of two beads that are kicked alike, so that their contact is never loaded."""
    period = _period(offset)
    ground = {"stiffness": 1.0, "modulation": {"depth": DEPTH, "frequency": 1.0 / period}}
    kicks = [{"bead": bead, "velocity": 1.0} for bead in (1, 2)]
    times = {"timestep": period / 1000.0, "every": period / FRAMES}
    return chain(2, PERIODS * period, foundation=ground, kick=kicks, **times)


GROUND = {"stiffness": 0.2, "modulation": {"depth": 0.5, "frequency": 0.2}}
CHAIN = chain(60, 60.0, timestep=0.001, every=0.5, foundation=GROUND)
CHAIN_ENERGY = 0.668106
"""Kinetic energy of this chain at its end, by scipy's DOP853."""


def _growth(run: Ran) -> float:
    """Rate of growth in a run: states s, s', s'' a period apart satisfy s'' = trace s' - s, whatever the start."""
    velocity = run.trajectory.velocity[::FRAMES, 0, 0]
    middle, sides = velocity[1:-1], velocity[2:] + velocity[:-2]
    period = FRAMES * run.problem.every * run.problem.scale.time
    return _rate(float(np.sum(middle * sides) / np.sum(middle * middle)), period)


def _parametric(results: Results) -> Statements:
    """Rate of growth at the resonance and beside it, and a chain with contacts."""
    rate, first = each(_growth, results["resonance"]), _first_order(0.0)
    beside = max(abs(_growth(results[name]["reference"]) - _floquet(offset)) for name, offset in OFFSETS.items())
    kinetic = each(lambda run: 0.5 * np.sum(run.trajectory.velocity[-1] ** 2), results["chain"])
    yield state(
        MeasuredQuantity("rate of growth of the amplitude", rate, near(first, 1e-3 * first), "8"),
        published="The amplitude grows as exp(s t), s = h omega_0 / 4 at twice the frequency omega_0, to first "
        "order in the depth h of the modulation of omega^2.",
        source="landau1976",
        derived=f"s = e sqrt(k_0) / 4 = {first:g}; required within 0.1%.",
    )
    yield state(
        MeasuredQuantity("rate of growth of the amplitude", rate, near(_floquet(0.0), 2e-7), "8"),
        derived=f"The monodromy matrix of one bead gives {_floquet(0.0):.8f} (Floquet).",
    )
    yield state(
        MeasuredQuantity("largest difference from Floquet", {"reference": beside}, near(0.0, 1e-6), "1e"),
        derived="Beside the resonance, and outside of it, where nothing grows.",
    )
    yield state(
        MeasuredQuantity("kinetic energy at the end", kinetic, near(CHAIN_ENERGY, 5e-6), "6"),
        derived=f"A chain of 60 beads in contact, k = 0.2, e = 0.5, f = 0.2: {CHAIN_ENERGY:g} at t = 60, by "
        "another integrator.",
    )


def _draw_parametric(axis: Axes, results: Results) -> None:
    """Rate of growth over the frequency of the modulation."""
    offsets = np.array([*OFFSETS.values()])
    fine = np.linspace(1.1 * offsets[0], 1.1 * offsets[-1], 400)
    axis.plot(2.0 + fine, [_first_order(offset) for offset in fine], label="first order", **PUBLISHED)
    rates = [_growth(results[name]["reference"]) for name in OFFSETS]
    axis.plot(2.0 + offsets, rates, "o", color=COLOURS[1], label=NAMES["reference"])
    axis.plot(2.0, _growth(results["resonance"]["lammps"]), "o", color=COLOURS[0], label=NAMES["lammps"])


PARAMETRIC = Entry(
    title="Parametric growth on a modulated foundation",
    introduction="The stiffness of a foundation is modulated near twice the frequency of the beads on it: their "
    "oscillations grow exponentially, by the work of the ground.",
    sources={"landau1976": "textbook: parametric resonance"},
    scenes={"resonance": _modulated(0.0), "chain": CHAIN},
    swept={name: _modulated(offset) for name, offset in OFFSETS.items()},
    statements=_parametric,
    axes=("angular frequency of the modulation / that of the beads", "rate of growth of the amplitude (reduced)"),
    draw=_draw_parametric,
    caption="Rate of growth over the frequency of the modulation; the line is the theory of first order in the depth.",
)

# --- Landau-Zener tunnelling ------------------------------------------------------------------------------------------

COUPLING, SWEEP = 0.02, 0.8
"""Stiffness of the springs, and difference of the foundations at either end; they cross at a stiffness of 1."""

RATE = 0.002
RATES = {f"rate-{rate:g}": rate for rate in (0.0007, 0.001, 0.0014, 0.004, 0.008)}
"""Rates of change of that difference: in runs by both engines, and in those by the reference alone."""


def _formula(rate: float) -> float:
    """Share of the action that stays in the chain, by the Landau-Zener formula."""
    return math.exp(-math.pi * COUPLING**2 / (math.sqrt(1.0 + COUPLING) * rate))


def _crossing(rate: float, *, mode: bool = True) -> dict[str, Any]:
    """Scene in which all beads of chain 1 are kicked alike, and for a pure mode those of chain 2, too.

    No contact is loaded.
    """
    low, high = 1.0 - 0.5 * SWEEP, 1.0 + 0.5 * SWEEP
    duration = 2.0 * SWEEP / rate
    slower = np.linalg.eigh([[low + COUPLING, -COUPLING], [-COUPLING, high + COUPLING]])[1][:, 0]
    kicks = [
        {"chain": number, "bead": bead, "velocity": velocity}
        for number, velocity in enumerate((1.0, float(slower[1] / slower[0])) if mode else (1.0,), 1)
        for bead in (1, 2, 3)
    ]
    ramps = [{"from": start, "to": end, "times": [0.0, duration]} for start, end in ((low, high), (high, low))]
    links = {"coupling": {"stiffness": COUPLING}, "foundation": {"stiffness": ramps}}
    return chain(3, duration, timestep=0.02, every=2.0, chains=2, kick=kicks, **links)


def _stays(run: Ran) -> float:
    """Share of the action that stays in chain 1, which has the slower mode at the start, the faster one at the end."""
    action = run.flow.fastest_mode_action
    return math.nan if action is None else action


def _landau_zener(results: Results) -> Statements:
    """Share of the action that stays, from a pure mode and from a kick of one chain, and over the rate."""
    expected = _formula(RATE)
    finite = 2.0 * COUPLING / SWEEP * math.sqrt(expected * (1.0 - expected))
    mode, kick = (each(_stays, results[name]) for name in ("mode", "kick"))
    swept = [_stays(results[name]["reference"]) / _formula(rate) for name, rate in RATES.items()]
    slowest, *_, fastest = RATES.values()
    yield state(
        MeasuredQuantity("share of the action that stays", mode, near(expected, 0.003 * expected), "6"),
        published="A classical analog of the Landau-Zener formula holds for two coupled oscillators.",
        source="novotny2010, abstract",
        derived="From a pure mode of the coupled pair, exp(-pi kappa^2 / (omega_0 alpha)) of the action E / omega "
        f"stays in the chain, {expected:.6f} here, with omega_0^2 = k_0 + kappa and the rate alpha of k_1 - k_2; "
        "required within 0.3%, for a sweep of k_1 - k_2 from -D to D with D = 40 kappa.",
    )
    yield state(
        MeasuredQuantity("share of the action that stays", kick, near(expected, 0.003 * expected, 1.05 * finite), "6"),
        derived="The same where chain 1 alone is kicked.",
        correction="Its beads then are not in a pure mode: the finite start adds up to "
        f"2 (kappa / D) sqrt(P (1 - P)) = {finite:.3f}.",
    )
    yield state(
        MeasuredQuantity("largest share over the formula's", {"reference": max(swept)}, near(1.0, 0.003), "5"),
        MeasuredQuantity("smallest share over the formula's", {"reference": min(swept)}, near(1.0, 0.003), "5"),
        derived=f"Likewise from a pure mode at rates from {slowest:g} to {fastest:g}.",
    )


def _draw_landau_zener(axis: Axes, results: Results) -> None:
    """Share of the action over the rate."""
    rates = [*RATES.values()]
    every = np.geomspace(0.5 * rates[0], 2.0 * rates[-1], 100)
    axis.semilogx(every, [_formula(rate) for rate in every], label="Landau-Zener", **PUBLISHED)
    shares = [_stays(results[name]["reference"]) for name in RATES]
    axis.semilogx(rates, shares, "o", color=COLOURS[1], label=NAMES["reference"])
    for name, marker in (("mode", "o"), ("kick", "s")):
        share = _stays(results[name]["lammps"])
        axis.semilogx(RATE, share, marker, color=COLOURS[0], label=f"{NAMES['lammps']}, {name}")


LANDAU_ZENER = Entry(
    title="Landau-Zener tunnelling between two chains",
    introduction="Two weakly coupled chains on foundations, one of which stiffens while the other softens: where "
    "they cross, part of the action goes over to the other chain. All beads of a chain are kicked alike, so that its "
    "contacts are never loaded.",
    sources={
        "zener1932": "could not be read; the formula as stated by novotny2010 and textbooks",
        "novotny2010": "abstract read: derives a classical analog of the formula",
    },
    scenes={"mode": _crossing(RATE), "kick": _crossing(RATE, mode=False)},
    swept={name: _crossing(rate) for name, rate in RATES.items()},
    statements=_landau_zener,
    axes=("rate of the difference of the stiffnesses (reduced)", "share of the action that stays"),
    draw=_draw_landau_zener,
    caption="Share of the action that stays in the chain over the rate at which the foundations change.",
)
