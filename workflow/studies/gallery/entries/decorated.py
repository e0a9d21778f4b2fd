"""Small beads between large ones act as softer contacts between heavier beads."""

import math

import numpy as np
from matplotlib.axes import Axes

from analysis.shape.exact_wave import solitary_wave
from workflow.studies.gallery.criteria import Measured, near, state
from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Results, chain, each
from workflow.studies.page import Statement

RADII = (0.2, 0.3, 0.4)
PLAIN = 0.68163
"""Velocity of the wave of a plain kicked chain, V."""
SOURCE = "harbola2009decorated, abstract"


def _effective(radius: float) -> tuple[float, float]:
    """Contact constant and mass of the plain chain that a decorated one acts as.

    A small bead between two large ones is light: its two contacts feel the same force and share the overlap.
    """
    contact = (2.0 * radius / (1.0 + radius)) ** 0.5
    return contact / math.sqrt(8.0), 1.0 + radius**3


def _speed(radius: float, velocity: float) -> float:
    """Cells per unit time of the effective chain's solitary wave."""
    contact, mass = _effective(radius)
    return float((contact / mass) ** 0.4 * solitary_wave().speed_at(velocity))


def statements(results: Results) -> list[Statement]:
    """Speed and amplitude of the effective chain."""
    found = []
    for radius in RADII:
        runs = results[f"radius-{radius:g}"]
        velocity = runs["reference"].peak(81)
        expected = _speed(radius, velocity)
        speed = each(runs, lambda run: 0.5 * run.speed(61, 101))
        peak = each(runs, lambda run: run.peak(81))
        found.append(
            state(
                Measured("speed, cells per unit time", speed, near(expected, 2e-3 * expected), "4"),
                published="A decorated chain acts as a plain chain of renormalised mass and interaction.",
                source=SOURCE,
                derived=f"Radius {radius:g}: the light bead, between its two contacts in series, gives the contact "
                f"constant and mass of a plain chain whose wave of {velocity:.4f} V has the speed {expected:.4f}; "
                "required within 0.2%.",
            )
        )
        found.append(
            state(
                Measured("velocity of the leading pulse at bead 81", peak, near(PLAIN, 2e-3, 0.01), "4 V"),
                published="A decorated chain acts as a plain chain of renormalised mass and interaction.",
                source=SOURCE,
                derived=f"Radius {radius:g}: the wave of a plain kicked chain has {PLAIN} V.",
            )
        )
    return found


def draw(axis: Axes, results: Results) -> None:
    """Speed over the radius of the small beads."""
    every = np.linspace(0.15, 0.45, 50)
    axis.plot(every, [_speed(one, PLAIN) for one in every], label="effective chain", **PUBLISHED)
    found = [0.5 * results[f"radius-{radius:g}"]["lammps"].speed(61, 101) for radius in RADII]
    axis.plot(RADII, found, "o", color=COLOURS[0], label="LAMMPS")


ENTRY = Entry(
    title="Decorated chains",
    introduction="Small beads between large ones, all of the same material.",
    sources={
        "harbola2009decorated": "abstract read; the paper's own effective constants could not be read",
    },
    scenes={
        f"radius-{radius:g}": chain(
            141,
            140,
            timestep=0.002,
            kinds={"big": {"radius": 1}, "small": {"radius": radius}},
            pattern=["big", "small"],
        )
        for radius in RADII
    },
    statements=statements,
    axes=("radius of the small beads (share of that of the large ones)", "speed (cells / T)"),
    draw=draw,
    caption="Speed of the pulse over the radius of the small beads; the line is the effective chain's.",
)
