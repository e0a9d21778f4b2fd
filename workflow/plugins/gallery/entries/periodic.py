"""Periodic motion of chains under a static load: beats as a sum of two modes, and a driven chain that rectifies."""

import functools
import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from analysis.trajectory import Floats
from workflow.plugins.gallery.criteria import NAMES, MeasuredQuantity, at_least, at_most, near, state
from workflow.plugins.gallery.entry import Entry, Ran, Results, Statements, chain, each, line
from workflow.plugins.gallery.periodic_family import COMPUTED
from workflow.plugins.modes.family import PeriodicFamily, follow

LOAD = {"force": 1.0}
STIFFNESS = 1.5
"""Slope k of a contact at rest under that load."""

# --- two chains as two modes ------------------------------------------------------------------------------------------

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

# --- rectification ----------------------------------------------------------------------------------------------------

BEADS, DEFECT, DRAG, DRIVE = 20, 0.2, 0.05, 3.6
"""Number of beads, mass of the light one, drag coefficient, and angular frequency of the drive."""

CUT_OFF = 2.0 * math.sqrt(STIFFNESS)
BELOW, ABOVE = 0.15, 0.25
AMPLITUDES = (0.05, 0.1, BELOW, 0.2, 0.23, 0.24, ABOVE, 0.3)
SIDES = {"near": 2, "far": BEADS - 1}
"""Where the driven bead 1 is, as seen from the light bead -> number of the light bead."""


def _driven(side: str, amplitude: float) -> dict[str, Any]:
    kinds = {"light": {"mass": DEFECT}}
    replaced = [{"bead": SIDES[side], "kind": "light"}]
    drive = {"displacement": amplitude, "frequency": DRIVE / (2.0 * math.pi), "phase": -90}
    return chain(
        BEADS,
        600.0,
        timestep=0.02,
        every=0.2,
        kick=None,
        kinds=kinds,
        replace=replaced,
        drive=drive,
        precompression=LOAD,
        walls={"right": "rigid"},
        damping={"beads": DRAG},
    )


DRIVEN = {f"{side}-{amplitude:g}": (side, amplitude) for side in SIDES for amplitude in AMPLITUDES}
BOTH = {name: _driven(*driven) for name, driven in DRIVEN.items() if driven[1] in (BELOW, ABOVE)}


