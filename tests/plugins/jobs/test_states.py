"""States of directories by what their jobs report, and queues of clusters, without a scheduler on this machine."""

import os
import re
import time
from datetime import datetime

import pytest
from hypothesis import given
from hypothesis import strategies as st
from run_states import CASE, STEPS, alps, with_deck, with_frames, with_record, with_restart

from lammps_inputs import file_names
from workflow.plugins.jobs import job_files
from workflow.plugins.jobs.schedulers import SLURM, slurm_jobs
from workflow.plugins.jobs.states import queue_of
from workflow.runs.files import RECORD
from workflow.runs.status import MEANING, Queue, Queued, status, statuses

AGAIN = "`sbatch job.sbatch` there starts again, as there is no restart"
LOST = "ERROR: Lost atoms"
GONE = "job 7 is gone: killed, or its node lost; " + AGAIN
REPORTED = r".*as reported on \d{4}-\d\d-\d\d \d\d:\d\d by n12"
HERE, ELSEWHERE = Queue("alps"), Queue("elsewhere")


def with_state(directory, state, *, reason="", ends=3600.0, number="7"):
    at, until = (datetime.fromtimestamp(time.time() + later).astimezone().isoformat() for later in (0.0, ends))
    (directory / SLURM.script).write_text("")
    line = f"{state} job={number} cluster=alps host=n12 at={at} until={until} {reason}"
    (directory / job_files.STATE).write_text(f"{line:500}\n")
    return directory


def listed(directory, number, waiting):
    return alps(Queued(number, waiting, directory.resolve()))


@pytest.mark.parametrize(
    ("reported", "queue", "state", "why"),
    [
        ({"state": "running"}, ("7", False), "running", "job 7"),
        (None, ("8", True), "waiting", "job 8"),
        ({"state": "running"}, ("8", True), "waiting", "job 8"),
        ({"state": "failed"}, ("8", True), "waiting", "job 8"),
        ({"state": "done"}, ("8", True), "done", ""),
        *(({"state": state}, HERE, "incomplete", re.escape(GONE)) for state in ("running", "waiting")),
        *(
            ({"state": state}, queue, state, REPORTED)
            for state in ("running", "waiting")
            for queue in (None, ELSEWHERE)
        ),
        *(
            ({"state": state, "reason": LOST}, HERE, state, f"{LOST}; `sbatch job.sbatch` there ")
            for state in ("failed", "incomplete")
        ),
        ({"state": "running", "ends": -60.0}, None, "running", ""),  # it may still end
        ({"state": "running", "ends": -3600.0}, None, "incomplete", ".*past its time limit"),
    ],
)
def test_the_state_of_a_job_is_what_its_queue_says_then_what_it_reported(reported, queue, state, why, tmp_path):
    directory = with_deck(tmp_path / "x")
    if reported is not None:
        with_state(directory, **reported)
    found = status(directory, listed(directory, *queue) if isinstance(queue, tuple) else queue)
    assert found.state == state
    assert re.match(why, found.why)


def test_a_task_of_an_array_works_in_its_line_of_the_list_of_cases(tmp_path):
    (tmp_path / file_names.CASES).write_text("a\nb\n")
    text = f"11|R|0|{tmp_path}\n12|PD|1|{tmp_path}\n13|PD|9|{tmp_path}\n14|CG|N/A|{tmp_path}/c\n"
    queue = queue_of("alps", slurm_jobs(text))
    assert [(one.number, one.waiting, one.directory.name) for one in queue.jobs] == [
        ("11", False, "a"),
        ("12", True, "b"),
        ("13", True, tmp_path.name),
        ("14", False, "c"),
    ]
    for name in ("a", "b"):
        with_deck(tmp_path / name)
    assert [one.state for one in statuses([tmp_path], queue)] == ["running", "waiting"]


def test_a_job_resumes_at_the_step_of_its_restart_or_that_of_its_last_frame_if_it_is_later(tmp_path):
    directory = with_restart(with_deck(tmp_path / "x"), 400)
    assert status(with_state(directory, "incomplete"), alps()).why.endswith("there resumes at step 400")
    with_restart(with_frames(directory, 20), 20 * CASE.problem().steps_per_frame + 7)
    found = status(directory)
    assert found.state == "incomplete"
    assert found.why.endswith(f"resumes at step {found.step}")


def test_of_a_job_and_a_local_run_the_later_one_counts(tmp_path):
    directory = with_record(with_state(with_deck(tmp_path / "x"), "incomplete"), outcome="done", steps_done=STEPS)
    os.utime(directory / job_files.STATE, (1e9, 1e9))
    assert status(directory).state == "done"
    os.utime(directory / RECORD, (9e8, 9e8))
    assert status(directory, alps()).state == "incomplete"


@given(st.binary(max_size=300))
def test_whatever_stands_in_a_report_the_state_has_a_name_and_one_printable_line(tmp_path_factory, content):
    directory = with_deck(tmp_path_factory.mktemp("x"))
    (directory / job_files.STATE).write_bytes(content)
    for queue in (None, alps()):
        found = status(directory, queue)
        assert found.state in MEANING
        assert found.why.isprintable()
