"""A scene of every ingredient, of the ways that it can be given, and of those that meet in one force or one deck."""

from functools import cache
from typing import Any

import numpy as np
from truth import Truth

from lammps_inputs import Scene, library

STEEL = {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3}

DIMER = {"kinds": {"heavy": {"mass": 1.0}, "light": {"mass": 0.3428}}, "pattern": ["heavy", "light"]}
SIZES = {"kinds": {"big": {}, "small": {"radius": 0.7}}, "pattern": ["big", "big", "small"]}
UNLIKE = {
    "kinds": {"heavy": {"mass": 1.0}, "light": {"mass": 0.5, "stiffness": 2.0}},
    "pattern": [["heavy"], ["light"]],
}
MASSES = {"kinds": {"heavy": {"mass": 1.0}, "light": {"mass": 0.5, "radius": 1.0}}, "pattern": [["heavy"], ["light"]]}

WALLS = {"walls": {"left": "rigid", "right": {"stiffness": 5.0}}}
AT_END = {"walls": {"left": {"stiffness": 2.0}, "right": {"stiffness": 5.0}}}
PRESSED = {"precompression": {"force": 0.3}}
HELD = {**PRESSED, "walls": {"left": "bead", "right": "flat"}}
COLUMN = {"gravity": 0.02, "walls": {"right": "flat"}}
PRESSED_COLUMN = {**AT_END, "gravity": 0.05, "precompression": {"force": 0.2}}
TIED = {"stiffness": 0.1}
ALL_LOST = {"contact": 0.1, "beads": 0.05, "coupling": 0.1}

LOSSES: dict[str, dict[str, Any]] = {
    "linear": {"contact": 0.2},
    "linear, cut": {"contact": 0.2, "tension": "cut"},
    "viscoelastic": {"contact": 0.3, "law": "viscoelastic"},
    "viscoelastic, cut": {"contact": 0.3, "law": "viscoelastic", "tension": "cut"},
    "restitution": {"contact": 0.7, "law": "restitution"},
    "of springs": {"coupling": 0.2},
    "all": ALL_LOST,
}


def exponent(p: float, **more: Any) -> dict[str, Any]:
    return {"contact": {"exponent": p}, **more}


CASES: dict[str, dict[str, Any]] = {
    "one chain": {"chains": 1, "coupling": None},
    "gap": {"gap": 0.3},
    "coupling from a row on": {"coupling": {"stiffness": 0.5, "rows": [3, 8]}},
    "ramp": {"chains": 3, "coupling": {"stiffness": {"from": 0.0, "to": 0.9, "rows": [2, 7]}}},
    "ring": {"chains": 4, "coupling": {"stiffness": 0.4, "topology": "ring"}},
    "lattice": {"chains": 6, "coupling": {"stiffness": 0.4, "topology": {"lattice": [2, 3]}}},
    "edges": {"chains": 4, "coupling": {**TIED, "topology": {"edges": [[4, 1, 0.3], [1, 3], [2, 3, 0.05]]}}},
    "cubic": {"coupling": {"stiffness": 0.2, "cubic": 0.7}},
    "cubic ring": {"chains": 4, "coupling": {"cubic": 0.7, "rows": [2, 6], "topology": "ring"}},
    "foundation": {"foundation": {"stiffness": 0.5}},
    "cubic foundation": {"foundation": {"stiffness": 0.3, "cubic": 0.7}},
    "purely cubic foundation": {"foundation": {"cubic": 0.5}},
    "foundation in some rows": {"foundation": {"stiffness": 0.4, "rows": [3, 6]}},
    "foundation by chain": {"foundation": {"stiffness": [0.5, 0.2], "cubic": 0.3}},
    "wall on the right": {"walls": {"right": "bead"}},
    "wall on the left": {"walls": {"left": "flat"}, "kick": {"bead": 3, "velocity": -1.0}},
    "walls": WALLS,
    "walls, gap": {**WALLS, "gap": 0.3},
    "dimer": DIMER,
    "dimer of sizes": SIZES,
    "another pattern in each chain": {**DIMER, "pattern": [["heavy", "light"], ["light", "heavy", "heavy"]]},
    "impurity": {"kinds": {"steel": {"mass": 8.0, "stiffness": 2.0}}, "replace": {"bead": 6, "kind": "steel"}},
    "taper": {"taper": 0.05},
    "disorder": {"disorder": {"mass": 0.1, "radius": 0.1, "stiffness": 0.3, "seed": 5}},
    "striker": {"striker": {"mass": 3.0, "velocity": 1.0}, "kick": None},
    "exponent 1": exponent(1.0),
    "exponent 1.25": exponent(1.25),
    "exponent 3": exponent(3.0),
    "walls of exponent 2": exponent(2.0, **AT_END),
    "walls of exponent 3, gap": exponent(3.0, **AT_END, gap=0.3),
    "column of exponent 1": exponent(1.0, walls={"right": "bead"}, gravity=0.05),
    "pressed column of exponent 2": exponent(2.0, **PRESSED_COLUMN),
    "unlike columns of exponent 2": exponent(2.0, walls={"right": "bead"}, gravity=0.05, coupling=None, **MASSES),
    "pressed": PRESSED,
    "pressed between walls": HELD,
    "column": COLUMN,
    "pressed column": {**COLUMN, "precompression": {"force": 0.1}, "walls": {"left": "flat", "right": "flat"}},
    "unlike columns": {**COLUMN, **UNLIKE, "coupling": None},
    "pressed dimer": {**PRESSED, **UNLIKE, "pattern": ["heavy", "light"]},
    "pressed, exponent 1": exponent(1.0, **PRESSED),
    "pressed, exponent 2": exponent(2.0, **PRESSED),
    "drag on beads": {"damping": {"beads": 0.3}},
    **{f"damping {name}": {"damping": keys} for name, keys in LOSSES.items()},
    **{f"damping {name}, pressed": {"damping": keys, **PRESSED} for name, keys in LOSSES.items()},
    "damping linear, exponent 1": exponent(1.0, damping=LOSSES["linear"]),
    "damping viscoelastic, exponent 3": exponent(3.0, damping=LOSSES["viscoelastic"]),
    "damping viscoelastic, exponent 1, pressed": exponent(1.0, damping=LOSSES["viscoelastic"], **PRESSED),
    "damping all, exponent 2, pressed": exponent(2.0, damping=ALL_LOST, **PRESSED),
    "damping cut, pressed by a wall": {
        "damping": LOSSES["linear, cut"],
        **PRESSED,
        "walls": {"right": {"stiffness": 5.0}},
    },
    "damping restitution, wall, gap": {
        "damping": LOSSES["restitution"],
        "walls": {"right": {"stiffness": 5.0}},
        "gap": 0.3,
    },
    "damped column of exponent 2": exponent(
        2.0, gravity=0.05, walls={"right": {"stiffness": 5.0}}, damping=LOSSES["viscoelastic"]
    ),
    "damped column": {**COLUMN, "damping": {"contact": 0.1, "coupling": 0.1}},
    "pushed": {
        "kick": None,
        "push": [
            {"peak": 0.6, "duration": 20.3, "shape": "half-sine"},
            {"chain": 2, "bead": 3, "table": [[0, 0.2], [0.7, 0.5], [2, -0.1], [3, 0]]},
        ],
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
