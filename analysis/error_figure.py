"""The figure of a validation: error over space and time, and each quantity against its tolerance."""

import matplotlib as mpl
import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from analysis.comparison import Deviation
from analysis.figures import STYLE, unit_label
from analysis.trajectory import Floats
from lammps_inputs import Problem


def validation_figure(
    problem: Problem,
    error_map: tuple[Floats, Floats],
    deviations: dict[str, Deviation],
    tolerances: dict[str, float],
) -> Figure:
    """Largest velocity error of any chain over bead and time; beside it, every quantity as a share of its tolerance.

    Args:
        problem: what was run.
        error_map: times [cell] and errors [cell, bead cell], see `analysis.comparison.Comparison.error_map`.
        deviations, tolerances: by quantity, dimensionless.
    """
    times, errors = error_map
    beads = problem.recorded_beads
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.0, 3.8), layout="constrained")
        space, bars = figure.subplots(1, 2, width_ratios=(1.6, 1.0))
        top = max(float(np.nanmax(errors, initial=0.0)), 1e-15)
        image = space.imshow(
            np.maximum(errors, top * 1e-6),
            origin="lower",
            aspect="auto",
            interpolation="nearest",
            extent=(beads[0] - 0.5, beads[-1] + 0.5, times[0] * problem.scale.time, times[-1] * problem.scale.time),
            cmap="cividis",
            norm=LogNorm(top * 1e-6, top),
            rasterized=True,
        )
        space.set_xlabel("bead")
        space.set_ylabel(f"time $t$ ({unit_label(problem, 'time')})")
        space.set_title("largest velocity error of any chain")
        figure.colorbar(image, ax=space).set_label("$|v - v_{ref}|$ / $V$")
        names = [name for name in deviations if np.isfinite(deviations[name].largest)]
        shares = np.maximum([deviations[name].largest / tolerances[name] for name in names], 1e-6)
        colours = ["#D55E00" if share > 1.0 else "#0072B2" for share in shares]
        bars.barh(names, shares, color=colours)
        bars.set_xscale("log")
        bars.set_xlim(min(1e-3, float(shares.min(initial=1.0)) / 2.0), max(10.0, 2.0 * float(shares.max(initial=1.0))))
        bars.axvline(1.0, color="black", linewidth=1.0)
        bars.invert_yaxis()
        bars.set_xlabel("largest error / tolerance")
        figure.suptitle(f"{problem.name}: against the reference")
    return figure
