"""Force traces of two coupled steel chains before a rigid wall, in SI units, by the integrator that shares no code
with the product: what a laboratory would measure, with noise.
"""

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scene_keys import units
from truth import Truth, force_of

from lammps_inputs import library

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
    case = library.from_plain(scene(), "steel")
    unit = units(case)
    truth = Truth(case, last / unit.time, 1e-10)
    late = np.arange(0.0, last, 1.0 / RATE) - LATE
    state = truth.states(late[late > 0.0] / unit.time)
    gauges = (("wall", 1, BEADS), ("contact", 1, 10), ("sensor", 2, 15), ("wall", 2, BEADS))
    columns = [force_of(truth.nature, *gauge)(*state) * unit.force for gauge in gauges]
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
