"""Limits of runs on this machine from a site's file."""

import pytest
from bad_scenes import scene_text
from refusals import refusal

from lammps_inputs.output import Limits
from workflow.cli import main
from workflow.plugins.jobs import site


@pytest.fixture(autouse=True)
def nobodys_site(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv(site.VARIABLE, raising=False)
    monkeypatch.setattr("workflow.runs.size.MOST", Limits(gigabytes=1e-9, hours=1.0))


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(scene_text())
    return path


@pytest.mark.parametrize(("gigabytes", "code"), [("1e-4", 0), ("2e-5", 2)])
@pytest.mark.usefixtures("lammps_here")
def test_a_site_sets_the_limit_where_the_scene_names_none(gigabytes, code, scene, tmp_path, monkeypatch):
    (tmp_path / "site.yaml").write_text(f"limits: {{gigabytes: {gigabytes}}}\n")
    monkeypatch.setenv(site.VARIABLE, str(tmp_path / "site.yaml"))
    assert main(["run", str(scene), "-o", str(tmp_path / "out"), "--no-check"]) == code


@pytest.mark.usefixtures("lammps_here")
def test_the_limit_of_the_scene_comes_before_that_of_the_site(tmp_path, monkeypatch):
    (tmp_path / "site.yaml").write_text("limits: {gigabytes: 1e-9}\n")
    monkeypatch.setenv(site.VARIABLE, str(tmp_path / "site.yaml"))
    path = tmp_path / "scene.yaml"
    path.write_text(scene_text(limits="{gigabytes: 1e-4}"))
    assert main(["run", str(path), "-o", str(tmp_path / "out"), "--no-check"]) == 0


def test_a_refusal_names_the_file_of_the_site_too(scene, tmp_path, capsys):
    assert "` in the scene or in ~/.config/granchain/site.yaml" in refusal(["run", scene, "-o", tmp_path / "o"], capsys)
