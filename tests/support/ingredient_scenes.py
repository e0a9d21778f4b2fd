"""A scene of every ingredient, of the ways that it can be given, and of those that meet in one force or one deck."""

import math
from functools import cache
from typing import Any

import numpy as np
from scene_keys import units
from scenes_nature import Units
from truth import Truth

from lammps_inputs import Scene, library

STEEL = {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3}

DIMER = {"kinds": {"heavy": {"mass": 1.0}, "light": {"mass": 0.3428}}, "pattern": ["heavy", "light"]}
SIZES = {"kinds": {"big": {}, "small": {"radius": 0.7}}, "pattern": ["big", "big", "small"]}
UNLIKE = {
    "kinds": {"heavy": {"mass": 1.0}, "light": {"mass": 0.5, "stiffness": 2.0}},
    "pattern": [["heavy"], ["light"]],
}

WALLS = {"walls": {"left": "rigid", "right": {"stiffness": 5.0}}}
AT_END = {"walls": {"left": {"stiffness": 2.0}, "right": {"stiffness": 5.0}}}
PRESSED = {"precompression": {"force": 0.3}}
HELD = {**PRESSED, "walls": {"left": "bead", "right": "flat"}}
COLUMN = {"gravity": 0.02, "walls": {"right": "flat"}}
PRESSED_COLUMN = {**AT_END, "gravity": 0.05, "precompression": {"force": 0.2}}
TIED = {"stiffness": 0.1}
MOVED = {"displacement": 0.5, "frequency": 0.3, "phase": -60.0}
FORCED = {"chain": 2, "bead": 4, "force": 0.4, "frequency": 0.2, "phase": 30.0}

LOSSES: dict[str, dict[str, Any]] = {
    "linear": {"contact": 0.2},
    "viscoelastic": {"contact": 0.3, "law": "viscoelastic"},
    "restitution": {"contact": 0.7, "law": "restitution"},
    "all": {"contact": 0.1, "beads": 0.05, "coupling": 0.1},
}


def exponent(p: Any, profile: Any = None, **more: Any) -> dict[str, Any]:
    return {"contact": {"exponent": p, **({} if profile is None else {"strength": profile})}, **more}


def strength(profile: Any, **more: Any) -> dict[str, Any]:
    return {"contact": {"strength": profile}, **more}


RISING = {"from": 1.0, "to": 4.0, "contacts": [2, 6]}
WAVY = {"mean": 1.2, "amplitude": 0.5, "wavenumber": 0.618, "phase": 40.0}
RANDOM = {"spread": 0.3, "seed": 4}

RISING_BED = {"from": 0.1, "to": 0.6, "rows": [2, 7]}
MODULATED = {"depth": 0.5, "frequency": 0.3, "phase": 30.0}
VANISHING = {"from": 0.3, "to": 0.0, "times": [0.1, 3.3]}
SOFTENING = {"from": 0.9, "to": 0.2, "times": [1.37, 9.1]}
KINDS = [
    {"mass": 0.3, "stiffness": 0.2, "rows": [2, 5]},
    {"mass": 0.1, "stiffness": 0.5, "rows": [4, 7]},
    {"mass": 0.2, "stiffness": 0.9, "rows": [7, 8]},
]
SATURATING = {"force": "k*s/sqrt(1+(s/s0)^2)", "k": 0.3, "s0": 0.5}
MAGNETS = {"force": "A/(d+s)^p", "A": 0.2, "p": 4.0, "d": 1.0}

EQUAL = [[0.2 * k, 0.36 * math.sin(math.pi * k / 100) ** 2 if k % 100 else 0.0] for k in range(101)]
UNEQUAL = [[0.3 + (k / 30) ** 3, 0.5 * math.sin(math.pi * k / 60) ** 2 * (k < 60)] for k in range(61)]

