"""The paper's open question for touching beads: any number of chains, any graph of springs, and what disturbs them.

Relative modes of synchronised waves decay and beat as closed forms say (`touching_arrays`), whatever the graph.
Runs of kicked arrays show how far equipartition takes, and what amplitude and energy remain.
"""

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from granchain.parts import Floats, page
from workflow.plugins.gallery import gapped_pairs, open_figures, touching_arrays
from workflow.plugins.gallery.criteria import MeasuredQuantity, at_least, at_most, near, state
from workflow.plugins.gallery.entry import Entry, Results, Statements
from workflow.plugins.gallery.equipartition_distance import DECAY_LENGTH
from workflow.plugins.gallery.statements import Statement
from workflow.plugins.gallery.touching_arrays import GraphOfChains, Levelled, Mode, ring_of, row_of, square_of

PAPER = "starosvetsky2013, section 4"
OPEN = "Left open: the parametric study of the full array."
SINGLE = 0.6816315
"""Peak velocity far along a single chain, in units of V."""

# --- relative modes of synchronised waves -----------------------------------------------------------------------------

APART = 2e-3
"""Largest relative difference of the kicks."""

MODES = (
    *((row_of(2), kappa, 1) for kappa in (0.003, 0.01, 0.03, 0.1, 0.3)),
    *((row_of(4), 0.03, mode) for mode in (1, 2, 3)),
    (ring_of(6), 0.03, 1),
    (square_of(3), 0.03, 1),
    (square_of(3), 0.01, 8),
)
"""GraphOfChains, coupling and number of the mode, from 0 for the synchronised one."""


@functools.cache
def _modes() -> tuple[tuple[str, Mode], ...]:
    measured = []
    for graph, kappa, number in MODES:
        values, vectors = graph.modes()
        vector = vectors[:, number] / np.max(np.abs(vectors[:, number]))
        stiffness = float(values[number]) * kappa
        beads = math.ceil(60 + 12 / touching_arrays.decay(stiffness, SINGLE))
        plain = touching_arrays.plain_array(graph, kappa, 1.0 - APART + APART * vector, beads)
        mode = touching_arrays.mode_of(touching_arrays.peaks(touching_arrays.problem_of(plain)), vector, stiffness)
        assert mode is not None, "the chains are long enough"
        measured.append((f"{graph}, kappa = {kappa:g}, mode {number}", mode))
    return tuple(measured)


def _deviations(of: Callable[[Mode], float], largest: float) -> dict[str, float]:
    return {name: of(mode) for name, mode in _modes() if mode.stiffness <= largest}


def modes(_: Results) -> Statements:
    """Statements on decay and beat of relative modes."""
    constant = touching_arrays.decay(1.0, 1.0)
    yield state(
        MeasuredQuantity("deviation of the decay, mu kappa <= 0.1", _deviations(_decay_off, 0.1), near(0.0, 0.02), "4"),
        source=PAPER,
        published=OPEN,
        derived="A relative mode of synchronised waves decays from row to row by 4/45 omega^2 S^2 / e, omega^2 = mu "
        f"kappa, S and e shift and energy of the wave: {constant:.4f} mu kappa V_s^-0.4, whatever the graph.",
        also=[f"{name}: {mode.decay:.3e} a row, {_decay_off(mode):+.2%}" for name, mode in _modes()],
    )
    yield state(
        MeasuredQuantity(
            "deviation of the wavenumber, mu kappa <= 0.1", _deviations(_beat_off, 0.1), near(0.0, 0.05), "4"
        ),
        derived="It beats with the wavenumber omega / (3 c), c the speed of the waves in beads / T: a wave that is "
        "ahead is slowed down by the springs, and lags behind.",
        also=[f"{name}: {mode.wavenumber:.4f} rad a bead, {_beat_off(mode):+.2%}" for name, mode in _modes()],
    )
    rising = [_decay_off(mode) / mode.stiffness for name, mode in _modes() if mode.stiffness > 0.01]
    yield state(
        MeasuredQuantity(
            "deviation of the decay over mu kappa", {"reference": float(np.mean(rising))}, near(-0.17, 0.07), "3"
        ),
        derived="The closed forms are of first order in mu kappa: their deviations are proportional to it (a fit).",
    )


def _decay_off(mode: Mode) -> float:
    return mode.decay / touching_arrays.decay(mode.stiffness, mode.amplitude) - 1.0


def _beat_off(mode: Mode) -> float:
    return mode.wavenumber / touching_arrays.beat(math.sqrt(mode.stiffness), mode.amplitude) - 1.0


