"""Runs that fail: every way to fail ends in one line that says why, and no process is left; wrong states are found."""

import os
import re
import resource
import signal
from pathlib import Path

import numpy as np
import pytest
from processes import wait_until, working_in
from stock_lammps import scene

from lammps_inputs import Kick, file_names, physics
from lammps_inputs.decks import scene_files
from workflow.engines.lammps import engine, mpi
from workflow.engines.lammps.worker import fault
from workflow.errors import RunError
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory

RANKS = [1, pytest.param(2, marks=pytest.mark.skipif(mpi.cores() < 2, reason="needs two cores"))]

SCENE = scene(chains=2, beads=24, kappa=0.1, duration=20.0)
LONG = scene(chains=2, beads=120, kappa=0.1, duration=1e5, every=1.0)


def failure(directory, ranks=1, case=SCENE, **options):
    """The one line that a run of the deck in a directory ends with."""
    with pytest.raises(RunError) as caught:
        engine.run_deck(directory, problem=case.problem(), ranks=ranks, **options)
    message = str(caught.value)
    assert len(message.splitlines()) == 1
    assert "Traceback" not in message
    assert wait_until(lambda: not working_in(directory))
    return message


def failure_of(old, new, directory, ranks=1):
    """The same for the deck with a change."""
    scene_files.write(SCENE, directory)
    path = directory / file_names.DECK
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    return failure(directory, ranks)


# --- time steps that are too long -------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("step", [1.2, 2.0])
def test_an_unstable_time_step_fails_in_the_first_segment_with_step_bound_and_remedy(step, tmp_path):
    unstable = scene(beads=20, timestep=step, every=step, duration=2000 * step)
    with pytest.raises(RunError, match=rf"^by step 200, .* smaller timestep \(it is {_text(step)}, .* 0\.798\)$"):
        run(unstable, tmp_path / "run", force=True)
    record = RunDirectory(tmp_path / "run").job.plain()
    assert record["outcome"] == "failed"
    assert "take a smaller timestep" in record["reason"]


def _text(step):
    return re.escape(f"{step:.3g}")


def test_the_remedy_is_in_the_units_of_the_scene(tmp_path):
    slow = scene(beads=20, kick=(Kick(velocity=1e-5),), timestep=20.0, every=20.0, duration=1e4)  # V**-0.2 = 10
    with pytest.raises(RunError, match=r"\(it is 20, unstable above 7\.98\)$"):
        run(slow, tmp_path / "run", force=True)


# --- decks that LAMMPS does not take ----------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("ranks", RANKS)
def test_an_error_of_lammps_is_one_line_in_its_own_words(ranks, tmp_path):
    message = failure_of("pair_style gran", "pair_style grin", tmp_path, ranks)
    assert message.startswith("LAMMPS: ERROR: Unrecognized pair style 'grin/hertz/history'")


@pytest.mark.slow
@pytest.mark.parametrize("ranks", RANKS)
def test_an_error_that_one_rank_alone_sees_is_told(ranks, tmp_path):
    # a bead of the last row is out of reach of its spring
    message = failure_of("set atom 1 vx ${kick1}", "set atom 24 y 1e30", tmp_path, ranks)
    assert message.startswith(f"LAMMPS: ERROR on proc {ranks - 1}: Bond atoms 48 24 missing")


@pytest.mark.slow
def test_a_missing_deck_is_told(tmp_path):
    scene_files.write(SCENE, tmp_path)
    (tmp_path / file_names.DECK).unlink()
    assert f"Cannot open input script {file_names.DECK}" in failure(tmp_path)


def test_a_deck_that_leaves_the_interpreter_is_told_with_its_exit_code(tmp_path):
    assert failure_of("run ${steps}", "quit 3", tmp_path) == "LAMMPS ended with exit code 3 after step 0."


def test_a_deck_that_loses_beads_is_told(tmp_path):
    assert "Atom-IDs must exist" in failure_of("run ${steps}", "run 0\ndelete_atoms group all compress no", tmp_path)


def test_a_deck_that_stops_before_its_end_is_told(tmp_path):
    assert "stopped at step 100 instead of 200" in failure_of(
        "run ${steps}",
        "variable one equal 1\nfix stop all halt 100 v_one > 0 error continue message no\nrun ${steps}",
        tmp_path,
    )


# --- deaths -----------------------------------------------------------------------------------------------------------


def to_workers(directory, act):
    """A progress function that does something to the processes of LAMMPS at the first report."""
    done = []

    def progress(*_):
        if not done:
            done.extend(pid for pid in working_in(directory) if _is_worker(pid))
            for pid in done:
                act(pid)

    return progress


def _is_worker(pid):
    return Path(f"/proc/{pid}/cmdline").read_bytes().split(b"\0")[1:3] == [b"-P", b"-m"]


def kill(pid):
    os.kill(pid, signal.SIGKILL)


def limit_files(pid):
    """Files of at most 100 kB, which LAMMPS meets like a full disk."""
    resource.prlimit(pid, resource.RLIMIT_FSIZE, (100_000, 100_000))


