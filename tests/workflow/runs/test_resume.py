"""Runs that are interrupted, killed or lose files, and go on: bit for bit as if nothing had happened."""

import contextlib
import json
import os
import random
import shutil
import signal

import lammps_here
import numpy as np
import pytest
from kill_many import AIMS, SCENES, command, end, frames, until_done
from plain_scene import goes_on_bit_for_bit
from processes import HANGS, started, wait_until, working_in
from stock_lammps import scene
from sweeps import GRANCHAIN

from analysis.files.binary_dump import BinaryDump
from lammps_inputs import InputError, file_names, strict_yaml
from workflow.cli import main
from workflow.engines.lammps import files_on_disk, mpi
from workflow.engines.registry import engine_names
from workflow.runs.resume import resume
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory, results

pytestmark = pytest.mark.usefixtures("lammps_here")

TWO = pytest.mark.skipif(mpi.cores() < 2, reason="needs two cores")


def a_scene(**changes):
    """Three chains, whose forces add up in an order that shows in the last bit."""
    return scene(**{"chains": 3, "beads": 12, "kappa": 0.05, "duration": 200.0, "every": 0.5, **changes})


@pytest.fixture(scope="module")
def whole(tmp_path_factory, request):
    """`a_scene` run without a break."""
    request.getfixturevalue("lammps_here")
    return run(a_scene(), tmp_path_factory.mktemp("resume") / "whole", check=False).directory.path


@pytest.fixture(scope="module")
def interrupted(tmp_path_factory, request):
    """`a_scene` interrupted; to be copied."""
    request.getfixturevalue("lammps_here")
    path = tmp_path_factory.mktemp("resume") / "cut"
    run(a_scene(), path, check=False, lammps=lammps_here.interrupted_after(5000))
    return path


@pytest.fixture
def cut(interrupted, tmp_path):
    """A copy of `a_scene` interrupted."""
    return RunDirectory(shutil.copytree(interrupted, tmp_path / "cut"))


def assert_same(directory, whole):
    np.testing.assert_array_equal(frames(directory), frames(whole))
    left, right = (RunDirectory(path).job.results.plain() for path in (directory, whole))
    assert left == right == results(RunDirectory(directory))


def test_the_error_is_measured_where_only_that_is_missing(tmp_path, capsys):
    run(a_scene(duration=4.0), tmp_path, check=False)
    assert main(["run", "--resume", str(tmp_path)]) == 0
    assert "largest errors against the reference integrator: velocities" in capsys.readouterr().out
    assert RunDirectory(tmp_path).job.check.velocity > 0.0


def test_a_run_killed_before_its_deck_was_written_is_resumed(tmp_path):
    run(a_scene(duration=4.0), tmp_path / "whole", check=False)
    shutil.copytree(tmp_path / "whole", tmp_path / "cut")
    for name in (file_names.DATA, file_names.DUMP):
        (tmp_path / "cut" / name).unlink()
    RunDirectory(tmp_path / "cut").update(outcome="running")
    resume(tmp_path / "cut", check=False)
    assert_same(tmp_path / "cut", tmp_path / "whole")


def test_an_interrupted_run_goes_on_bit_for_bit_from_where_it_was_and_is_checked(cut, whole, capsys):
    step, before = cut.job.steps_done, cut.job.wall_seconds
    assert files_on_disk.step_of(cut.path / file_names.RESTART) == step
    assert main(["run", "--resume", str(cut.path)]) == 0
    printed = capsys.readouterr().out
    assert f"on 1 rank, resumed from step {step}\n" in printed
    assert "largest errors against the reference integrator: velocities" in printed
    assert_same(cut.path, whole)
    assert not (cut.path / file_names.RESTART).exists()
    assert cut.job.wall_seconds > before  # of all parts
    assert cut.job.check.velocity > 0.0
    files = {path.name: path.read_bytes() for path in cut.path.iterdir()}
    assert main(["run", "--resume", str(cut.path)]) == 0
    assert capsys.readouterr().out == f"{cut.path}: the run is done already\n"
    assert {path.name: path.read_bytes() for path in cut.path.iterdir()} == files


def frame_size(directory):
    found = BinaryDump(directory.dump)
    return directory.dump.stat().st_size // found.n_frames


def beyond_the_restart(directory, whole):
    """Nine frames more, and one that is cut."""
    kept = directory.dump.stat().st_size + 9 * frame_size(directory)
    directory.dump.write_bytes((whole / file_names.DUMP).read_bytes()[: kept + 77])


def without_the_frame_of_the_restart(directory, _):
    os.truncate(directory.dump, directory.dump.stat().st_size - frame_size(directory))


