"""Sound and dispersion as measurements: hand-made numbers in scenes' units."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from ingredient_scenes import STEEL
from stock_lammps import scene

from analysis.shape.unit_cell import UnitCell
from lammps_inputs import Kick, Material, library
from workflow.plugins.sound import measure as sound
from workflow.plugins.sound.dispersion import Map
from workflow.plugins.sound.loaded_pulse import LoadedWave
from workflow.plugins.sound.loaded_pulse import Sound as Measured


def sound_of(problem, bead_length, wave=None, crests=()):
    return sound.SoundMeasurement(
        problem, Measured.of(problem, wave, SimpleNamespace(crests=crests), bead_length), bead_length
    )


@pytest.mark.parametrize("si", [False, True])
def test_sound_is_told_in_beads_and_metres_a_time(si):
    plain = {"name": "a", "beads": 20, "precompression": {"force": 2.0}, "kick": {"velocity": 0.1}}
    plain |= {"duration": 1e-3, "material": STEEL} if si else {"duration": 20.0}
    loaded = library.from_plain(plain, "a").problem()
    scale = loaded.scale
    wave = LoadedWave(chain=1, first=3, last=9, force_ratio=4.0, speed=1.5, sound=1.2, theory=1.3)
    crests = tuple(SimpleNamespace(peak_velocity=np.array([peak, 0.1])) for peak in (0.2, 0.3))
    found = sound_of(loaded, 9.52e-3 if si else None, wave, crests).plain()
    assert found["crest"] == pytest.approx(0.3 * scale.velocity)
    stiffness = 1.5 * scale.force / scale.length * float(loaded.system.along[0].law.rest) ** 0.5
    c0 = math.sqrt(stiffness / scale.mass)
    assert found["load"] == pytest.approx([2.0, 2.0], rel=1e-4)
    assert found["speed"] == pytest.approx([c0, c0])
    assert found["metres"] == (pytest.approx([9.52e-3 * c0] * 2) if si else None)
    assert found["cutoff"] == pytest.approx(2.0 * c0)
    told = {name: found["pulse"][name] for name in ("speed", "sound")}
    assert told == pytest.approx({"speed": 1.5 / scale.time, "sound": 1.2 / scale.time})
    ratios = [found["pulse"][name] for name in ("over_sound", "theory", "over_theory")]
    assert ratios == pytest.approx([1.25, 1.3, 1.25 / 1.3])


def test_the_cutoff_is_the_edge_of_the_highest_band_and_springs_to_the_ground_leave_no_speed_of_sound():
    plain = {"name": "a", "beads": 20, "precompression": {"force": 1.0}, "kick": {"velocity": 0.1}, "duration": 20.0}
    turns = {"kinds": {"heavy": {}, "light": {"mass": 0.5}}, "pattern": ["heavy", "light"]}
    found, held = (
        sound_of(library.from_plain({**plain, **more}, "a").problem(), 1.0)
        for more in (turns, {"foundation": {"stiffness": 0.5}})
    )
    (line,) = held.lines()
    found, held = found.plain(), held.plain()
    assert found["cutoff"] == pytest.approx(math.sqrt(2.0 * 1.5 * 3.0))
    assert found["speed"] == found["metres"] == pytest.approx([math.sqrt(1.5 / 0.75)] * 2)
    assert held["cutoff"] == pytest.approx(math.sqrt(4.0 * 1.5 + 0.5))
    assert held["speed"] is held["metres"] is None
    assert line.endswith("hold the beads; small waves have frequencies from 0.707107 to 2.54951 rad per unit time")
    tapered = library.from_plain({**plain, "taper": 0.02, "foundation": {"stiffness": 100.0}}, "a").problem()
    assert sound_of(tapered, 1.0).plain()["cutoff"] > 10.0  # a bound, on springs too


def test_bands_and_their_bin_are_in_the_units_of_the_scene():
    problem = scene(chains=2, beads=10, kick=(Kick(velocity=0.5),), material=Material(**STEEL)).problem()
    cell = UnitCell(np.ones((1, 1)), np.full((1, 1), 2.25), np.zeros((1, 1, 1)))  # omega = 3 |sin(q / 2)|
    frequency = np.array([0.0, 0.25])
    folded, exact = np.array([0.1, 0.2]), np.zeros((2, 1))
    found = Map(1, folded, frequency, np.zeros((2, 2)), cell, folded, exact, np.array([[np.nan], [0.4]]))
    told, unit = sound.DispersionMeasurement(problem, found.bands(), found).plain(), problem.scale.time
    assert np.array(told["bands"]) == pytest.approx(np.array([[0.0, 3.0 / unit]]), abs=1e-6 / unit)
    assert np.array(told["measured"]) == pytest.approx(np.array([[0.4 / unit, 0.4 / unit]]))
    assert told["bin"] == pytest.approx(0.25 / unit)
