"""The contract of all studies: cases are evaluated once and cached, and a directory is one study's own."""

import importlib
import itertools
import json
import os
import signal
from pathlib import Path

import pytest
from pool_here import answers
from processes import HANGS, children, started, wait_until
from sweeps import GRANCHAIN, SMALL

from lammps_inputs import InputError, strict_yaml
from workflow import studies
from workflow.cli import main
from workflow.errors import RunError
from workflow.runs.status import status
from workflow.study_kit.directory import Study
from workflow.workers.evaluate import StoredResults, case, evaluate, values
from workflow.workers.pool import Pool, TaskResult


def declared():
    """Every study that declares a directory, in whatever module of `workflow.studies`."""
    found = {}
    for path in sorted(Path(studies.__file__).parent.glob("*/study.py")):
        module = importlib.import_module(f"workflow.studies.{path.parent.name}.study")
        named = [getattr(one, "study", one) for one in vars(module).values()]
        found |= {one.command: one for one in named if isinstance(one, Study)}
    return list(found.values())


STUDIES = pytest.mark.parametrize("study", declared(), ids=lambda study: study.command)


def parsed(text, **options):
    """A case whose value is what a JSON text holds; it fails where the text is none."""
    return case("json:loads", {"s": text}, **options)


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


def test_cases_that_use_all_cores_come_last():
    seen = []
    cases = [parsed("1", cost=3.0)._replace(alone=True), parsed("2"), parsed("3", cost=2.0)]
    evaluate(cases, tell=lambda _, answer: seen.append(answer.value))
    assert (set(seen[:2]), seen[2]) == ({2, 3}, 1)


@STUDIES
def test_status_says_what_a_directory_is_before_and_after_its_end(study, tmp_path):
    with pytest.raises(KeyboardInterrupt), study.opened(tmp_path / "one"):
        raise KeyboardInterrupt
    cut = status(tmp_path / "one")
    assert cut.state == "incomplete"
    assert f"granchain {study.command}`; {study.resume}" in cut.why
    with study.opened(tmp_path / "one"):
        assert status(tmp_path / "one").state == "running"
    assert status(tmp_path / "one").state == "done"
    assert f"granchain {study.command}`; {study.result}" in status(tmp_path / "one").why


@STUDIES
def test_a_directory_in_use_or_with_a_file_of_somebody_elses_is_refused(study, tmp_path, monkeypatch):
    monkeypatch.setattr("workflow.runs.files._LOCK_SECONDS", 0.0)
    with (
        study.opened(tmp_path / "busy"),
        pytest.raises(InputError, match="is under way"),
        study.opened(tmp_path / "busy"),
    ):
        pass
    (tmp_path / "foreign").mkdir()
    mine = tmp_path / "foreign" / study.tables[0]
    mine.write_text("mine")
    with pytest.raises(InputError, match=study.tables[0]), study.opened(tmp_path / "foreign"):
        pass
    assert mine.read_text() == "mine"
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"), study.opened(tmp_path / "file" / "x"):
        pass


@pytest.mark.slow
def test_ctrl_c_keeps_what_was_computed_and_leaves_neither_processes_nor_files_on_the_way(tmp_path):
    work, out = tmp_path / "tmp", tmp_path / "out"
    work.mkdir()

    def kept():
        return [line for path in out.glob("*.jsonl") for line in path.read_text().splitlines()]

    command = [GRANCHAIN, "extremes", "masses", "-o", out]
    with started(command, env={**os.environ, "TMPDIR": str(work)}) as process:
        assert wait_until(lambda: kept() and any(work.rglob("chains.dump.bin")), process)
        own, before = children(process.pid), len(kept())
        os.killpg(process.pid, signal.SIGINT)
        _, complaints = process.communicate(timeout=HANGS)
    assert process.returncode == 130
    assert own
    # what runs in a callback of LLVM's when it is interrupted says so, and goes on to its end
    assert "Error" not in complaints
    assert wait_until(lambda: not any(Path(f"/proc/{child}").exists() for child in own))
    assert list(work.iterdir()) == []
    assert len(kept()) >= before
    assert all(json.loads(line)["result"] for line in kept())
    assert status(out).state == "incomplete"


SEARCHES = {
    "threshold": ["--where", "mass=12.5", "--vary", "kinds.a.mass=0.5:3", "--points", "3"],
}


@pytest.mark.usefixtures("pool_here")
@pytest.mark.parametrize("command", SEARCHES)
def test_a_study_that_was_interrupted_keeps_what_it_computed_and_ends_as_one_that_was_not(
    command, tmp_path, monkeypatch, capsys
):
    def interrupted(pool, tasks):
        yield from itertools.islice(answers(pool, tasks), 2)
        raise KeyboardInterrupt

    monkeypatch.setattr("workflow.study_kit.directory.write_figure", lambda *_: None)
    scene = {**SMALL, "kinds": {"a": {"mass": 1.0}}, "pattern": ["a"]}
    (tmp_path / "s.yaml").write_text(strict_yaml.dump(scene))
    words = [command, str(tmp_path / "s.yaml"), *SEARCHES[command], "-o"]
    with monkeypatch.context() as patch:
        patch.setattr(Pool, "answers", interrupted)
        assert main([*words, str(tmp_path / "cut")]) == 130
    assert "the same command resumes" in capsys.readouterr().out
    cache = tmp_path / "cut" / "evaluations.jsonl"
    kept = cache.read_text()
    assert len(kept.splitlines()) == 2
    assert main([*words, str(tmp_path / "cut")]) == main([*words, str(tmp_path / "whole")]) == 0
    assert cache.read_text().startswith(kept)
    tables = [path.name for path in (tmp_path / "whole").glob("*.csv")]
    assert len(tables) == 2
    assert all((tmp_path / "cut" / name).read_text() == (tmp_path / "whole" / name).read_text() for name in tables)


def test_the_studies_that_are_known_are_found():
    assert {study.command for study in declared()} >= {"extremes", "gallery", "threshold"}
