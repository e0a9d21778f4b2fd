"""Only files that run.json lists are replaced or removed, a run as a whole or not at all, and all are whole."""

import itertools
import json
import os
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Collection
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

import numpy as np
import pytest
from processes import HANGS, started
from refusals import refusal

from lammps_inputs import InputError, Kick, Scene, file_names, strict_yaml
from workflow.cli import main
from workflow.errors import EndedError
from workflow.runs import files
from workflow.runs.files import RECORD, complete, write_json, write_text
from workflow.runs.job import load
from workflow.runs.output_directory import (
    complete_replacement,
    others,
    prepared,
    record_files,
    refuse_unusable,
    refuse_unwritable,
)
from workflow.runs.resume import resume
from workflow.runs.run import prepare_run, run, run_prepared
from workflow.runs.run_directory import RunDirectory
from workflow.study_kit.directory import Study
from workflow.sweep.cases import CaseRequest
from workflow.sweep.run_sweep import refuse_another

Printed, Patch = pytest.CaptureFixture[str], pytest.MonkeyPatch


def scene(duration: float = 1.0) -> Scene:
    return Scene(name="small", beads=4, kick=(Kick(velocity=1.0),), duration=duration)


def scene_file(path: Path) -> Path:
    path.write_text("# mine\n" + strict_yaml.dump(scene().plain()))
    return path


def contents(directory: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in directory.iterdir() if path.is_file()}


@pytest.mark.parametrize("command", ["run", "run --overwrite", "deck", "deck --overwrite"])
def test_a_project_folder_is_left_as_it_is(tmp_path: Path, command: str, monkeypatch: Patch) -> None:
    scene_file(tmp_path / "scene.yaml")
    for name in (".scene.yaml.swp", ".log.lammps.bak", ".run.json.orig", "waves.csv", "shape.png"):
        (tmp_path / name).write_text("mine")
    before = contents(tmp_path)
    monkeypatch.chdir(tmp_path)
    assert main([*command.split(), "scene.yaml", "-o", "."]) == 2
    assert contents(tmp_path) == before


def test_a_scene_of_an_earlier_run_is_not_overwritten_by_its_own_run(tmp_path: Path) -> None:
    run(scene(), tmp_path, engine="reference")
    before = scene_file(tmp_path / "scene.yaml").read_bytes()
    words = ["run", str(tmp_path / "scene.yaml"), "-o", str(tmp_path), "--overwrite", "--engine", "reference"]
    assert main(words) == 2
    assert (tmp_path / "scene.yaml").read_bytes() == before


def test_of_two_that_find_a_new_directory_empty_at_once_one_is_refused(tmp_path: Path, monkeypatch: Patch) -> None:
    both_found_it_empty = threading.Barrier(2, timeout=HANGS)

    def alone(directory: Path) -> AbstractContextManager[int]:
        both_found_it_empty.wait()
        return files.alone(directory)

    def write(name: str) -> None:
        with prepared(tmp_path / "run", {name: ""}, [name]):
            pass

    monkeypatch.setattr("workflow.runs.output_directory.alone", alone)
    with ThreadPoolExecutor(2) as pool:
        failures = [one.exception() for one in [pool.submit(write, name) for name in ("one", "other")]]
    (refused,) = filter(None, failures)
    assert isinstance(refused, InputError)
    assert "exists and is not empty" in str(refused)
    assert len(contents(tmp_path / "run")) == 2  # run.json, and the file of the one


def test_overwriting_removes_what_is_listed(tmp_path: Path) -> None:
    run(scene(), tmp_path, engine="reference").directory.update(outcome="running")  # as after a kill
    record_files(tmp_path, ["waves.csv"])
    write_text(tmp_path / "waves.csv", "ours")
    run(scene(2.0), tmp_path, engine="reference", overwrite=True)
    assert not (tmp_path / "waves.csv").exists()
    assert "waves.csv" not in load(tmp_path / RECORD).files


@pytest.mark.parametrize("name", [".nfs00000001", ".DS_Store"])
def test_hidden_files_of_a_system_stay_where_a_run_is_overwritten(tmp_path: Path, name: str) -> None:
    run(scene(), tmp_path, engine="reference")
    (tmp_path / name).write_text("theirs")
    run(scene(2.0), tmp_path, engine="reference", overwrite=True)
    assert (tmp_path / name).read_text() == "theirs"
    assert load(tmp_path / RECORD).outcome == "done"


