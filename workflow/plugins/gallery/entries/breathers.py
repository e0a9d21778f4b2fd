"""Breathers of chains under a static load: dark ones of a uniform chain, and those in the gap of a diatomic one."""

import functools
import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from granchain.parts import Floats, motion, page, unit_cell
from workflow.plugins.gallery.criteria import MeasuredQuantity, at_least, at_most, near, state
from workflow.plugins.gallery.entry import COLOURS, PUBLISHED, Entry, Results, Statements, chain, line, panel
from workflow.plugins.gallery.periodic_family import COMPUTED, stays
from workflow.plugins.modes.family import PeriodicFamily, follow

LOAD = {"force": 1.0}
STIFFNESS = 1.5
"""Slope k of a contact at rest under that load."""

# --- a uniform chain --------------------------------------------------------------------------------------------------

UNIFORM, UNIFORM_ENERGY = 24, 8.0
EDGE = 2.0 * math.sqrt(STIFFNESS)


@functools.cache
def _uniform() -> tuple[PeriodicFamily, PeriodicFamily]:
    """Branches of the highest mode and of the next one of a uniform chain between mirrors."""
    walls = {"left": "rigid", "right": "rigid"}
    plain = chain(UNIFORM, 1.0, name="uniform", precompression=LOAD, walls=walls)
    return follow(plain, -1, UNIFORM_ENERGY), follow(plain, -2, UNIFORM_ENERGY)


def _alternating(amplitude: float) -> float:
    """Frequency at which neighbours move oppositely, by scipy's DOP853, up to an amplitude of 0.5."""
    from scipy.integrate import solve_ivp

    def rates(_: float, motion_of_bead: Floats) -> list[float]:
        """Velocity and acceleration, from displacement and velocity [2]."""
        twice = 2.0 * float(motion_of_bead[0])
        return [float(motion_of_bead[1]), (1.0 - twice) ** 1.5 - (1.0 + twice) ** 1.5]

    def middle(_: float, motion_of_bead: Floats) -> float:
        """Displacement, from displacement and velocity [2]."""
        return float(motion_of_bead[0])

    solution = solve_ivp(rates, (0.0, 2.0), [amplitude, 0.0], "DOP853", events=middle, rtol=1e-12, atol=1e-15)
    return 0.5 * math.pi / float(solution.t_events[0][0])


def _at_the_wall(dark: PeriodicFamily) -> float:
    """Frequency of alternating motion with the amplitude and the mean overlap of the first beads of the last state.

    A contact law of exponent 3/2 at a mean overlap d has the frequency d^(1/4) times that at 1 of the amplitude over d.
    """
    begin, *_, end = np.array(dark.data["motion"])[:, 0]
    mean, amplitude = 0.5 * (begin + end), 0.5 * abs(begin[0] - end[0])
    overlap = 1.0 + float(mean[0] - mean[1])
    return float(overlap**0.25 * _alternating(amplitude / overlap))


def _dark(_: Results) -> Statements:
    """Frequencies of alternating motion, and the hole in it."""
    uniform, dark = _uniform()
    amplitudes = np.array([np.max(np.abs(periodic["x"])) for periodic in uniform.states])
    exact = np.array([_alternating(float(amplitude)) for amplitude in amplitudes])
    deviation = float(np.max(np.abs(uniform.frequency / exact - 1.0)))
    narrow = float(dark.participation[-1])
    wall = float(dark.frequency[-1]) / _at_the_wall(dark)
    both = np.concatenate([uniform.frequency, dark.frequency])
    bright = min(float(np.min(family.participation / family.participation[0])) for family in (uniform, dark))
    yield state(
        MeasuredQuantity("highest linear frequency", {COMPUTED: float(uniform.linear.frequency[-1])}, near(EDGE, 1e-9)),
        MeasuredQuantity("largest relative deviation of the frequency", {COMPUTED: deviation}, at_most(2e-9), "1e"),
        derived=f"The band ends at 2 sqrt(k) = {EDGE:.5f}. Where neighbours move oppositely, with rigid walls as "
        "mirrors, each bead is an oscillator, x'' = (1 - 2 x)^(3/2) - (1 + 2 x)^(3/2), integrated here by scipy's "
        f"DOP853; required up to the energy {UNIFORM_ENERGY:g}, at which the frequency is {exact[-1]:.6f}.",
    )
    yield state(
        MeasuredQuantity("highest frequency of the states", {COMPUTED: float(np.max(both))}, at_most(EDGE, EDGE)),
        MeasuredQuantity("smallest participation number over the linear mode's", {COMPUTED: bright}, at_least(0.999)),
        MeasuredQuantity(
            "unstable states of alternating motion", {COMPUTED: float(np.sum(~uniform.stable))}, near(0.0, 0.0), "0"
        ),
        published="A defocusing nonlinear Schroedinger equation holds for frequencies close to the edge of the "
        "phonon band of a uniform chain under static load.",
        source="chong2013, abstract",
        derived="So no bright breather begins at the edge: frequencies fall into the band as the energy grows, "
        "states do not become localised, and alternating motion is stable.",
    )
    yield state(
        MeasuredQuantity("participation number of the last state", {COMPUTED: narrow}, at_least(0.8 * UNIFORM), "2"),
        MeasuredQuantity("frequency over that of the alternating motion", {COMPUTED: wall}, near(1.0, 1e-3), "6"),
        published="A uniform chain of spheres under static load has families of dark breathers.",
        source="chong2013, abstract",
        derived=f"The second-highest mode has one node and a participation number of 2/3 of {UNIFORM} beads; as its "
        "energy grows the hole around the node becomes narrower. The beads at the walls then move alternately, with "
        "the frequency of such motion of their amplitude and mean overlap; required within 0.1%.",
    )
    yield state(
        stays(dark, -1),
        derived=f"LAMMPS is started on the last state, of the energy {dark.states[-1]['energy']:g}, which is "
        f"{'stable' if dark.stable[-1] else 'unstable'}.",
        also=[
            f"unstable states of the branch with the hole: {np.sum(~dark.stable)} of {len(dark.states)}",
            "the nonlinear instability that the abstract of the source names is not examined",
        ],
    )


