"""The software is cited as ``CITATION.cff`` and ``pyproject.toml`` say."""

import importlib.resources
import re
import tomllib
from pathlib import Path

import pytest
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


@pytest.mark.parametrize("address", ["", "https://example.org/granchain"])
def test_the_address_of_the_software_is_cited_where_the_citation_file_has_one(address, tmp_path, monkeypatch):
    (tmp_path / "CITATION.cff").write_text(f'title: granchain\nurl: "{address}"\n')
    folders = {"workflow.plugins.cite": tmp_path}
    read = importlib.resources.files
    monkeypatch.setattr(software.importlib.resources, "files", lambda name: folders.get(name) or read(name))
    text, entry = software.in_a_line("1.0"), software.bibtex("1.0")
    assert text == "The granchain authors, granchain 1.0, " + ", ".join(filter(None, (software.TITLE, address)))
    assert re.findall(r"  url = {(.*)},", entry) == list(filter(None, [address]))
