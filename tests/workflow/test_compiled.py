"""Machine code is kept between processes, and never that of other sources."""

import importlib
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from processes import HANGS

from lammps_inputs import find
from workflow import compiled
from workflow.engines.reference import engine

ROOT = Path(__file__).parents[2]
FLOORS = ("lammps_inputs", "analysis", "workflow")

PROGRAM = """
import os, tempfile
import lammps_inputs
tempfile.tempdir = os.environ.get("TEMPORARY")
from workflow.engines.reference import engine
problem = lammps_inputs.find("one-chain").problem().coarser(400)
print(engine.run(problem).velocity[-1].max())
print(sum(engine.make_state(problem, None).program.advance.stats.cache_hits.values()))
"""


def run(tree, cache, **environment):
    """Largest velocity at the end of a run with the sources of a tree, and whether the kernel came from the disk."""
    own = {"PYTHONPATH": str(tree), "NUMBA_CACHE_DIR": str(cache), **environment}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        env={**os.environ, **own},
        capture_output=True,
        text=True,
        timeout=HANGS,
        cwd=tree,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    value, hits = done.stdout.split()
    return float(value), hits == "1"


@pytest.fixture(scope="module")
def value():
    """Largest velocity at the end of the same run in this process."""
    return float(engine.run(find("one-chain").problem().coarser(400)).velocity[-1].max())


@pytest.fixture(scope="module")
def at_once(tmp_path_factory):
    """A cache that two processes have filled at once, and what they found."""
    cache = tmp_path_factory.mktemp("compiled") / "cache"
    with ThreadPoolExecutor(2) as pool:
        return cache, {found for found, _ in pool.map(lambda _: run(ROOT, cache), range(2))}


@pytest.mark.slow
def test_a_changed_law_is_computed_with_though_the_old_one_is_on_the_disk(at_once, value, tmp_path):
    tree, (cache, _) = tmp_path / "tree", at_once
    for floor in FLOORS:
        shutil.copytree(ROOT / floor, tree / floor, ignore=shutil.ignore_patterns("__pycache__"))
    law = tree / "lammps_inputs/laws/contact.py"
    text = law.read_text()
    hertz = "return strength * (closed * np.sqrt(closed))\n"
    assert text.count(hertz) == 1
    law.write_text(text.replace(hertz, "return 2.0 * strength * (closed * closed)\n"))
    other, hit = run(tree, cache)
    assert not hit
    assert other != value


@pytest.mark.slow
def test_processes_that_compile_at_once_agree_and_leave_whole_files(at_once, value):
    cache, values = at_once
    assert values == {value}
    assert run(ROOT, cache) == (value, True)
    place = next(path for path in (cache / "granchain").iterdir() if any(path.glob("*.py")))
    assert len([path for path in place.glob("*") if path.is_file()]) == 1


HELPER = "def twice(s):\n    return 2.0 * s\n"


def test_a_change_of_what_a_law_calls_changes_its_digest(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "law_of_mine.py").write_text("from helper_of_mine import twice\n\ndef force(s):\n    return twice(s)\n")
    (tmp_path / "helper_of_mine.py").write_text(HELPER)
    law = importlib.import_module("law_of_mine")
    before = compiled.digest([law.force])
    (tmp_path / "helper_of_mine.py").write_text(HELPER.replace("2.0", "3.0"))
    assert compiled.digest([law.force]) != before