def _draw_dark(axis: Axes, _: Results) -> None:
    """Mean kinetic energies of the beads along the chain."""
    dark = _uniform()[1]
    energies = dark.values("energy")
    for number, energy in enumerate((0.01, 1.0, UNIFORM_ENERGY)):
        place = int(np.argmin(np.abs(np.log(energies / energy))))
        kinetic = np.array(dark.states[place]["kinetic"])[0]
        label = f"energy {energies[place]:.2g}, frequency {dark.frequency[place]:.4f}"
        beads = np.arange(1, UNIFORM + 1)
        axis.plot(beads, kinetic / np.max(kinetic), marker="o", markersize=3, label=label, **line(number))
    axis.set_ylim(0.0, 1.45)


DARK_BREATHERS = Entry(
    title="Dark breathers of a uniform chain",
    introduction=f"{UNIFORM} equal beads under a static force of 1 between rigid walls: periodic states that begin at "
    "the two highest linear modes.",
    sources={
        "chong2013": "abstract read: families of dark breathers near the edge of the phonon band",
        "james2013": "abstract read: chains without static load have no breathers, so that there is nothing to compute",
    },
    scenes={},
    statements=_dark,
    axes=("bead", "mean kinetic energy / largest"),
    draw=_draw_dark,
    caption="Kinetic energies of the beads, means over a period, in three states of the second-highest mode.",
)

# --- a diatomic chain -------------------------------------------------------------------------------------------------

LIGHT = 0.3428
ACOUSTIC, OPTICAL = math.sqrt(2.0 * STIFFNESS), math.sqrt(2.0 * STIFFNESS / LIGHT)
GAP_ENERGY = 12.0
CENTRES = {"heavy": 41, "light": 43}
"""Kind of the bead in the middle -> number of beads, of which the first and the last are heavy."""

SHORTER, SHORTER_ENERGY = 29, 3.0
"""Number of beads of another chain with a heavy bead in the middle, and largest energy there."""

MARKS = {"heavy": "s", "light": "o"}


@functools.cache
def _gap(kind: str) -> PeriodicFamily:
    """Branch of the lowest optical mode, with a bead of a kind in the middle."""
    return lowest_optical(CENTRES[kind], GAP_ENERGY)


