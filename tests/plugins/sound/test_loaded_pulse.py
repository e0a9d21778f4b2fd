"""Where the leading pulse of a loaded chain is measured, either way, and how fast it is by theory."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from ingredient_scenes import STEEL
from plain_scene import scene
from synthetic_waves import of_keys

from analysis import motion
from analysis.shape.unit_cell import cell_of
from workflow.engines.reference import engine
from workflow.plugins.sound.loaded_pulse import LoadedPulseMeter, with_errors
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.analysis_files import analyse

KINDS = {"heavy": {"mass": 1.0}, "light": {"mass": 0.3}}


def found(bead, velocity):
    """Forty beads, one of them kicked."""
    plain = {"beads": 40, "precompression": {"force": 0.3}, "duration": 36.0}
    kick = {"bead": bead, "velocity": velocity}
    problem = of_keys(**{**plain, "kick": kick, "output": {"every": 0.05}})
    run = engine.run(problem)
    return LoadedPulseMeter(problem).read((run[:100], run[100:])), run


@pytest.mark.parametrize(("bead", "first"), [(1, 20), (27, 27)])
def test_it_is_over_ten_contacts_clear_of_the_end_and_not_before_the_kick(bead, first):
    wave, run = found(bead, 1.0)
    last = 30 if bead == 1 else 32  # five contacts from the end, and 1.5 of the cube root of the way
    assert (wave.chain, wave.first, wave.last) == (1, first, last)
    overlap = motion.overlaps(run.problem.system, run.displacement)[:, 0, first - 1 : last]
    force = np.maximum(overlap, 0.0) ** 1.5 / float(run.problem.system.along[0].law.load)
    assert wave.force_ratio == pytest.approx(np.mean(np.max(force, axis=0)), rel=1e-3)
    assert wave.speed == pytest.approx(
        (last - first) / np.ptp(run.time[np.argmax(force[:, [0, -1]], axis=0)]), rel=0.02
    )


@pytest.mark.parametrize("bead", [1, 27])
def test_in_the_mirror_it_is_the_same(bead):
    (one, _), (other, _) = found(bead, 1.0), found(41 - bead, -1.0)
    assert (other.first, other.last) == (40 - one.first, 40 - one.last)
    for name in ("force_ratio", "speed", "sound", "theory"):
        assert getattr(other, name) == pytest.approx(getattr(one, name), rel=1e-9)


@pytest.mark.parametrize("stride", [5, 10])
def test_force_and_speed_are_off_by_no_more_than_their_uncertainties(stride):
    """Frames 0.25 or 0.5 T apart against those 0.05 T apart; errors of a run are added."""
    exact, run = found(1, 1.0)
    problem = run.problem.coarser(stride)
    wave = LoadedPulseMeter(problem).read([replace(run[::stride], problem=problem)])
    total = with_errors(wave, problem, 0.1, 0.02)
    for name in ("force_ratio", "speed", "theory", "over_sound", "over_theory"):
        uncertainty = getattr(wave, f"{name}_error")
        assert abs(getattr(wave, name) - getattr(exact, name)) < uncertainty < 0.05 * getattr(wave, name)
        assert getattr(total, f"{name}_error") > uncertainty
    assert total.force_ratio_error == pytest.approx(0.1 + wave.force_ratio_error)
    assert total.over_sound_error == pytest.approx((0.02 + wave.speed_error) / wave.sound)


@pytest.mark.slow
@pytest.mark.parametrize("pattern", [["heavy"], ["heavy", "light"], ["heavy", "light", "light"]], ids=len)
def test_a_front_of_sound_runs_as_fast_as_its_dispersion_says(pattern):
    """Its maximum is Airy's, 1.0188 (a c0 t)**(1/3) behind c0 t where omega = c0 (q - a q**3 / 3)."""
    plain = {"beads": 150, "precompression": {"force": 1.0}, "kick": {"velocity": 1e-4}}
    problem = of_keys(**plain, duration=150.0, kinds=KINDS, pattern=pattern)
    wave = LoadedPulseMeter(problem).read(engine.blocks(problem))
    short, long = cell_of(problem.system).branches(np.array([0.1, 0.01]))[:, 0] / [0.1, 0.01]
    bent = 3.0 * (1.0 - short / long) / (0.1**2 - 0.01**2)
    way = 0.5 * (wave.first + wave.last)
    expected = 1.0 - 1.0188 / 3.0 * math.cbrt(bent / way**2)
    assert wave.over_sound == pytest.approx(expected, abs=1e-3)


pytestmark = pytest.mark.usefixtures("lammps_here")


def loaded(**changes):
    return scene(**{"chains": 1, "coupling": None, "output": {"every": 0.25}, **changes})


@pytest.mark.slow
def test_sound_of_the_steel_beads_at_one_newton_runs_at_369_metres_a_second(tmp_path):
    beads, mode = 40, 2
    case = loaded(
        material=STEEL,
        beads=beads,
        precompression={"force": 1.0},
        kick=[{"bead": 1, "velocity": 1e-6}, {"bead": beads, "velocity": 1e-6}],
        duration=4e-3,
        output={"every": 1e-5},
        timestep=5e-7,
    )
    run(case, tmp_path / "run", check=False)
    sound = analyse(RunDirectory(tmp_path / "run"), figures=False).measurements["sound"].values.pulse
    assert sound is not None
    report = json.loads((tmp_path / "run" / "analysis.json").read_text())["sound"]
    assert report["metres"][0] == pytest.approx(369.2, abs=0.05)
    # the slowest even standing wave of the free chain, frequency 2 c0 sin(q / 2)
    motion = RunDirectory(tmp_path / "run").trajectory
    q = math.pi * mode / beads
    swing = motion.velocity[:, 0] @ np.cos(q * (np.arange(beads) + 0.5))
    zero = np.flatnonzero(np.diff(np.sign(swing)))
    time = motion.time[zero] + motion.problem.every * swing[zero] / (swing[zero] - swing[zero + 1])
    omega = math.pi * (len(zero) - 1) / (time[-1] - time[0])
    metres = omega / (2.0 * math.sin(q / 2.0)) / case.scale.time * 2.0 * STEEL["radius"]
    assert metres == pytest.approx(369.2, rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("force", "beads", "duration", "ratio", "faster"),
    [(0.43, 300, 290.0, 1.955, 1.0004), (0.0091, 200, 230.0, 67.7, 1.0085)],
    ids=["1.955", "67.7"],
)
def test_waves_on_a_load_are_faster_than_the_long_wave_theory_says(tmp_path, force, beads, duration, ratio, faster):
    case = loaded(
        precompression={"force": force}, beads=beads, duration=duration, output={"every": 0.1}, timestep=0.005
    )
    run(case, tmp_path / "run", check=False)
    wave = LoadedPulseMeter(case.problem()).read(RunDirectory(tmp_path / "run").blocks())
    assert wave.force_ratio == pytest.approx(ratio, rel=0.02)
    assert wave.over_theory == pytest.approx(faster, abs=1e-4)
