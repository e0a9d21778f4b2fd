"""A column under gravity: how a weak pulse decays with depth."""

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes

from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Ran, Results, Statement, chain, each, number

DEPTHS = np.arange(60, 241, 20)


def _peaks(run: Ran) -> "np.ndarray[tuple[int], np.dtype[np.float64]]":
    return np.array([run.peak(int(depth)) for depth in DEPTHS])


def statements(results: Results) -> list[Statement]:
    """Exponents of velocity and of speed over depth."""
    runs = results["column"]
    depth = np.log(DEPTHS)
    middle = np.log(0.5 * (DEPTHS[1:] + DEPTHS[:-1]))

    def speeds(run: Ran) -> float:
        speed = [run.speed(int(a), int(b)) for a, b in pairwise(DEPTHS)]
        return float(np.polyfit(middle, np.log(speed), 1)[0])

    return [
        number(
            "The velocity of the leading peak falls as depth^(-0.250).",
            -0.25,
            each(runs, lambda run: float(np.polyfit(depth, np.log(_peaks(run)), 1)[0])),
            within=0.005,
            roughly=0.02,
            form="4",
            correction="Down to some 240 beads it falls a little more slowly: the pulse still grows broader.",
        ),
        number(
            "The pulse's speed grows as depth^(1/2 (1 - 1/p)), with the exponent p = 3/2 of the contact force: 1/6.",
            1.0 / 6.0,
            each(runs, speeds),
            within=0.005,
            roughly=0.02,
            form="4",
        ),
    ]


def draw(axis: Axes, results: Results) -> None:
    """Velocity over depth."""
    peaks = _peaks(results["column"]["lammps"])
    axis.loglog(DEPTHS, peaks, "o", color=COLOURS[0], label="LAMMPS")
    axis.loglog(DEPTHS, peaks[0] * (DEPTHS / DEPTHS[0]) ** -0.25, label="depth^(-1/4)", **PUBLISHED)


ENTRY = Entry(
    title="A column under gravity",
    introduction="Three hundred beads one on top of the other; the top one is tapped.",
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
