"""The leading pulse on a static load, of the reference's runs, against theory."""

import math

import numpy as np
import pytest

from analysis.sound.dispersion import cell_of
from analysis.sound.loaded_pulse import LoadedPulse
from lammps_inputs import library
from workflow.engines.reference import engine

KINDS = {"heavy": {"mass": 1.0}, "light": {"mass": 0.3}}


@pytest.mark.parametrize("pattern", [["heavy"], ["heavy", "light"], ["heavy", "light", "light"]], ids=len)
def test_a_front_of_sound_runs_as_fast_as_its_dispersion_says(pattern):
    """Its maximum is Airy's, 1.0188 (a c0 t)**(1/3) behind c0 t where omega = c0 (q - a q**3 / 3)."""
    plain = {"name": "sound", "beads": 150, "precompression": {"force": 1.0}, "kick": {"velocity": 1e-4}}
    scene = library.from_plain({**plain, "duration": 150.0, "kinds": KINDS, "pattern": pattern}, "test")
    problem = scene.problem()
    watcher = LoadedPulse(problem)
    for block in engine.blocks(problem):
        watcher.add(block)
    wave = watcher.result()
    short, long = cell_of(problem).branches(np.array([0.1, 0.01]))[:, 0] / [0.1, 0.01]
    bent = 3.0 * (1.0 - short / long) / (0.1**2 - 0.01**2)
    way = 0.5 * (wave.first + wave.last)
    expected = 1.0 - 1.0188 / 3.0 * math.cbrt(bent / way**2)
    assert wave.over_sound == pytest.approx(expected, abs=1e-3)
