"""Contacts that stiffen along the chain: the velocity of the pulse stays, its force and speed grow."""

import math

import numpy as np
from matplotlib.axes import Axes

from lammps_inputs import laws
from workflow.studies.gallery.criteria import Measured, near, state
from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Ran, Results, chain, each
from workflow.studies.page import Statement

SOURCE = "chaunsali2018, abstract"
LAST = 4.0
"""Strength behind the ramp, over that before it."""

RAMPS = {"ramp-100": (50, 150), "ramp-10": (100, 110), "jump": (100, 101)}
"""Contacts at which the ramp begins and ends."""

BEFORE, BEHIND = 40, 200
"""Beads, and contacts, at which the pulse is measured."""


def _velocity(run: Ran) -> float:
    return run.peak(BEHIND) / run.peak(BEFORE) - 1.0


def _force(run: Ran) -> float:
    before, behind = run.forces(contacts=(BEFORE, BEHIND)).largest[0]
    return math.log(behind / before) / math.log(LAST)


def _speed(run: Ran) -> float:
    return math.log(run.speed(BEHIND - 20, BEHIND + 20) / run.speed(BEFORE - 15, BEFORE)) / math.log(LAST)


def statements(results: Results) -> list[Statement]:
    """Velocity, force and speed behind a slow ramp; how much a steeper one scatters."""
    slow = results["ramp-100"]
    return [
        state(
            Measured("change of the peak velocity", each(slow, _velocity), near(0.0, 2e-3)),
            published="The gradient in stiffness accelerates the impulse wave without a significant scattering.",
            source=SOURCE,
            derived="A pulse that keeps its momentum and energy keeps its velocity V_m, as all beads have one mass.",
        ),
        state(
            Measured("exponent", each(slow, _force), near(0.4, 1e-3), "4"),
            published="The gradient in stiffness results in the scaling of contact forces along the chain.",
            source=SOURCE,
            derived="F_m grows as A^(2/5) V_m^(6/5), so as A^0.4.",
        ),
        state(
            Measured("exponent", each(slow, _speed), near(0.4, 1e-3), "4"),
            derived="The speed grows as A^(2/5) V_m^(1/5), so as A^0.4.",
        ),
        *(
            state(
                Measured("change of the peak velocity", each(results[name], _velocity), near(0.0, 2e-3, 0.1)),
                derived=f"A ramp over {last - first} contact{'s' * (last - first > 1)} does not change the velocity.",
                correction="The pulse is about five beads long: a shorter ramp scatters it.",
            )
            for name, (first, last) in RAMPS.items()
            if name != "ramp-100"
        ),
    ]


def draw(axis: Axes, results: Results) -> None:
    """Local speed over local strength."""
    run = results["ramp-100"]["lammps"]
    waves, strength = run.waves.of_chain(1), np.asarray(laws.strength(run.problem.system.along[0].law))[0]
    inside = (waves.bead > 30) & (waves.bead < 160)
    at = strength[waves.bead[inside] - 1]
    axis.loglog(at, waves.speed[inside], "o", markersize=3, color=COLOURS[0], label="LAMMPS")
    every = np.geomspace(1.0, LAST, 50)
    axis.loglog(every, run.speed(BEFORE - 15, BEFORE) * every**0.4, label="strength^0.4", **PUBLISHED)


ENTRY = Entry(
    title="Graded contacts",
    introduction="Contacts become four times as stiff along the chain, as between cylinders whose crossing angle "
    "changes: the pulse keeps its velocity, and becomes faster and stronger.",
    sources={"chaunsali2018": "abstract read: acceleration without significant scattering, scaling of forces"},
    scenes={
        name: chain(260, 293, contact={"strength": {"from": 1.0, "to": LAST, "contacts": [*ends]}})
        for name, ends in RAMPS.items()
    },
    statements=statements,
    axes=("strength of the contact (first contact = 1)", "speed (beads / T)"),
    draw=draw,
    caption="Speed of the leading pulse over the strength of the contacts that it passes; ramp over 100 contacts.",
)
