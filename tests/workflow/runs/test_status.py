"""Every state that a directory can be in has its name, and what to do next is said, without Slurm on this machine."""

import fcntl
import json
import os
import platform
import re
import struct
import time
from datetime import datetime
from importlib import metadata

import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_problems import problem
from stock_lammps import scene

from analysis.files.recording import Writer
from lammps_inputs import file_names, physics
from lammps_inputs.decks import continuation, deck
from workflow.cli import main
from workflow.engines.registry import engine_names
from workflow.plugins.jobs import job
from workflow.plugins.jobs.schedulers import slurm_jobs
from workflow.plugins.jobs.site import JobOptions
from workflow.runs.files import RECORD, write_json
from workflow.runs.status import MEANING, Queue, Queued, queue_of, status, statuses
from workflow.study_kit.directory import Study

CASE = scene(chains=2, beads=8, kappa=0.1, duration=10.0, every=0.1)
STEPS = CASE.problem().steps


def with_deck(directory, **changes):
    directory.mkdir(exist_ok=True)
    deck.write(CASE.model_copy(update=changes), directory)
    return directory


def with_frames(directory, last, name=file_names.DUMP):
    """Frames until one, as LAMMPS would have written them."""
    zero = physics.initial_velocity(CASE.problem().system) * 0.0
    with Writer(directory / name, problem()) as writer:
        for frame in range(last + 1):
            writer.append(frame * CASE.problem().steps_per_frame, zero, zero)
    return directory


def aged(directory, seconds=3600.0):
    """As it would be an hour later."""
    for path in directory.iterdir():
        os.utime(path, (time.time() - seconds,) * 2)
    return directory


def with_state(directory, state, *, reason="", ends=3600.0, number="7"):
    at, until = (datetime.fromtimestamp(time.time() + later).astimezone().isoformat() for later in (0.0, ends))
    (directory / file_names.JOB).write_text("")
    line = f"{state} job={number} cluster=alps host=n12 at={at} until={until} {reason}"
    (directory / file_names.JOB_STATE).write_text(f"{line:500}\n")
    return directory


def with_restart(directory, step):
    """The head and the end of a restart as LAMMPS writes it."""
    magic = b"LammpS RestartT\0"
    (directory / file_names.RESTART).write_bytes(magic + bytes(8) + struct.pack("<iq", 5, step) + bytes(600) + magic)
    return directory


def with_record(directory, **record):
    write_json(directory / RECORD, {"engine": "lammps", "steps": STEPS, "host": platform.node(), **record})
    return directory


def alps(*jobs):
    return Queue("alps", list(jobs))


# --- of other commands than run ---------------------------------------------------------------------------------------


def test_a_finished_study_is_told_to_be_done(tmp_path, capsys):
    with Study("trade", "trade.csv has the points").opened(tmp_path / "c"):
        pass
    assert main(["status", str(tmp_path / "c")]) == 0
    assert capsys.readouterr().out.startswith(f"{tmp_path / 'c'}: done: of `granchain trade`; trade.csv")


def test_a_study_has_a_state_of_its_own_beside_the_runs_in_it_and_waits_in_the_queue(tmp_path):
    study = tmp_path / "fitted"
    study.mkdir()
    (study / file_names.JOB).write_text("")
    (found,) = statuses([study], None)
    assert (found.state, found.why) == ("written", "`sbatch job.sbatch` there starts it")
    own = {"command": "fit", "result": "fit.json holds it", "resume": "the same command fits again"}
    write_json(study / RECORD, {"files": [RECORD], "study": {**own, "done": False}})
    with_record(with_deck(study / "lammps"), outcome="done")
    states = [(found.directory.name, found.state) for found in statuses([study], None)]
    assert states == [("fitted", "incomplete"), ("lammps", "done")]
    assert statuses([study], alps(Queued("9", True, study.resolve())))[0].state == "waiting"


# --- no run, or not yet -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("make", [lambda _: None, lambda path: path.mkdir(), lambda path: path.write_text("")])
def test_what_holds_no_run_is_called_none(make, tmp_path):
    make(tmp_path / "x")
    assert status(tmp_path / "x").state == "none"