MODES_ENTRY = Entry(
    title="Open question 3: relative modes of synchronised solitary waves",
    introduction=(
        "Chains of touching beads, all kicked, with velocities that differ by 0.2 % in an eigenvector of the graph of "
        "springs with eigenvalue mu. V_s is the peak velocity of the waves. Decay and wavenumber are those of the "
        "mode's share of the peaks, from bead 30 on."
    ),
    sources={"starosvetsky2013": "section 4"},
    scenes={},
    statements=modes,
)

# --- how far equipartition takes --------------------------------------------------------------------------------------

KAPPAS = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 3.0)
GRAPHS = (
    *(row_of(chains) for chains in (2, 3, 4, 8, 16, 32)),
    *(ring_of(chains) for chains in (4, 8, 16)),
    *(square_of(side) for side in (2, 3, 4, 8)),
)
ELSEWHERE = ((row_of(3), (1,)), (row_of(8), (3,)), (row_of(4), (0, 1)), (square_of(3), (4,)), (row_of(8), (0, 7)))
"""Arrays that are kicked in the middle, or in two chains."""

LEAST = 0.015
"""Least mu kappa of the slowest mode of arrays of more than two chains: distances are below a thousand beads."""


@functools.cache
def _arrays() -> tuple[Levelled, ...]:
    cases: list[tuple[GraphOfChains, float, tuple[int, ...]]] = [
        (graph, kappa, (0,)) for graph in GRAPHS for kappa in KAPPAS
    ]
    cases += [(graph, 0.1, kicked) for graph, kicked in ELSEWHERE]
    return tuple(
        touching_arrays.levelled(graph, kappa, kicked)
        for graph, kappa, kicked in cases
        if graph.chains == 2 or graph.slowest(kicked)[0] * kappa >= LEAST
    )


def _bead(value: int | None) -> float:
    return math.nan if value is None else float(value)


def arrays(_: Results) -> Statements:
    """Statements on the distance to equipartition, and on what remains."""
    cases = _arrays()
    reached = [case for case in cases if case.within(0.01) is not None]
    yield state(
        MeasuredQuantity(
            "arrays whose peaks agree to 1%, over all", {"reference": len(reached) / len(cases)}, at_least(1.0), "3"
        ),
        source=PAPER,
        published=OPEN,
        derived="Required: equipartition in every array of the table.",
        also=[f"{len(cases)} arrays: rows of 2 to 32 chains, rings, square lattices up to 8 x 8; kappa = 0.005 to 3"],
    )
    soft = [case for case in reached if case.slowest * case.kappa <= 0.2]
    delays = {f"{tolerance:.0%}": [case.delayed(tolerance) for case in soft] for tolerance in (0.1, 0.01)}
    yield state(
        MeasuredQuantity(
            "median of distance times decay, less log(spread / tolerance)",
            {name: float(np.median(values)) for name, values in delays.items()},
            near(-0.45, 0.1),
            "2",
        ),
        MeasuredQuantity(
            "largest deviation from -0.45",
            {name: float(np.max(np.abs(np.array(values) + 0.45))) for name, values in delays.items()},
            at_most(1.4),
            "2",
        ),
        derived="A kick gives its slowest relative modes velocities of a spread, (largest - smallest) / mean, which "
        "falls as exp(-decay n). So peaks agree to a tolerance after log(spread / tolerance) lengths of decay, with "
        "the amplitude that remains; the rest, -0.45 lengths, is a fit for mu kappa <= 0.2, of 4 to 7 lengths in all.",
        also=[
            f"stiffer springs take longer: up to {max(case.delayed(0.01) for case in reached):.1f} lengths more "
            "at kappa = 3",
            *(
                f"{case.graph}, kappa = {case.kappa:g}, chains {', '.join(str(k + 1) for k in case.kicked)} kicked: 1% "
                f"from bead {case.within(0.01)} on, {case.delayed(0.01):+.2f}; mu = {case.slowest:.3f}, spread "
                f"{case.spread:.2f}"
                for case in reached
                if case.kicked != (0,)
            ),
        ],
    )
    yield _amplitudes(reached)
    yield _dying(cases)


def _amplitudes(reached: Sequence[Levelled]) -> Statement:
    rows = [case for case in reached if case.graph.kind == "row" and case.kicked == (0,) and case.kappa == 0.1]
    ratios = {f"N = {case.graph.chains}": case.graph.chains * case.amplitude / SINGLE for case in rows}
    return state(
        MeasuredQuantity("N times amplitude over that of a single chain, kappa = 0.1", ratios, at_least(1.0, 0.9), "3"),
        derived="Momentum: equal waves of all momentum of a single chain's would have the Nth part of its amplitude. "
        "Required: at least that, as rows that are left behind recoil.",
        also=[
            f"{case.graph}, kappa = {case.kappa:g}: amplitude {case.amplitude:.4f} V, energy {case.energy:.3f} of the "
            "input"
            for case in reached
            if case.kappa in {0.1, 1.0}
        ],
    )


