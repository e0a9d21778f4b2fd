"""A column under gravity: how a weak pulse decays with depth."""

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes

from workflow.studies.gallery.criteria import Measured, near, state
from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Ran, Results, chain, each, exponent
from workflow.studies.page import Statement

DEPTHS = np.arange(60.0, 241.0, 20.0)


def _peaks(run: Ran) -> "np.ndarray[tuple[int], np.dtype[np.float64]]":
    return np.array([run.peak(int(depth)) for depth in DEPTHS])


def statements(results: Results) -> list[Statement]:
    """Exponents of velocity and of speed over depth."""
    runs = results["column"]
    middle = 0.5 * (DEPTHS[1:] + DEPTHS[:-1])

    def speeds(run: Ran) -> float:
        speed = [run.speed(int(a), int(b)) for a, b in pairwise(DEPTHS)]
        return exponent(np.array(speed), middle)

    falls = each(runs, lambda run: exponent(_peaks(run), DEPTHS))
    between = f"beads {DEPTHS[0]:g} to {DEPTHS[-1]:g}"
    return [
        state(
            Measured(f"exponent of the leading peak, {between}", falls, near(-0.25, 0.005, 0.02), "4"),
            published="The velocity of the leading peak falls as depth^(-0.250).",
            source="hong1998, abstract",
            correction=f"Down to {DEPTHS[-1]:g} beads it falls a little more slowly: the pulse still becomes broader.",
        ),
        state(
            Measured(f"exponent of the speed, {between}", each(runs, speeds), near(1.0 / 6.0, 0.005, 0.02), "4"),
            published="The phase velocity grows as depth^(1/2 (1 - 1/p)), p being the exponent of the contact force.",
            source="hong1999, abstract",
            derived="p = 3/2: exponent 1/6.",
        ),
    ]


def draw(axis: Axes, results: Results) -> None:
    """Velocity over depth."""
    peaks = _peaks(results["column"]["lammps"])
    axis.loglog(DEPTHS, peaks, "o", color=COLOURS[0], label="LAMMPS")
    axis.loglog(DEPTHS, peaks[0] * (DEPTHS / DEPTHS[0]) ** -0.25, label="depth^(-1/4)", **PUBLISHED)


ENTRY = Entry(
    title="A column under gravity",
    introduction="A vertical column of three hundred beads; the top one is kicked weakly.",
    sources={
        "hong1999": "abstract read",
        "hong1998": "abstract read",
    },
    scenes={
        "column": chain(
            300, 230, timestep=0.01, every=0.25, gravity=0.01, walls={"right": "flat"}, kick={"velocity": 1e-3}
        )
    },
    statements=statements,
    axes=("depth (beads)", "velocity of the leading peak (V)"),
    draw=draw,
    caption="Velocity of the leading peak over depth.",
)
