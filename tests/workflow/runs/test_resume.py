"""Runs that were cut short and go on: bit for bit as if nothing had happened."""

import hashlib
import json
import os
import random
import shutil
import signal
import time

import lammps_here
import numpy as np
import pytest
from kill_many import AIMS, SCENES, command, end, frames, next_words, until_done
from plain_scene import goes_on_bit_for_bit
from processes import HANGS, wait_until, working_in
from refusals import refusal
from stock_lammps import scene

from analysis.files.binary_dump import BinaryDump
from lammps_inputs import InputError, file_names, strict_yaml
from lammps_inputs.decks import scene_files
from workflow.cli import main
from workflow.engines.lammps import files_on_disk, mpi
from workflow.engines.registry import engine_names
from workflow.runs.files import alone, parts
from workflow.runs.output_directory import record_files
from workflow.runs.resume import resume
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory, results

pytestmark = pytest.mark.usefixtures("lammps_here")

TWO = pytest.mark.skipif(mpi.cores() < 2, reason="needs two cores")


def a_scene(**changes):
    """Three chains, whose forces add up in an order that shows in the last bit."""
    return scene(**{"chains": 3, "beads": 12, "kappa": 0.05, "duration": 200.0, "every": 0.5, **changes})


def interrupted_after(step, one, directory, **options):
    """A run that is interrupted at the first report after a step, and ends at the next."""
    if not options:
        run(one, directory, check=False, lammps=lammps_here.interrupted_after(step))
        return RunDirectory(directory)

    def progress(done, _):
        if done >= step and not sent:
            sent.append(done)
            os.kill(os.getpid(), signal.SIGINT)

    sent = []
    run(one, directory, check=False, progress=progress, **options)
    return RunDirectory(directory)


@pytest.fixture(scope="module")
def whole(tmp_path_factory, request):
    """`a_scene` run without a break."""
    request.getfixturevalue("lammps_here")
    path = tmp_path_factory.mktemp("resume") / "whole"
    run(a_scene(), path, check=False)
    return path


@pytest.fixture(scope="module")
def interrupted(tmp_path_factory, request):
    """`a_scene` interrupted; to be copied."""
    request.getfixturevalue("lammps_here")
    return interrupted_after(5000, a_scene(), tmp_path_factory.mktemp("resume") / "cut").path


@pytest.fixture
def cut(interrupted, tmp_path):
    """A copy of `a_scene` interrupted."""
    shutil.copytree(interrupted, tmp_path / "cut")
    return RunDirectory(tmp_path / "cut")


def assert_same(directory, whole):
    np.testing.assert_array_equal(frames(directory), frames(whole))
    left, right = (RunDirectory(path).job.results.plain() for path in (directory, whole))
    assert left == right == results(RunDirectory(directory))


# --- Ctrl-C -----------------------------------------------------------------------------------------------------------


def test_an_interrupted_run_goes_on_bit_for_bit_from_where_it_was_and_is_checked(cut, whole):
    step, before, started = cut.job.steps_done, cut.job.wall_seconds, time.perf_counter()
    assert files_on_disk.step_of(cut.path / file_names.RESTART) == step
    result = resume(cut.path)
    assert result.outcome == "done"
    assert result.check.velocity > 0.0
    assert [again.from_step for again in cut.job.resumed] == [step]
    assert_same(cut.path, whole)
    assert not (cut.path / file_names.RESTART).exists()
    # of all parts
    assert before < cut.job.wall_seconds < before + time.perf_counter() - started


@pytest.mark.slow
@pytest.mark.parametrize("changes", [{"scheme": "suzuki4"}, {"chains": 2, "beads": 200, "window": 64}])
def test_an_interrupted_run_of_another_kind_goes_on_bit_for_bit(changes, tmp_path):
    goes_on_bit_for_bit(a_scene(**changes), tmp_path, after=5000)