def _dying(cases: Sequence[Levelled]) -> Statement:
    pairs = [case for case in cases if case.graph.chains == 2 and case.kappa <= 0.1]
    over = {f"kappa = {case.kappa:g}": 2.0 * case.amplitude / SINGLE for case in pairs}
    return state(
        MeasuredQuantity("twice the amplitude over that of a single chain", over, at_least(0.9, -math.inf), "3"),
        derived="Required: at least 0.9, as much as with strong coupling.",
        correction="Below kappa of about 0.01 the pulse dies before it is shared: each row keeps kappa S^2 / 2, so "
        f"that v(n) = {SINGLE:.4f} V (1 - n / n*)^2.5, n* = {DECAY_LENGTH} V^0.4 / kappa.",
        also=[
            f"kappa = {case.kappa:g}: 1% from bead {case.within(0.01)} on, "
            f"{_bead(case.within(0.01)) * case.kappa / DECAY_LENGTH:.2f} n*"
            for case in pairs
        ],
    )


def array_tables(_: Results) -> dict[str, str]:
    """The arrays: distances, amplitude and energy."""
    names = ("array", "chains", "kappa", "kicked", "mu", "spread", "bead_10", "bead_1", "amplitude", "energy")
    rows = [
        (
            str(case.graph),
            case.graph.chains,
            case.kappa,
            " ".join(str(chain + 1) for chain in case.kicked),
            case.slowest,
            case.spread,
            case.within(0.1),
            case.within(0.01),
            case.amplitude,
            case.energy,
        )
        for case in _arrays()
    ]
    return {"arrays.csv": gapped_pairs.table(names, rows), "reductions.csv": _reductions()}


def _reductions() -> str:
    """Table for a designer: reduction of the peak velocity, and the beads that it takes, of rows of chains."""
    names = ("chains", "kappa", "reduction", "beads_to_10", "beads_to_1")
    rows = [
        (case.graph.chains, case.kappa, 1.0 - case.amplitude / SINGLE, case.within(0.1), case.within(0.01))
        for case in _arrays()
        if case.graph.kind == "row" and case.kicked == (0,)
    ]
    return gapped_pairs.table(names, rows)


def array_pictures(_: Results) -> list[page.PageFigure]:
    """Collapse of the distances, and amplitudes."""
    caption = "Distance to 1 % in lengths of decay, and amplitude times N, over the coupling of the slowest mode."
    return [page.drawn("collapse", open_figures.collapse_figure(_arrays(), SINGLE), caption)]


ARRAYS = Entry(
    title="Open question 4: the full array of touching beads",
    introduction=(
        "N chains in a row, a ring or a square lattice; the first one (a corner) is kicked with V unless a line says "
        "otherwise. mu is the least eigenvalue of the graph's Laplacian whose modes the kick excites: "
        "2 - 2 cos(pi / N) for a row. Distances are those of the peaks of all chains; by the reference."
    ),
    sources={"starosvetsky2013": "section 4"},
    scenes={},
    statements=arrays,
    pictures=array_pictures,
    tables=array_tables,
)

# --- what disturbs it -------------------------------------------------------------------------------------------------

KAPPA, BEADS, SEEDS = 0.1, 260, 6
NEAR = 10
"""Beads over which peaks are averaged where beads differ."""

Changed = tuple[str, Mapping[str, Any]]
SPREADS = (0.01, 0.05, 0.1)
DISORDERED: tuple[tuple[str, str, float], ...] = tuple(
    (words, key, spread) for words, key in (("masses", "mass"), ("contacts", "stiffness")) for spread in SPREADS
)
UNEQUAL = (0.001, 0.01, 0.1)
"""Coefficients of dashpots in the contacts, in units of m / T."""

LOADS = (1e-4, 1e-3, 1e-2, 0.1, 1.0)
"""Static forces, in units of m V / T."""


def _averaged(difference: Floats) -> Floats:
    return np.convolve(difference, np.full(NEAR, 1.0 / NEAR), mode="valid")


@functools.cache
def _difference(key: str, value: float, seed: int = 1) -> tuple[Floats, Floats]:
    """Relative difference of the peaks, averaged over some beads, and their mean, [bead] each."""
    keys: dict[str, Any] = {}
    if key in {"mass", "stiffness"}:
        keys = {"disorder": {key: value, "seed": seed}}
    elif key == "damping":
        keys = {"damping": {"contact": value}}
    elif key == "load":
        keys = {"precompression": {"force": value}}
    plain = touching_arrays.plain_array(row_of(2), KAPPA, (1.0, 0.0), BEADS, **keys)
    values = touching_arrays.peaks(touching_arrays.problem_of(plain), BEADS)
    mean = values.mean(axis=0)
    return _averaged((values[0] - values[1]) / mean), mean


