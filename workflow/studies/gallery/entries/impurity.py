"""One bead that is lighter or heavier than the others."""

import numpy as np
from matplotlib.axes import Axes

from analysis.shape.exact_wave import solitary_wave
from workflow.studies.gallery.criteria import NAMES, Measured, at_least, at_most, near, state
from workflow.studies.gallery.entry import COLOURS, Entry, Ran, Results, chain, each, exponent
from workflow.studies.page import Statement

LIGHT, HEAVY = (0.05, 0.1, 0.2), (2.0, 8.0)
PLACE = 40


def _scene(mass: float) -> dict[str, object]:
    other = {"chain": 1, "bead": PLACE, "kind": "other"}
    return chain(90, 100, timestep=0.002, every=0.05, kinds={"other": {"mass": mass}}, replace=other)


def _name(mass: float) -> str:
    return f"mass-{mass:g}"


def _frequency(run: Ran) -> float:
    """Of the first oscillation of the impurity, while the wave presses on it most."""
    first, second = run.passages(PLACE)[:2]
    return float(1.0 / (second - first))


def statements(results: Results) -> list[Statement]:
    """Light beads oscillate, heavy ones reflect."""
    frequency = {mass: each(results[_name(mass)], _frequency) for mass in LIGHT}
    width = solitary_wave().width
    spectrum = each(results[_name(0.1)], lambda run: float(run.speed(60, 75)) / width)
    above = {engine: frequency[0.1][engine] / spectrum[engine] for engine in NAMES}
    slope = {
        engine: exponent(np.array([frequency[mass][engine] for mass in LIGHT]), np.array(LIGHT)) for engine in NAMES
    }
    passed = {mass: each(results[_name(mass)], lambda run: run.peak(70) / run.peak(PLACE - 15)) for mass in HEAVY}
    return [
        state(
            Measured(
                "frequency of mass 0.1 over one over the time in which the wave passes", above, at_least(1.0), "2"
            ),
            published="A light intruder oscillates while the wave passes, at frequencies above the wave's spectrum.",
            source="job2009, abstract",
            also=[
                f"mass {mass:g}, {NAMES[engine]}: {value:.4f} 1/T"
                for mass in LIGHT
                for engine, value in frequency[mass].items()
            ],
        ),
        state(
            Measured("exponent", slope, near(-0.5, 0.02, 0.1), "3"),
            published="The frequency follows from dimensional analysis.",
            source="job2009, abstract",
            derived="Contacts of unchanged stiffness: frequency as mass^(-1/2).",
            correction=f"mass^({slope['reference']:.2f}): the lightest bead remains longest within one wave.",
        ),
        state(
            Measured("mass 2: transmitted over incident velocity", passed[2.0], at_most(1.0)),
            Measured(
                "mass 8: the same, over that of mass 2",
                {engine: passed[8.0][engine] / passed[2.0][engine] for engine in NAMES},
                at_most(1.0),
            ),
            derived="A heavy bead reflects part of the wave, the more the heavier it is, and transmits a train of "
            "weaker waves.",
        ),
    ]


def draw(axis: Axes, results: Results) -> None:
    """The impurities over time."""
    for place, mass in enumerate((*LIGHT[1:2], *HEAVY)):
        run = results[_name(mass)]["lammps"].trajectory
        axis.plot(run.time, run.velocity[:, 0, PLACE - 1], color=COLOURS[place], label=f"mass {mass:g}")
    axis.set_xlim(42.0, 65.0)


ENTRY = Entry(
    title="An impurity",
    introduction="One bead of another mass in an otherwise uniform chain; its contacts are those of the other beads.",
    sources={
        "job2009": "abstract read; its intruders are smaller, not only lighter",
    },
    scenes={_name(mass): _scene(mass) for mass in (*LIGHT, *HEAVY)},
    statements=statements,
    axes=("time (T)", "velocity of the impurity (V)"),
    draw=draw,
    caption="A light impurity oscillates several times while the wave passes; heavy ones move slowly (LAMMPS).",
)