def lowest_optical(beads: int, energy: float) -> PeriodicFamily:
    """Branch of the lowest optical mode of a chain whose first and last beads are heavy, up to an energy."""
    kinds = {"heavy": {"mass": 1.0}, "light": {"mass": LIGHT}}
    plain = chain(beads, 1.0, name=f"diatomic-{beads}", kinds=kinds, pattern=[*kinds], precompression=LOAD)
    return follow(plain, (beads + 1) // 2, energy)


def _asymmetry(family: PeriodicFamily, place: int) -> float:
    """Difference of the changes of the overlaps from their mirror image over these changes, norms."""
    system, x = family.problem.system, np.array(family.states[place]["x"])
    change = motion.overlaps(system, x) - motion.overlaps(system, np.zeros_like(x))
    return float(np.linalg.norm(change - change[:, ::-1]) / np.linalg.norm(change))


def _gap_breathers(_: Results) -> Statements:
    """Gap of the linear spectrum, and the two families in it."""
    families = {kind: _gap(kind) for kind in CENTRES}
    heavy, light = families.values()
    yield from _gap_edges(families)
    lowest = {f"centred on a {kind} bead": float(np.min(family.frequency)) for kind, family in families.items()}
    narrowest = {f"centred on a {kind} bead": float(np.min(family.participation)) for kind, family in families.items()}
    reach = OPTICAL - 0.75 * (OPTICAL - ACOUSTIC)
    yield state(
        MeasuredQuantity("lowest frequency", lowest, at_most(reach), "4"),
        MeasuredQuantity("smallest participation number", narrowest, at_most(3.0), "2 beads"),
        published="Families of discrete breathers are computed throughout the linear spectral gap.",
        source="boechler2010, abstract",
        derived="As the energy grows the frequency of the lowest optical mode falls into the gap and the motion "
        f"becomes localised; required: through three quarters of the gap, to {reach:.4f}, and within 3 of "
        f"{heavy.participation[0]:.0f} beads.",
    )
    yield from _of_heavy(heavy)
    yield from _of_light(light, heavy)


def _gap_edges(families: dict[str, PeriodicFamily]) -> Statements:
    heavy = families["heavy"]
    edges = unit_cell.bands(heavy.problem.system)
    assert edges is not None
    exact = np.array([0.0, ACOUSTIC, OPTICAL, math.sqrt(2.0 * STIFFNESS * (1.0 + 1.0 / LIGHT))])
    frequencies = [family.linear.frequency for family in families.values()]
    within = sum(int(np.sum((values > ACOUSTIC) & (values < OPTICAL))) for values in frequencies)
    yield state(
        MeasuredQuantity(
            "largest deviation of the edges",
            {COMPUTED: float(np.max(np.abs(np.ravel(edges) - exact)))},
            at_most(1e-9),
            "1e",
        ),
        MeasuredQuantity("linear modes in the gap", {COMPUTED: float(within)}, near(0.0, 0.0), "0"),
        published="The edges of the bands are sqrt(2 k / M), sqrt(2 k / m) and sqrt(2 k (1 / M + 1 / m)).",
        source="brillouin1946",
        derived=f"k = {STIFFNESS:g}, M = 1, m = {LIGHT:g}: the gap is from {ACOUSTIC:.4f} to {OPTICAL:.4f}; chains "
        "that end with heavy beads have no mode in it.",
    )


def _of_heavy(heavy: PeriodicFamily) -> Statements:
    unstable = np.flatnonzero(~heavy.stable)
    first = float(heavy.frequency[unstable[0]])
    place = next(int(number) for number in unstable if heavy.values("largest")[number] > 1.1)
    inside = heavy.frequency < OPTICAL
    stable = float(np.sum(heavy.stable & inside))
    shorter = lowest_optical(SHORTER, SHORTER_ENERGY)
    check = heavy.by_lammps(place)
    growth = math.nan if check["growth"] is None else check["growth"][1] / check["predicted"]
    deep = heavy.values("energy") > heavy.values("energy")[unstable[0]]
    yield state(
        MeasuredQuantity(
            "asymmetry of the overlaps of the last state", {COMPUTED: _asymmetry(heavy, -1)}, at_most(1e-6), "1e"
        ),
        MeasuredQuantity(
            "stable states at energies above the first unstable one's",
            {COMPUTED: float(np.sum(heavy.stable & deep))},
            near(0.0, 0.0),
            "0",
        ),
        MeasuredQuantity("stable states in the gap", {COMPUTED: stable}, near(0.0, 0.0, math.inf), "0"),
        published="The breather that is centred on a heavy particle is unstable; its energy profile is symmetric.",
        source="theocharis2010, abstract",
        correction=f"In a chain of {CENTRES['heavy']} beads it is stable down to the frequency {first:.4f}, where its "
        f"participation number still is {heavy.participation[unstable[0]]:.1f}, and unstable below; with "
        f"{SHORTER} beads that begins at {shorter.frequency[~shorter.stable][0]:.4f}, farther from the edge.",
    )
    yield state(
        MeasuredQuantity("rate of growth in LAMMPS over the predicted one", {"lammps": growth}, near(1.0, 0.02)),
        derived=f"The state of frequency {heavy.frequency[place]:.4f} has the largest multiplier "
        f"{heavy.values('largest')[place]:.4f}: a deviation from it grows by that factor in a period.",
    )


def _of_light(light: PeriodicFamily, heavy: PeriodicFamily) -> Statements:
    folds = light.changes("fold")
    frequencies = [2.0 * math.pi / change["periods"][1] for change in folds] + [math.nan] * 2
    stable = light.stable & (light.frequency < OPTICAL)
    before = int(np.argmin(light.stable)) - 1
    narrowest = int(np.argmin(np.where(light.stable, light.participation, math.inf)))
    outside = (light.frequency > frequencies[0]) | (light.frequency < frequencies[1])
    weak, strong = (
        float(np.max(family.values("largest")[where])) for family, where in ((light, outside), (heavy, slice(None)))
    )
    yield state(
        MeasuredQuantity(
            "asymmetry of the overlaps of the last state", {COMPUTED: _asymmetry(light, -1)}, at_least(0.1), "3"
        ),
        MeasuredQuantity("stable states in the gap", {COMPUTED: float(np.sum(stable))}, at_least(1.0), "0"),
        published="The breather that is centred on a light particle is potentially stable; its energy profile is "
        "asymmetric.",
        source="theocharis2010, abstract",
        also=[
            f"its largest multiplier outside the two folds is {weak:.3f}, that centred on a heavy bead {strong:.3f}",
            f"it is stable down to the frequency {light.frequency[before]:.4f}, where its participation "
            f"number is {light.participation[before]:.1f}",
            "at lower frequencies contacts open, and a state counts as stable where its largest multiplier is within "
            f"{np.max(light.values('tolerance')[stable]):.2f} of 1, the error of the multipliers",
        ],
    )
    yield state(
        MeasuredQuantity("folds of the energy", {COMPUTED: float(len(folds))}, near(2.0, 0.0), "0"),
        derived="A real pair of multipliers leaves 1 where the energy has an extremum along a branch: it does so at "
        f"the frequency {frequencies[0]:.4f} and returns at {frequencies[1]:.4f}.",
    )
    yield state(
        stays(light, before, narrowest),
        derived=f"LAMMPS is started on the stable states of the frequencies {light.frequency[before]:.4f} and "
        f"{light.frequency[narrowest]:.4f}, whose participation numbers are {light.participation[before]:.1f} and "
        f"{light.participation[narrowest]:.1f}; a multiplier of 1.12 would make a deviation of 1e-7, that after the "
        "first period, as large as the limit.",
    )


def _draw_gap(axis: Axes, _: Results) -> None:
    """Energy of the two families over frequency."""
    for number, kind in enumerate(CENTRES):
        family = _gap(kind)
        energy, frequency, stable = family.values("energy"), family.frequency, family.stable
        look: dict[str, Any] = {"color": COLOURS[number], "marker": MARKS[kind], "markersize": 4, "linestyle": "none"}
        axis.semilogy(frequency, energy, color=COLOURS[number], linewidth=0.8)
        axis.semilogy(frequency[stable], energy[stable], label=f"{kind} bead in the middle, stable", **look)
        axis.semilogy(
            frequency[~stable], energy[~stable], fillstyle="none", label=f"{kind} bead in the middle, unstable", **look
        )
    for number, edge in enumerate((ACOUSTIC, OPTICAL)):
        axis.axvline(edge, label=None if number else "edges of the gap", **PUBLISHED)
    axis.set_ylim(0.3, None)


def _draw_shapes(axis: Axes, _: Results) -> None:
    """Displacements of a state of each family of nearly one frequency, in the middle of the gap."""
    for number, kind in enumerate(CENTRES):
        family = _gap(kind)
        place = int(np.argmin(np.abs(family.frequency - 0.5 * (ACOUSTIC + OPTICAL))))
        shape = np.array(family.states[place]["x"])[0]
        bead = np.arange(CENTRES[kind]) - CENTRES[kind] // 2
        label = f"{kind} bead in the middle, frequency {family.frequency[place]:.2f}"
        axis.plot(bead, shape, marker=MARKS[kind], markersize=3, label=label, **line(number))
    axis.set_ylim(-3.7, 2.6)


GAP_BREATHERS = Entry(
    title="Discrete gap breathers of a diatomic chain",
    introduction=f"Alternating beads of mass 1 and {LIGHT:g} (steel and aluminium) with equal contacts under a static "
    f"force of 1, {CENTRES['heavy']} beads with a heavy and {CENTRES['light']} with a light one in the middle: "
    "periodic states that begin at the lowest optical mode.",
    sources={
        "brillouin1946": "band edges of a chain of two masses",
        "boechler2010": "abstract read: breathers throughout the gap, computed and observed",
        "theocharis2010": "abstract read: two families, one unstable, one potentially stable",
    },
    scenes={},
    statements=_gap_breathers,
    axes=("angular frequency (reduced)", "energy (reduced)"),
    draw=_draw_gap,
    caption="Energy of the two families of breathers over frequency; filled symbols are stable.",
    pictures=lambda results: [
        page.drawn(
            "shapes",
            panel(("bead, from the middle one", "displacement at the start (reduced)"), _draw_shapes, results),
            "Displacements of a state of each family in the middle of the gap, at the instant at which all beads rest.",
        )
    ],
)
