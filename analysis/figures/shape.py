"""The shape of the leading waves on that of the exact solitary wave."""

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.figures.style import CHAIN_COLOURS, STYLE, shown_chains, title
from analysis.shape.exact_wave import wave_of
from analysis.shape.waveforms import COMPARED, Waveforms
from lammps_inputs import Problem

MARKERS = "os^DvP*Xp"


def shape_figure(problem: Problem, waveforms: Waveforms, beads: Sequence[int]) -> Figure:
    """Velocity of chosen beads as the waves pass them, scaled to the exact wave of their peak; differences below.

    Args:
        problem: what was run.
        waveforms: of the leading waves.
        beads: one panel each.
    """
    exact, passages, chains = wave_of(problem.system), waveforms.passages, shown_chains(problem)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(1.0 + 3.2 * len(beads), 4.4), layout="constrained")
        axes = figure.subplots(2, len(beads), sharex=True, squeeze=False, height_ratios=(2.2, 1.0))
        for column, bead in enumerate(beads):
            above, below = axes[:, column]
            xi = np.linspace(-COMPARED, COMPARED, 241)
            above.plot(xi, exact.velocity(xi), color="black", linewidth=1.0, label="exact wave")
            below.axhline(0.0, color="black", linewidth=1.0)
            for place, chain in enumerate(chains):
                found = np.flatnonzero((passages.chain == chain + 1) & (passages.bead == bead))
                if len(found) == 0:
                    continue
                row, peak = found[0], passages.peak_velocity[found[0]]
                ahead = exact.speed_at(peak) * (passages.arrival[row] - waveforms.time[row])
                inside = np.isfinite(waveforms.velocity[row]) & (np.abs(ahead) <= COMPARED)
                ahead, velocity = ahead[inside], waveforms.velocity[row, inside] / peak
                look = {
                    "color": CHAIN_COLOURS[place % len(CHAIN_COLOURS)],
                    "marker": MARKERS[place % len(MARKERS)],
                    "linestyle": "none",
                    "markersize": 3.5,
                    "markerfacecolor": "none" if place % 2 else None,
                    "markevery": (place, len(chains)),
                }
                above.plot(ahead, velocity, label=f"chain {chain + 1}", **look)
                below.plot(ahead, velocity - exact.velocity(ahead), **look)
            above.set_title(f"bead {bead}", loc="left")
            if column == len(beads) - 1:
                above.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), handletextpad=0.3)
            below.set_xlabel("distance ahead of the peak (beads)")
            below.ticklabel_format(axis="y", scilimits=(-2, 2))
        axes[0, 0].set_ylabel("velocity / peak")
        axes[1, 0].set_ylabel("minus exact wave")
        figure.suptitle(title(problem, each_chain=True))
    return figure
