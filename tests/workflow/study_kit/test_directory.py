"""The contract of all studies: cases are evaluated once and cached, and a directory is one study's own."""

import json

import pytest
from declared_studies import declared_studies

from lammps_inputs import InputError
from workflow.errors import RunError
from workflow.runs.status import status
from workflow.study_kit.directory import Study
from workflow.workers.computations import StoredResults, case, evaluate, values
from workflow.workers.pool import Pool, TaskResult

SPECIMEN = Study("specimen", "specimen.csv is the table", tables=("specimen.csv",))


def parsed(text, **options):
    """A case whose value is what a JSON text holds; it fails where the text is none."""
    return case("json:loads", {"s": text}, **options)


@pytest.mark.slow
def test_values_come_in_the_order_of_the_cases_and_those_in_the_cache_are_not_computed(tmp_path):
    path = tmp_path / "cases.jsonl"
    with StoredResults(path) as cache, Pool(1) as pool:
        assert values([parsed("1"), parsed("2", cost=9.0), parsed("1")], cache, pool=pool) == [1, 2, 1]
    lines = path.read_text().splitlines()
    assert [json.loads(line)["result"] for line in lines] == [2, 1]  # the largest first, and each once
    path.write_text(lines[0].replace('"result": 2', '"result": 5') + "\n" + lines[1][:-3])
    with StoredResults(path) as cache:
        assert values([parsed("2"), parsed("1")], cache) == [5, 1]
    assert len(path.read_text().splitlines()) == 2


def test_a_case_that_fails_is_an_answer_and_is_not_cached():
    cache, seen = StoredResults(None), []
    good, bad = parsed("1"), parsed("{")
    found = evaluate([good, bad], cache, progress=lambda *counts: seen.append(counts))
    assert found[good.key] == TaskResult(1)
    assert "JSONDecodeError" in found[bad.key].failed
    assert list(cache) == [good.key]
    assert (seen[0], seen[-1]) == ((0, 2, 0), (2, 2, 1))
    with pytest.raises(RunError, match="JSONDecodeError"):
        values([bad])


@pytest.mark.parametrize("study", [SPECIMEN, *declared_studies()], ids=lambda study: study.command)
def test_a_directory_is_one_studys_own_and_says_what_it_is_before_and_after_its_end(study, tmp_path, monkeypatch):
    monkeypatch.setattr("workflow.runs.files._LOCK_SECONDS", 0.0)
    path = tmp_path / "one"
    with pytest.raises(KeyboardInterrupt), study.opened(path):
        raise KeyboardInterrupt
    assert status(path).state == "incomplete"
    assert f"granchain {study.command}`; {study.resume}" in status(path).why
    with study.opened(path):
        assert status(path).state == "running"
        with pytest.raises(InputError, match="is under way"), study.opened(path):
            pass
    assert status(path).state == "done"
    assert f"granchain {study.command}`; {study.result}" in status(path).why
    mine = tmp_path / "foreign" / study.tables[0]
    mine.parent.mkdir()
    mine.write_text("mine")
    with pytest.raises(InputError, match=study.tables[0]), study.opened(mine.parent):
        pass
    assert mine.read_text() == "mine"
