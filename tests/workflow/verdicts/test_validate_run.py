"""Runs against other runs of one scene: bitwise the same, or how far apart, since when, and what they were run with."""

import json
import os
import shutil

import numpy as np
import pytest
from stock_lammps import scene

from lammps_inputs import Output, file_names
from workflow.cli import main
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory, results
from workflow.verdicts.validate import AGAINST
from workflow.verdicts.validate_run import validate_run

pytestmark = pytest.mark.usefixtures("lammps_here")


def a_scene(**changes):
    return scene(**{"chains": 3, "beads": 12, "kappa": 0.05, "duration": 20.0, "every": 0.5, **changes})


@pytest.fixture(scope="module")
def first(tmp_path_factory):
    return run(a_scene(), tmp_path_factory.mktemp("first") / "first", check=False).directory


@pytest.fixture(scope="module")
def finer(tmp_path_factory):
    """The same with half the time step."""
    return run(a_scene(timestep=0.005), tmp_path_factory.mktemp("finer") / "finer", check=False).directory


def copied(directory, path):
    return RunDirectory(shutil.copytree(directory.path, path))


def altered(directory, path):
    """A copy in which the last bead's last velocity is larger by 0.25, though its run.json is the same."""
    copy = copied(directory, path)
    content = bytearray(copy.dump.read_bytes())
    number = np.frombuffer(content, "<f8", count=1, offset=len(content) - 8)
    number[0] += 0.25
    copy.dump.write_bytes(content)
    return copy


def printed(words, capsys):
    capsys.readouterr()
    code = main([str(word) for word in words])
    return code, capsys.readouterr().out.splitlines()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "engine"),
    [
        ({"chains": 2, "beads": 100, "duration": 100.0, "window": 64}, "lammps"),
        ({"chains": 2, "scheme": "suzuki4"}, "lammps"),
        ({}, "reference"),
    ],
)
def test_the_scene_in_a_run_directory_is_enough_to_repeat_the_run_bitwise(changes, engine, tmp_path, capsys):
    directory = run(a_scene(**changes), tmp_path / "run", check=False, engine=engine).directory
    again = ["run", directory.path / file_names.SCENE, "-o", tmp_path / "again", "--engine", engine, "--no-check"]
    assert printed(again, capsys)[0] == 0
    code, lines = printed(["validate", tmp_path / "again", "--against", directory.path], capsys)
    recorded = directory.job.results
    assert code == 0
    assert (
        f"the run is bitwise the same as {directory.path} ({recorded.frames} frames, sha256 {recorded.sha256[:12]}...)"
        in lines
    )
    assert results(RunDirectory(tmp_path / "again"))["sha256"] == recorded.sha256


def test_a_run_that_is_bitwise_another_passes_whatever_the_tolerances(first, tmp_path, capsys):
    copy = copied(first, tmp_path / "copy")
    words = ["validate", copy.path, "--against", first.path, "--tolerance", "energy=0", "--json"]
    code, lines = printed(words, capsys)
    answer = json.loads("\n".join(lines))
    assert code == 0
    assert answer["passed"] is True
    assert answer["runs"]["identical"] is True
    assert answer["runs"]["sha256"] == 2 * [first.job.results.sha256]
    assert answer["runs"]["since"] is None
    assert answer["quantities"]["velocity"]["largest"] == 0.0
    assert json.loads((copy.path / f"{AGAINST}.json").read_text()) == answer


def test_the_frames_count_and_not_what_run_json_says_of_them(first, tmp_path, capsys):
    copy = altered(first, tmp_path / "altered")
    code, lines = printed(["validate", copy.path, "--against", first.path], capsys)
    assert code == 1
    assert f"the run is not bitwise the same as {first.path}, from t = 20 on" in lines
    assert any("velocity  2.50e-01" in line and "bead 12 of chain 3, t = 20" in line for line in lines)


def test_a_run_that_is_cut_short_is_incomplete_also_where_its_frames_are_the_same(first, tmp_path, capsys):
    copy = copied(first, tmp_path / "part")
    os.truncate(copy.dump, copy.dump.stat().st_size // 41 * 40)
    code, lines = printed(["validate", copy.path, "--against", first.path], capsys)
    assert code == 1
    assert "the run is incomplete: 40 of 41 frames" in lines
    assert any(line.startswith(f"the run is bitwise the same as {first.path} (40 frames, ") for line in lines)


def test_two_time_steps_are_compared_quantity_by_quantity_with_time_and_settings(first, finer, tmp_path, capsys):
    copy = copied(finer, tmp_path / "finer")
    copy.update(versions={**copy.job.versions, "lammps": "2024.8.29"}, ranks=2)
    code, lines = printed(["validate", copy.path, "--against", first.path], capsys)
    apart = np.abs(finer.trajectory.velocity - first.trajectory.velocity)
    since = first.trajectory.time[np.flatnonzero(apart.any(axis=(1, 2)))[0]]
    assert code == 0
    assert f"the run is not bitwise the same as {first.path}, from t = {since:.5g} on" in lines
    (row,) = (line.split() for line in lines if line.split()[:1] == ["velocity"])
    assert row[1] == f"{apart.max():.2e}"
    differ = {" ".join(words[:-2]): words[-2:] for words in map(str.split, lines) if len(words) > 2}
    assert (differ["time step"], differ["ranks"]) == (["0.005", "0.01"], ["2", "1"])
    assert differ["lammps"] == ["2024.8.29", first.job.versions["lammps"]]
    assert "numpy" not in differ


def test_beads_and_times_that_both_recorded_are_compared(first, finer, tmp_path):
    output = Output(every=1.0, beads=(3, 7))
    few = run(a_scene(timestep=0.005, output=output, duration=16.0), tmp_path / "few", check=False).directory
    validation, other = validate_run(few, first), copied(first, tmp_path / "copy")
    assert validation.complete
    assert validation.compared == 17
    apart = np.abs(finer.trajectory.velocity - first.trajectory.velocity)[:33:2, :, [2, 6]]
    assert validation.deviations["velocity"].largest == apart.max()
    assert "energy" not in validation.deviations
    assert validate_run(other, few).deviations["velocity"].largest == apart.max()


@pytest.mark.slow
def test_a_window_is_compared_with_all_rows_near_the_front(tmp_path):
    # as in `test_window`: the front is bitwise that of all rows
    long = {"chains": 2, "beads": 100, "duration": 100.0}
    whole, moving = (
        run(a_scene(**long, **window), tmp_path / name, check=False).directory
        for name, window in (("whole", {}), ("moving", {"window": 64}))
    )
    for pair in ((whole, moving), (moving, whole)):
        validation = validate_run(*pair)
        assert validation.runs.identical
        assert validation.passed
        assert any("the front half of the window" in remark for remark in validation.remarks)
