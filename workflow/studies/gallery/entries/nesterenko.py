"""Nesterenko's long-wave theory: speed, width, and how speed grows with amplitude and force."""

import math

import numpy as np
from matplotlib.axes import Axes

from analysis.shape.exact_wave import nesterenko, solitary_wave
from analysis.trajectory import Floats
from workflow.studies.gallery.entry import COLOURS, PUBLISHED, Entry, Ran, Results, Statement, chain, each, number

BEAD, FAR = 80, 110
HALF = 2.0 * math.acos(0.5**0.25) / math.pi
"""Full width at half maximum of cos**4, in its own width from end to end."""


def statements(results: Results) -> list[Statement]:
    """Constants of the wave, then the exponents of the train of a heavy striker."""
    single, train = results["single"], results["striker-4"]
    theory, exact = nesterenko(), solitary_wave()
    return [
        number(
            f"Speed: c = (4/5)^(2/5) V_m^(1/5) = {theory.speed:.4f} V_m^(1/5) beads per unit time.",
            theory.speed,
            each(single, lambda run: run.speed(60, 90) / run.peak(75) ** 0.2),
            within=1e-4,
            roughly=0.01,
            correction=f"{exact.speed:.5f}: the long-wave theory of the discrete chain is 0.8% too fast.",
        ),
        number(
            "Shape: velocities as cos^4 over five beads from end to end, so "
            f"{HALF * theory.width:.3f} beads wide at half their height.",
            HALF * theory.width,
            each(single, lambda run: run.width(BEAD)),
            within=0.005,
            roughly=0.25,
            form="3 beads",
            correction=f"{exact.width:.3f} beads: the wave of the discrete chain is an eighth narrower.",
        ),
        number(
            "Speed grows as the fifth root of the velocity of the beads: exponent 1/5.",
            0.2,
            each(train, lambda run: _slope(*_train(run)[:2])),
            within=0.002,
            form="4",
        ),
        number(
            "Speed grows as the sixth root of the force: exponent 1/6.",
            1.0 / 6.0,
            each(train, lambda run: _slope(_train(run)[2], _train(run)[1])),
            within=0.002,
            form="4",
        ),
    ]


def _slope(amplitude: Floats, speed: Floats) -> float:
    """Exponent of a power law."""
    return float(np.polyfit(np.log(amplitude), np.log(speed), 1)[0])


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
    introduction="The long-wave theory of an uncompressed chain, whose sound speed is zero: compact waves that are "
    "faster the stronger they are. A single kicked chain, and a striker of four beads' mass, which makes "
    "a train of them.",
    sources={
        "nesterenko1983": "long-wave theory, derived again in analysis/shape/exact_wave.py",
        "nesterenko2001": "long-wave theory",
        "coste1997": "abstract read: agreement with experiments without free parameter",
    },
    scenes={"single": chain(100, 125, every=0.05), "striker-4": chain(200, 200, striker={"mass": 4, "velocity": 1})},
    statements=statements,
    axes=("largest force", "speed (beads per unit time)"),
    draw=draw,
    caption="Speed of the pulses of one train over their force.",
)