def test_a_folder_of_ours_stays_where_a_run_is_overwritten(tmp_path: Path) -> None:
    run(scene(), tmp_path, engine="reference")
    record_files(tmp_path, ["frames.zarr"])
    (tmp_path / "frames.zarr").mkdir()
    for duration in (2.0, 3.0):
        run(scene(duration), tmp_path, engine="reference", overwrite=True)
    assert (tmp_path / "frames.zarr").is_dir()


def test_whoever_stands_in_a_directory_or_reaches_it_by_a_link_has_the_new_run_there(
    tmp_path: Path, monkeypatch: Patch
) -> None:
    directory = run(scene(), tmp_path / "run", engine="reference").directory.path
    (tmp_path / "link").symlink_to("run")
    monkeypatch.chdir(tmp_path / "link")
    words = ["run", str(scene_file(tmp_path / "s.yaml")), "--engine", "reference", "--overwrite"]
    for place in (".", str(tmp_path / "link")):
        assert main([*words, "-o", place]) == 0
    assert os.path.samestat(Path().stat(), directory.stat())
    assert (tmp_path / "link").is_symlink()


def test_a_run_does_not_overwrite_what_a_study_made(tmp_path: Path, capsys: Printed) -> None:
    with Study("map", "", tables=["map.csv"]).opened(tmp_path / "map"):
        write_text(tmp_path / "map" / "map.csv", "ours")
    before = contents(tmp_path / "map")
    words = ["run", str(scene_file(tmp_path / "s.yaml")), "-o", str(tmp_path / "map"), "--engine", "reference"]
    assert main([*words, "--overwrite"]) == 2
    assert "lists the files of an earlier run" in capsys.readouterr().err
    assert contents(tmp_path / "map") == before


def test_what_was_there_stays_when_overwriting_fails(tmp_path: Path, monkeypatch: Patch) -> None:
    run(scene(), tmp_path, engine="reference")
    before, writing = contents(tmp_path), Path.write_bytes

    def full(path: Path, content: bytes) -> int:
        if path.name == "in.chains":
            raise OSError(28, "No space left on device")
        return writing(path, content)

    monkeypatch.setattr(Path, "write_bytes", full)
    with (
        pytest.raises(EndedError, match=f"^{tmp_path}: cannot be written .No space left on device.; what was there"),
        prepared(tmp_path, {"scene.yaml": "new", "in.chains": "new"}, ["scene.yaml", "in.chains"], overwrite=True),
    ):
        pass
    assert contents(tmp_path) == before
    assert not list(tmp_path.glob(".*"))


# --- kills ------------------------------------------------------------------------------------------------------------

OPERATIONS = {"os.chmod", "os.mkdir", "os.remove", "os.rename", "os.rmdir"}
"""Changes of files and directories that Python announces before they are made."""


def killed(work: Callable[[], object], before: int, operations: Collection[str] = OPERATIONS) -> bool:
    """Do work in a process of its own, killed by SIGKILL before one of its operations; whether that came."""
    pid = os.fork()
    if pid == 0:
        left = itertools.count(before, -1)

        def hook(event: str, _: object) -> None:
            if event in operations and next(left) == 0:
                os.kill(os.getpid(), signal.SIGKILL)

        sys.addaudithook(hook)
        work()
        os._exit(0)
    code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    assert code in (0, -signal.SIGKILL)
    return code != 0


@pytest.mark.parametrize("overwrite", [False, True])
def test_a_kill_at_any_moment_leaves_the_earlier_files_or_the_new_ones(tmp_path: Path, *, overwrite: bool) -> None:
    (tmp_path / "before").mkdir()
    if overwrite:
        run(scene(), tmp_path / "before", engine="reference")
        record_files(tmp_path / "before", ["waves.csv"])
        write_text(tmp_path / "before" / "waves.csv", "ours")
    names = ["scene.yaml", "in.chains", "chains.dump.bin"]

    def begin(directory: Path, *, overwrite: bool) -> None:
        with prepared(directory, {name: name for name in names[:2]}, names, overwrite=overwrite, outcome="running"):
            pass

    begin(tmp_path / "after", overwrite=False)
    before, after = contents(tmp_path / "before"), contents(tmp_path / "after")
    assert set(after) == {RECORD, *names[:2]}
    states = []
    for moment in itertools.count():
        directory = tmp_path / str(moment)
        shutil.copytree(tmp_path / "before", directory)
        if not killed(lambda directory=directory: begin(directory, overwrite=overwrite), moment):  # type: ignore[misc]
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