@pytest.mark.slow
@TWO
def test_two_ranks_are_interrupted_and_go_on_as_one_or_two(tmp_path):
    run(a_scene(), tmp_path / "whole", check=False)
    interrupted_after(1000, a_scene(), tmp_path / "cut", ranks=2)
    shutil.copytree(tmp_path / "cut", tmp_path / "other")
    resume(tmp_path / "cut", check=False)
    resume(tmp_path / "other", check=False, ranks=1)
    for name in ("cut", "other"):
        assert_same(tmp_path / name, tmp_path / "whole")


@pytest.mark.parametrize("engine", [name for name in engine_names() if name != "lammps"])
def test_other_engines_start_again(engine, tmp_path):
    one = a_scene(gap=1.0, duration=40.0)
    run(one, tmp_path / "whole", engine=engine, check=False)
    shutil.copytree(tmp_path / "whole", tmp_path / "cut")
    directory = RunDirectory(tmp_path / "cut")
    os.truncate(directory.dump, 5000)
    directory.update(outcome="running")
    assert resume(tmp_path / "cut", check=False).outcome == "done"
    assert directory.job.resumed[0].from_step == 0
    assert_same(tmp_path / "cut", tmp_path / "whole")


# --- SIGKILL ----------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", ["some", pytest.param("lossy", marks=TWO)])
def test_runs_killed_at_random_are_resumed_bit_for_bit(name, tmp_path):
    one, ranks = SCENES[name]
    one = one.model_copy(update={"duration": one.duration / (8.0 * ranks**3)})  # ranks wait by computing
    seed = random.randrange(10**6)
    run(one, tmp_path / "whole", check=False, ranks=ranks)
    states = until_done(tmp_path / "cut", one, ranks, random.Random(seed), kills=1 + (name == "some"))
    assert states <= {"not begun", "running", "failed", "done"}
    assert np.array_equal(frames(tmp_path / "cut"), frames(tmp_path / "whole")), f"seed {seed}, aims {AIMS}"


