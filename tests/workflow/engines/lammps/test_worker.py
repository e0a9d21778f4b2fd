"""Runs that fail: every way to fail ends in one line that says why, and no process is left; wrong states are found."""

import os
import re
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

LONG = scene(chains=2, beads=120, kappa=0.1, duration=1e5, every=1.0)


@pytest.mark.slow
def test_an_unstable_time_step_fails_in_the_first_segment_with_step_bound_and_remedy_in_units_of_the_scene(tmp_path):
    slow = scene(beads=20, kick=(Kick(velocity=1e-5),), timestep=20.0, every=20.0, duration=4e4)  # V**-0.2 = 10
    with pytest.raises(RunError, match=r"^by step 200, .* smaller timestep \(it is 20, unstable above 7\.98\)$"):
        run(slow, tmp_path / "run", force=True)
    record = RunDirectory(tmp_path / "run").job.plain()
    assert record["outcome"] == "failed"
    assert "take a smaller timestep" in record["reason"]


HALT = "variable one equal 1\nfix stop all halt 100 v_one > 0 error continue message no\nrun ${steps}"
TWO = pytest.mark.skipif(mpi.cores() < 2, reason="needs two cores")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "ranks", "says"),
    [
        ("run ${steps}", "quit 3", 1, "LAMMPS ended with exit code 3 after step 0."),
        ("run ${steps}", HALT, 1, "stopped at step 100 instead of 200"),
        ("run ${steps}", "run 0\ndelete_atoms group all compress no", 1, "Atom-IDs must exist"),
        pytest.param("gran", "grin", 2, "LAMMPS: ERROR: Unrecognized pair style 'grin/hertz/history'", marks=TWO),
        # one rank alone sees that a bead of the last row is out of reach of its spring
        pytest.param("1 vx ${kick1}", "24 y 1e30", 2, "LAMMPS: ERROR on proc 1: Bond atoms 48 24 missing", marks=TWO),
    ],
)
def test_a_deck_that_lammps_does_not_take_is_one_line_and_no_process_is_left(old, new, ranks, says, tmp_path):
    case = scene(chains=2, beads=24, kappa=0.1, duration=20.0)
    scene_files.write(case, tmp_path)
    text = (tmp_path / file_names.DECK).read_text()
    assert old in text
    (tmp_path / file_names.DECK).write_text(text.replace(old, new))
    with pytest.raises(RunError) as caught:
        engine.run_deck(tmp_path, problem=case.problem(), ranks=ranks)
    message = str(caught.value)
    assert says in message
    assert len(message.splitlines()) == 1
    assert wait_until(lambda: not working_in(tmp_path))


def killing(directory):
    """A progress function that kills the process of LAMMPS at the first report."""

    def progress(*_):
        for pid in working_in(directory):
            if Path(f"/proc/{pid}/cmdline").read_bytes().split(b"\0")[1:3] == [b"-P", b"-m"]:
                os.kill(pid, signal.SIGKILL)

    return progress


@pytest.mark.filterwarnings("ignore::analysis.files.binary_dump.CutDumpWarning")  # the last frame may be cut
def test_a_killed_run_is_recorded_as_failed_and_its_frames_are_kept(tmp_path):
    with pytest.raises(RunError):
        run(LONG, tmp_path, progress=killing(tmp_path))
    directory = RunDirectory(tmp_path)
    assert directory.job.outcome == "failed"
    assert directory.job.reason.startswith("LAMMPS was killed by signal SIGKILL after step ")
    assert directory.trajectory.time[-1] >= 2.0


# --- what LAMMPS does not notice is found in a state that has it ------------------------------------------------------


@pytest.fixture
def problem():
    return scene(chains=2, beads=4, kappa=0.1).problem()


def start(problem):
    """A state with the energy of the kick: nothing has moved yet."""
    return np.zeros((2, 4)), physics.initial_velocity(problem.system)


@pytest.mark.parametrize(
    ("which", "place", "value", "says"),
    [
        *((which, (1, 2), value, "no longer a finite number") for which in (0, 1) for value in (np.nan, np.inf)),
        (0, (1, 1), 4.5, "beads 2 and 3 of chain 2 have passed through each other"),  # the diameter is 4
        (0, (0, 0), 4.0, "beads 1 and 2 of chain 1 have passed through each other"),
        (0, (0, 2), 2.5, "beads 3 and 4 of chain 1 overlap by 2.5, more than half a diameter (2)"),
        (1, (0, 0), 0.97**0.5, "energy has changed by -3%"),
        (1, (0, 0), 1.03**0.5, "energy has changed by 3%"),
        (1, (0, 1), 9.0, "energy has changed by 8.1e+03%"),
    ],
)
def test_a_fault_of_a_state_is_told_in_one_line_with_remedy_and_bound(which, place, value, says, problem):
    state = start(problem)
    state[which][place] = value
    message = fault(problem, *state)
    assert says in message
    assert re.search(r"take a smaller timestep \(it is 0\.01, unstable above 0\.\d+\)$", message)
    assert len(message.splitlines()) == 1


def test_a_change_of_energy_by_one_per_cent_or_into_contacts_springs_and_gaps_is_no_fault(problem):
    x, v = start(problem)
    for factor in (0.99, 1.0, 1.01):
        assert fault(problem, x, v * np.sqrt(factor)) is None
    # all of it at rest: 2/5 r^2.5 in one contact and 0.05 r^2 in one spring make 1/2
    overlap = 1.0
    for _ in range(60):
        overlap = ((0.5 - 0.05 * overlap**2) / 0.4) ** 0.4
    pressed = np.array([[overlap] * 4, [*[overlap] * 3, 0.0]])  # between beads 3 and 4 of chain 2
    assert fault(problem, pressed, 0.0 * v) is None
    gapped = scene(chains=2, beads=4, kappa=0.1, gap=5.0).problem()
    x[0, 0] = 4.9
    assert fault(gapped, x, v) is not None  # the spring holds 1.2 of an energy of 0.5
    x[1, 0] = 4.9
    assert fault(gapped, x, v) is None