def test_a_deck_that_was_not_run_is_written_and_it_is_said_how_to_start_it(tmp_path):
    found = status(with_deck(tmp_path / "x"))
    assert (found.state, found.why) == ("written", "`lmp -in in.chains` there starts it")
    for name, text in job.render_job(JobOptions(), CASE.problem()).items():
        (tmp_path / "x" / name).write_text(text)
    assert status(tmp_path / "x").why == "`sbatch job.sbatch` there starts it"


def test_a_run_killed_before_it_wrote_more_than_its_scene_is_incomplete(tmp_path):
    directory = with_deck(tmp_path / "x")
    (directory / file_names.DECK).unlink()
    assert status(directory).state == "incomplete"


# --- a deck run by hand -----------------------------------------------------------------------------------------------


def test_a_deck_whose_last_frame_is_there_is_done(tmp_path):
    assert status(aged(with_frames(with_deck(tmp_path / "x"), 100))).state == "done"


def test_a_deck_whose_frames_end_early_is_incomplete_and_how_far_is_told(tmp_path):
    found = status(aged(with_frames(with_deck(tmp_path / "x"), 30)))
    assert (found.state, found.step, found.steps) == ("incomplete", 300, STEPS)
    assert "starts it from the beginning" in found.why
    (tmp_path / "x" / file_names.RESTART).write_text("")
    assert "in.continue" in status(tmp_path / "x").why


def test_a_deck_whose_frames_are_new_runs_and_how_new_they_are_is_told(tmp_path):
    found = status(aged(with_frames(with_deck(tmp_path / "x"), 30), 60.0))
    assert found.state == "running"
    assert found.why.startswith("its last frame is 60 s old; if no lmp runs any more, `lmp -in in.chains` there")


def test_the_parts_of_a_continued_run_count_together(tmp_path):
    directory = with_frames(with_deck(tmp_path / "x"), 30)
    with_frames(directory, 60, continuation.dump_part(2))
    (directory / continuation.dump_part(3)).write_bytes(b"")
    assert status(aged(directory)).step == 600


def test_a_frame_that_is_cut_does_not_count(tmp_path):
    directory = with_frames(with_deck(tmp_path / "x"), 30)
    with (directory / file_names.DUMP).open("r+b") as file:
        file.truncate(file.seek(0, 2) - 1)
    assert status(aged(directory)).step == 290


# --- jobs -------------------------------------------------------------------------------------------------------------


def test_a_job_on_a_node_runs(tmp_path):
    directory = with_state(with_deck(tmp_path / "x"), "running")
    found = status(with_frames(directory, 30), alps(Queued("7", False, directory.resolve())))
    assert (found.state, found.step, found.why) == ("running", 300, "job 7")


@pytest.mark.parametrize(
    ("reported", "state"), [(None, "waiting"), ("running", "waiting"), ("failed", "waiting"), ("done", "done")]
)
def test_a_job_in_the_queue_waits_whatever_it_said_before_unless_it_is_done(reported, state, tmp_path):
    directory = with_deck(tmp_path / "x")
    if reported is not None:
        with_state(directory, reported)
    assert status(directory, alps(Queued("8", True, directory.resolve()))).state == state


@pytest.mark.parametrize("state", ["running", "waiting"])
def test_a_job_that_its_cluster_does_not_know_is_incomplete_and_goes_on_with_sbatch(state, tmp_path):
    found = status(with_state(with_deck(tmp_path / "x"), state), alps())
    assert found.state == "incomplete"
    again = "`sbatch job.sbatch` there starts again, as there is no restart"
    assert found.why == f"job 7 is gone: killed, or its node lost; {again}"


@pytest.mark.parametrize("state", ["running", "waiting"])
@pytest.mark.parametrize("queue", [None, Queue("elsewhere")], ids=["no Slurm", "another cluster's"])
def test_where_its_queue_cannot_be_asked_a_job_is_what_it_said_last(state, queue, tmp_path):
    found = status(with_state(with_deck(tmp_path / "x"), state), queue)
    assert found.state == state
    at = re.search(r" at=(\S+) ", (tmp_path / "x" / file_names.JOB_STATE).read_text())[1]
    assert found.why.endswith(f"as reported on {datetime.fromisoformat(at):%Y-%m-%d %H:%M} by n12")