@pytest.fixture
def half_replaced(tmp_path: Path) -> Path:
    """A directory of a run of 1 T that a kill left between the removal of its files and the move of those of 2 T."""
    run(scene(), tmp_path / "run", engine="reference", check=False)
    ready = prepare_run(scene(2.0), tmp_path / "run", engine="reference", overwrite=True)
    RunDirectory(tmp_path / "run").update(request=CaseRequest({}, scene(2.0).plain(), "reference").plain())
    assert killed(lambda: run_prepared(ready, check=False), 1, ["os.rename"])
    assert others(tmp_path / "run") == {".granchain-next"}
    return tmp_path / "run"


def test_a_run_whose_replacement_was_killed_is_resumed_as_the_new_one(half_replaced: Path) -> None:
    assert resume(half_replaced) is not None
    assert RunDirectory(half_replaced).scene.duration == 2.0


def test_a_case_whose_replacement_was_killed_is_the_same_case(half_replaced: Path) -> None:
    refuse_another(half_replaced, CaseRequest({}, scene(2.0).plain(), "reference"), scene(2.0))


def test_a_run_whose_replacement_was_killed_is_overwritten_only_on_request(half_replaced: Path) -> None:
    with pytest.raises(InputError, match="is not empty"):
        run(scene(3.0), half_replaced, engine="reference")
    run(scene(3.0), half_replaced, engine="reference", overwrite=True)
    assert RunDirectory(half_replaced).scene.duration == 3.0


def test_a_directory_where_a_run_names_its_file_is_refused_before_anything_is_touched(tmp_path: Path) -> None:
    run(scene(), tmp_path, engine="reference")
    (tmp_path / "events.csv").mkdir()
    job = load(tmp_path / RECORD)
    (tmp_path / RECORD).write_text(json.dumps({**job.plain(), "files": sorted({*job.files} - {"events.csv"})}))
    before = contents(tmp_path)
    with pytest.raises(InputError, match=r"events\.csv: is not listed"):
        refuse_unusable(tmp_path, ["events.csv"], overwrite=True)
    assert contents(tmp_path) == before


@pytest.mark.slow
@pytest.mark.parametrize("name", [file_names.LOG, "chains.dump.2.bin"])
def test_nothing_is_written_through_a_link(tmp_path: Path, name: str, capsys: Printed) -> None:
    directory = run(scene(), tmp_path / "run", check=False).directory
    directory.update(outcome="interrupted")
    (directory.path / name).unlink(missing_ok=True)
    (directory.path / name).symlink_to(tmp_path / "victim")
    assert main(["run", "--resume", str(directory.path)]) == 2
    assert "is a link" in capsys.readouterr().err
    assert not (tmp_path / "victim").exists()


@pytest.mark.parametrize(
    "text",
    [
        '{"ranks": Infinity}',
        '{"ranks": 1e400}',
        '{"wall_seconds": 1e400}',
        '{"wall_seconds": "3"}',
        '{"settings": {"accuracy": "x"}}',
        '{"results": {"frames": "x", "sha256": ""}}',
        '{"started": "0001-01-01T00:00:00"}x',
        '{"host": "\\ud800"}',
        '{"results": ' + "[" * 100_000,
        '{"files": ["../../home"]}',
        '{"force": true}',
        '{"check": {"velocity": 1e-4, "amplitude": 1e-4, "arrival": 1e-4, "seconds": 1.0}}',
        "[]",
    ],
)
@pytest.mark.parametrize("words", [["status"], ["run", "--resume"]])
def test_a_hostile_record_is_refused_in_one_line(tmp_path: Path, text: str, words: list[str], capsys: Printed) -> None:
    (tmp_path / "scene.yaml").write_text(strict_yaml.dump(scene().resolved().plain()))
    (tmp_path / RECORD).write_text(text)
    assert main([*words, str(tmp_path)]) in (1, 2)
    out, err = capsys.readouterr()
    assert (out + err).count("\n") == 1
    assert "cannot be read" in out + err


def test_names_are_printed_without_what_moves_a_terminal(tmp_path: Path, capsys: Printed) -> None:
    directory = tmp_path / "a\n\x1b[2J"
    words = ["run", str(scene_file(tmp_path / "s.yaml")), "-o", str(directory), "--engine", "reference"]
    assert main(words) == 0
    out = capsys.readouterr().out
    assert "\x1b" not in out
    assert out.count("\n") == 3  # units, what was done, and where


def test_more_beads_than_memory_holds_are_refused_beforehand(tmp_path: Path, capsys: Printed) -> None:
    path = tmp_path / "s.yaml"
    path.write_text(
        strict_yaml.dump(
            scene().plain() | {"chains": 20, "beads": 100_000_000, "limits": {"gigabytes": 1e9, "hours": 1e9}}
        )
    )
    assert "need 2e+03 GB of memory for LAMMPS" in refusal(["run", path, "-o", tmp_path / "run"], capsys)


