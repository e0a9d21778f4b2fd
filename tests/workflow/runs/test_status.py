"""What a directory is, from its files alone; the golden text of `status` has every state."""

import fcntl
import json
import os
from importlib import metadata

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from run_states import CASE, aged, alps, with_deck, with_frames, with_record, with_restart

from lammps_inputs import file_names
from lammps_inputs.decks import continuation
from workflow.runs.files import RECORD, write_json
from workflow.runs.status import MEANING, Queued, status, statuses


def test_a_study_has_a_state_of_its_own_beside_the_runs_in_it_and_waits_in_the_queue(tmp_path):
    study = tmp_path / "fitted"
    study.mkdir()
    own = {"command": "fit", "result": "fit.json holds it", "resume": "the same command fits again"}
    write_json(study / RECORD, {"files": [RECORD], "study": {**own, "done": False}})
    with_record(with_deck(study / "lammps"), outcome="done")
    states = [(found.directory.name, found.state) for found in statuses([study], None)]
    assert states == [("fitted", "incomplete"), ("lammps", "done")]
    assert statuses([study], alps(Queued("9", True, study.resolve())))[0].state == "waiting"


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


@pytest.mark.parametrize("record", [{"outcome": "running"}, {"outcome": "interrupted", "steps_done": 200}])
def test_no_run_resumes_at_a_later_step_than_the_one_that_it_has_reached(record, tmp_path):
    """A restart may fall between two frames."""
    directory = with_restart(with_frames(with_deck(tmp_path / "x"), 20), 20 * CASE.problem().steps_per_frame + 7)
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


@pytest.fixture(scope="module")
def any_directory(tmp_path_factory):
    """A deck with frames."""
    return with_frames(with_deck(tmp_path_factory.mktemp("x")), 3)


KEYS = ["outcome", "steps", "steps_done", "host", "engine", "reason"]
RECORDS = st.dictionaries(
    st.sampled_from(KEYS),
    st.none() | st.integers() | st.floats() | st.text() | st.sampled_from(["running", "failed", "done"]),
)
FILES = [RECORD, file_names.DECK, file_names.DUMP, file_names.SCENE, file_names.CASES]


@settings(max_examples=25)
@given(
    st.tuples(st.sampled_from(FILES), st.binary(max_size=300))
    | st.tuples(st.just(RECORD), RECORDS.map(lambda record: json.dumps(record).encode()))
)
def test_whatever_stands_in_a_file_the_state_has_a_name_and_one_printable_line(any_directory, file):
    name, content = file
    path = any_directory / name
    before = path.read_bytes() if path.exists() else None
    path.write_bytes(content)
    try:
        for queue in (None, alps()):
            found = status(any_directory, queue)
            assert found.state in MEANING
            assert found.why.isprintable()
    finally:
        path.unlink()
        if before is not None:
            path.write_bytes(before)
