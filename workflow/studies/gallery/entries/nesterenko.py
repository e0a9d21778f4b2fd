"""Nesterenko's long-wave theory: speed, width, and how speed grows with amplitude and force."""

import math

import numpy as np
from matplotlib.axes import Axes

from analysis.shape.exact_wave import nesterenko, solitary_wave
from analysis.trajectory import Floats
from workflow.studies.gallery.criteria import Measured, near, state
from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Ran, Results, chain, each, exponent
from workflow.studies.page import Statement

BEAD, FAR = 80, 110
HALF = 2.0 * math.acos(0.5**0.25) / math.pi
"""Full width at half maximum of cos**4, in its own width from end to end."""


def statements(results: Results) -> list[Statement]:
    """Constants of the wave, then the exponents of the train of a heavy striker."""
    single, train = results["single"], results["striker-4"]
    theory, exact = nesterenko(), solitary_wave()
    width = HALF * theory.width
    exponents = each(train, lambda run: exponent(_train(run)[1], _train(run)[0]))
    of_force = each(train, lambda run: exponent(_train(run)[1], _train(run)[2]))
    speed = each(single, lambda run: run.speed(60, 90) / run.peak(75) ** 0.2)
    return [
        state(
            Measured("speed over V_m^(1/5)", speed, near(theory.speed, 1e-4, 0.01)),
            published="Long-wave theory: a compact wave overlap^(1/2) = 5/4 (c cos)^2, velocity = c overlap.",
            source="nesterenko2001, ch. 1",
            derived=f"c = (4/5)^(2/5) V_m^(1/5) = {theory.speed:.4f} V_m^(1/5) beads per unit time.",
            correction=f"{exact.speed:.5f}: the long-wave theory of the discrete chain is 0.8% too fast.",
        ),
        state(
            Measured(
                "full width at half maximum",
                each(single, lambda run: run.width(BEAD)),
                near(width, 0.005, 0.25),
                "3 beads",
            ),
            published="The wave is cos^4, five beads wide.",
            source="nesterenko1983",
            derived=f"End to end 5 pi / sqrt(10) = {theory.width:.2f} beads, {width:.3f} at half the maximum.",
            correction=f"{exact.width:.3f} beads: the wave of the discrete chain is an eighth narrower.",
        ),
        state(
            Measured("exponent", exponents, near(0.2, 0.002), "4"),
            published="The speed grows as the fifth root of the velocity of the beads.",
            source="nesterenko1983",
        ),
        state(
            Measured("exponent", of_force, near(1.0 / 6.0, 0.002), "4"),
            published="The speed grows as the sixth root of the force.",
            source="nesterenko1983",
        ),
    ]


def _train(run: Ran) -> tuple[Floats, Floats, Floats]:
    """Velocities, speeds and forces of the pulses of a train that pass one bead, [pulse]."""
    before, at = run.train(FAR - 20, 0.1), run.train(FAR, 0.1)
    count = min(len(before), len(at))
    speed = 20.0 / (at.arrival[:count] - before.arrival[:count])
    read = run.forces(contacts=(FAR,))
    force = [
        float(np.max(read.force[np.abs(read.time - arrival - 0.5 / c) < 2.0, 0, 0]))
        for arrival, c in zip(at.arrival, speed, strict=False)
    ]
    return at.peak_velocity[:count], speed, np.array(force)


def draw(axis: Axes, results: Results) -> None:
    """Speed over force."""
    _, speed, force = _train(results["striker-4"]["lammps"])
    axis.loglog(force, speed, "o", color=COLOURS[0], label="pulses of a train (LAMMPS)")
    every = np.geomspace(force.min(), force.max(), 50)
    axis.loglog(every, speed[0] * (every / force[0]) ** (1.0 / 6.0), label="sixth root", **PUBLISHED)


ENTRY = Entry(
    title="Nesterenko's solitary wave",
    introduction="The long-wave theory of an uncompressed chain, whose sound speed is zero: compact waves whose "
    "speed grows with their amplitude. A single kicked chain, and a striker of four beads' mass, which makes a "
    "train of them.",
    sources={
        "nesterenko1983": "long-wave theory, derived again in analysis/shape/exact_wave.py",
        "nesterenko2001": "long-wave theory",
        "coste1997": "abstract read: agreement with experiments without free parameter",
    },
    scenes={"single": chain(100, 125, every=0.05), "striker-4": chain(200, 200, striker={"mass": 4, "velocity": 1})},
    statements=statements,
    axes=("largest contact force (m V / T)", "speed (beads / T)"),
    draw=draw,
    caption="Speed of the pulses of one train over their force.",
)