RECORDED: list[dict[str, Any]] = [
    {"bead": 1, "velocity": 0.3, "until": 7.1},
    {"bead": 1, "displacement": 0.05, "frequency": 0.2, "phase": 40.0},
    {"bead": 1, "displacement": 0.04, "frequency": 0.33},
    {"bead": 8, "quantity": "displacement", "table": [[1.3, 0], [2.1, -0.2], [3.7, 0.1], [5, 0.1], [8.2, -0.3]]},
    {"chain": 2, "bead": 4, "quantity": "velocity", "table": [[0.7, 0.2], [2.1, -0.4], [4.9, 0.1]]},
    {"chain": 2, "bead": 4, "velocity": -0.1, "from": 5.3},
]
"""Motions of three beads, of which two have several."""
STARTS = [
    {"bead": 1, "displacement": 0.5},
    {"chain": 2, "bead": 8, "displacement": -0.3, "velocity": -0.2},
    {"bead": 3, "velocity": 0.3},
]
TABLE = [[1, 2, -0.4, 0.1], [2, 8, 0.2, 0.0], [3, 5, 0.3, -0.2], [4, 1, -0.3, 0.0]]

CASES: dict[str, dict[str, Any]] = {
    "one chain": {"chains": 1, "coupling": None},
    "gap": {"gap": 0.3},
    "gaps that differ, walls": {"gap": [0.1, 0.0, 0.4, 0.2, 0.0, 0.5, 0.1], **WALLS},
    "random gaps, foundation cubic": {
        "gap": {"mean": 0.3, "spread": 0.8, "seed": 2},
        "coupling": None,
        "foundation": {"stiffness": 0.3, "cubic": 0.2},
    },
    "ramp": {"chains": 3, "coupling": {"stiffness": {"from": 0.0, "to": 0.9, "rows": [2, 7]}}},
    "ring": {"chains": 4, "coupling": {"stiffness": 0.4, "topology": "ring"}},
    "lattice": {"chains": 6, "coupling": {"stiffness": 0.4, "topology": {"lattice": [2, 3]}}},
    "edges": {"chains": 4, "coupling": {**TIED, "topology": {"edges": [[4, 1, 0.3], [1, 3], [2, 3, 0.05]]}}},
    "cubic": {"coupling": {"stiffness": 0.2, "cubic": 0.7}},
    "cubic ring": {"chains": 4, "coupling": {"cubic": 0.7, "rows": [2, 6], "topology": "ring"}},
    "foundation": {"foundation": {"stiffness": 0.5}},
    "foundation rising, modulated": {
        "foundation": {"stiffness": RISING_BED, "modulation": MODULATED, "rows": [1, 6]},
    },
    "foundations over time": {
        "foundation": {"stiffness": [{"from": 0.3, "to": 0.9, "times": [0, 12]}, SOFTENING], "cubic": 0.2},
    },
    "foundation that vanishes in time beside a graded one": {
        "foundation": {"stiffness": [VANISHING, RISING_BED], "modulation": MODULATED},
    },
    "foundation by chain": {"foundation": {"stiffness": [0.5, 0.2], "cubic": 0.3}},
    "walls": WALLS,
    "dashpots at the ends of a dimer": {**DIMER, "walls": {"left": {"damping": 0.4}, "right": {"damping": 0.2}}},
    "matched end of a column": {**COLUMN, "walls": {"left": "matched", "right": "flat"}},
    "matched end, drag, pressed": {
        **PRESSED,
        "walls": {"left": {"damping": 0.3}, "right": "matched"},
        "damping": {"beads": 0.1},
    },
    "dashpot at an end, damped contacts": {"walls": {"right": {"damping": 0.2}}, "damping": {"contact": 0.02}},
    "closed to rings": {"periodic": True},
    "closed to rings of sizes": {
        **SIZES,
        "periodic": True,
        "gap": {"mean": 0.2, "spread": 0.8},
        "coupling": None,
        "chains": 1,
    },
    "closed to rings, damped": {"periodic": True, "damping": LOSSES["viscoelastic"]},
    "closed to rings, random contacts, resonators": strength(
        RANDOM, periodic=True, resonators={"mass": 0.3, "stiffness": 0.8}
    ),
    "bonded rings, initial states": {
        "periodic": True,
        "contact": {"force": "k*s", "k": 0.7, "tension": "allowed"},
        "initial": STARTS,
        "kick": None,
    },
    "dimer": DIMER,
    "dimer of sizes": SIZES,
    "impurity": {"kinds": {"steel": {"mass": 8.0, "stiffness": 2.0}}, "replace": {"bead": 6, "kind": "steel"}},
    "taper": {"taper": 0.05},
    "disorder": {"disorder": {"mass": 0.1, "radius": 0.1, "stiffness": 0.3, "seed": 5}},
    "striker": {"striker": {"mass": 3.0, "velocity": 1.0}, "kick": None},
    "exponent 1": exponent(1.0),
    "exponents by contact": exponent([1.5, 1.0, 1.5, 1.5, 1.0, 1.5, 1.5], RISING, kick={"velocity": 0.5}),
    "exponents by chain, damped": exponent([[1.0] * 7, [1.5] * 3 + [1.0] * 4], damping=LOSSES["linear"]),
    "walls of exponent 3, gap": exponent(3.0, **AT_END, gap=0.3),
    "wavy contacts, gap, walls": strength(WAVY, gap=0.3, **AT_END),
    "random contacts": strength(RANDOM),
    "random contacts of a dimer of sizes": strength({**RISING, **RANDOM}, **SIZES),
    "graded contacts, pressed": strength(RISING, **HELD),
    "graded column of exponent 1": exponent(1.0, RISING, gravity=0.05, walls={"right": "bead"}),
    "random contacts, damping viscoelastic": strength(RANDOM, damping=LOSSES["viscoelastic"], coupling=None, **PRESSED),
    "graded contacts, damping restitution, pressed": strength(RISING, damping=LOSSES["restitution"], **PRESSED),
    "pressed column of exponent 2": exponent(2.0, **PRESSED_COLUMN),
    "resonators of two kinds, in some rows": {"resonators": KINDS},
    "resonators by chain, column, dimer": {
        **COLUMN,
        **DIMER,
        "coupling": None,
        "resonators": {"mass": [0.2, 0], "stiffness": [0.5, 1]},
    },
    "resonators, damped, driven, walls, foundation, drag": {
        **WALLS,
        "drive": [MOVED, FORCED],
        "kick": None,
        "resonators": {"mass": 0.3, "stiffness": 0.8, "damping": 0.2},
        "foundation": {"stiffness": 0.3},
        "damping": {"beads": 0.2},
    },
    "resonators, damped in some rows, pushed, with all other dashpots": {
        "resonators": {"mass": [0.3, 0.5], "stiffness": 0.8, "damping": [0.2, 0.3], "rows": [2, 5]},
        "damping": LOSSES["all"],
        "push": {"bead": 2, "peak": 0.8, "duration": 2.0, "shape": "half-sine"},
    },
    "pressed": PRESSED,
    "pressed between walls": HELD,
    "pressed to an overlap, exponent 2": {
        "contact": {"exponent": 2.0, "strength": 1.5},
        "precompression": {"overlap": 0.5},
        "walls": {"left": "bead", "right": "bead"},
    },
    "column": COLUMN,
    "unlike columns": {**COLUMN, **UNLIKE, "coupling": None},
    "damping viscoelastic, cut": {"damping": {**LOSSES["viscoelastic"], "tension": "cut"}},
    "damping viscoelastic, exponent 1, pressed": exponent(1.0, damping=LOSSES["viscoelastic"], **PRESSED),
    "damping all, exponent 2, pressed": exponent(2.0, damping=LOSSES["all"], **PRESSED),
    "damping cut, pressed by a wall": {
        "damping": {"contact": 0.2, "tension": "cut"},
        **PRESSED,
        "walls": {"right": {"stiffness": 5.0}},
    },
    "damping restitution, wall, gap": {
        "damping": LOSSES["restitution"],
        "walls": {"right": {"stiffness": 5.0}},
        "gap": 0.3,
    },
    "damped column": {**COLUMN, "damping": {"contact": 0.1, "coupling": 0.1}},
    "pushed": {
        "kick": None,
        "push": [
            {"peak": 0.6, "duration": 20.3, "shape": "half-sine"},
            {"chain": 2, "bead": 3, "table": [[0, 0.2], [0.7, 0.5], [2, -0.1], [3, 0]]},
        ],
    },
    "pushed by long records": {"kick": None, "push": [{"table": EQUAL}, {"chain": 2, "bead": 3, "table": UNEQUAL}]},
    "formulas of springs": {
        "coupling": {**SATURATING, "rows": [2, 7]},
        "foundation": {"force": "f*sin(s/s0)", "f": 0.2, "s0": 0.6},
    },
    "magnets": {"contact": MAGNETS, "walls": {"left": "bead", "right": "bead"}, "kick": {"velocity": 0.3}},
    "formula of contacts, damped, wall": {
        "contact": {"force": "a*s^1.5*(1+s/s0)", "a": 1.0, "s0": 2.0},
        "damping": {"contact": 0.2},
        "walls": {"right": "bead"},
    },
    "driven": {"drive": [MOVED, FORCED], "kick": None},
    "driven by two tones, a piston and records": {"drive": RECORDED, "kick": None},
    "driven by records, damped": {"drive": RECORDED[:2] + RECORDED[3:], "kick": None, "damping": LOSSES["all"]},
    "initial states, gap, kicked": {"initial": STARTS, "gap": 0.1, "kick": {"bead": 3, "velocity": 0.4}},
    "initial states of all atoms, pressed, damped, walls": {
        **HELD,
        "initial": {"table": TABLE},
        "resonators": {"mass": 0.3, "stiffness": 0.8},
        "foundation": {"stiffness": 0.3},
        "damping": {"beads": 0.1},
        "kick": None,
    },
    "pushed before unlike walls": {
        **SIZES,
        "pattern": [["big"], ["small", "small"]],
        "walls": {"left": "flat", "right": "bead"},
        "push": {"bead": 2, "peak": 0.8, "duration": 2.0, "shape": "half-sine"},
        "kick": None,
    },
}


