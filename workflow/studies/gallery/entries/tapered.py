"""Each bead is smaller than the one before: hard spheres, binary collisions, and what is so."""

import numpy as np
from matplotlib.axes import Axes

from lammps_inputs import physics
from workflow.studies.gallery.entry import (
    COLOURS,
    NAMES,
    PUBLISHED,
    Entry,
    Ran,
    Results,
    Statement,
    chain,
    claim,
    each,
    number,
)

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
    return [
        *(
            number(
                f"Hard spheres: the last of {BEADS} beads, each {taper:.0%} smaller, gets {_hard_spheres(taper):.4f} "
                "of the energy.",
                _hard_spheres(taper),
                arrives[taper],
                within=0.005,
                roughly=0.06,
                form="4",
                correction="Hard spheres pass on too much: Hertzian beads share their energy with neighbours.",
            )
            for taper in TAPERS
        ),
        claim(
            "The larger the taper, the less arrives.",
            [f"{NAMES[engine]}: " + ", ".join(f"{arrives[taper][engine]:.4f}" for taper in TAPERS) for engine in NAMES],
            all(arrives[0.02][engine] > arrives[0.05][engine] > arrives[0.08][engine] for engine in NAMES),
        ),
        *(
            number(
                f"Binary collisions: from bead {FIRST} to {LAST} the velocity grows {_growth(taper):.4f} times (taper "
                f"{taper:.0%}).",
                _growth(taper),
                each(results[_name(taper)], lambda run: run.peak(LAST) / run.peak(FIRST)),
                within=0.01 * _growth(taper),
                roughly=0.2 * _growth(taper),
                form="4",
                correction="The trend is right, the number too large: beads do not meet two by two.",
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
    axes=("taper", "energy that the last bead gets (share)"),
    draw=draw,
    caption="Share of the kick's energy that comes out of twenty beads; the line is for hard spheres.",
)
