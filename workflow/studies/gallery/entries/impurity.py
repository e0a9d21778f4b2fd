"""One bead that is lighter or heavier than the others."""

import numpy as np
from matplotlib.axes import Axes

from analysis.shape.exact_wave import solitary_wave
from workflow.studies.gallery.entry import (
    COLOURS,
    NAMES,
    Entry,
    Ran,
    Results,
    Statement,
    chain,
    claim,
    each,
    engines,
    number,
)

LIGHT, HEAVY = (0.05, 0.1, 0.2), (2.0, 8.0)
PLACE = 40


def _scene(mass: float) -> dict[str, object]:
    other = {"chain": 1, "bead": PLACE, "kind": "other"}
    return chain(90, 100, timestep=0.002, every=0.05, kinds={"other": {"mass": mass}}, replace=other)


def _name(mass: float) -> str:
    return f"mass-{mass:g}"


def _frequency(run: Ran) -> float:
    """Of the first swing of the impurity, while the wave presses on it most."""
    first, second = run.passages(PLACE)[:2]
    return float(1.0 / (second - first))


def statements(results: Results) -> list[Statement]:
    """Light ones swing, heavy ones throw back."""
    frequency = {mass: each(results[_name(mass)], _frequency) for mass in LIGHT}
    passes = each(results[_name(0.1)], lambda run: float(run.speed(60, 75)))
    spectrum = {engine: speed / solitary_wave().width for engine, speed in passes.items()}
    slope = {
        engine: float(np.polyfit(np.log(LIGHT), [np.log(frequency[mass][engine]) for mass in LIGHT], 1)[0])
        for engine in NAMES
    }
    passed = {mass: each(results[_name(mass)], lambda run: run.peak(70) / run.peak(PLACE - 15)) for mass in HEAVY}
    return [
        claim(
            "A light bead in the chain oscillates while the wave passes, faster than the wave's own spectrum.",
            [
                *(
                    line
                    for mass in LIGHT
                    for line in engines(frequency[mass], " 1/T", 4, f"mass {mass:g}: oscillations: ")
                ),
                *engines(spectrum, " 1/T", 4, "one over the time in which the wave passes: "),
            ],
            min(frequency[0.1].values()) > max(spectrum.values()),
        ),
        number(
            "Its frequency follows from dimensions: with the contacts' stiffness as they are, as mass^(-1/2).",
            -0.5,
            slope,
            within=0.02,
            roughly=0.1,
            form="3",
            correction=f"mass^({slope['reference']:.2f}): the lightest stay longest within one wave.",
        ),
        claim(
            "A heavy bead throws part of the wave back and lets a train of weaker ones on.",
            [
                line
                for mass in HEAVY
                for line in engines(
                    passed[mass], digits=5, label=f"mass {mass:g}: first wave behind it over incident one: "
                )
            ],
            max(passed[8.0].values()) < min(passed[2.0].values()) < 1.0,
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
    introduction="One bead of another mass in an otherwise uniform chain; its contacts are as the others'.",
    sources={
        "job2009": "abstract read; its intruders are smaller, not only lighter",
    },
    scenes={_name(mass): _scene(mass) for mass in (*LIGHT, *HEAVY)},
    statements=statements,
    axes=("time (T)", "velocity of the impurity (V)"),
    draw=draw,
    caption="A light impurity oscillates several times while the wave passes; heavy ones are slow (LAMMPS).",
)
