"""Only files that run.json lists are replaced or removed, a run as a whole or not at all, and all are whole."""

import itertools
import json
import os
import shutil
import signal
import sys
from contextlib import nullcontext

import pytest
from refusals import refusal

from lammps_inputs import Kick, Scene, file_names
from workflow.runs.files import RECORD, complete, write_json, write_text
from workflow.runs.job import load
from workflow.runs.output_directory import (
    complete_replacement,
    others,
    prepared,
    record_files,
)
from workflow.runs.resume import resume
from workflow.runs.run import prepare_run, run, run_prepared
from workflow.runs.run_directory import RunDirectory


def scene(duration=1.0):
    return Scene(name="small", beads=4, kick=(Kick(velocity=1.0),), duration=duration)


def contents(directory):
    return {path.name: path.read_bytes() for path in directory.iterdir() if path.is_file()}


@pytest.mark.slow
def test_overwriting_removes_what_is_listed_and_leaves_hidden_files_of_a_system_and_folders(tmp_path):
    run(scene(), tmp_path, engine="reference").directory.update(outcome="running")  # as after a kill
    record_files(tmp_path, ["waves.csv", "frames.zarr"])
    write_text(tmp_path / "waves.csv", "ours")
    (tmp_path / "frames.zarr").mkdir()
    (tmp_path / ".nfs00000001").write_text("theirs")
    for duration in (2.0, 3.0):
        run(scene(duration), tmp_path, engine="reference", overwrite=True)
    assert not (tmp_path / "waves.csv").exists()
    assert "waves.csv" not in load(tmp_path / RECORD).files
    assert (tmp_path / "frames.zarr").is_dir()
    assert (tmp_path / ".nfs00000001").read_text() == "theirs"
    assert RunDirectory(tmp_path).scene.duration == 3.0


OPERATIONS = {"os.chmod", "os.mkdir", "os.remove", "os.rename", "os.rmdir"}
"""Changes of files and directories that Python announces before they are made."""


def killed(work, before, operations=OPERATIONS):
    """Do work in a process of its own, killed by SIGKILL before one of its operations; whether that came."""
    pid = os.fork()
    if pid == 0:
        left = itertools.count(before, -1)

        def hook(event, _):
            if event in operations and next(left) == 0:
                os.kill(os.getpid(), signal.SIGKILL)

        sys.addaudithook(hook)
        work()
        os._exit(0)
    code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    assert code in (0, -signal.SIGKILL)
    return code != 0


@pytest.mark.slow
@pytest.mark.parametrize("overwrite", [False, True])
def test_a_kill_at_any_moment_leaves_the_earlier_files_or_the_new_ones(tmp_path, *, overwrite):
    (tmp_path / "before").mkdir()
    if overwrite:
        run(scene(), tmp_path / "before", engine="reference")
        record_files(tmp_path / "before", ["waves.csv"])
        write_text(tmp_path / "before" / "waves.csv", "ours")
    names = ["scene.yaml", "in.chains", "chains.dump.bin"]

    def begin(directory, *, overwrite):
        with prepared(directory, {name: name for name in names[:2]}, names, overwrite=overwrite, outcome="running"):
            pass

    begin(tmp_path / "after", overwrite=False)
    before, after = contents(tmp_path / "before"), contents(tmp_path / "after")
    assert set(after) == {RECORD, *names[:2]}
    states = []
    for moment in itertools.count():
        directory = tmp_path / str(moment)
        shutil.copytree(tmp_path / "before", directory)
        if not killed(lambda directory=directory: begin(directory, overwrite=overwrite), moment):
            break
        complete_replacement(directory)
        states.append(contents(directory))
        assert states[-1] in (before, after)
        begin(directory, overwrite=bool(states[-1]))
        assert contents(directory) == after
        assert not list(directory.glob(".*"))
    changes = [first != second for first, second in itertools.pairwise(states)]
    assert (states[0], states[-1], sum(changes)) == (before, after, 1)
    assert min(states.count(before), states.count(after)) > 2


def test_a_run_whose_replacement_was_killed_is_resumed_as_the_new_one(tmp_path):
    """Between the removal of the files of 1 T and the move of those of 2 T."""
    path = run(scene(), tmp_path / "run", engine="reference", check=False).directory.path
    ready = prepare_run(scene(2.0), path, engine="reference", overwrite=True)
    assert killed(lambda: run_prepared(ready, check=False), 1, ["os.rename"])
    assert others(path) == {".granchain-next"}
    assert resume(path) is not None
    assert RunDirectory(path).scene.duration == 2.0


@pytest.mark.usefixtures("lammps_here")
def test_nothing_is_written_through_a_link(tmp_path, capsys):
    directory = run(scene(), tmp_path / "run", check=False).directory
    directory.update(outcome="interrupted")
    (directory.path / file_names.LOG).unlink()
    (directory.path / file_names.LOG).symlink_to(tmp_path / "victim")
    assert "is a link" in refusal(["run", "--resume", directory.path], capsys)
    assert not (tmp_path / "victim").exists()


@pytest.mark.parametrize("fails", [False, True])
def test_a_directory_is_replaced_as_one_or_not_at_all(tmp_path, fails):
    def write(content):
        with complete(tmp_path / "store", directory=True) as temporary:
            (temporary / content).write_text(content)
            if fails and content == "after":
                raise KeyboardInterrupt

    write("before")
    with pytest.raises(KeyboardInterrupt) if fails else nullcontext():
        write("after")
    assert [path.name for path in (tmp_path / "store").iterdir()] == ["before" if fails else "after"]
    assert list(tmp_path.iterdir()) == [tmp_path / "store"]


def test_numbers_come_back_from_json_and_what_is_none_is_null(tmp_path):
    write_json(tmp_path / "a.json", {"a": 0.1 + 0.2, "b": [float("nan"), (float("inf"), 1)]})
    assert json.loads((tmp_path / "a.json").read_text()) == {"a": 0.1 + 0.2, "b": [None, [None, 1]]}
