"""Small scenes of many ingredients whose equations of motion can be linearised."""

import granchain

SMALL = {"name": "small", "chains": 1, "beads": 6, "kick": {"velocity": 1}, "duration": 30}
LOADED = {"precompression": {"force": 3}, "walls": {"left": "bead", "right": "bead"}}
SMOOTH = {
    "loaded": LOADED,
    "coupled": {**LOADED, "chains": 3, "coupling": {"stiffness": 0.2, "cubic": 0.1}},
    "lattice": {**LOADED, "chains": 7, "coupling": {"stiffness": 0.2, "topology": "ring"}},
    "formula": {**LOADED, "chains": 2, "coupling": {"force": "k*s/sqrt(1+(s/a)^2)", "k": 0.3, "a": 0.5}},
    "magnets": {"contact": {"force": "A/(d+s)^p", "A": 1, "p": 4, "d": 1}, **{"walls": LOADED["walls"]}},
    "exponent": {**LOADED, "contact": {"exponent": 2.5}},
    "foundation": {**LOADED, "foundation": {"stiffness": 0.4, "cubic": 0.2}},
    "foundation in time": {
        **LOADED,
        "foundation": {"stiffness": {"from": 0.2, "to": 0.6, "times": [3, 9]}},
    },
    "unlike masses": {**LOADED, "disorder": {"mass": 0.3, "seed": 1}},
    "resonators": {**LOADED, "resonators": {"mass": 0.3, "stiffness": 0.5, "damping": 0.05}},
    "exponent beside resonators": {
        **LOADED,
        "contact": {"exponent": 2.5},
        "resonators": {"mass": 0.3, "stiffness": 0.5},
    },
    "formula beside resonators": {
        **LOADED,
        "precompression": None,
        "contact": {"force": "A*(d0+s)^p", "A": 1, "d0": 1.5, "p": 2},
        "resonators": {"mass": 0.3, "stiffness": 0.5},
    },
    "dashpots": {**LOADED, "damping": {"contact": 0.1, "tension": "allowed"}},
    "driven": {**LOADED, "kick": None, "drive": {"displacement": 0.05, "frequency": 0.4}, "damping": {"beads": 0.1}},
    "pushed": {**LOADED, "kick": None, "push": {"shape": "half-sine", "peak": 0.3, "duration": 2}},
}

WITH_DERIVATIVES = ("lattice", "foundation in time", "resonators", "driven")
"""Scenes whose vectors are tested with what numbers change in their forces as a source."""


def resolved(changes):
    """The small scene with other keys, and without those of None; with its time step."""
    scene = {key: value for key, value in {**SMALL, **changes}.items() if value is not None}
    return granchain.load(scene).resolved()
