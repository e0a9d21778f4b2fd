"""Files are written whole or not at all."""

import json
import os

import pytest

from workflow.errors import EndedError
from workflow.runs.files import write_json, write_text


def test_whoever_reads_a_file_while_it_is_replaced_reads_all_of_the_one_before(tmp_path):
    path = tmp_path / "run.json"
    write_text(path, "before " * 1000)
    with path.open("rb", buffering=0) as reader:
        assert reader.read(7) == b"before "
        write_text(path, "after")
        assert reader.read() == b"before " * 999
    assert path.read_text() == "after"
    assert list(tmp_path.iterdir()) == [path]


def test_what_was_there_stays_where_the_new_cannot_be_written(tmp_path, monkeypatch):
    path = tmp_path / "run.json"
    write_text(path, "before")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fdopen", full)
    with pytest.raises(EndedError, match="what was there is left as it was"):
        write_text(path, "after")
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


def test_numbers_come_back_from_json_and_what_is_none_is_null(tmp_path):
    write_json(tmp_path / "a.json", {"a": 0.1 + 0.2, "b": [float("nan"), (float("inf"), 1)]})
    assert json.loads((tmp_path / "a.json").read_text()) == {"a": 0.1 + 0.2, "b": [None, [None, 1]]}
