"""Runs that fail: every way to fail ends in one line that says why, and no process is left."""

import os
import signal

import pytest
from processes import wait_until, working_in
from stock_lammps import scene

from lammps_inputs import deck
from workflow.engines.lammps import engine, mpi
from workflow.errors import RunError
from workflow.run import run
from workflow.run_directory import RunDirectory

RANKS = [1, pytest.param(2, marks=pytest.mark.skipif(mpi.cores() < 2, reason="needs two cores"))]

SCENE = scene(chains=2, beads=24, kappa=0.1, duration=20.0)
LONG = scene(chains=2, beads=120, kappa=0.1, duration=1e5, every=1.0)


def failure(directory, problem, ranks=1, **options):
    """The one line that a run of the deck in a directory ends with."""
    with pytest.raises(RunError) as caught:
        engine.run(directory, problem, ranks=ranks, **options)
    message = str(caught.value)
    assert len(message.splitlines()) == 1
    assert "Traceback" not in message
    assert wait_until(lambda: not working_in(directory), 5.0)
    return message


def failure_of(old, new, directory, ranks=1):
    """The same for the deck with a change."""
    deck.write(SCENE, directory)
    path = directory / deck.DECK
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    return failure(directory, SCENE.problem(), ranks)


# --- time steps that are too long -------------------------------------------------------------------------------------


@pytest.mark.parametrize("step", [1.0, 3.0, 1e3, 1e100])
def test_an_unstable_time_step_fails_with_step_bound_and_remedy(step, tmp_path):
    unstable = scene(beads=20, timestep=step, every=step, duration=2000 * step)
    with pytest.raises(RunError, match=rf"^by step \d+, .*; take a smaller timestep \(it is {step:.3g}, .* 0\.786\)$"):
        run(unstable, tmp_path / "run")
    record = RunDirectory(tmp_path / "run").record
    assert record["outcome"] == "failed"
    assert "take a smaller timestep" in record["reason"]


def test_a_hopeless_run_ends_within_its_first_segment(tmp_path):
    with pytest.raises(RunError, match=r"^by step 200, "):
        run(scene(beads=20, timestep=1.0, every=1.0, duration=1e9), tmp_path / "run")


def test_the_remedy_is_in_the_units_of_the_scene(tmp_path):
    slow = scene(beads=20, kick=(scene().kick[0].model_copy(update={"velocity": 1e-5}),), timestep=10.0, every=10.0)
    with pytest.raises(RunError, match=r"\(it is 10, unstable above 7\.86\)$"):
        run(slow.model_copy(update={"duration": 1e4}), tmp_path / "run")


# --- decks that LAMMPS does not take ------------------------------------------------------------------------------------


@pytest.mark.parametrize("ranks", RANKS)
@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("pair_style gran", "pair_style grin", "Unrecognized pair style 'grin/hertz/history'"),
        ("read_data data", "read_data no", "Cannot open file no.chains"),
        ("setforce NULL 0 0", "setforce NULL 0", "Illegal fix setforce command"),
        ("${kick1}", "${kick9}", "Substitution for illegal variable kick9"),
    ],
)
def test_an_error_of_lammps_is_one_line_in_its_own_words(old, new, says, ranks, tmp_path):
    assert failure_of(old, new, tmp_path, ranks).startswith(f"LAMMPS: ERROR: {says}")


@pytest.mark.parametrize("ranks", RANKS)
def test_an_error_that_one_rank_alone_sees_is_told(ranks, tmp_path):
    # a bead of the last row is out of reach of its spring
    message = failure_of("set atom 1 vx ${kick1}", "set atom 24 y 1e30", tmp_path, ranks)
    assert message.startswith(f"LAMMPS: ERROR on proc {ranks - 1}: Bond atoms 48 24 missing")


@pytest.mark.parametrize("ranks", RANKS)
def test_a_missing_deck_is_told(ranks, tmp_path):
    deck.write(SCENE, tmp_path)
    (tmp_path / deck.DECK).unlink()
    assert f"Cannot open file {deck.DECK}" in failure(tmp_path, SCENE.problem(), ranks)


def test_a_missing_scene_is_told(tmp_path):
    deck.write(SCENE, tmp_path)
    (tmp_path / deck.SCENE).unlink()
    assert failure(tmp_path, SCENE.problem()) == f"LAMMPS: {deck.SCENE}: no such file"


def test_a_deck_that_leaves_the_interpreter_is_told_with_its_exit_code(tmp_path):
    assert failure_of("run ${steps}", "quit 3", tmp_path) == "LAMMPS ended with exit code 3 after step 0."


def test_a_deck_that_loses_beads_is_told(tmp_path):
    assert "Atom-IDs must exist" in failure_of("run ${steps}", "run 0\ndelete_atoms group all compress no", tmp_path)


def test_a_deck_that_stops_before_its_end_is_told(tmp_path):
    assert "stopped at step 100 instead of 200" in failure_of(
        "run ${steps}", "fix stop all halt 100 v_timestep > 0.0 error continue message no\nrun ${steps}", tmp_path
    )


# --- deaths -----------------------------------------------------------------------------------------------------------


def kill_worker(directory):
    """A progress function that ends a process of LAMMPS at the first report."""

    def progress(*_):
        workers = [pid for pid in working_in(directory) if b"worker" in _command(pid) and b"-n" not in _command(pid)]
        os.kill(workers[-1], signal.SIGKILL)

    return progress


def _command(pid):
    with open(f"/proc/{pid}/cmdline", "rb") as file:
        return file.read().split(b"\0")[1:4][-1]


def test_a_killed_process_is_told_with_its_signal_and_the_last_step(tmp_path):
    deck.write(LONG, tmp_path)
    message = failure(tmp_path, LONG.problem(), progress=kill_worker(tmp_path))
    assert message == "LAMMPS was killed by signal SIGKILL after step 200."


@pytest.mark.skipif(mpi.cores() < 2, reason="needs two cores")
def test_a_killed_rank_ends_the_others_and_is_told(tmp_path):
    deck.write(LONG, tmp_path)
    message = failure(tmp_path, LONG.problem(), ranks=2, progress=kill_worker(tmp_path))
    assert message == "LAMMPS ended with exit code 9 after step 200."


def test_a_killed_run_is_recorded_as_failed_and_its_frames_are_kept(tmp_path):
    with pytest.raises(RunError):
        run(LONG, tmp_path, progress=kill_worker(tmp_path))
    directory = RunDirectory(tmp_path)
    assert directory.record["outcome"] == "failed"
    assert directory.record["reason"] == "LAMMPS was killed by signal SIGKILL after step 200."
    assert directory.trajectory.time[-1] >= 2.0
