"""A driven chain under a static load that rectifies."""

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from granchain.parts import Floats
from workflow.plugins.gallery.criteria import NAMES, MeasuredQuantity, at_least, at_most, state
from workflow.plugins.gallery.entry import Entry, Ran, Results, Statements, chain, each, line

LOAD = {"force": 1.0}
STIFFNESS = 1.5
"""Slope k of a contact at rest under that load."""

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
