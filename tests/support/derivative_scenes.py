"""Small scenes of all ingredients that have derivatives, and their derivatives by differences of runs."""

import math
from typing import Any, NamedTuple

import numpy as np

from lammps_inputs import library
from lammps_inputs.limits.rates import stability_bound
from workflow.engines.reference import engine
from workflow.quantities.evaluate import of_frames
from workflow.sweep import fields

STEEL = {"radius": 0.01, "density": 7780.0, "youngs_modulus": 2e11, "poisson_ratio": 0.3}
CHAIN = {"name": "scene", "chains": 1, "beads": 8, "kick": {"velocity": 1.0}, "duration": 12.0}
PAIR = {**CHAIN, "chains": 2, "coupling": {"stiffness": 0.3}}
HELD = {"precompression": {"force": 0.3}, "walls": {"left": "bead", "right": "flat"}, "kick": {"velocity": 0.5}}
PLAIN = ("peak_velocity@6", "arrival@6", "speed@4", "participation")
SHORT = {**CHAIN, "beads": 5, "duration": 6.0}
EARLY = ("peak_velocity@4", "arrival@4", "speed@3", "participation")
AT_WALL = ("peak_velocity@4", "wall_force", "delay")


class Differentiable(NamedTuple):
    """A scene, quantities of it, and the fields by which they have derivatives."""

    keys: dict[str, Any]
    quantities: tuple[str, ...]
    by: tuple[str, ...]


SCENES = {
    "stiff": Differentiable(
        {**CHAIN, "contact": {"strength": 100.0}, "duration": 2.5}, PLAIN, ("kick.velocity", "contact.strength")
    ),
    "soft": Differentiable(
        {**CHAIN, "contact": {"strength": 0.01}, "duration": 80.0}, PLAIN, ("kick.velocity", "contact.strength")
    ),
    "fast": Differentiable({**CHAIN, "kick": {"velocity": 30.0}, "duration": 6.0}, PLAIN, ("kick.velocity",)),
    "steel": Differentiable(
        {**PAIR, "material": STEEL, "coupling": {"stiffness": 2e7}, "duration": 2.4e-4},
        ("peak_velocity@6", "arrival@6", "participation"),
        ("material.radius", "material.youngs_modulus", "coupling.stiffness"),
    ),
    "pair": Differentiable(PAIR, PLAIN, ("coupling.stiffness", "kick.velocity")),
    "striker": Differentiable(
        {**CHAIN, "kick": None, "striker": {"mass": 3.0, "velocity": 1.0}, "coupling": None},
        PLAIN,
        ("striker.mass", "striker.velocity"),
    ),
    "wall": Differentiable(
        {**CHAIN, "walls": {"right": {"stiffness": 50.0}}, "duration": 16.0}, AT_WALL, ("walls.right.stiffness",)
    ),
    "gap": Differentiable({**CHAIN, "gap": 0.3, "duration": 20.0}, PLAIN[:2], ("gap", "kick.velocity")),
    "exponent": Differentiable({**CHAIN, "contact": {"exponent": 2.0}}, PLAIN, ("contact.exponent",)),
    "ramp of strengths, light beads": Differentiable(
        {
            **CHAIN,
            "kinds": {"heavy": {"mass": 1.0}, "light": {"mass": 0.05}},
            "pattern": ["heavy", "light"],
            "contact": {"strength": {"from": 1.0, "to": 40.0, "contacts": [2, 5]}},
        },
        PLAIN,
        ("contact.strength.from", "kinds.light.mass", "kick.velocity"),
    ),
    "load, gravity, push": Differentiable(
        {
            **CHAIN,
            **HELD,
            "gravity": 0.05,
            "kick": None,
            "push": {"shape": "half-sine", "peak": 0.5, "duration": 2.0},
        },
        PLAIN[:2],
        ("precompression.force", "gravity", "push.peak"),
    ),
    "inner masses, foundation": Differentiable(
        {
            **PAIR,
            "foundation": {"stiffness": 0.2, "cubic": 0.1},
            "resonators": {"mass": 0.2, "stiffness": 3.0},
        },
        ("peak_velocity@4", "peak_velocity@6", "participation"),
        ("foundation.stiffness", "resonators.mass", "resonators.stiffness"),
    ),
    "viscoelastic, drag": Differentiable(
        {**CHAIN, **HELD, "damping": {"contact": 0.2, "law": "viscoelastic", "beads": 0.05, "tension": "allowed"}},
        PLAIN[:2],
        ("damping.contact", "damping.beads", "precompression.force"),
    ),
    "restitution": Differentiable(
        {**SHORT, "damping": {"contact": 0.8, "law": "restitution"}}, EARLY, ("damping.contact", "kick.velocity")
    ),
    "magnets": Differentiable(
        {
            **CHAIN,
            "contact": {"force": "A/(d+s)^p", "A": 1.0, "p": 4.0, "d": 1.0},
            "walls": {"left": "bead", "right": "bead"},
            "kick": {"velocity": 0.5},
            "duration": 6.0,
        },
        ("peak_velocity@6", "arrival@6"),
        ("contact.A",),
    ),
}


def scene_of(name: str) -> dict[str, Any]:
    """Plain data of a scene, whose duration is a whole number of times that between frames."""
    keys = {key: value for key, value in SCENES[name].keys.items() if value is not None}
    scene = library.from_plain(keys, name)
    frames = scene.problem().frames
    return scene.model_copy(update={"duration": frames * scene.resolved().output.every}).plain()


def values_of_run(plain: dict[str, Any], name: str, every: float) -> Any:
    """Quantities, [quantity], of an accurate run with frames that far apart, in units of the scene."""
    scene = library.from_plain({**plain, "output": {"every": every}}, name)
    problem = scene.problem()
    run = engine.run(problem, steps_per_frame=2 * engine.default_steps_per_frame(problem))
    values = of_frames(problem, run.blocks, scene, SCENES[name].quantities)
    return np.array([values[quantity] for quantity in SCENES[name].quantities], dtype=np.float64)


def differences(name: str, field: str) -> tuple[Any, Any]:
    """Derivatives [quantity] by a field from differences of accurate runs, extrapolated, and their uncertainties."""
    plain = scene_of(name)
    problem = library.from_plain(plain, name).problem()
    frames = problem.frames * math.ceil(problem.every / (0.02 * min(1.0, stability_bound(problem.system))))
    every = plain["duration"] / frames
    value = fields.look_up(plain, fields.parse(field, plain))

    def difference(share: float) -> Any:
        """Central difference, [quantity]."""
        low, high = (
            values_of_run(fields.put_all(plain, {field: value * (1.0 + side)}), name, every) for side in (-share, share)
        )
        return (high - low) / (2.0 * share * value)

    near, middle, far = (difference(share) for share in (5e-5, 1e-4, 2e-4))
    right, coarser = (4.0 * near - middle) / 3.0, (4.0 * middle - far) / 3.0
    return right, np.abs(right - coarser)