def _level(difference: Floats, tolerance: float) -> float:
    apart = np.flatnonzero(~(np.abs(difference) <= tolerance))
    first = int(apart[-1]) + 1 if len(apart) else 0
    return first + 1.0 if first < 0.9 * len(difference) else math.nan


def robust(_: Results) -> Statements:
    """Statements on disorder, damping, unequal springs and static load."""
    plain = _level(_difference("none", 0.0)[0], 0.1)
    for words, key in (("masses", "mass"), ("contacts", "stiffness")):
        ensembles = {
            spread: np.array([_level(_difference(key, spread, seed)[0], 0.1) for seed in range(1, SEEDS + 1)])
            for spread in SPREADS
        }
        reached = {f"{spread:.0%}": float(np.mean(np.isfinite(values))) for spread, values in ensembles.items()}
        yield state(
            MeasuredQuantity("share of the arrays that agree to 10%", reached, at_least(1.0, 0.0), "2"),
            source=PAPER,
            published=OPEN,
            derived=f"Disorder of the {words}, uniform within 1, 5 and 10 %, {SEEDS} arrays each; peaks averaged over "
            f"{NEAR} beads. Required: equipartition in every array.",
            correction=f"With 10 % not in every array of {BEADS} beads.",
            also=[
                f"{spread:.0%}: 10% from bead {_mean(values)} on (without disorder {plain:.0f}); difference of beads "
                f"200 to {BEADS - 2 * NEAR}: {_rest(key, spread):.3f} (root of the mean square)"
                for spread, values in ensembles.items()
                if np.isfinite(values).any()
            ],
        )
    for words, key, settings, unit in (
        ("Dashpots in the contacts", "damping", UNEQUAL, "m / T"),
        ("A static load", "load", LOADS, "m V / T"),
    ):
        distances = {f"{value:g} {unit}": _level(_difference(key, value)[0], 0.1) for value in settings}
        yield state(
            MeasuredQuantity(
                "bead from which peaks agree to 10%, over that without",
                {name: value / plain for name, value in distances.items()},
                near(1.0, 0.25, 10.0),
                "2",
            ),
            source=PAPER,
            published=OPEN,
            derived=f"{words}: required is a distance that moves by at most a quarter.",
            correction="The distance moves, as the values say.",
            also=[
                f"{value:g} {unit}: mean peak at bead 100 {_difference(key, value)[1][99]:.4f} V, at 200 "
                f"{_difference(key, value)[1][199]:.4f} V"
                for value in settings
            ],
        )
    yield _unequal_springs()


def _mean(values: Floats) -> str:
    """Mean and standard error of the values that are defined."""
    defined = values[np.isfinite(values)]
    error = np.std(defined, ddof=1) / math.sqrt(len(defined)) if len(defined) > 1 else math.nan
    return f"{defined.mean():.0f} +- {error:.0f}"


def _rest(key: str, spread: float) -> float:
    rest = [_difference(key, spread, seed)[0][200:] for seed in range(1, SEEDS + 1)]
    return float(np.sqrt(np.mean(np.square(rest))))


def _unequal_springs() -> Statement:
    equal = touching_arrays.levelled(row_of(3), KAPPA)
    beads = len(equal.difference) + touching_arrays.CLEAR
    moved = {}
    for pair in ((0.1, 0.11), (0.11, 0.1)):
        edges = [[1, 2, pair[0]], [2, 3, pair[1]]]
        plain = touching_arrays.plain_array(row_of(3), KAPPA, (1.0, 0.0, 0.0), beads)
        problem = touching_arrays.problem_of({**plain, "coupling": {"topology": {"edges": edges}}})
        values = touching_arrays.peaks(problem)
        difference = (values.max(axis=0) - values.min(axis=0)) / values.mean(axis=0)
        moved[f"springs {pair[0]:g} and {pair[1]:g}"] = _level(difference, 0.01) / _bead(equal.within(0.01))
    return state(
        MeasuredQuantity(
            "bead from which three chains agree to 1%, over that with equal springs", moved, near(1.0, 0.15), "3"
        ),
        source=PAPER,
        published=OPEN,
        derived="Springs that differ by 10 % keep the synchronised wave: in it they are not stretched. Required: the "
        "distance moves by at most 15 %.",
    )


ROBUST = Entry(
    title="Open question 5: disorder, damping, unequal springs, static load",
    introduction=(
        f"Two chains of {BEADS} touching beads, kappa = {KAPPA:g}, the first kicked with V; each case beside the "
        "same array without. Where beads differ, so do peaks side by side: differences are averaged over ten beads."
    ),
    sources={"starosvetsky2013": "section 4"},
    scenes={},
    statements=robust,
)
