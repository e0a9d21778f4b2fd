"""Sound and pulses of runs on a static load."""

import pytest
from ingredient_scenes import COLUMN
from plain_scene import scene

from workflow.cli import main
from workflow.plugins.sound.dispersion import Dispersion
from workflow.plugins.sound.loaded_pulse import LoadedPulse
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory

pytestmark = pytest.mark.usefixtures("lammps_here")

FREE = {"precompression": {"force": 0.3}}


def loaded(**changes):
    return scene(**{"chains": 1, "coupling": None, "output": {"every": 0.25}, **changes})


def test_linear_contacts_show_the_exact_band_in_a_run(tmp_path):
    """No contact opens, so that all is linear: modes 2 sin(q / 2) of a free chain, up to the cut-off 2 sqrt(k / m)."""
    case = loaded(
        beads=40,
        contact={"exponent": 1.0},
        precompression={"force": 3.0},
        kick={"bead": 10, "velocity": 1.0},
        duration=60.0,
        timestep=0.005,
        output={"every": 0.25},
    )
    found = run(case, tmp_path / "run", check=False)
    spectrum = Dispersion(found.directory.problem)
    for block in found.directory.blocks():
        spectrum.add(block)
    seen = spectrum.result()
    assert seen.cell.bands()[0, 1] == pytest.approx(2.0, rel=1e-12)
    assert abs(seen.measured_bands()[0, 1] - 2.0) < seen.bin


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
    watcher = LoadedPulse(case.problem())
    for block in RunDirectory(tmp_path / "run").blocks():
        watcher.add(block)
    wave = watcher.result()
    assert wave.force_ratio == pytest.approx(ratio, rel=0.02)
    assert wave.over_theory == pytest.approx(faster, abs=1e-4)


@pytest.mark.slow
def test_analyze_says_what_the_sound_is_and_why_there_is_no_map(tmp_path, capsys):
    for name, keys, words in (
        ("free", FREE, ("the speed of sound is c0 = ", "dispersion.csv")),
        (
            "column",
            COLUMN,
            ("the speed of sound is c0 = ", "there is no dispersion map: beads and their loads do not repeat"),
        ),
    ):
        run(loaded(**keys, beads=30, duration=30.0), tmp_path / name, check=False)
        assert main(["analyze", str(tmp_path / name), "--no-figures"]) == 0
        said = capsys.readouterr().out
        assert all(word in said for word in words), said
