"""Distance to equipartition and final amplitude over coupling and number of chains, by the reference integrator.

Only the rows near the front are integrated; every case is computed a second time with a window twice as wide, and the
two must agree.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from granchain.parts import Problem, Survey, engine, leading_waves, library, style

MOST_BEADS = 12_000

NARROWEST, WIDEST = 80, 640
"""Rows of a window."""

THRESHOLD = 1e-6
"""Least peak velocity in units of V of a leading pulse: a weakly coupled far chain starts with pulses this small."""

SAME = 1e-6
"""Largest difference of peak velocities in units of V between a window and one twice as wide."""

DECAY_LENGTH = 2.709
"""Bead n* times kappa at which a pulse whose springs keep half their energy behind it has decayed (V = 1, N = 2)."""


@dataclass(frozen=True)
class Distance:
    """How far equipartition takes in equal chains of touching beads; dimensionless.

    Attributes:
        chains: number of chains.
        kappa: coupling.
        beads: length of the chains that were integrated.
        within_10: bead from which leading peaks agree to 10 % for half a beat; None if they do not.
        within_1: bead from which they agree to 1 %; None if they do not.
        amplitude: mean leading peak over the last half beat in units of V; NaN where a chain was not reached.
        window_error: largest difference of a leading peak from that of a window twice as wide, in units of V.
    """

    chains: int
    kappa: float
    beads: int
    within_10: int | None
    within_1: int | None
    amplitude: float
    window_error: float


def equipartition_distance(chains: int, kappa: float, most_beads: int = MOST_BEADS) -> Distance:
    """Find where the leading pulses agree, in chains as long as that takes, or of ``most_beads``."""
    slowest = 2.0 - 2.0 * math.cos(math.pi / chains)
    beads = min(most_beads, max(60, math.ceil(16.0 / (kappa * slowest))))
    while True:
        distance = _in_chains_of(beads, chains, kappa)
        if distance.within_1 is not None or beads >= most_beads:
            return distance
        beads = min(most_beads, 2 * beads)


def _in_chains_of(beads: int, chains: int, kappa: float) -> Distance:
    keys = {"chains": chains, "beads": beads, "duration": 10.0 * beads}
    scene = {"name": "distance", **keys, "coupling": {"stiffness": kappa}, "kick": {"velocity": 1.0}}
    problem = library.from_plain(scene, "distance").problem()
    window, error, waves = NARROWEST, math.inf, _waves(problem, NARROWEST)
    while error > SAME and window < WIDEST:
        window *= 2
        narrow, waves = waves, _waves(problem, window)
        error = _difference(narrow, waves)
    shared = Survey(problem, tuple, "maximum").replaced(passages=waves).shared
    return Distance(
        chains,
        kappa,
        beads,
        shared.agrees_from(0.1),
        shared.agrees_from(0.01),
        math.nan if shared.final is None else shared.final.value,
        error,
    )


def _waves(problem: Problem, window: int) -> leading_waves.Waves:
    """Leading waves without those of the last rows, which the free end disturbs."""
    window = min(window, problem.beads + 30)
    until = problem.beads - 5
    waves = leading_waves.with_speeds(*engine.passages(problem, rows=window, until_bead=until, threshold=THRESHOLD))
    return waves.where(waves.bead <= until - 5)


def _difference(narrow: leading_waves.Waves, wide: leading_waves.Waves) -> float:
    if len(narrow) != len(wide) or not np.array_equal(narrow.bead, wide.bead):
        return math.inf
    return float(np.max(np.abs(narrow.peak_velocity - wide.peak_velocity), initial=0.0))


@mpl.rc_context(style.STYLE)
def distance_map(distances: Sequence[Distance]) -> Figure:
    """Draw distance (bead from which amplitudes agree to 1 % and 10 %) and final amplitude over kappa."""
    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    distance_axes, amplitude_axes = figure.subplots(1, 2)
    numbers = sorted({case.chains for case in distances})
    colours = mpl.colormaps["viridis"](np.linspace(0.0, 0.85, len(numbers)))
    for colour, marker, chains in zip(colours, "osD^v<>", numbers, strict=False):
        cases = sorted((case for case in distances if case.chains == chains), key=lambda case: case.kappa)
        kappa = [case.kappa for case in cases]
        look = {"color": colour, "marker": marker, "markersize": 4}
        one_percent = [math.nan if case.within_1 is None else case.within_1 for case in cases]
        ten_percent = [math.nan if case.within_10 is None else case.within_10 for case in cases]
        distance_axes.plot(kappa, one_percent, label=f"{chains} chains, 1 %", **look)
        distance_axes.plot(
            kappa, ten_percent, label=f"{chains} chains, 10 %", **{**look, "marker": "", "linestyle": ":"}
        )
        amplitude_axes.plot(kappa, [case.amplitude for case in cases], label=f"{chains} chains", **look)
    ends = np.array([min(case.kappa for case in distances), max(case.kappa for case in distances)])
    law = {"color": "black", "linewidth": 1.0, "linestyle": (0, (5, 2))}
    distance_axes.plot(ends, DECAY_LENGTH / ends, label=rf"decay law {DECAY_LENGTH} / $\kappa$", **law)
    for axes in (distance_axes, amplitude_axes):
        axes.set_xscale("log")
        axes.set_xlabel(r"coupling $\kappa$ (at $V$ = 1)")
    distance_axes.set_yscale("log")
    distance_axes.set_ylabel("bead from which amplitudes agree")
    distance_axes.legend(fontsize=7)
    amplitude_axes.set_ylabel(r"final amplitude $v_\mathrm{max} / V$")
    amplitude_axes.set_ylim(bottom=0.0)
    amplitude_axes.legend()
    return figure