def test_frames_with_the_largest_numbers_end_in_a_line(tmp_path: Path, capsys: Printed) -> None:
    directory: RunDirectory = run(scene(), tmp_path, engine="reference").directory
    data = bytearray(directory.dump.read_bytes())
    data[-8:] = np.float64(1e308).tobytes()
    directory.dump.write_bytes(data)
    refusal(["analyze", tmp_path], capsys)


def test_a_report_that_is_listed_is_no_news_of_the_run(tmp_path: Path) -> None:
    """What `status` says by the age of run.json stays."""
    path = tmp_path / RECORD
    write_text(path, '{"outcome": "done", "files": ["run.json"]}')
    os.utime(path, (1e9, 1e9))
    record_files(tmp_path, ["waves.csv"])
    assert load(path).files == ["run.json", "waves.csv"]
    assert path.stat().st_mtime == 1e9


def test_a_directory_or_file_that_cannot_be_written_to_is_named(tmp_path: Path) -> None:
    """Whoever runs this, the kernel's own directory takes no files, and a directory is none."""
    refuse_unwritable(tmp_path, ())
    with pytest.raises(InputError, match=r"^/proc: cannot be written to "):
        refuse_unwritable(Path("/proc"), ())
    with pytest.raises(InputError, match=rf"^{tmp_path}: cannot be written to "):
        refuse_unwritable(tmp_path, (tmp_path,))


# --- written whole or not at all --------------------------------------------------------------------------------------


def test_whoever_reads_a_file_while_it_is_replaced_reads_all_of_the_one_before(tmp_path: Path) -> None:
    path = tmp_path / "run.json"
    write_text(path, "before " * 1000)
    with path.open("rb", buffering=0) as reader:
        assert reader.read(7) == b"before "
        write_text(path, "after")
        assert reader.read() == b"before " * 999
    assert path.read_text() == "after"
    assert list(tmp_path.iterdir()) == [path]


def test_what_was_there_stays_where_the_new_cannot_be_written(tmp_path: Path, monkeypatch: Patch) -> None:
    path = tmp_path / "run.json"
    write_text(path, "before")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(EndedError, match="what was there is left as it was"):
        write_text(path, "after")
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("fails", [False, True])
def test_a_directory_is_replaced_as_one_or_not_at_all(tmp_path: Path, fails: bool) -> None:
    def write(content: str) -> None:
        with complete(tmp_path / "store", directory=True) as temporary:
            (temporary / content).write_text(content)
            if fails and content == "after":
                raise KeyboardInterrupt

    write("before")
    with pytest.raises(KeyboardInterrupt) if fails else nullcontext():
        write("after")
    assert [path.name for path in (tmp_path / "store").iterdir()] == ["before" if fails else "after"]
    assert list(tmp_path.iterdir()) == [tmp_path / "store"]


WRITES = """
import sys
from pathlib import Path
from workflow.runs.files import complete
with complete(Path(sys.argv[1]), directory=sys.argv[2] == "True"):
    print(flush=True)
    sys.stdin.read()
"""


@pytest.mark.parametrize("directory", [False, True])
def test_what_a_killed_process_was_writing_is_removed_by_the_next_and_what_another_writes_is_not(
    tmp_path: Path, directory: bool
) -> None:
    def writer(name: str) -> AbstractContextManager[subprocess.Popen[str]]:
        return started([sys.executable, "-c", WRITES, tmp_path / name, directory], stdin=subprocess.PIPE)

    with writer("killed") as killed, writer("slow") as slow:
        for process in (killed, slow):
            assert process.stdout is not None
            process.stdout.readline()
        killed.kill()
        killed.wait(HANGS)
        assert len(list(tmp_path.iterdir())) == 2
        write_text(tmp_path / "other.txt", "text")
        (left,) = (path.name for path in tmp_path.iterdir() if path.name != "other.txt")
        assert left.startswith(".slow.granchain-")
        slow.communicate("", HANGS)
        assert slow.returncode == 0
    assert {path.name for path in tmp_path.iterdir()} == {"other.txt", "slow"}


def test_numbers_come_back_from_json_and_what_is_none_is_null(tmp_path: Path) -> None:
    write_json(tmp_path / "a.json", {"a": 0.1 + 0.2, "b": [float("nan"), (float("inf"), 1)]})
    assert json.loads((tmp_path / "a.json").read_text()) == {"a": 0.1 + 0.2, "b": [None, [None, 1]]}
