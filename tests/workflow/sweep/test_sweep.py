"""Sweeps: nothing computed twice, nothing lost, nothing silently another scene."""

import json
import os
import signal
import subprocess
from pathlib import Path

import numpy as np
import pool_here
import pytest
from processes import HANGS, children, started, wait_until, working_in
from sweeps import GRANCHAIN, SMALL, UNTIL, sweep, sweep_file

from lammps_inputs import library
from workflow.cli import main
from workflow.engines.registry import engine_names
from workflow.runs.files import alone
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.sweep import file as sweep_files
from workflow.sweep.cases import CaseRequest, task
from workflow.sweep.run_sweep import begin
from workflow.workers.pool import Pool

pytestmark = pytest.mark.usefixtures("lammps_here")


@pytest.fixture
def here(monkeypatch):
    """Cases are computed in this process; as by `pool_here`, for one test."""
    monkeypatch.setattr(Pool, "answers", pool_here.answers)


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A finished sweep of two cases: its file and directory."""
    folder = tmp_path_factory.mktemp("sweep")
    path = sweep_file(folder, coupling__stiffness=[0.1, 0.2])
    assert sweep(path, folder / "s") == 0
    return path, folder / "s"


# --- running ----------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_swept_case_is_bit_for_bit_the_scene_run_alone(done, tmp_path):
    swept = RunDirectory(done[1] / "coupling.stiffness=0.2").trajectory
    alone = run(library.from_plain({**SMALL, "coupling": {"stiffness": 0.2}}, ""), tmp_path / "alone", check=False)
    np.testing.assert_array_equal(swept.velocity, alone.trajectory.velocity)
    np.testing.assert_array_equal(swept.displacement, alone.trajectory.displacement)


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("engine", [name for name in engine_names() if name != "lammps"])
def test_other_engines_sweep_too(engine, tmp_path):
    path = sweep_file(tmp_path, {**SMALL, "gap": 0.1}, engine=engine, beads=[12])
    assert sweep(path, tmp_path / "s") == 0
    assert RunDirectory(tmp_path / "s" / "beads=12").job.engine == engine


@pytest.mark.usefixtures("here")
def test_a_scene_that_ends_at_a_bead_sweeps_and_is_recognised_again(tmp_path, capsys):
    path = sweep_file(tmp_path, UNTIL, beads=[12])
    assert sweep(path, tmp_path / "s") == 0
    assert sweep(path, tmp_path / "s") == 0
    assert "1 of 1 cases done (1 of them before)" in capsys.readouterr().out


def test_the_directory_keeps_a_sweep_file_that_makes_its_cases(done):
    path, directory = done
    again, wanted = (sweep_files.load(each) for each in (directory / "sweep.yaml", path))
    assert sweep_files.all_cases(again) == sweep_files.all_cases(wanted)
    assert sweep(directory / "sweep.yaml", directory) == 0  # nothing runs again


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("of_users", ["scene: mine\n", ""])
def test_a_file_of_the_user_at_its_place_remains(of_users, tmp_path):
    path = sweep_file(tmp_path, engine="reference", beads=[12])
    assert sweep(path, tmp_path / "s") == 0
    (tmp_path / "s" / "sweep.yaml").write_text(of_users)
    assert sweep(path, tmp_path / "s") == 0
    assert (tmp_path / "s" / "sweep.yaml").read_text() == of_users


def stamps(directory):
    return {path: path.stat().st_mtime_ns for path in directory.rglob("*") if path.is_file()}


def test_a_finished_sweep_is_not_computed_again(done):
    path, directory = done
    before = stamps(directory)
    assert sweep(path, directory) == 0
    assert stamps(directory) == before


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


@pytest.mark.usefixtures("here")
def test_a_failed_case_beside_a_file_of_the_users_is_named_and_left_as_it_is(tmp_path, capsys):
    path = sweep_file(tmp_path, engine="reference", beads=[12])
    assert sweep(path, tmp_path / "s") == 0
    case = tmp_path / "s" / "beads=12"
    RunDirectory(case).update(outcome="failed")
    (case / "notes.txt").write_text("mine")
    frames = RunDirectory(case).dump.read_bytes()
    capsys.readouterr()
    assert sweep(path, tmp_path / "s") == 1
    assert f"beads=12: {case / 'notes.txt'}: is not listed in run.json" in capsys.readouterr().out
    assert (case / "notes.txt").read_text() == "mine"
    assert RunDirectory(case).dump.read_bytes() == frames
    (case / "notes.txt").unlink()
    assert sweep(path, tmp_path / "s") == 0


@pytest.mark.usefixtures("here")
def test_added_values_are_computed_and_cases_no_longer_named_stay(tmp_path, capsys):
    assert sweep(sweep_file(tmp_path, beads=[10, 11]), tmp_path / "s") == 0
    assert sweep(sweep_file(tmp_path, beads=[11, 12]), tmp_path / "s") == 0
    out = capsys.readouterr().out
    assert "2 of 2 cases done (1 of them before)" in out
    assert "1 more cases, with values that" in out
    assert {path.name for path in (tmp_path / "s").glob("*=*")} == {"beads=10", "beads=11", "beads=12"}


@pytest.mark.usefixtures("here")
def test_a_case_whose_scene_was_changed_by_hand_is_refused(tmp_path, capsys):
    path = sweep_file(tmp_path, beads=[12])
    case = tmp_path / "s" / "beads=12"
    assert sweep(path, tmp_path / "s") == 0
    scene = case / "scene.yaml"
    scene.write_text(scene.read_text().replace("stiffness: 0.1", "stiffness: 0.2"))
    assert sweep(path, tmp_path / "s") == 2
    assert f"{case}: holds this case of another scene (coupling differs)" in capsys.readouterr().err


def test_two_sweeps_do_not_share_a_directory(done, monkeypatch, capsys):
    path, directory = done
    monkeypatch.setattr("workflow.runs.files._LOCK_SECONDS", 0.0)
    with alone(directory):
        assert sweep(path, directory) == 2
    assert "a run is under way in it" in capsys.readouterr().err


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


@pytest.mark.usefixtures("here")
def test_a_pulse_that_does_not_arrive_is_its_cases_failure(tmp_path, capsys):
    path = sweep_file(tmp_path, UNTIL, kick__velocity=[1, -1])
    assert sweep(path, tmp_path / "s") == 1
    assert "kick.velocity=-1: until_bead: bead 8 is not passed" in capsys.readouterr().out
    assert RunDirectory(tmp_path / "s" / "kick.velocity=-1").job.outcome == "failed"


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


@pytest.mark.slow
def test_whoever_waits_for_a_sweep_is_told_once_what_is_compiled_for_it(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    path = sweep_file(tmp_path, engine="reference", beads=[8, 9])
    assert main(["sweep", str(path), "-o", str(tmp_path / "s"), "--jobs", "2"]) == 0
    said = capsys.readouterr().err.splitlines()
    assert said == ["compiling the reference; takes a few seconds, once for this kind of scene"]


# --- interruption -----------------------------------------------------------------------------------------------------


@pytest.fixture
def slow(tmp_path):
    """A sweep of four short cases and a long one, as a command in a session of its own, with two cases done."""
    path = sweep_file(tmp_path, {**SMALL, "timestep": 0.01}, duration=[10, 20, 30, 40, 4000])
    words = ["sweep", str(path), "-o", str(tmp_path / "s"), "--no-check"]
    with started([GRANCHAIN, *words]) as process:
        assert wait_until(lambda: finished(tmp_path / "s") >= 2, process)
        yield process, words, tmp_path / "s"


def finished(directory):
    return len(list(directory.glob("*/analysis.json")))


def outcomes(directory):
    records = [json.loads(path.read_text())["outcome"] for path in directory.glob("*/run.json")]
    return {outcome: records.count(outcome) for outcome in records}


def at_work(directory):
    """Processes that work below a directory."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            found += (
                [(process / "cmdline").read_text()] if (process / "cwd").readlink().is_relative_to(directory) else []
            )
        except OSError:
            continue
    return found


