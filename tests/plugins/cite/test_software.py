"""The software is cited as ``CITATION.cff`` and ``pyproject.toml`` say."""

import tomllib
from pathlib import Path

import yaml

import lammps_inputs
from workflow.plugins.cite import software


def test_the_software_is_cited_alike_by_hosts_of_repositories_and_by_the_command():
    root = Path(lammps_inputs.__file__).parents[1]
    project = tomllib.loads((root / "pyproject.toml").read_text())["project"]
    cff = yaml.safe_load((root / "CITATION.cff").read_text())
    assert (cff["title"], cff["version"], cff["license"]) == (project["name"], project["version"], project["license"])
    entry = software.bibtex(project["version"])
    assert f"version = {{{cff['version']}}}" in entry
    assert cff["authors"][0]["name"] in entry
    assert str(software.YEAR) in (root / "LICENSE").read_text()
    assert software.address() == cff["url"]
