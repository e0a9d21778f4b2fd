"""Viscoelastic contacts: the decay of a pulse."""

import numpy as np
from matplotlib.axes import Axes

from workflow.studies.gallery.criteria import Measured, near, state
from workflow.studies.gallery.entry import COLOURS, Entry, Ran, Results, chain, each
from workflow.studies.page import Statement

COEFFICIENTS = (0.01, 0.002)
BEADS = np.arange(40, 101)


def _name(coefficient: float) -> str:
    return f"viscoelastic-{coefficient:g}"


def _inverse(run: Ran) -> "np.ndarray[tuple[int], np.dtype[np.float64]]":
    return np.array([run.peak(int(bead)) ** -0.2 for bead in BEADS])


def statements(results: Results) -> list[Statement]:
    """How the peak velocity to the power -1/5 rises."""
    return [
        state(
            Measured(
                "rise a bead over the coefficient",
                each(results[_name(one)], lambda run, one=one: float(np.polyfit(BEADS, _inverse(run), 1)[0]) / one),  # type: ignore[misc]
                near(0.07577, 1e-3, 4e-3),
            ),
            derived="For weak damping the peak velocity to the power -1/5 rises linearly along the chain, by "
            f"0.07577 times the coefficient a bead (exact wave; here {one:g}).",
            correction="Derived for vanishing damping.",
        )
        for one in COEFFICIENTS
    ]


def draw(axis: Axes, results: Results) -> None:
    """The same over distance."""
    for place, one in enumerate(COEFFICIENTS):
        axis.plot(BEADS, _inverse(results[_name(one)]["lammps"]), color=COLOURS[place], label=f"coefficient {one:g}")


ENTRY = Entry(
    title="Viscoelastic contacts",
    introduction="Dashpots in the contacts as of viscoelastic spheres: b overlap^(1/2) times the rate of overlap.",
    sources={
        "kuwabara1987": "the law; could not be read",
        "brilliantov1996": "the law; could not be read",
    },
    scenes={_name(one): chain(120, 130, damping={"contact": one, "law": "viscoelastic"}) for one in COEFFICIENTS},
    statements=statements,
    axes=("bead", "(peak velocity / V)^(-1/5)"),
    draw=draw,
    caption="Peak velocity to the power -1/5 along the chain (LAMMPS).",
)
