"""Sweep of the frequency of a drive in LAMMPS, up and then down, in steps of constant frequency.

Each step starts at phase 0 of the drive from the state in which the one before ended, the first at rest, and lasts
until transients have decayed.
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from granchain.parts import physics, rates
from workflow.plugins.derivatives import tangent
from workflow.plugins.modes.driven import at_period
from workflow.plugins.modes.lammps_check import PER_BOUND, lammps_problem, run
from workflow.plugins.modes.response import SAMPLES, largest

STEPS = 256
"""Steps of LAMMPS in a period, at least."""

DECAYED = 10.0
"""Logarithm by which the slowest small deviation decays within a step of the sweep."""

OVERSHOOT = 9.0
"""Energy of transients over that of the responses, up to which beads are large enough: three times the velocities."""

FEWEST, MOST = 20, 2000
"""Periods of a step, at least and at most."""


def computed(
    plain: dict[str, Any], source: str, periods: Sequence[float], energy: float, decay: float
) -> list[dict[str, Any]]:
    """Steps of the sweep in order, as plain data.

    Args:
        plain: the scene.
        source: its name in messages.
        periods: of the drive, from the lowest frequency to the highest, in units of T.
        energy: largest energy of the responses, in units of m V^2 (`OVERSHOOT`).
        decay: rate of decay of the slowest small deviation from rest, in 1 / T.

    Returns:
        Of each step ``direction``, "up" or "down"; ``period``; ``periods`` that were run; ``steps`` in a period;
        ``speed``, largest of each atom in the last period, [line, bead]; ``change`` of displacements and velocities by
        that period, over their size, displacements times the drive's angular frequency.
    """
    problem = tangent.problem_of(plain, source)
    bound = rates.stability_bound(problem.system)
    x, v = np.zeros((2, physics.lines(problem.system), problem.beads))
    sweep = []
    for direction, period in (*itertools.product(["up"], periods), *itertools.product(["down"], reversed(periods))):
        steps = SAMPLES * math.ceil(max(STEPS, PER_BOUND * period / bound) / SAMPLES)
        count = min(MOST, max(FEWEST, math.ceil(DECAYED / (decay * period))))
        driven = lammps_problem(at_period(problem, period), OVERSHOOT * energy, period, steps, count)
        for motion in driven.system.motions:
            place = motion.chain - 1, motion.bead - 1
            x[place], v[place] = 0.0, motion.velocity(0.0)
        frames = replace(driven, steps_per_frame=steps // SAMPLES, frames=SAMPLES * count)
        displacement, velocity = run(frames, x, v)
        x, v = displacement[-1].copy(), velocity[-1].copy()
        states = 2.0 * np.pi / period * displacement[-SAMPLES - 1 :: SAMPLES], velocity[-SAMPLES - 1 :: SAMPLES]
        before, after = np.swapaxes(np.array(states), 0, 1)
        sweep.append(
            {
                "direction": direction,
                "period": period,
                "periods": count,
                "steps": steps,
                "speed": largest(velocity[-SAMPLES:]).tolist(),
                "change": float(np.linalg.norm(after - before) / np.linalg.norm(after)),
            }
        )
    return sweep
