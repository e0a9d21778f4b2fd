"""The command line: what is wrong is one line on standard error, exit code 2, and nothing written."""

import contextlib
import importlib
import json
import os
import re
import shutil
import subprocess
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest
from bad_scenes import scene_text
from plug_ins import needs
from processes import HANGS
from refusals import refusal
from stock_lammps import scene
from sweeps import GRANCHAIN

from lammps_inputs import installed_scenes, library, plugins, strict_yaml
from workflow import cli
from workflow.cli import COMMANDS, main
from workflow.engines.lammps import mpi
from workflow.prepare.settings import settle
from workflow.runs.run import run

pytestmark = pytest.mark.usefixtures("lammps_here")


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A finished run of two short chains."""
    path = tmp_path_factory.mktemp("finished") / "run"
    run(scene(chains=2, beads=12, kappa=0.1, duration=10.0), path, check=False)
    return path


@pytest.fixture
def a_run(finished, tmp_path):
    """A copy of it that may be spoiled."""
    return shutil.copytree(finished, tmp_path / "run")


@pytest.fixture
def locked(tmp_path):
    """A directory that the user may not look into; root, for whom permissions do not count, is somebody else here."""
    for name in COMMANDS:  # while they can be read
        cli.module_of(name)
    importlib.import_module("rich.progress")
    assert main(["deck", "two-chains", "-o", str(tmp_path / "compiled")]) == 0  # a cache of root's is read here
    tmp_path.chmod(0)
    if os.getuid() == 0:
        os.seteuid(65534)
        try:
            Path(cli.__file__).read_bytes()
        except PermissionError:
            os.seteuid(0)
            pytest.skip("the package lies where only root can read it")
    yield tmp_path
    os.seteuid(os.getuid())
    tmp_path.chmod(0o700)


# --- scenes -----------------------------------------------------------------------------------------------------------


def test_a_scene_without_permission_is_one_line(locked, capsys):
    assert refusal(["show", locked / "a.yaml"], capsys) == f"{locked}/a.yaml: cannot be read (Permission denied)"


def test_more_ranks_than_rows_are_refused(tmp_path, capsys):
    if mpi.cores() < 3:
        pytest.skip("two rows and three ranks need three cores")
    short = tmp_path / "short.yaml"
    short.write_text(scene_text(beads="2"))
    assert "ranks divide the 2 rows" in refusal(["run", short, "-o", tmp_path / "out", "--ranks", 3], capsys)


# --- options ----------------------------------------------------------------------------------------------------------


def test_help_lists_every_command_with_its_job(capsys):
    with pytest.raises(SystemExit):
        main(["--help"])
    listed = capsys.readouterr().out
    jobs = cli.by_job()
    names = [name for of_job in jobs.values() for name in of_job]
    assert sorted(names) == sorted(COMMANDS)
    assert re.findall(r"^  ([a-z]+) +[A-Z]", listed, re.M) == names
    assert re.findall(r"^([A-Z][a-z ]+)$", listed, re.M) == [job for job, of_job in jobs.items() if of_job]


def test_a_command_of_a_plug_in_stands_under_the_job_that_its_source_names_and_is_not_imported(tmp_path, monkeypatch):
    (tmp_path / "weighing.py").write_text('"""Weigh a scene."""\n\nJOB = "Scenes"\nraise AssertionError("imported")\n')
    monkeypatch.syspath_prepend(tmp_path)
    points = {kind: plugins.declared(kind) for kind in cli.PLUG_INS}
    points["tools"] = {**points["tools"], "weigh": EntryPoint("weigh", "weighing", "granchain.tools")}
    monkeypatch.setattr(plugins, "declared", points.__getitem__)
    assert cli.by_job()["Scenes"][-1] == "weigh"
    assert cli.summary_of("weigh") == "Weigh a scene."


# --- where to write ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("command", ["run", "deck"])
def test_an_output_without_permission_is_refused(command, locked, capsys):
    message = refusal([command, "two-chains", "-o", locked / "out"], capsys)
    assert message == f"{locked}/out: cannot be written to (Permission denied)"


def test_a_run_that_fails_is_one_line_and_exit_code_1(tmp_path, capsys):
    bad = tmp_path / "unstable.yaml"
    bad.write_text(scene_text(timestep="2", duration="4000", output="{every: 2}"))
    assert main(["run", str(bad), "-o", str(tmp_path / "out"), "--force"]) == 1
    out, err = capsys.readouterr()
    assert out.count("\n") == 1  # the units
    assert err.startswith("granchain: by step 200, ")
    assert err.count("\n") == 1
    assert json.loads((tmp_path / "out" / "run.json").read_text())["outcome"] == "failed"


# --- what to analyse --------------------------------------------------------------------------------------------------


def spoiled(name, content):
    """A function that replaces a file of a run; None removes it."""

    def spoil(directory):
        path = directory / name
        path.unlink()
        if content is not None:
            path.write_bytes(content)

    return spoil


def test_a_run_without_permission_is_one_line(locked, capsys):
    assert refusal(["analyze", locked / "run"], capsys) == f"{locked}/run: cannot be read (Permission denied)"


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("chains.dump.bin", bytes(range(256)) * 40, "chains.dump.bin: is not a LAMMPS binary dump"),
        ("chains.dump.bin", 200, "chains.dump.bin: ends within its first frame"),
        ("scene.yaml", b"\xff\xfe", "scene.yaml: is not a text file"),
    ],
)
def test_binary_content_of_a_run_is_one_line_that_names_its_file_once(name, content, says, a_run, capsys):
    if isinstance(content, int):
        os.truncate(a_run / name, content)
    else:
        (a_run / name).write_bytes(content)
    message = refusal(["analyze", a_run], capsys)
    assert message.startswith(f"{a_run}/{says}" if name == "chains.dump.bin" else str(a_run))
    assert says in message
    assert message.count(str(a_run)) == 1


@pytest.mark.parametrize("record", [None, b"", b"{", b"[]", b"\xff"])
def test_a_run_is_analysed_whatever_run_json_holds(record, a_run, capsys):
    spoiled("run.json", record)(a_run)
    assert main(["analyze", str(a_run), "--no-figures"]) == 0
    assert capsys.readouterr().err == ""
    assert (a_run / "waves.csv").exists()


# --- where to print ---------------------------------------------------------------------------------------------------


@contextlib.contextmanager
def no_output(why):
    """Standard output that takes nothing."""
    with pytest.MonkeyPatch.context() as patch, contextlib.suppress(OSError):  # at its end
        if why == "Bad file descriptor":
            patch.setattr(sys, "stdout", None)
            yield
            return
        with Path("/dev/full").open("w") as full:
            patch.setattr(sys, "stdout", full)
            yield


REASONS = pytest.mark.parametrize("why", ["Bad file descriptor", "No space left on device"])


@REASONS
def test_a_command_whose_output_is_lost_writes_its_files_and_says_so_in_one_line(why, a_run, capsys):
    with no_output(why):
        assert main(["analyze", str(a_run), "--no-figures"]) == 0
    said = f"granchain: standard output: cannot be written ({why}); the results are in the files\n"
    assert capsys.readouterr().err == said
    assert (a_run / "waves.csv").exists()
    with no_output(why):
        assert main(["analyze", str(a_run), "--no-figures", "--quiet"]) == 0
    assert capsys.readouterr().err == ""


@REASONS
@pytest.mark.parametrize("words", [["scenes"], ["show", "two-chains"], pytest.param(["schema"], marks=needs("schema"))])
def test_a_command_that_only_prints_fails_where_it_cannot(words, why, capsys):
    with no_output(why):
        assert main(words) == 1
    assert capsys.readouterr().err == f"granchain: standard output: cannot be written ({why})\n"


@pytest.mark.slow
@pytest.mark.parametrize("streams", ["<&- >&- 2>&-", ">/dev/full"])
def test_a_program_without_standard_streams_ends_with_its_own_code_and_no_traceback(streams, tmp_path):
    words = ["sh", "-c", f'"$@" {streams}', "sh", sys.executable, "-m", "workflow", "new", tmp_path / "scene.yaml"]
    done = subprocess.run(words, capture_output=True, text=True, timeout=HANGS, check=False)
    assert done.returncode == 0
    assert done.stdout == ""
    assert done.stderr.count("\n") == (0 if "2>" in streams else 1)


# --- scenes and show --------------------------------------------------------------------------------------------------


def test_scenes_lists_a_line_for_each_installed_scene(capsys):
    assert main(["scenes"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(installed_scenes.installed())
    assert all(len(line.split()) > 3 for line in lines)


TEXTS = {
    **{name: strict_yaml.dump(library.load_plain(path)) for name, path in [*installed_scenes.installed().items()][::9]},
    "least": scene_text(),
    "until a bead": scene_text(duration=None, until_bead="7"),
    "several kicks": scene_text(kick="[{bead: 1, velocity: 1.0}, {bead: 9, velocity: -0.3}]"),
    "beads": scene_text(output="{every: 0.3, beads: [9, 2, 5]}"),
    "fast": scene_text(kick="{velocity: 1e12}", duration="0.01"),
    "gap": scene_text(gap="0.1", chains="2", coupling="{stiffness: 0.123456789012345678}"),
    "text like a number": scene_text(name="'1e5'", description="'yes: no # null'"),
}


def shown(text, directory, capsys, *options):
    path = directory / "scene.yaml"
    path.write_text(text, encoding="utf-8")
    assert main(["show", str(path), *options]) == 0
    return capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.parametrize("kind", TEXTS)
def test_what_show_prints_is_a_scene_of_the_same_problem_and_prints_again(kind, tmp_path, capsys):
    text = TEXTS[kind]
    printed = shown(text, tmp_path, capsys, "--pilot")
    one, other = (library.from_plain(strict_yaml.parse(each, "here"), "here") for each in (text, printed))
    assert settle(one)[0].problem() == other.problem()
    assert other.resolved() == other
    chosen = [line for line in printed.splitlines() if not line.startswith("# time step ")]  # of the time step
    assert shown(printed, tmp_path, capsys).splitlines() == chosen


OPEN = {
    **TEXTS,
    "until a bead": scene_text(duration=None, until_bead="5"),
    "window": scene_text(beads="300", window="auto"),
    "accuracy": scene_text(accuracy="1e-4"),
    "time step": scene_text(timestep="0.01"),
}


@pytest.mark.parametrize("kind", OPEN)
def test_without_trials_show_prints_a_scene_that_leaves_open_what_the_scene_does(kind, tmp_path, capsys):
    printed = shown(OPEN[kind], tmp_path, capsys)
    one, other = (library.from_plain(strict_yaml.parse(each, "here"), "here") for each in (OPEN[kind], printed))
    assert other.resolved() == one.resolved()
    for key in ("duration", "until_bead", "window", "accuracy", "timestep"):
        assert getattr(other, key) == getattr(one, key)
    assert shown(printed, tmp_path, capsys) == printed
    assert ("find by trials" in printed) == (one.timestep is None or one.until_bead is not None)


def test_show_fills_in_every_default(tmp_path, capsys):
    text = shown(scene_text(), tmp_path, capsys, "--pilot")
    data = strict_yaml.parse(text, "here")
    assert data["chains"] == 1
    assert data["kick"] == {"chain": 1, "bead": 1, "velocity": 1.0}
    assert (
        f"# time step {data['timestep']:.3g}, for an error of velocities up to 0.0002 V (default accuracy): error"
        in text
    )
    assert data["output"] == {"every": 0.1, "beads": "all"}


# --- pipes ------------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("arguments", [["scenes"], ["show", "nothing"]])
def test_a_reader_that_has_gone_away_leaves_no_traceback(arguments):
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run([GRANCHAIN, *arguments], stdout=writing, stderr=subprocess.PIPE, text=True, timeout=HANGS)
    os.close(writing)
    assert done.stderr.count("\n") <= 1
    assert "Traceback" not in done.stderr
    assert "Broken" not in done.stderr


def test_deck_writes_the_three_files_and_says_what_to_do(tmp_path, capsys):
    assert main(["deck", "two-chains", "-o", str(tmp_path / "deck")]) == 0
    assert {path.name for path in (tmp_path / "deck").iterdir()} == {
        "scene.yaml",
        "in.chains",
        "data.chains",
        "run.json",
    }
    assert "lmp -in in.chains" in capsys.readouterr().out