def test_a_job_of_an_earlier_version_is_done_if_all_frames_are_there(tmp_path):
    directory = with_frames(with_deck(tmp_path / "x"), STEPS // 10)
    (directory / file_names.JOB_STATE).write_text(f"state done\nstep {STEPS}\nsteps {STEPS}\njob 7\n")
    assert status(directory, alps()).state == "done"
    with_frames(directory, STEPS // 20)
    assert status(directory, alps()).why == "job.state cannot be read; `sbatch job.sbatch` beside cases.txt tries again"


def test_a_job_past_its_time_limit_is_incomplete_even_where_its_queue_cannot_be_asked(tmp_path):
    assert status(with_state(with_deck(tmp_path / "y"), "running", ends=-60.0)).state == "running"  # it may still end
    found = status(with_state(with_deck(tmp_path / "x"), "running", ends=-3600.0))
    assert found.state == "incomplete"
    assert "past its time limit" in found.why


@pytest.mark.parametrize("state", ["failed", "incomplete"])
def test_why_a_job_ended_is_told_with_what_to_do(state, tmp_path):
    found = status(with_state(with_deck(tmp_path / "x"), state, reason="ERROR: Lost atoms"), alps())
    assert found.state == state
    assert found.why.startswith("ERROR: Lost atoms; `sbatch job.sbatch` there ")


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


def test_a_task_that_is_gone_goes_on_with_its_array(tmp_path):
    directory = with_state(with_deck(tmp_path / "x"), "running")
    (directory / file_names.JOB).unlink()
    assert status(directory, alps()).why.endswith(
        "`sbatch job.sbatch` beside cases.txt starts again, as there is no restart"
    )


@pytest.mark.parametrize(("name", "submission"), [("pbs", "qsub job.pbs"), ("sge", "qsub job.sge")])
def test_a_job_of_another_scheduler_is_submitted_by_its_command(name, submission, tmp_path):
    directory = with_deck(tmp_path / "a")
    array = job.render_array(JobOptions(scheduler=name), ["a"])
    files = {**job.case_files(CASE.problem()), **{f"../{file}": text for file, text in array.items()}}
    for file, text in files.items():
        (directory / file).write_text(text)
    assert status(directory).why == f"`{submission}` beside cases.txt starts it"
    (tmp_path / f"job.{name}").rename(directory / f"job.{name}")
    assert status(directory).why == f"`{submission}` there starts it"


def test_a_directory_of_runs_stands_for_them_all(tmp_path):
    (tmp_path / file_names.CASES).write_text("c\na\n")
    for name in "abc":
        with_deck(tmp_path / name)
    (tmp_path / "other").mkdir()
    assert [one.directory.name for one in statuses([tmp_path], None)] == ["c", "a", "b"]


# --- local runs -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("record", "state", "step", "why"),
    [
        ({"outcome": "done"}, "done", STEPS, ""),
        ({"outcome": "failed", "reason": "no \x1b[31mway"}, "failed", None, "no  [31mway"),
        ({"outcome": "interrupted", "steps_done": 300}, "incomplete", 300, "interrupted; `granchain run --resume "),
        *(
            ({"outcome": "interrupted", "engine": other}, "incomplete", None, "interrupted; `granchain run --resume ")
            for other in engine_names()[1:]
        ),
    ],
)
def test_a_local_run_that_ended_is_what_its_record_says(record, state, step, why, tmp_path):
    found = status(with_record(with_deck(tmp_path / "x"), **record))
    assert (found.state, found.step) == (state, step)
    assert found.why.startswith(why)


def test_it_is_said_from_which_step_a_run_goes_on(tmp_path):
    directory = with_restart(with_deck(tmp_path / "x"), 400)
    account = {"outcome": "interrupted", "steps_done": 430, "versions": {"lammps": metadata.version("lammps")}}
    assert status(with_record(directory, **account)).why.endswith(" resumes at step 400")
    older = {**account, "versions": {"lammps": "2020.1.1"}}
    assert " starts again, for the restart is of another version" in status(with_record(directory, **older)).why
    (directory / RECORD).unlink()
    assert status(with_state(directory, "incomplete"), alps()).why.endswith("there resumes at step 400")


@pytest.mark.parametrize("record", [{"outcome": "running"}, {"outcome": "interrupted", "steps_done": 200}, None])
def test_no_run_resumes_at_a_later_step_than_the_one_that_it_has_reached(record, tmp_path):
    """A restart may fall between two frames."""
    directory = with_restart(with_frames(with_deck(tmp_path / "x"), 20), 20 * CASE.problem().steps_per_frame + 7)
    if record is None:
        with_state(directory, "incomplete")
    else:
        with_record(directory, versions={"lammps": metadata.version("lammps")}, **record)
    found = status(directory)
    assert found.state == "incomplete"
    assert found.why.endswith(f"resumes at step {found.step}")


def test_a_local_run_under_way_holds_its_directory_and_a_killed_one_does_not(tmp_path):
    directory = with_record(with_deck(tmp_path / "x"), outcome="running")
    handle = os.open(directory, os.O_RDONLY)
    fcntl.flock(handle, fcntl.LOCK_EX)
    assert status(directory).state == "running"
    os.close(handle)
    found = status(directory)
    assert found.state == "incomplete"
    assert found.why.startswith("killed, or its disk was full; `granchain run --resume")


def test_a_run_on_another_machine_runs_while_it_writes(tmp_path):
    directory = with_frames(with_record(with_deck(tmp_path / "x"), outcome="running", host="elsewhere"), 20)
    assert status(directory).state == "running"
    assert status(aged(directory)).state == "incomplete"


def test_of_a_job_and_a_local_run_the_later_one_counts(tmp_path):
    directory = with_record(with_state(with_deck(tmp_path / "x"), "incomplete"), outcome="done", steps_done=STEPS)
    os.utime(directory / file_names.JOB_STATE, (1e9, 1e9))
    assert status(directory).state == "done"
    os.utime(directory / RECORD, (9e8, 9e8))
    assert status(directory, alps()).state == "incomplete"


# --- anything ---------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def any_directory(tmp_path_factory):
    """A deck with frames."""
    return with_frames(with_deck(tmp_path_factory.mktemp("x")), 3)


def assert_named(directory, file, content):
    """With other content of a file the state has a name, and a printable line says why."""
    path = directory / file
    before = path.read_bytes() if path.exists() else None
    path.write_bytes(content)
    try:
        for queue in (None, alps()):
            found = status(directory, queue)
            assert found.state in MEANING
            assert found.why.isprintable()
    finally:
        path.unlink()
        if before is not None:
            path.write_bytes(before)


@given(
    st.sampled_from(
        [RECORD, file_names.JOB_STATE, file_names.DECK, file_names.DUMP, file_names.SCENE, file_names.CASES]
    ),
    st.binary(max_size=300),
)
def test_whatever_stands_in_a_file_the_state_has_a_name_and_one_printable_line(any_directory, name, content):
    assert_named(any_directory, name, content)


@given(
    st.dictionaries(
        st.sampled_from(["outcome", "steps", "steps_done", "host", "engine", "reason"]),
        st.none() | st.integers() | st.floats() | st.text() | st.sampled_from(["running", "failed", "done"]),
    )
)
def test_whatever_a_record_says_the_state_has_a_name(any_directory, record):
    assert_named(any_directory, RECORD, json.dumps(record).encode())


def test_the_command_prints_a_line_each_and_their_counts(tmp_path, capsys):
    with_record(with_deck(tmp_path / "a"), outcome="done", steps_done=STEPS)
    with_record(with_deck(tmp_path / "b"), outcome="failed", reason="no way")
    assert main(["status", str(tmp_path / "a"), str(tmp_path / "b")]) == 1
    assert capsys.readouterr().out.splitlines() == [
        f"{tmp_path}/a: done, {STEPS} steps",
        f"{tmp_path}/b: failed: no way",
        "2 directories: 1 done, 1 failed",
    ]
    assert main(["status", str(tmp_path / "a")]) == 0
    capsys.readouterr()
    assert main(["status", str(tmp_path / "a"), str(tmp_path / "nowhere")]) == 2
    assert capsys.readouterr() == ("", f"granchain: {tmp_path}/nowhere: no such directory\n")


def test_the_command_prints_json(tmp_path, capsys):
    with_record(with_deck(tmp_path / "a"), outcome="done", steps_done=STEPS)
    assert main(["status", "--json", str(tmp_path / "a")]) == 0
    (found,) = json.loads(capsys.readouterr().out)
    assert (found["state"], found["step"]) == ("done", STEPS)
