"""Runs that tests of exports look at, made once, by the reference integrator."""

import functools

import pytest

import granchain

COUPLED = {
    "name": "coupled",
    "chains": 2,
    "beads": 12,
    "coupling": {"stiffness": 0.1, "rows": [3, 9]},
    "kick": {"velocity": 1.0},
    "duration": 20.0,
}
SCENES = {
    "coupled": COUPLED,
    "steel": {
        "name": "steel",
        "beads": 12,
        "material": {"name": "steel", "radius": 4.76e-3},
        "kick": {"velocity": 0.4},
        "duration": 2e-4,
        "output": {"forces": {"contacts": [5]}},
    },
    "damped": {**COUPLED, "name": "damped", "damping": {"contact": 0.05}, "output": {"forces": {"contacts": [5]}}},
    "short": {"name": "short", "beads": 8, "kick": {"velocity": 1.0}, "duration": 4.0, "output": {"every": 0.5}},
    "recorded": {**COUPLED, "name": "recorded", "output": {"beads": [4, 5, 11]}},
}


@pytest.fixture(scope="session")
def run_of(tmp_path_factory):
    """Name of a scene above, or of an installed one -> its run."""

    @functools.cache
    def run(name):
        return granchain.run(SCENES.get(name, name), tmp_path_factory.mktemp("export") / name, engine="reference")

    return run
