"""Chains under a static load: solitary waves on top of it, bands of sound and the gaps between them, a column."""

import functools
import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from granchain.parts import Floats
from workflow.plugins.gallery.criteria import MeasuredQuantity, near, state
from workflow.plugins.gallery.entry import COLOURS, PUBLISHED, Entry, Ran, Results, Statements, chain, each, exponent
from workflow.plugins.sound import dispersion, loaded_pulse


def _weakly_kicked(beads: int, duration: float, **keys: object) -> dict[str, object]:
    """Scene of a chain with a weak kick, unless other keys replace the kick."""
    return chain(beads, duration, timestep=0.01, every=0.25, **{"kick": {"velocity": 1e-3}, **keys})


# --- solitary waves on top of a load ----------------------------------------------------------------------------------

LOADS = {f"load-{load:g}": load for load in (0.1, 0.01, 0.003)}


def _wave(run: Ran) -> loaded_pulse.LoadedWave:
    wave = loaded_pulse.LoadedPulseMeter(run.problem).read(run.blocks())
    assert wave is not None
    return wave


def _precompressed(results: Results) -> Statements:
    """Speed of the wave over that of sound at three force ratios."""
    for name, load in LOADS.items():
        speed, wave = each(lambda run: _wave(run).over_sound, results[name]), _wave(results[name]["reference"])
        required = near(wave.theory, 1e-3, 0.012 * wave.theory)
        yield state(
            MeasuredQuantity("speed of the wave over that of sound", speed, required, "4"),
            published="Long-wave theory: V_s / c_0 = sqrt((4/15) (3 + 2 f^(5/3) - 5 f^(2/3))) / (f^(2/3) - 1), f = "
            "F_m / F_0.",
            source="nesterenko2001",
            derived=f"F_0 = {load:g}, f = {wave.force_ratio:.2f}: {wave.theory:.4f} times c_0 = sqrt(3/2) F_0^(1/6) = "
            f"{math.sqrt(1.5) * load ** (1.0 / 6.0):.4f}.",
            correction="The discrete chain is faster than the long-wave theory, the more so the farther it is from "
            "sound.",
        )


def _long_wave(ratio: Floats) -> Floats:
    """Speed over that of sound by the long-wave theory, [ratio], over the force ratio f."""
    strain = ratio ** (2.0 / 3.0)
    return np.sqrt(4.0 / 15.0 * (3.0 + 2.0 * ratio * strain - 5.0 * strain)) / (strain - 1.0)


def _draw_precompressed(axis: Axes, results: Results) -> None:
    """Speed over sound, over the force ratio."""
    every = np.geomspace(1.05, 300.0, 100)
    axis.semilogx(every, _long_wave(every), label="Nesterenko", **PUBLISHED)
    waves = [_wave(results[name]["lammps"]) for name in LOADS]
    axis.semilogx([w.force_ratio for w in waves], [w.over_sound for w in waves], "o", color=COLOURS[0], label="LAMMPS")


PRECOMPRESSED = Entry(
    title="Waves in precompressed chains",
    introduction="A chain under a constant load has a speed of sound; solitary waves are faster.",
    sources={
        "nesterenko2001": "long-wave theory",
        "coste1997": "abstract read: measured at three static forces",
        "daraio2006": "could not be read",
    },
    scenes={name: chain(120, 105, timestep=0.01, precompression={"force": load}) for name, load in LOADS.items()},
    statements=_precompressed,
    axes=("largest force / static force", "speed / speed of sound"),
    draw=_draw_precompressed,
    caption="Speed of the pulse over that of sound; the line is the long-wave theory.",
)

# --- bands of sound ---------------------------------------------------------------------------------------------------

PLACES = ((0, 1), (1, 0), (1, 1))
"""Indices of the measured edges: end of the acoustic band, beginning and end of the optical one."""

BANDS = ("wavenumber (rad / bead)", "angular frequency (reduced)")

Edge = tuple[float, str, str]
"""Angular frequency of the edge of a band, published claim, and its derivation."""


@functools.cache
def _spectrum(run: Ran) -> dispersion.Map:
    """Power of the velocities over wavenumber and frequency."""
    power = dispersion.DispersionMeter(run.problem).read(run.blocks())
    assert isinstance(power, dispersion.Map)
    return power


