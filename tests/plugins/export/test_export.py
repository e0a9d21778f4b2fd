"""``granchain export``: what it refuses, which files it replaces, and what it prints."""

import json
from importlib.util import find_spec

import pytest
from refusals import refusal

import granchain
from lammps_inputs import file_names
from workflow.cli import main
from workflow.runs.files import RECORD


@pytest.fixture
def run(tmp_path):
    scene = {"name": "tiny", "beads": 8, "kick": {"velocity": 1.0}, "duration": 4.0}
    return granchain.run(scene, tmp_path / "run", engine="reference").directory.path


def test_a_package_that_is_not_installed_is_named_with_what_installs_it(run, capsys, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name, find=find_spec: None if name == "gsd" else find(name))
    line = refusal(["export", run, "--to", "ovito"], capsys)
    assert line == "--to ovito: needs gsd, not installed here; `pip install 'granchain[export]'`"


def test_files_in_the_directory_of_the_run_are_listed_as_its_own_and_replaced(run):
    assert main(["export", str(run), "--to", "vmd", "-q"]) == 0
    assert "frames.vmd" in json.loads((run / RECORD).read_text())["files"]
    assert main(["export", str(run), "--to", "vmd", "--every", "2", "-q"]) == 0


def test_elsewhere_existing_files_are_replaced_on_request(run, tmp_path, capsys):
    path = tmp_path / "my.vmd"
    path.write_text("mine")
    assert main(["export", str(run), "--to", "vmd", "-o", str(path), "--overwrite"]) == 0
    assert path.read_text() != "mine"
    assert capsys.readouterr().out == f"written: {path} ({path.stat().st_size / 1e3:.1f} kB)\n"


def test_a_run_that_was_cut_is_exported_as_far_as_it_goes_and_that_is_said(run, capsys):
    dump, record = run / file_names.DUMP, run / RECORD
    dump.write_bytes(dump.read_bytes()[: dump.stat().st_size // 2])
    record.write_text(record.read_text().replace('"outcome": "done"', '"outcome": "interrupted"'))
    assert main(["export", str(run), "--to", "vmd"]) == 0
    assert capsys.readouterr().out.startswith("the run was interrupted: only its frames until then are written\n")
    assert "animate goto 0" in (run / "frames.vmd").read_text()


def test_an_interruption_leaves_neither_a_file_nor_part_of_one(run, tmp_path, monkeypatch):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("workflow.plugins.export.atoms._vmd_tail", interrupt)
    assert main(["export", str(run), "--to", "vmd", "-o", str(tmp_path / "out")]) == 130
    assert list((tmp_path / "out").iterdir()) == []