def test_frames_beyond_the_last_restart_are_computed_again_and_read_once(cut, whole):
    step = cut.job.steps_done
    content = (whole / file_names.DUMP).read_bytes()
    size = len(content) // 401
    kept = (step // 50 + 10) * size  # nine frames beyond the restart, and a cut one
    cut.dump.write_bytes(content[: kept + 77])
    resume(cut.path, check=False)
    assert cut.dumps[0].stat().st_size == kept
    assert_same(cut.path, whole)


@pytest.mark.slow
@pytest.mark.parametrize("lost", ["last frame", "end of restart", "restart", "version"])
def test_without_a_whole_restart_and_all_frames_until_then_it_starts_again(lost, cut, whole):
    restart = cut.path / file_names.RESTART
    if lost == "last frame":  # that of the restart itself
        found = BinaryDump(cut.dump)
        assert found.steps[-1] == cut.job.steps_done == files_on_disk.step_of(restart)
        os.truncate(cut.dump, cut.dump.stat().st_size // found.n_frames * (found.n_frames - 1))
    elif lost == "end of restart":
        os.truncate(restart, restart.stat().st_size - 1)
    elif lost == "restart":
        restart.unlink()
    else:  # another LAMMPS may not read it, or sum up in another order
        cut.update(versions={**cut.job.versions, "lammps": "2025.7.22.1"})
    resume(cut.path, check=False)
    assert [again.from_step for again in cut.job.resumed] == [0]
    assert_same(cut.path, whole)


def test_a_run_that_ends_in_seconds_writes_no_restart(tmp_path):
    written = []
    run(
        a_scene(duration=100.0),
        tmp_path / "run",
        check=False,
        progress=lambda *_: written.extend((tmp_path / "run").glob("*restart*")),
    )
    assert not written


@pytest.mark.slow
@TWO
@pytest.mark.parametrize("which", [0, 1], ids=["mpiexec", "its proxy"])
def test_whoever_is_killed_of_a_run_on_two_ranks_nobody_is_left(which, tmp_path):
    scene_file = tmp_path / "long.yaml"
    scene_file.write_text(strict_yaml.dump(a_scene(duration=6e5).plain()))
    process = command(scene_file, "-o", tmp_path / "run", "--ranks", 2)
    try:
        assert wait_until(lambda: (tmp_path / "run" / file_names.DUMP).exists(), process)
        everybody = sorted(working_in(tmp_path / "run"))  # mpiexec, its proxy and two ranks
        assert len(everybody) == 4
        os.kill(everybody[which], signal.SIGKILL)
        _, err = process.communicate(timeout=HANGS)
        assert process.returncode == 1
        assert err.startswith("granchain: LAMMPS ")
        assert f"; `granchain run --resume {tmp_path / 'run'}` " in err
        assert wait_until(lambda: not working_in(tmp_path / "run"))
    finally:
        end(process, tmp_path / "run")


# --- what resume says -------------------------------------------------------------------------------------------------


def said(words, capsys):
    """Exit code of a command, and the line that it printed."""
    code = main([str(word) for word in words])
    out, err = capsys.readouterr()
    (line,) = (out + err).splitlines()
    return code, line


def test_a_run_that_is_done_is_left_as_it_is(tmp_path, capsys):
    run(a_scene(duration=4.0), tmp_path, check=False)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    words = ["run", "--resume", tmp_path, "--no-check"]
    assert said(words, capsys) == (0, f"{tmp_path}: the run is done already")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_the_error_is_measured_where_only_that_is_missing(tmp_path, capsys):
    run(a_scene(duration=4.0), tmp_path, check=False)
    assert main(["run", "--resume", str(tmp_path)]) == 0
    assert "largest errors against the reference integrator: velocities" in capsys.readouterr().out
    assert RunDirectory(tmp_path).job.check.velocity > 0.0


def test_the_command_says_from_which_step_it_went_on(cut, capsys):
    assert main(["run", "--resume", str(cut.path), "--no-check"]) == 0
    assert f"on 1 rank, resumed from step {cut.job.resumed[0].from_step}\n" in capsys.readouterr().out


@pytest.mark.parametrize("left", [[], [".run.json.granchain-abcd1234"], ["scene.yaml"]])
def test_a_run_killed_in_its_first_milliseconds_is_told_and_can_be_run_again(left, tmp_path, capsys):
    path = tmp_path / "run"
    path.mkdir()
    scene_file = tmp_path / "scene.yaml"
    scene_file.write_text(strict_yaml.dump(a_scene(duration=4.0).plain()))
    for name in left:
        record_files(path, [name] if name == "scene.yaml" else [])  # the list of files is written before them
        shutil.copy(scene_file, path / name)
    code, line = said(["run", "--resume", path], capsys)
    assert code == 2
    assert "run the scene" in line
    words = ["run", scene_file, "-o", path, "--no-check", *(["--overwrite"] if "scene.yaml" in left else [])]
    assert main([str(word) for word in words]) == 0
    assert not list(path.glob(".*"))


@pytest.mark.slow
def test_a_run_killed_before_its_deck_was_written_is_resumed(tmp_path):
    run(a_scene(duration=4.0), tmp_path / "whole", check=False)
    shutil.copytree(tmp_path / "whole", tmp_path / "cut")
    for name in (file_names.DATA, file_names.DUMP):
        (tmp_path / "cut" / name).unlink()
    RunDirectory(tmp_path / "cut").update(outcome="running")
    resume(tmp_path / "cut", check=False)
    assert_same(tmp_path / "cut", tmp_path / "whole")


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        (file_names.DECK, "overlap^1.5", "overlap^1.7"),
        (file_names.DATA, "\n1 1 1 13\n", "\n1 1 1 14\n"),
        (file_names.SCENE, "0.05", "0.06"),
    ],
)
def test_files_that_were_changed_are_not_gone_on_with(name, old, new, cut):
    text = (cut.path / name).read_text()
    assert text.count(old) == 1
    (cut.path / name).write_text(text.replace(old, new))
    with pytest.raises(InputError, match=r"in\.chains, data\.chains are not those that the run was begun with"):
        resume(cut.path)