def _transmitted(run: Ran) -> Floats:
    """Deviation of the force on the wall from its mean, in the second half of the run, [frame], in units of F_0."""
    force = run.forces(wall=True).force[:, 0, 0]
    late = force[len(force) // 2 :] * run.problem.scale.force
    return np.asarray(late - np.mean(late))


def _rms(run: Ran) -> float:
    return float(np.sqrt(np.mean(_transmitted(run) ** 2)))


def _spectrum(run: Ran) -> tuple[Floats, Floats]:
    """Angular frequencies, and the power of the force on the wall at these, [frequency]."""
    force = _transmitted(run)
    power = np.abs(np.fft.rfft(force * np.hanning(len(force)))) ** 2
    frequency = 2.0 * np.pi * np.fft.rfftfreq(len(force), run.problem.every * run.problem.scale.time)
    return np.asarray(frequency, dtype=np.float64), np.asarray(power, dtype=np.float64)


def _in_band(run: Ran) -> float:
    """Share of the power at frequencies in the band of the chain."""
    frequency, power = _spectrum(run)
    return float(np.sum(power[frequency < CUT_OFF]) / np.sum(power))


def _lines(run: Ran) -> float:
    """Number of maxima of the power in the band that exceed a thousandth of the largest."""
    frequency, power = _spectrum(run)
    inner = power[1:-1]
    top = (inner > power[:-2]) & (inner > power[2:]) & (inner > 1e-3 * np.max(power)) & (frequency[1:-1] < CUT_OFF)
    return float(np.count_nonzero(top))


def _decay(frequency: float) -> float:
    """Ratio of the amplitudes of neighbours, which move oppositely, at a frequency above the band."""
    return math.exp(-math.acosh(0.5 * frequency**2 / STIFFNESS - 1.0))


def _defect_frequency() -> float:
    """Frequency of the light bead between a bead at rest and a long chain."""
    from scipy.optimize import brentq

    def excess(frequency: float) -> float:
        return DEFECT * frequency**2 - STIFFNESS * (2.0 + _decay(frequency))

    frequency: float = brentq(excess, 1.0001 * CUT_OFF, 10.0)
    return frequency


def _rectifier(results: Results) -> Statements:
    """Transmitted force from either side, below and above the threshold."""
    mode = _defect_frequency()
    below = {side: each(_rms, results[f"{side}-{BELOW:g}"]) for side in SIDES}
    above = {side: each(_rms, results[f"{side}-{ABOVE:g}"]) for side in SIDES}
    ratio = {engine: (above["near"][engine] / above["far"][engine]) ** 2 for engine in NAMES}
    near_side = np.array([_rms(results[f"near-{amplitude:g}"]["reference"]) for amplitude in AMPLITUDES])
    step = int(np.argmax(near_side[1:] / near_side[:-1]))
    from_the_far = max(_rms(results[f"far-{amplitude:g}"]["reference"]) for amplitude in AMPLITUDES)
    yield state(
        MeasuredQuantity("rms force below, light bead near", below["near"], at_most(1e-4), "1e F_0"),
        MeasuredQuantity("rms force below, light bead far", below["far"], at_most(1e-4), "1e F_0"),
        published="Vibrations in a stop band of the crystal that do not bifurcate transmit little energy.",
        source="boechler2011, patent",
        derived=f"The drive, at {DRIVE:g}, is above the band, which ends at {CUT_OFF:.4f}, and below the mode of the "
        f"light bead, {mode:.4f}: its amplitude decreases by {_decay(DRIVE):.3f} from bead to bead. What arrives at an "
        f"amplitude of {BELOW:g} is the remainder of the start.",
    )
    yield state(
        MeasuredQuantity(
            "largest ratio of rms forces", {"reference": near_side[step + 1] / near_side[step]}, at_least(100.0), "1e"
        ),
        published="Near the defect the system bifurcates at a critical amplitude, with a sharp transition.",
        source="boechler2011, abstract",
        derived="The light bead's mode softens, so that its resonance comes down to the drive as the amplitude grows; "
        "required: the force on the wall at two neighbouring amplitudes differs by more than a factor of 100.",
        also=[f"between the amplitudes {AMPLITUDES[step]:g} and {AMPLITUDES[step + 1]:g}"],
    )
    yield state(
        MeasuredQuantity("ratio of transmitted powers", ratio, at_least(1e4), "1e"),
        published="Rectification ratios are greater than 10^4.",
        source="boechler2011, abstract",
        derived=f"Power of the force on the wall, driven with {ABOVE:g} beside the light bead, over that driven from "
        "the other end.",
        also=[f"from the far side the rms force is at most {from_the_far:.0e} F_0 at all amplitudes"],
    )
    yield state(
        MeasuredQuantity(
            "share of the power in the band", each(_in_band, results[f"near-{ABOVE:g}"]), at_least(0.9), "4"
        ),
        MeasuredQuantity("lines in the band", each(_lines, results[f"near-{ABOVE:g}"]), at_least(5.0), "0"),
        published="Above the threshold the states are quasiperiodic or chaotic, with broadband frequency content, some "
        "of it within the pass bands.",
        source="boechler2011, patent",
        derived="A periodic state of the drive's frequency has no line below it; required: at least five that exceed a "
        "thousandth of the largest power. Which of the two kinds the state is of is not decided here.",
    )


def _draw_rectifier(axis: Axes, results: Results) -> None:
    """Transmitted force over the amplitude, from either side."""
    for number, (side, words) in enumerate(zip(SIDES, ("beside the light bead", "at the other end"), strict=True)):
        forces = [_rms(results[f"{side}-{amplitude:g}"]["reference"]) for amplitude in AMPLITUDES]
        axis.semilogy(AMPLITUDES, forces, marker="o", label=f"driven {words}", **line(number))
        both = [_rms(results[f"{side}-{amplitude:g}"]["lammps"]) for amplitude in (BELOW, ABOVE)]
        label = None if number else NAMES["lammps"]
        axis.semilogy((BELOW, ABOVE), both, "x", color="black", markersize=8, zorder=3, label=label)


RECTIFIER = Entry(
    title="Acoustic rectification by a bifurcation",
    introduction=f"{BEADS} beads under a static force of 1, of mass 1 but for one of {DEFECT:g} next to an end, with "
    f"a drag of {DRAG:g}. The bead at that end is driven, or that at the other one; the force on the wall at the end "
    "that is not driven is measured. The publication's dimensions could not be read: what does not depend on them is "
    "compared.",
    sources={
        "boechler2011": "abstract, and that of the patent US 2013/0033339 of the authors, read",
    },
    scenes=BOTH,
    swept={name: _driven(*driven) for name, driven in DRIVEN.items() if name not in BOTH},
    statements=_rectifier,
    axes=("amplitude of the drive (reduced)", "rms force on the wall / static force"),
    draw=_draw_rectifier,
    caption="Transmitted force over the amplitude of the drive, by the reference and at two amplitudes by LAMMPS.",
)
