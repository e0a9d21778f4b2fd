"""Studies that are interrupted: what they computed is kept, and they end as those that were not."""

import itertools
import json
import os
import signal
from pathlib import Path

import pytest
from declared_studies import declared_studies
from plug_ins import needs
from pool_here import answers
from processes import HANGS, children, started, wait_until
from sweeps import GRANCHAIN, SMALL

from lammps_inputs import plugins, strict_yaml
from workflow.cli import main
from workflow.runs.status import status
from workflow.workers.pool import Pool


@pytest.mark.slow
@needs("extremes")
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
@pytest.mark.parametrize("command", [pytest.param(name, marks=needs(name)) for name in SEARCHES])
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
    own = {name for name in plugins.declared("studies") if plugins.provider("studies", name) == ""}
    assert {study.command for study in declared_studies()} >= own
