"""Each bead is smaller than the one before: hard spheres, binary collisions, and Hertzian contacts."""

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes

from lammps_inputs import physics
from workflow.studies.gallery.criteria import NAMES, Measured, at_most, near, state
from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Ran, Results, chain, each
from workflow.studies.page import Statement

BEADS = 20
TAPERS = (0.02, 0.05, 0.08)
FIRST, LAST = 5, 15


def _name(taper: float) -> str:
    return f"taper-{taper:g}"


def _hard_spheres(taper: float) -> float:
    """Share of the kick's energy that the last of twenty hard spheres gets, collision by collision."""
    f = (1.0 - taper) ** 3
    return float((4.0 * f / (1.0 + f) ** 2) ** (BEADS - 1))


def _growth(taper: float) -> float:
    """By what the velocity grows between two beads, collision by collision."""
    return float((2.0 / (1.0 + (1.0 - taper) ** 3)) ** (LAST - FIRST))


def _arrives(run: Ran) -> float:
    """Largest kinetic energy of the last bead, in that of the kick."""
    mass = physics.mass_of(run.problem.system, slice(None), -1)
    return float(np.max(0.5 * mass * run.trajectory.velocity[:, :, -1] ** 2) / physics.energy(run.problem.system))


def statements(results: Results) -> list[Statement]:
    """Energy that arrives, and how velocities grow."""
    arrives = {taper: each(results[_name(taper)], _arrives) for taper in TAPERS}
    growth = {taper: each(results[_name(taper)], lambda run: run.peak(LAST) / run.peak(FIRST)) for taper in TAPERS}
    falls = [{engine: arrives[b][engine] / arrives[a][engine] for engine in NAMES} for a, b in pairwise(TAPERS)]
    return [
        *(
            state(
                Measured("share of the energy", arrives[taper], near(_hard_spheres(taper), 0.005, 0.06), "4"),
                published="Hard spheres: the last of n beads gets [4 f / (1 + f)^2]^(n - 1) of the energy.",
                source="doney2005, as quoted",
                derived=f"n = {BEADS}, each {taper:.0%} smaller, f = (1 - {taper:g})^3: {_hard_spheres(taper):.4f}, "
                "taken for Hertzian beads.",
                correction="Hard spheres transmit too much: Hertzian beads share their energy with neighbours.",
            )
            for taper in TAPERS
        ),
        state(
            *(
                Measured(f"share at {b:.0%} over that at {a:.0%}", fall, at_most(1.0), "4")
                for (a, b), fall in zip(pairwise(TAPERS), falls, strict=True)
            ),
            derived="The larger the taper, the smaller the share of the energy that arrives.",
        ),
        *(
            state(
                Measured(
                    "ratio of the velocities",
                    growth[taper],
                    near(_growth(taper), 0.01 * _growth(taper), 0.2 * _growth(taper)),
                    "4",
                ),
                published="The binary collision approximation gives quantitatively accurate results.",
                source="harbola2009, abstract",
                derived=f"Taper {taper:.0%}: from bead {FIRST} to {LAST} the velocity grows by the factor "
                f"{_growth(taper):.4f}; required within 1%.",
                correction="The trend is right, the number too large: beads do not collide in pairs.",
            )
            for taper in TAPERS
        ),
    ]


def draw(axis: Axes, results: Results) -> None:
    """Energy that arrives over the taper."""
    every = np.linspace(0.0, 0.09, 50)
    axis.plot(every, [_hard_spheres(one) for one in every], label="hard spheres", **PUBLISHED)
    found = [_arrives(results[_name(taper)]["lammps"]) for taper in TAPERS]
    axis.plot(TAPERS, found, "o", color=COLOURS[0], label="LAMMPS")


ENTRY = Entry(
    title="Tapered chains",
    introduction="Twenty beads, each smaller than the one before by the same share: a shock absorber.",
    sources={
        "doney2005": "could not be read; the formula follows from two-body collisions",
        "harbola2009": "abstract read: binary collisions quantitatively accurate",
        "machado2013": "abstract read: trends right, energies and momenta not in good quantitative agreement",
    },
    scenes={_name(taper): chain(BEADS, 25, timestep=0.002, every=0.02, taper=taper) for taper in TAPERS},
    statements=statements,
    axes=("taper (decrease of the radius from bead to bead)", "energy of bead 20 (share of the kick)"),
    draw=draw,
    caption="Largest kinetic energy of bead 20 as a share of that of the kick; the line is for hard spheres.",
)
