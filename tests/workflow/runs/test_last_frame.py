"""Runs that start from the last frame of another."""

import shutil

import numpy as np
import pytest

from lammps_inputs import InputError, library
from workflow.runs.run import run

pytestmark = pytest.mark.usefixtures("lammps_here")

SPRINGS = {"chains": 2, "beads": 8, "coupling": {"stiffness": 0.1}, "resonators": {"mass": 0.3, "stiffness": 0.2}}
COMMON = {"name": "part", **SPRINGS, "timestep": 0.01, "output": {"every": 0.5}}
ONE_CHAIN = dict.fromkeys(["chains", "coupling", "resonators"])


def scene(folder, **keys):
    data = library.with_files({**COMMON, **keys}, folder)
    return library.from_plain({key: value for key, value in data.items() if value is not None}, "x")


@pytest.fixture(scope="module")
def first(tmp_path_factory):
    folder = tmp_path_factory.mktemp("first")
    run(scene(folder, kick={"velocity": 1.0}, duration=10.0), folder / "first", check=False)
    return folder


@pytest.mark.slow
def test_two_runs_one_after_the_other_are_the_run_of_both_times_with_kicks_that_add(first, tmp_path):
    whole = run(scene(first, kick={"velocity": 1.0}, duration=20.0), tmp_path / "whole", check=False).trajectory
    case = scene(first, initial={"run": "first"}, duration=10.0)
    second = run(case, tmp_path / "second", check=False).trajectory
    assert second.time[-1] * case.scale.time == pytest.approx(10.0)
    for mine, theirs, worth in zip(second.atoms, whole.atoms, (case.scale.length, case.scale.velocity), strict=True):
        np.testing.assert_allclose(mine * worth, theirs[20:], rtol=0.0, atol=1e-11)
    kicked = scene(first, initial={"run": "first"}, kick={"bead": 3, "velocity": 2.0}, duration=10.0)
    start = run(kicked, tmp_path / "kicked", check=False).trajectory.velocity[0] * kicked.scale.velocity
    difference = start - whole.velocity[20]
    assert difference[0, 2] == pytest.approx(2.0, abs=1e-12)
    assert np.count_nonzero(np.abs(difference) > 1e-12) == 1


@pytest.mark.slow
def test_a_column_that_came_to_rest_is_kicked_as_the_settled_one(tmp_path):
    column = {"name": "column", "beads": 6, "walls": {"right": "flat"}, "timestep": 0.01}
    falls = {"acceleration": 1e-3, "settled": False}
    loose = scene(tmp_path, **column, gravity=falls, damping={"beads": 0.2}, duration=600.0, **ONE_CHAIN)
    run(loose, tmp_path / "rest", check=False)
    kicked = {**column, **ONE_CHAIN, "kick": {"velocity": 1.0}, "duration": 10.0}
    fallen = run(scene(tmp_path, **kicked, gravity=falls, initial={"run": "rest"}), tmp_path / "fallen", check=False)
    settled = run(scene(tmp_path, **kicked, gravity=1e-3), tmp_path / "settled", check=False)
    np.testing.assert_allclose(fallen.trajectory.velocity, settled.trajectory.velocity, rtol=0.0, atol=1e-12)


def test_the_new_run_needs_the_old_directory_no_more_and_names_it_by_its_checksum(first, tmp_path):
    shutil.copytree(first / "first", tmp_path / "old")
    new = run(scene(tmp_path, initial={"run": "old"}, duration=2.0), tmp_path / "new", check=False).directory
    shutil.rmtree(tmp_path / "old")
    [initial] = library.load(new.path / "scene.yaml").initial
    assert (initial.run.directory, initial.run.beads, initial.run.time) == ("old", 8, pytest.approx(10.0))
    assert len(initial.table) == 32
    text = (new.path / "scene.yaml").read_text()
    (tmp_path / "other.yaml").write_text(text.replace(f"1,1,{initial.table[0][2]!r}", "1,1,0.25"))
    with pytest.raises(InputError, match="by their checksum; name the run again"):
        library.load(tmp_path / "other.yaml")


def test_a_run_that_cannot_be_continued_is_refused_in_one_line(first, tmp_path):
    with pytest.raises(InputError, match="has 2 x 8 beads, and this scene 2 x 9"):
        scene(first, initial={"run": "first"}, duration=2.0, beads=9)
    few = {"kick": {"velocity": 1.0}, "duration": 1.0, "output": {"every": 0.5, "beads": [3]}}
    run(scene(first, **few), tmp_path / "few", check=False)
    with pytest.raises(InputError, match="frames hold 1 of 8 beads"):
        scene(tmp_path, initial={"run": "few"}, duration=2.0)