@pytest.mark.parametrize(
    "content", ["", "{", "[]", "{}", '{"engine": "lammps", "outcome": "running", "ranks": 1, "started": "x"}']
)
def test_a_record_that_a_loss_of_power_left_empty_is_told(content, tmp_path, capsys):
    scene_files.write(a_scene(), tmp_path)
    (tmp_path / "run.json").write_text(content)
    code, line = said(["run", "--resume", tmp_path], capsys)
    assert code == 2
    assert "run.json" in line
    assert "run the scene again with another -o" in line


# --- one at a time ----------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_two_resumes_at_once_do_not_meet(tmp_path, monkeypatch):
    monkeypatch.setattr("workflow.runs.files._LOCK_SECONDS", 0.2)
    interrupted_after(1000, a_scene(duration=6e5), tmp_path)
    process = command("--resume", tmp_path)
    try:
        assert wait_until(lambda: len(parts(tmp_path)) == 2, process)
        before = json.loads((tmp_path / "run.json").read_text())
        with pytest.raises(InputError, match="a run is under way in it"):
            resume(tmp_path)
        with pytest.raises(InputError, match="a run is under way in it"):
            run(a_scene(), tmp_path, overwrite=True)
        assert json.loads((tmp_path / "run.json").read_text()) == before
        # the worker outlives its parent for a moment, in which nobody else may write
        os.kill(process.pid, signal.SIGSTOP)
        (worker,) = (pid for pid in working_in(tmp_path))
        os.kill(worker, signal.SIGSTOP)
        process.kill()
        process.wait(HANGS)
        with pytest.raises(InputError, match="a run is under way in it"), alone(tmp_path):
            pass
        os.kill(worker, signal.SIGCONT)
        assert wait_until(lambda: not working_in(tmp_path))
        with alone(tmp_path):
            pass
    finally:
        end(process, tmp_path)


@pytest.mark.slow
def test_a_worker_that_loses_its_parent_leaves_a_restart(tmp_path):
    scene_file = tmp_path / "long.yaml"
    scene_file.write_text(strict_yaml.dump(a_scene(duration=6e5).plain()))
    path = tmp_path / "run"
    process = command(scene_file, "-o", path, restart_every=30.0)
    assert wait_until(lambda: path.is_dir() and (path / file_names.DUMP).exists(), process)
    process.kill()
    process.communicate()
    assert wait_until(lambda: not working_in(path))
    assert files_on_disk.step_of(path / file_names.RESTART) > 0
    assert next_words(path, scene_file, 1) == ("running", ["--resume", path])


def test_a_damaged_restart_is_not_gone_on_with(tmp_path):
    restart = tmp_path / file_names.RESTART
    restart.write_bytes(b"whole")
    assert not files_on_disk.intact(restart)
    sums = tmp_path / file_names.RESTART_SUMS
    sums.write_text(f"{'0' * 64}\n{hashlib.sha256(b'whole').hexdigest()}\n")
    assert files_on_disk.intact(restart)
    restart.write_bytes(b"whale")
    assert not files_on_disk.intact(restart)


def test_with_another_atom_in_a_frame_a_run_starts_again(cut):
    raw = bytearray(cut.dump.read_bytes())
    where = raw.rindex(np.float64(5.0).tobytes())
    raw[where : where + 8] = np.float64(6.0).tobytes()
    cut.dump.write_bytes(bytes(raw))
    again = resume(cut.path, check=False)
    assert again.outcome == "done"
    assert again.directory.job.resumed[-1].from_step == 0


@pytest.mark.parametrize("name", [file_names.DECK, file_names.DATA])
def test_a_deck_that_is_no_text_is_answered_in_a_line(name, cut, capsys):
    (cut.path / name).write_bytes(b"\xff\xfe junk")
    assert "--overwrite" in refusal(["run", "--resume", cut.path], capsys)
