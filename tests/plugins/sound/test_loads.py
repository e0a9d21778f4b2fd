"""Sound and pulses of runs on a static load."""

import json
import math

import numpy as np
import pytest
from ingredient_scenes import STEEL
from plain_scene import scene

from workflow.plugins.sound.loaded_pulse import LoadedPulseMeter
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.analysis_files import analyse

pytestmark = pytest.mark.usefixtures("lammps_here")


def loaded(**changes):
    return scene(**{"chains": 1, "coupling": None, "output": {"every": 0.25}, **changes})


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