def _edges(results: Results, scene: str, edges: Sequence[Edge], source: str) -> Statements:
    """The three edges, from the power of the velocities over wavenumber and frequency."""
    resolved = max(each(lambda run: _spectrum(run).bin / run.problem.scale.time, results[scene]).values())
    bands = each(lambda run: _spectrum(run).measured_bands() / run.problem.scale.time, results[scene])
    for place, (edge, published, derived) in zip(PLACES, edges, strict=True):
        frequencies = {engine: float(edges_of_engine[place]) for engine, edges_of_engine in bands.items()}
        yield state(
            MeasuredQuantity("angular frequency of the edge", frequencies, near(edge, resolved), "4"),
            published=published,
            source=source,
            derived=f"{derived}; the spectrum resolves {resolved:.4f}.",
        )


def _draw_bands(axis: Axes, run: Ran, edges: Sequence[Edge], *, exact: bool) -> None:
    """Branches, and the edges of the bands."""
    spectrum, second = _spectrum(run), run.problem.scale.time
    for branch, (name, mark) in enumerate((("lower", "o"), ("upper", "s"))):
        look: dict[str, Any] = {"color": COLOURS[branch], "marker": mark, "linestyle": "none", "markersize": 4}
        axis.plot(spectrum.folded, spectrum.measured[:, branch] / second, label=f"{name} branch (LAMMPS)", **look)
        if exact:
            label = None if branch else "exact branches"
            axis.plot(spectrum.folded, spectrum.exact[:, branch] / second, color="black", linewidth=0.8, label=label)
    edge_words = "derived edges" if exact else "published edges"
    for number, (edge, _, _) in enumerate(edges):
        axis.axhline(edge, label=None if number else edge_words, **PUBLISHED)


LIGHT, LOAD = 0.5, 1.0
KINDS = {"heavy": {"mass": 1}, "light": {"mass": LIGHT}}
STIFFNESS = 1.5 * LOAD ** (1.0 / 3.0)
OF_TWO_MASSES = [
    (
        edge,
        f"{says} at the squared angular frequency {formula}.",
        f"k = 3/2 F_0^(1/3) = {STIFFNESS:g}, M = 1, m = {LIGHT:g}: an angular frequency of {edge:.4f}",
    )
    for says, formula, edge in (
        ("The acoustic band ends", "2 k / M", math.sqrt(2.0 * STIFFNESS)),
        ("The optical band begins", "2 k / m", math.sqrt(2.0 * STIFFNESS / LIGHT)),
        ("The optical band ends", "2 k (1/M + 1/m)", math.sqrt(2.0 * STIFFNESS * (1.0 + 1.0 / LIGHT))),
    )
]

BAND_GAP = Entry(
    title="Band gap of a diatomic chain",
    introduction="Alternating beads of mass 1 and 1/2 under a static force of 1, with a weak kick.",
    sources={
        "brillouin1946": "band edges of a chain of two masses",
        "boechler2010": "abstract read: such a spectrum measured in a compressed diatomic chain",
    },
    scenes={"diatomic": _weakly_kicked(160, 200, kinds=KINDS, pattern=[*KINDS], precompression={"force": LOAD})},
    statements=lambda results: _edges(results, "diatomic", OF_TWO_MASSES, "brillouin1946"),
    axes=BANDS,
    draw=lambda axis, results: _draw_bands(axis, results["diatomic"]["lammps"], OF_TWO_MASSES, exact=False),
    caption="Frequencies over wavenumber in the LAMMPS run.",
)

# --- resonators -------------------------------------------------------------------------------------------------------

MASS, SPRING, OVERLAP, DRIVE = 0.1, 1.0, 0.25, 2.5
CONTACT, OWN = 1.5 * math.sqrt(OVERLAP), SPRING / MASS
SUM = (1.0 + MASS) * OWN + 4.0 * CONTACT
TOPS = [math.sqrt(0.5 * (SUM + sign * math.sqrt(SUM**2 - 16.0 * CONTACT * OWN))) for sign in (-1.0, 1.0)]
OF_RESONATORS = [
    (
        edge,
        "Local resonances of the cylinders of a woodpile form band gaps.",
        f"At an angular frequency of {edge:.6f} {says}",
    )
    for says, edge in (
        ("the acoustic band ends", TOPS[0]),
        ("the optical band begins", math.sqrt(OWN * (1.0 + MASS))),
        ("the optical band ends", TOPS[1]),
    )
]
EFFECTIVE = 1.0 + MASS * OWN / (OWN - DRIVE**2)
RATIO = -math.exp(-math.acosh(EFFECTIVE * DRIVE**2 / (2.0 * CONTACT) - 1.0))


def _ratio(run: Ran) -> float:
    """Velocity of bead 3 over that of bead 2 at the frequency of the drive, in phase with it."""
    trajectory = run.trajectory
    late = trajectory.time > 0.5 * trajectory.time[-1]
    time = trajectory.time[late]
    weight = np.hanning(len(time)) * np.exp(-1j * DRIVE * run.problem.scale.time * time)
    second, third = (weight @ trajectory.velocity[late, 0, bead] for bead in (1, 2))
    return float((third / second).real)


