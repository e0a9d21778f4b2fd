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


@pytest.mark.parametrize(
    ("of_site", "of_scene", "code"),
    [("1e-4", {}, 0), ("2e-5", {}, 2), ("1e-9", {"limits": "{gigabytes: 1e-4}"}, 0)],
    ids=["enough", "not enough", "the scene's comes first"],
)
@pytest.mark.usefixtures("lammps_here")
def test_a_site_sets_the_limit_where_the_scene_names_none(of_site, of_scene, code, tmp_path, monkeypatch):
    (tmp_path / "site.yaml").write_text(f"limits: {{gigabytes: {of_site}}}\n")
    monkeypatch.setenv(site.VARIABLE, str(tmp_path / "site.yaml"))
    (tmp_path / "scene.yaml").write_text(scene_text(**of_scene))
    assert main(["run", str(tmp_path / "scene.yaml"), "-o", str(tmp_path / "out"), "--no-check"]) == code


def test_a_refusal_names_the_file_of_the_site_too(tmp_path, capsys):
    (tmp_path / "scene.yaml").write_text(scene_text())
    said = refusal(["run", tmp_path / "scene.yaml", "-o", tmp_path / "o"], capsys)
    assert "` in the scene or in ~/.config/granchain/site.yaml" in said
