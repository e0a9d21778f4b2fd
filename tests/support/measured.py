"""Force traces of two coupled steel chains before a rigid wall, in SI units, by scipy's DOP853 from Hertz's formulas:
nothing of the product is used. What a laboratory would measure, with noise.
"""

import functools
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Floats = NDArray[np.float64]

BEADS = 20
RADIUS, DENSITY, MODULUS, POISSON = 4.76e-3, 8000.0, 193e9, 0.3
COUPLING, KICK = 2.41e6, 1.0
TRUTH = {"material.youngs_modulus": MODULUS, "coupling.stiffness": COUPLING, "kick.velocity": KICK}

RATE = 1e6
"""Samples a second."""

LATE = 37.3e-6
"""By how much the table's times are later than the impact."""

NAMES = ("force_wall_right_chain_1", "force_contact_10_chain_1", "force_sensor_15_chain_2", "force_wall_right_chain_2")


def scene(**factors: float) -> dict[str, Any]:
    """Plain data of the scene, its fields off by factors."""
    return {
        "name": "steel",
        "chains": 2,
        "beads": BEADS,
        "coupling": {"stiffness": COUPLING * factors.get("coupling", 1.0)},
        "walls": {"right": "rigid"},
        "kick": {"velocity": KICK * factors.get("kick", 1.0)},
        "material": {
            "radius": RADIUS,
            "density": DENSITY,
            "youngs_modulus": MODULUS * factors.get("modulus", 1.0),
            "poisson_ratio": POISSON,
        },
        "duration": 6e-4,
    }


@functools.cache
def traces(last: float = 6e-4) -> tuple[Floats, Floats]:
    """Times (s) and forces (N), [time, trace] in the order of `NAMES`, without noise."""
    mass = 4.0 / 3.0 * math.pi * RADIUS**3 * DENSITY
    contact = MODULUS * math.sqrt(2.0 * RADIUS) / (3.0 * (1.0 - POISSON**2))
    wall = 4.0 / 3.0 * MODULUS / (1.0 - POISSON**2) * math.sqrt(RADIUS)
    # in micrometres and microseconds, where all numbers are near one
    size = 2 * BEADS

    def forces(x: Floats) -> tuple[Floats, Floats]:
        x = x.reshape(2, BEADS, *x.shape[1:])
        along = contact * np.maximum((x[:, :-1] - x[:, 1:]) * 1e-6, 0.0) ** 1.5
        return along, wall * np.maximum(x[:, -1] * 1e-6, 0.0) ** 1.5

    def rate(_: float, state: Floats) -> Floats:
        x = state[:size]
        along, at_wall = forces(x)
        total = np.zeros((2, BEADS))
        total[:, 1:] += along
        total[:, :-1] -= along
        total[:, -1] -= at_wall
        pull = COUPLING * 1e-6 * (x[:BEADS] - x[BEADS:])
        total += np.stack([-pull, pull])
        return np.concatenate([state[size:], (total / mass * 1e-6).reshape(-1)])

    start = np.zeros(2 * size)
    start[size] = KICK
    late = np.arange(0.0, last, 1.0 / RATE) - LATE
    at = np.concatenate([[0.0], late[late > 0.0]])
    found = solve_ivp(rate, (0.0, at[-1] * 1e6), start, t_eval=at * 1e6, method="DOP853", rtol=1e-10, atol=1e-12)
    along, at_wall = forces(found.y[:size, 1:])
    columns = [at_wall[0], along[0, 9], 0.5 * (along[1, 13] + along[1, 14]), at_wall[1]]
    before = int(np.sum(late <= 0.0))
    return late + LATE, np.pad(np.stack(columns, axis=1), ((before, 0), (0, 0)))


def table(
    path: Path,
    noise: float = 0.02,
    seed: int = 1,
    names: tuple[str, ...] = NAMES,
    change: Callable[[Floats], Floats] = np.copy,
) -> Path:
    """Write a table of traces, with normal noise of a share of each one's largest value, changed by a function."""
    time, force = traces()
    chosen = force[:, [NAMES.index(name) for name in names]]
    noisy = chosen + noise * chosen.max(axis=0) * np.random.default_rng(seed).standard_normal(chosen.shape)
    np.savetxt(
        path, np.column_stack([time, change(noisy)]), delimiter=",", header=",".join(("time", *names)), comments=""
    )
    return path