def _resonators(results: Results) -> Statements:
    """The edges of the bands, and the decay in the gap."""
    yield from _edges(results, "kicked", OF_RESONATORS, "kim2014, abstract")
    yield state(
        MeasuredQuantity("ratio", each(_ratio, results["driven"]), near(RATIO, 1e-4), "6"),
        derived=f"A drive in the gap, at an angular frequency of {DRIVE:g}, moves each bead "
        f"-exp(-arccosh(m omega^2 / (2 K) - 1)) = {RATIO:.6f} times as far as the bead before, with the effective "
        "mass m = 1 + m2 w^2 / (w^2 - omega^2).",
    )


def _with_resonators(beads: int, **keys: object) -> dict[str, object]:
    ingredients = {
        "precompression": {"force": OVERLAP * math.sqrt(OVERLAP)},
        "resonators": {"mass": MASS, "stiffness": SPRING},
    }
    return _weakly_kicked(beads, 200, **keys, **ingredients)


RESONATORS = Entry(
    title="Band gap of resonators",
    introduction="Equal beads with masses of 0.1 on springs of stiffness 1, under a static overlap of 0.25: a weak "
    "kick, and a drive in the gap.",
    sources={
        "kim2014": "abstract read: band gaps of woodpiles by the bending of their cylinders",
        "vorotnikov2017": "abstract read: pulses in a chain with resonators inside the beads",
    },
    scenes={
        "kicked": _with_resonators(160),
        "driven": _with_resonators(
            30, kick=None, drive={"displacement": 1e-4, "frequency": DRIVE / (2.0 * math.pi), "phase": -90}
        ),
    },
    statements=_resonators,
    axes=BANDS,
    draw=lambda axis, results: _draw_bands(axis, results["kicked"]["lammps"], OF_RESONATORS, exact=True),
    caption="Frequencies over wavenumber in the LAMMPS run, the exact branches, and the edges of the bands.",
)

# --- a column under gravity -------------------------------------------------------------------------------------------

DEPTHS = np.arange(60.0, 241.0, 20.0)


def _phase_velocity(run: Ran) -> float:
    """Exponent of the speed as a power of depth."""
    speed = [run.speed(int(above), int(below)) for above, below in pairwise(DEPTHS)]
    return exponent(np.array(speed), 0.5 * (DEPTHS[1:] + DEPTHS[:-1]))


def _gravity(results: Results) -> Statements:
    """Exponents of velocity and speed of a weak pulse as powers of depth."""
    falls = each(lambda run: exponent(run.peaks(DEPTHS), DEPTHS), results["column"])
    speed = each(_phase_velocity, results["column"])
    between = f"beads {DEPTHS[0]:g} to {DEPTHS[-1]:g}"
    yield state(
        MeasuredQuantity(f"exponent of the leading peak, {between}", falls, near(-0.25, 0.005, 0.02), "4"),
        published="The velocity of the leading peak falls as depth^(-0.250).",
        source="hong1998, abstract",
        correction=f"Down to {DEPTHS[-1]:g} beads it falls a little more slowly: the pulse still becomes broader.",
    )
    yield state(
        MeasuredQuantity(f"exponent of the speed, {between}", speed, near(1.0 / 6.0, 0.005, 0.02), "4"),
        published="The phase velocity grows as depth^(1/2 (1 - 1/p)), p being the exponent of the contact force.",
        source="hong1999, abstract",
        derived="p = 3/2: exponent 1/6.",
    )


def _draw_gravity(axis: Axes, results: Results) -> None:
    """Velocity over depth."""
    peaks = results["column"]["lammps"].peaks(DEPTHS)
    axis.loglog(DEPTHS, peaks, "o", color=COLOURS[0], label="LAMMPS")
    axis.loglog(DEPTHS, peaks[0] * (DEPTHS / DEPTHS[0]) ** -0.25, label=r"$\propto$ depth$^{-1/4}$", **PUBLISHED)


GRAVITY = Entry(
    title="A column under gravity",
    introduction="A vertical column of three hundred beads; the top one is kicked weakly.",
    sources={
        "hong1999": "abstract read",
        "hong1998": "abstract read",
    },
    scenes={"column": _weakly_kicked(300, 230, gravity=0.01, walls={"right": "flat"})},
    statements=_gravity,
    axes=("depth (beads)", r"velocity of the leading peak $v_\mathrm{max} / V$"),
    draw=_draw_gravity,
    caption="Velocity of the leading peak over depth.",
)