@pytest.mark.slow
@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGKILL], ids=lambda end: end.name)
def test_a_sweep_that_was_ended_leaves_no_process_and_keeps_what_is_done_and_the_same_command_does_the_rest(
    slow, end, capsys
):
    process, words, directory = slow
    os.kill(process.pid, end)
    out, err = process.communicate(timeout=HANGS)
    assert wait_until(lambda: at_work(directory) == [])
    kept = finished(directory)
    assert 2 <= kept < 5
    if end == signal.SIGINT:
        assert (process.returncode, err) == (130, "")
        assert "the sweep was interrupted; completed cases remain, and the same command runs the rest" in out
        assert f"{kept} of 5 cases done" in out
        assert outcomes(directory)["done"] >= kept
        assert outcomes(directory).get("running", 0) == 0
    assert main(words) == 0
    assert f"5 of 5 cases done ({kept} of them before)" in capsys.readouterr().out
    assert outcomes(directory) == {"done": 5}
    reports = [json.loads(path.read_text()) for path in directory.glob("*/analysis.json")]
    assert [report["complete"] for report in reports] == [True] * 5


@pytest.mark.slow
def test_an_interrupted_case_goes_on_from_its_restart_and_ends_as_if_it_had_not_been(tmp_path):
    scene = {**SMALL, "duration": 3000, "timestep": 0.01, "output": {"every": 1.0}}
    path, case = sweep_file(tmp_path, scene, beads=[12]), tmp_path / "s" / "beads=12"
    command = [GRANCHAIN, "sweep", path, "-o", tmp_path / "s", "--no-check"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True) as process:
        dump = case / "chains.dump.bin"
        assert wait_until(lambda: dump.exists() and dump.stat().st_size > 10_000, process)
        os.killpg(process.pid, signal.SIGINT)
    assert RunDirectory(case).job.outcome == "interrupted"
    assert sweep(path, tmp_path / "s") == 0
    assert RunDirectory(case).job.resumed[0].from_step > 0
    whole = run(library.from_plain(scene, ""), tmp_path / "whole", check=False).trajectory
    np.testing.assert_array_equal(RunDirectory(case).trajectory.velocity, whole.velocity)


def test_a_case_directory_is_a_run_directory_from_its_first_moment(tmp_path):
    scene = library.from_plain(SMALL, "")
    begin(tmp_path / "case", CaseRequest({}, SMALL, "lammps"), scene)
    assert RunDirectory(tmp_path / "case").scene == scene.resolved()
