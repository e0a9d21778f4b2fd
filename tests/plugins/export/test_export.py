"""``granchain export``: what it refuses, which files it replaces, and what it prints."""

import json
import subprocess
import sys
from importlib.util import find_spec

import pytest
from processes import HANGS

import granchain
from lammps_inputs import InputError, file_names
from workflow.cli import main
from workflow.plugins.export.registry import FORMATS
from workflow.runs.files import RECORD


@pytest.fixture
def run(tmp_path):
    scene = {"name": "tiny", "beads": 8, "kick": {"velocity": 1.0}, "duration": 4.0}
    return granchain.run(scene, tmp_path / "run", engine="reference").directory.path


def complaint(words, capsys):
    code = main(["export", *map(str, words)])
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1
    return code, lines[0]


def test_an_unknown_format_is_refused_with_the_list_of_all(run, capsys):
    code, line = complaint([run, "--to", "vmd,netcfd"], capsys)
    assert code == 2
    assert line.startswith("granchain: --to: 'netcfd' is no format (did you mean `netcdf`?); ")
    assert line.endswith(f"{', '.join(FORMATS)}, with commas between")


def test_a_package_that_is_not_installed_is_named_with_what_installs_it(run, capsys, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name, find=find_spec: None if name == "gsd" else find(name))
    code, line = complaint([run, "--to", "ovito"], capsys)
    assert (code, line) == (
        2,
        "granchain: --to ovito: needs gsd, not installed here; `pip install 'granchain[export]'`",
    )


def test_files_in_the_directory_of_the_run_are_listed_as_its_own_and_replaced(run):
    assert main(["export", str(run), "--to", "vmd", "-q"]) == 0
    assert "frames.vmd" in json.loads((run / RECORD).read_text())["files"]
    assert main(["export", str(run), "--to", "vmd", "--every", "2", "-q"]) == 0


def test_a_users_own_file_in_the_directory_of_the_run_is_never_replaced(run, capsys):
    (run / "frames.vmd").write_text("mine")
    code, line = complaint([run, "--to", "vmd", "--overwrite"], capsys)
    assert code == 2
    assert f"{run / 'frames.vmd'}: is not listed in run.json" in line
    assert (run / "frames.vmd").read_text() == "mine"


def test_elsewhere_existing_files_are_replaced_only_on_request(run, tmp_path, capsys):
    path = tmp_path / "my.vmd"
    path.write_text("mine")
    code, line = complaint([run, "--to", "vmd", "-o", path], capsys)
    assert (code, line) == (2, f"granchain: {path}: exists; choose another -o, or replace it (--overwrite)")
    assert main(["export", str(run), "--to", "vmd", "-o", str(path), "--overwrite"]) == 0
    assert path.read_text() != "mine"
    assert capsys.readouterr().out == f"written: {path} ({path.stat().st_size / 1e3:.1f} kB)\n"


def test_a_directory_is_not_replaced_by_a_file(run, tmp_path, capsys):
    (tmp_path / "my.vmd").mkdir()
    code, line = complaint([run, "--to", "vmd", "-o", tmp_path / "my.vmd", "--overwrite"], capsys)
    assert code == 2
    assert line.endswith("is a directory that granchain did not write; choose another -o")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--every", "0"], "--every: 0 given; 1 or more"),
        (["--seconds", "nan"], "--seconds: nan given; more than 0"),
        (["--rate", "1000"], "--rate: 1000 given; 1 to 100 pictures a second"),
        (["--pixels", "10"], "--pixels: 10 given; 320 to 4000"),
    ],
)
def test_numbers_that_make_no_file_are_refused(run, options, words, capsys):
    assert complaint([run, "--to", "gif", *options], capsys) == (2, f"granchain: {words}")


def test_what_is_neither_a_run_nor_a_sweep_and_a_run_without_frames_are_refused(run, tmp_path, capsys):
    (tmp_path / "empty").mkdir()
    assert complaint([tmp_path / "empty", "--to", "vmd"], capsys)[1].endswith("it has no scene.yaml")
    (run / file_names.DUMP).unlink()
    code, line = complaint([run, "--to", "vmd"], capsys)
    assert (code, line) == (2, f"granchain: {run}: holds no chains.dump.bin; run the deck first")


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


def test_a_large_file_is_announced(run, capsys, monkeypatch):
    monkeypatch.setattr("workflow.plugins.export.request.LARGE", 100.0)
    assert main(["export", str(run), "--to", "vmd"]) == 0
    assert capsys.readouterr().err == "frames.vmd: 41 frames of 1 x 8 beads, 0 MB at most\n"


def test_the_dataset_of_a_run_without_xarray_is_refused_in_one_line(run, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    with pytest.raises(
        InputError, match=r"^dataset: needs xarray, not installed here; `pip install 'granchain\[export"
    ):
        _ = granchain.open(run).dataset


def test_the_command_loads_no_package_of_a_format_that_is_not_asked_for():
    packages = [package for each in FORMATS.values() for package in each.packages] + ["matplotlib", "PIL"]
    code = f"import sys, workflow.plugins.export.tool; print([name for name in {packages} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=HANGS)
    assert done.stdout == "[]\n"
