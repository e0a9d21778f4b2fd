"""Runs computed again from their run.json."""

import json
import os

import numpy as np
import pytest
from stock_lammps import scene

from lammps_inputs import InputError
from workflow.cli import main
from workflow.runs.rerun import original, rerun
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory, results

pytestmark = pytest.mark.usefixtures("lammps_here")


def a_scene(**changes):
    return scene(**{"chains": 3, "beads": 12, "kappa": 0.05, "duration": 20.0, "every": 0.5, **changes})


@pytest.fixture(scope="module")
def first(tmp_path_factory):
    return run(a_scene(), tmp_path_factory.mktemp("first"), check=False).directory


def altered(first, path, **changes):
    """A copy of a run.json alone, changed."""
    path.write_text(json.dumps({**first.job.plain(), **changes}))
    return path


def said(words, capsys):
    code = main([str(word) for word in words])
    out, err = capsys.readouterr()
    return code, out + err


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "options"),
    [
        ({}, {}),
        ({"chains": 2, "beads": 100, "duration": 100.0, "window": 64}, {}),
        ({"chains": 2, "scheme": "suzuki4"}, {}),
        ({"gap": 1.0}, {"engine": "collisions"}),
        ({}, {"engine": "reference"}),
    ],
)
def test_a_run_json_alone_is_enough_to_come_to_the_same(changes, options, tmp_path, capsys):
    directory = run(a_scene(**changes), tmp_path / "run", check=False, **options).directory
    alone = altered(directory, tmp_path / "run.json")
    code, text = said(["rerun", alone, "-o", tmp_path / "again"], capsys)
    frames = directory.job.results.frames
    assert code == 0
    assert text == f"test: bitwise the same ({frames} frames, sha256 {results(directory)['sha256'][:12]}...)\n"
    assert RunDirectory(tmp_path / "again").trajectory.frames == frames


def test_a_run_without_o_leaves_nothing_behind(first, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert said(["rerun", first.path], capsys)[0] == 0
    assert list(tmp_path.iterdir()) == []


def test_what_is_not_the_same_is_told_with_distance_time_and_versions(first, tmp_path, capsys):
    other = run(a_scene(timestep=0.005), tmp_path / "other", check=False).directory
    differences = np.abs(other.trajectory.velocity - first.trajectory.velocity)
    apart = differences.max()
    since = first.trajectory.time[np.flatnonzero(differences.any(axis=(1, 2)))[0]]
    other.update(scene=first.job.scene, versions={**other.job.versions, "lammps": "2024.8.29"})
    found = rerun(original(tmp_path / "other"), tmp_path / "again")
    assert found.distance is not None
    assert found.distance.velocity == apart
    assert found.distance.since == since
    code, text = said(["rerun", tmp_path / "other"], capsys)
    assert code == 1
    verdict, *causes = text.splitlines()
    assert verdict.startswith(f"test: not the same: velocities up to {apart:.1e} V and displacements ")
    assert verdict.endswith(f"first at t = {since:.5g}")
    assert f"  lammps: 2024.8.29 then, {first.job.versions['lammps']} here" in causes
    assert any(cause.startswith("  deck: ") for cause in causes)


def test_without_its_frames_the_distance_is_that_of_the_last_states(first, tmp_path, capsys):
    other = run(a_scene(timestep=0.005), tmp_path / "other", check=False).directory
    apart = np.abs(other.trajectory.velocity[-1] - first.trajectory.velocity[-1]).ravel()
    alone = altered(other, tmp_path / "alone.json", scene=first.job.scene)
    code, text = said(["rerun", alone], capsys)
    shown = np.unique(np.linspace(0, 35, 32).astype(int))
    assert code == 1
    assert f"velocities up to {apart[shown].max():.1e} V" in text
    assert "at the end, among the beads whose last state run.json holds" in text


def test_frames_that_were_altered_since_are_told(tmp_path, capsys):
    directory = run(a_scene(), tmp_path, check=False).directory
    os.truncate(directory.dump, directory.dump.stat().st_size // 41 * 40)
    code, text = said(["rerun", tmp_path], capsys)
    assert code == 2
    assert "its frames or scene are not those that its run.json describes" in text


def test_a_file_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        original(tmp_path / "none.json")


WRONG = {
    "unfinished": ({"outcome": "running"}, "its run is 'running', not 'done'; finish it with run --resume"),
    "no scene": ({"scene": None}, "holds no 'scene'"),
    "bad scene": ({"scene": {"name": "x", "beads": -1}}, "scene: "),
    "path as name": ({"scene": {"name": "../x", "beads": 4}}, "scene: name: '../x' given"),
    "engine": ({"engine": "rm -rf"}, "engine: should be 'lammps', 'reference' or 'collisions', 'rm -rf' given"),
    "ranks": ({"ranks": "2; ls"}, "ranks: should be a whole number, '2; ls' given"),
    "results": ({"results": {"sha256": "0", "samples": [{"chain": "x"}]}}, "results.frames: is missing"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_run_json_that_is_none_is_refused_in_one_line(case, first, tmp_path):
    changes, says = WRONG[case]
    with pytest.raises(InputError) as caught:
        original(altered(first, tmp_path / "run.json", **changes))
    message = str(caught.value)
    assert message.startswith(f"{tmp_path}/run.json: ")
    assert says in message
    assert len(message.splitlines()) == 1