def scene(name: str, **changes: Any) -> Scene:
    """A case: two chains of eight beads, kappa = 0.1, bead 1 of chain 1 kicked, unless it says otherwise."""
    return _changed(name, changes) if changes else _as_it_is(name)


@cache
def _as_it_is(name: str) -> Scene:
    """A case without changes, read once: formulas take a second."""
    return _changed(name, {})


def _changed(name: str, changes: dict[str, Any]) -> Scene:
    plain = {
        "name": "test",
        "chains": 2,
        "beads": 8,
        "coupling": TIED,
        "kick": {"velocity": 1.0},
        "duration": 12.0,
        "timestep": 0.01,
        "output": {"every": 0.5},
    }
    keys = {**plain, **CASES[name], **changes}
    return library.from_plain({key: value for key, value in keys.items() if value is not None}, "test")


@cache
def exact(name: str) -> Any:
    """Velocities at the frames of a case, [frame, chain, bead], by the integrator that shares no code."""
    problem = scene(name).problem()
    return Truth(scene(name), problem.duration, 1e-11).states(problem.every * np.arange(problem.frames + 1))[1]


def in_units(name: str, velocity: float, material: dict[str, float] | None = None) -> Scene:
    """A case in reduced units or, with a material, in SI, with so many times its velocities: the same problem.

    The numbers of its keys follow from the formulas of the units, which are independent of the product's.
    """
    keys = {**scene(name).plain(), **CASES[name]}
    one, p = units(scene(name)), CASES[name].get("contact", {}).get("exponent", 1.5)
    mass, strength = 1.0, 1.0
    if material is not None:
        mass = 4.0 / 3.0 * np.pi * material["radius"] ** 3 * material["density"]
        plane = material["youngs_modulus"] / (1.0 - material["poisson_ratio"] ** 2)
        strength = plane * np.sqrt(2.0 * material["radius"]) / 3.0 if p == 1.5 else 1e10
    length = (mass * (velocity * one.velocity) ** 2 / strength) ** (1.0 / (p + 1.0)) / one.length
    unit = Units(mass, length, velocity)
    dashpot = unit.force / unit.velocity
    losses = {"viscoelastic": dashpot / unit.length**0.5, "restitution": 1.0}
    spring = {"": unit.stiffness, "from": unit.stiffness, "to": unit.stiffness, "times": unit.time}
    formula = {"k": unit.stiffness, "s0": unit.length, "d": unit.length, "f": unit.force}
    formula |= {"A": unit.force * unit.length**4, "a": unit.force / unit.length**1.5}
    springs = {**formula, "stiffness": spring, "cubic": unit.stiffness / unit.length**2}
    drive = {"displacement": unit.length, "force": unit.force, "frequency": 1.0 / unit.time}
    drive |= {"velocity": velocity, "from": unit.time, "until": unit.time}
    second = {"displacement": unit.length, "velocity": velocity}
    driven = keys["drive"] if isinstance(keys.get("drive"), list) else [{}]
    drives = tuple({**drive, "table": (unit.time, second.get(one.get("quantity"), 1.0))} for one in driven)
    worth = {
        "gap": {"": unit.length, "mean": unit.length},
        "contact": formula,
        "coupling": {**springs, "topology": {"edges": (1, 1, unit.stiffness)}},
        "foundation": {**springs, "modulation": {"frequency": 1.0 / unit.time}},
        "walls": {side: {"stiffness": unit.force / unit.length**p, "damping": dashpot} for side in ("left", "right")},
        "precompression": {"force": unit.force, "overlap": unit.length},
        "gravity": unit.length / unit.time**2,
        "damping": {
            "contact": losses.get(CASES[name].get("damping", {}).get("law"), dashpot),
            "beads": dashpot,
            "coupling": dashpot,
        },
        "drive": drives if isinstance(keys.get("drive"), list) else drives[0],
        "push": {"peak": unit.force, "duration": unit.time, "table": (unit.time, unit.force)},
        "resonators": {"mass": mass, "stiffness": unit.stiffness, "damping": dashpot},
        "initial": {"displacement": unit.length, "velocity": velocity, "table": (1, 1, unit.length, velocity)},
        "kick": {"velocity": velocity},
        "striker": {"velocity": velocity, "mass": mass},
        "duration": unit.time,
        "timestep": unit.time,
        "output": {"every": unit.time},
    }
    ball = material or {"radius": 1.0}
    kind = {"mass": mass, "radius": ball["radius"], "stiffness": ball.get("youngs_modulus", 1.0)}
    keys = _times(keys, {**worth, "kinds": dict.fromkeys(keys.get("kinds", ()), kind)})
    if material is not None:
        keys["material"] = material
        for own in keys.get("kinds", {}).values():
            if "stiffness" in own:  # by modulus, Poisson's ratio and density, others by their mass
                plane = own.pop("stiffness") / (1.0 - material["poisson_ratio"] ** 2)
                own |= {"youngs_modulus": plane * (1.0 - 0.45**2), "poisson_ratio": 0.45}
                radius = own.get("radius", material["radius"])
                own["density"] = own.pop("mass") / (4.0 / 3.0 * np.pi * radius**3)
        if p != 1.5 and "exponent" in keys["contact"]:
            keys["contact"] = {**keys["contact"], "stiffness": strength}
    return library.from_plain({key: value for key, value in keys.items() if value is not None}, "test")


def _times(value: Any, worth: Any) -> Any:
    """Numbers times what their unit is worth: by key, one by one where that is a tuple; "" where there is no key."""
    if isinstance(value, dict):
        by_key = worth if isinstance(worth, dict) else {}
        return {key: _times(inner, by_key[key]) if key in by_key else inner for key, inner in value.items()}
    if isinstance(value, list | tuple):
        each = isinstance(worth, tuple) and not isinstance(value[0], list | tuple)
        return [_times(one, worth[place] if each else worth) for place, one in enumerate(value)]
    factor = worth.get("", 1) if isinstance(worth, dict) else worth
    return value * factor if isinstance(value, float | int) else value