def test_a_killed_process_is_told_with_its_signal_and_the_last_step(tmp_path):
    scene_files.write(LONG, tmp_path)
    message = failure(tmp_path, case=LONG, progress=to_workers(tmp_path, kill))
    assert re.fullmatch(r"LAMMPS was killed by signal SIGKILL after step \d+\.", message)


@pytest.mark.slow
@pytest.mark.skipif(mpi.cores() < 2, reason="needs two cores")
@pytest.mark.parametrize("which", [min, max])
def test_a_killed_rank_ends_the_other_and_is_told(which, tmp_path):
    scene_files.write(LONG, tmp_path)
    ranks = []

    def kill_one(pid):
        ranks.append(pid)
        if len(ranks) == 2:
            kill(which(ranks))

    message = failure(tmp_path, ranks=2, case=LONG, progress=to_workers(tmp_path, kill_one))
    assert re.match(r"LAMMPS ended with exit code 9 after step \d+\.", message)


@pytest.mark.filterwarnings("ignore::analysis.files.binary_dump.CutDumpWarning")  # the last frame may be cut
def test_a_killed_run_is_recorded_as_failed_and_its_frames_are_kept(tmp_path):
    with pytest.raises(RunError):
        run(LONG, tmp_path, progress=to_workers(tmp_path, kill))
    directory = RunDirectory(tmp_path)
    assert directory.job.outcome == "failed"
    assert directory.job.reason.startswith("LAMMPS was killed by signal SIGKILL after step ")
    assert directory.trajectory.time[-1] >= 2.0


@pytest.mark.slow
def test_frames_that_cannot_be_written_fail_the_run(tmp_path):
    scene_files.write(LONG, tmp_path)
    message = failure(tmp_path, case=LONG, progress=to_workers(tmp_path, limit_files))
    assert message.startswith("LAMMPS: ERROR on proc 0: Error writing dump frames: File too large")


# --- what LAMMPS does not notice is found in a state that has it ------------------------------------------------------

REMEDY = r"take a smaller timestep \(it is 0\.01, unstable above 0\.\d+\)$"


@pytest.fixture
def problem():
    return scene(chains=2, beads=4, kappa=0.1).problem()


@pytest.fixture
def state(problem):
    """A state with the energy of the kick: nothing has moved yet."""
    return np.zeros((2, 4)), physics.initial_velocity(problem.system)


def test_the_start_has_no_fault(problem, state):
    assert fault(problem, *state) is None


@pytest.mark.parametrize("which", [0, 1])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_number_that_is_not_finite_is_found(which, value, problem, state):
    state[which][1, 2] = value
    assert "no longer a finite number" in fault(problem, *state)


def test_beads_that_passed_each_other_are_named(problem, state):
    state[0][1, 1] = 4.5  # the diameter is 4
    assert fault(problem, *state).startswith("beads 2 and 3 of chain 2 have passed through each other")


def test_beads_exactly_on_each_other_have_passed(problem, state):
    state[0][0, 0] = 4.0
    assert "passed" in fault(problem, *state)


def test_an_overlap_of_more_than_half_a_diameter_is_named(problem, state):
    state[0][0, 2] = 2.5
    assert fault(problem, *state).startswith("beads 3 and 4 of chain 1 overlap by 2.5, more than half a diameter (2)")


@pytest.mark.parametrize("factor", [0.97, 1.03])
def test_a_change_of_energy_by_three_per_cent_is_found(factor, problem, state):
    x, v = state
    assert f"energy has changed by {100 * (factor - 1):.3g}%" in fault(problem, x, v * np.sqrt(factor))


@pytest.mark.parametrize("factor", [0.99, 1.01])
def test_a_change_of_energy_by_one_per_cent_is_no_fault(factor, problem, state):
    x, v = state
    assert fault(problem, x, v * np.sqrt(factor)) is None


def test_energy_in_contacts_and_springs_counts(problem):
    # all of it at rest: 2/5 r^2.5 in one contact and 0.05 r^2 in one spring make 1/2
    overlap = 1.0
    for _ in range(60):
        overlap = ((0.5 - 0.05 * overlap**2) / 0.4) ** 0.4
    x = np.zeros((2, 4))
    x[0, 3] = overlap
    x[0, :3] = overlap
    x[1, :3] = (
        overlap  # so that chain 1 is whole, chain 2 is pressed between beads 3 and 4, and one spring is stretched
    )
    assert fault(problem, x, np.zeros((2, 4))) is None


@pytest.mark.parametrize("spoiled", [(0, np.nan), (0, 5.0), (0, 2.5), (1, 9.0)])
def test_every_fault_tells_the_remedy_and_the_bound(spoiled, problem, state):
    which, value = spoiled
    state[which][0, 1] = value
    message = fault(problem, *state)
    assert len(message.splitlines()) == 1
    assert re.search(REMEDY, message)


def test_the_gap_is_no_overlap(state):
    gapped = scene(chains=2, beads=4, kappa=0.1, gap=5.0).problem()
    state[0][0, 0] = 4.9
    assert fault(gapped, *state) is not None  # the spring holds 1.2 of an energy of 0.5
    state[0][1, 0] = 4.9
    assert fault(gapped, *state) is None