def with_a_damaged_restart(directory, _):
    raw = bytearray((directory.path / file_names.RESTART).read_bytes())
    raw[len(raw) // 2] ^= 1
    (directory.path / file_names.RESTART).write_bytes(bytes(raw))


def with_the_restart_of_another_version(directory, _):
    """Another LAMMPS may not read it, or sum up in another order."""
    directory.update(versions={**directory.job.versions, "lammps": "2025.7.22.1"})


@pytest.mark.parametrize(
    ("lose", "starts_again"),
    [
        (beyond_the_restart, False),
        (without_the_frame_of_the_restart, True),
        *(
            pytest.param(lose, True, marks=pytest.mark.slow)
            for lose in (
                with_a_damaged_restart,
                with_the_restart_of_another_version,
            )
        ),
    ],
)
def test_without_a_whole_restart_and_all_frames_until_then_a_run_starts_again(lose, starts_again, cut, whole):
    step = cut.job.steps_done
    lose(cut, whole)
    resume(cut.path, check=False)
    assert [again.from_step for again in cut.job.resumed] == [0 if starts_again else step]
    assert_same(cut.path, whole)


@pytest.mark.slow
@pytest.mark.parametrize("changes", [{"scheme": "suzuki4"}, {"chains": 2, "beads": 200, "window": 64}])
def test_an_interrupted_run_of_another_kind_goes_on_bit_for_bit(changes, tmp_path):
    goes_on_bit_for_bit(a_scene(**changes), tmp_path, after=5000)


@pytest.mark.parametrize("engine", [name for name in engine_names() if name != "lammps"])
def test_other_engines_start_again(engine, tmp_path):
    one = a_scene(gap=1.0, duration=40.0)
    run(one, tmp_path / "whole", engine=engine, check=False)
    directory = RunDirectory(shutil.copytree(tmp_path / "whole", tmp_path / "cut"))
    os.truncate(directory.dump, 5000)
    directory.update(outcome="running")
    assert resume(directory.path, check=False).outcome == "done"
    assert directory.job.resumed[0].from_step == 0
    assert_same(directory.path, tmp_path / "whole")


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


LONG = a_scene(duration=1e5, every=1.0)
"""Three quarters of a minute in LAMMPS."""

FURTHER = (signal.SIGQUIT, signal.SIGTERM, signal.SIGHUP, signal.SIGINT)


@pytest.mark.parametrize(
    ("ranks", "before", "number"),
    [
        (1, (), signal.SIGTERM),  # goes to the command alone, as from a batch system
        pytest.param(2, (signal.SIGINT, *FURTHER * 5), signal.SIGINT, marks=[TWO, pytest.mark.slow]),
    ],
)
def test_ctrl_c_or_sigterm_ends_a_run_with_one_line_and_its_frames_and_further_signals_change_nothing(
    ranks, before, number, whole, tmp_path, capsys
):
    (tmp_path / "long.yaml").write_text(strict_yaml.dump(LONG.plain()))
    path = tmp_path / "run"
    with started([GRANCHAIN, "run", tmp_path / "long.yaml", "-o", path, "--ranks", ranks]) as process:
        assert wait_until(lambda: (path / file_names.DUMP).exists(), process)
        assert wait_until(lambda: (path / file_names.DUMP).stat().st_size > 10_000, process)
        for other in before:
            os.killpg(process.pid, other)
        (os.kill if number == signal.SIGTERM else os.killpg)(process.pid, number)
        out, err = process.communicate(timeout=HANGS)
    done = RunDirectory(path).job.steps_done
    assert (process.returncode, err, RunDirectory(path).job.outcome) == (130, "", "interrupted")
    assert out.splitlines()[-1] == (
        f"the run was interrupted at step {done} of 10000000; its frames remain; "
        f"`granchain run --resume {path}` resumes at step {done}"
    )
    assert wait_until(lambda: not working_in(path))
    kept = min(100, done // 100)
    np.testing.assert_array_equal(frames(path)[:kept], frames(whole)[: 2 * kept : 2])
    assert main(["analyze", str(path), "--no-figures"]) == 0
    assert f"incomplete: {done // 100 + 1} of 100001 frames" in capsys.readouterr().out
    assert json.loads((path / "analysis.json").read_text())["complete"] is False


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [(file_names.DECK, "overlap^1.5", "overlap^1.7"), (file_names.SCENE, "0.05", "0.06")],
)
def test_files_that_were_changed_are_not_gone_on_with(name, old, new, cut):
    (cut.path / name).write_text((cut.path / name).read_text().replace(old, new, 1))
    with pytest.raises(InputError, match=r"in\.chains, data\.chains are not those that the run was begun with"):
        resume(cut.path)


@pytest.mark.slow
def test_nobody_else_writes_where_a_run_is_under_way(tmp_path, monkeypatch):
    monkeypatch.setattr("workflow.runs.files._LOCK_SECONDS", 0.2)
    (tmp_path / "long.yaml").write_text(strict_yaml.dump(LONG.plain()))
    process = command(tmp_path / "long.yaml", "-o", tmp_path / "run")
    with contextlib.ExitStack() as stack:
        stack.callback(end, process, tmp_path / "run")
        assert wait_until((tmp_path / "run" / file_names.DUMP).exists, process)
        for attempt in (lambda: resume(tmp_path / "run"), lambda: run(LONG, tmp_path / "run", overwrite=True)):
            with pytest.raises(InputError, match="a run is under way in it"):
                attempt()
        assert RunDirectory(tmp_path / "run").job.outcome == "running"
