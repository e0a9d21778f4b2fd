"""Sweeps: nothing computed twice, nothing lost, nothing silently another scene."""

import contextlib
import json
import os
import signal
from pathlib import Path

import numpy as np
import pool_here
import pytest
from processes import HANGS, children, started, wait_until, working_in
from sweeps import GRANCHAIN, SMALL, sweep, sweep_file

from lammps_inputs import library
from workflow.cli import main
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.sweep.cases import CaseRequest, task
from workflow.workers.pool import Pool

pytestmark = pytest.mark.usefixtures("lammps_here")


@pytest.fixture
def here(monkeypatch):
    """Cases are computed in this process; as by `pool_here`, for one test."""
    monkeypatch.setattr(Pool, "answers", pool_here.answers)


@pytest.mark.slow
@pytest.mark.usefixtures("here")
def test_a_swept_case_is_bit_for_bit_the_scene_run_alone(tmp_path):
    assert sweep(sweep_file(tmp_path, coupling__stiffness=[0.2]), tmp_path / "s") == 0
    swept = RunDirectory(tmp_path / "s" / "coupling.stiffness=0.2").trajectory
    alone = run(library.from_plain({**SMALL, "coupling": {"stiffness": 0.2}}, ""), tmp_path / "alone", check=False)
    np.testing.assert_array_equal(swept.velocity, alone.trajectory.velocity)
    np.testing.assert_array_equal(swept.displacement, alone.trajectory.displacement)


def stamps(directory):
    return {path: path.stat().st_mtime_ns for path in directory.rglob("*") if path.is_file()}


@pytest.mark.slow
@pytest.mark.usefixtures("here")
def test_what_is_missing_failed_or_cut_short_is_computed_again_and_nothing_else(tmp_path):
    path = sweep_file(tmp_path, coupling__stiffness=[0.1, 0.2, 0.3, 0.4, 0.5])
    assert sweep(path, tmp_path / "s") == 0
    kept, unanalysed, failed, killed, gone = sorted((tmp_path / "s").glob("*=*"))
    (unanalysed / "analysis.json").unlink()
    RunDirectory(failed).update(outcome="failed")
    RunDirectory(killed).update(outcome="running")
    for file in gone.iterdir():
        file.unlink()  # killed before anything was written
    before = stamps(tmp_path / "s")
    assert sweep(path, tmp_path / "s") == 0
    changed = {path.parent for path, stamp in stamps(tmp_path / "s").items() if before.get(path) != stamp}
    assert changed == {unanalysed, failed, killed, gone}
    assert before[unanalysed / "run.json"] == (unanalysed / "run.json").stat().st_mtime_ns
    assert before[kept / "run.json"] == (kept / "run.json").stat().st_mtime_ns


# --- failures ---------------------------------------------------------------------------------------------------------


@pytest.mark.usefixtures("here")
def test_a_failing_case_among_good_ones_is_told_in_one_line_and_tried_again(tmp_path, capsys):
    scene = {**SMALL, "duration": 200, "output": {"every": 1.4}}
    path = sweep_file(tmp_path, scene, timestep=[0.01, 0.1, 0.7])
    for before in ("", " (2 of them before)"):
        assert sweep(path, tmp_path / "s") == 1
        out, err = capsys.readouterr()
        assert err == ""
        told, count, _ = out.splitlines()
        assert told.startswith("timestep=0.7: by step 200, the energy has changed by ")
        assert count == f"{tmp_path / 's'}: 2 of 3 cases done{before}, 1 failed"
    found = {path.name: RunDirectory(path).job.outcome for path in (tmp_path / "s").glob("*=*")}
    assert found == {"timestep=0.01": "done", "timestep=0.1": "done", "timestep=0.7": "failed"}


def case(directory, **changes):
    return task(directory, CaseRequest({}, {**SMALL, "timestep": 0.01, **changes}, "lammps"), check=False)


@pytest.mark.slow
def test_a_process_that_dies_is_one_failed_case_and_the_others_go_on(tmp_path):
    tasks = [(name, case(tmp_path / name, duration=3e5 if name == "long" else 10)) for name in ("long", "a", "b", "c")]
    found, before = {}, children(os.getpid())
    with Pool(2) as pool:
        for name, answer in pool.answers(tasks):
            found[name] = answer
            if name == "b":  # the other process is in the long case, or comes to it
                assert wait_until(lambda: working_in(tmp_path / "long"))
                (victim,) = working_in(tmp_path / "long")
                os.kill(victim, signal.SIGABRT)
    assert {name: answer.value for name, answer in found.items()} == {
        "long": None,
        "a": "done",
        "b": "done",
        "c": "done",
    }
    assert "was killed by signal SIGABRT" in found["long"].failed
    assert children(os.getpid()) == before


def at_work(directory):
    """Processes that work below a directory."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            found += [process] * (process / "cwd").readlink().is_relative_to(directory)
    return found


@pytest.mark.slow
@pytest.mark.usefixtures("here")
def test_an_interrupted_sweep_leaves_no_process_and_keeps_what_is_done_and_the_same_command_does_the_rest(
    tmp_path, capsys
):
    path, directory = sweep_file(tmp_path, {**SMALL, "timestep": 0.01}, duration=[10, 20, 30, 40, 4000]), tmp_path / "s"
    words = ["sweep", str(path), "-o", str(directory), "--no-check"]
    with started([GRANCHAIN, *words]) as process:
        assert wait_until(lambda: len(list(directory.glob("*/analysis.json"))) >= 2, process)
        os.kill(process.pid, signal.SIGINT)
        out, err = process.communicate(timeout=HANGS)
    assert wait_until(lambda: at_work(directory) == [])
    kept = len(list(directory.glob("*/analysis.json")))
    assert (process.returncode, err) == (130, "")
    assert "the sweep was interrupted; completed cases remain, and the same command runs the rest" in out
    assert f"{kept} of 5 cases done" in out
    assert main(words) == 0
    assert f"5 of 5 cases done ({kept} of them before)" in capsys.readouterr().out
    assert {RunDirectory(case).job.outcome for case in directory.glob("*=*")} == {"done"}
    assert all(json.loads(report.read_text())["complete"] for report in directory.glob("*/analysis.json"))
