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
import lammps_inputs
from workflow.engines.reference import engine
problem = lammps_inputs.find("one-chain").problem().coarser(400)
print(engine.run(problem).velocity[-1].max())
print(sum(engine.make_state(problem, None).program.advance.stats.cache_hits.values()))
"""


def run(tree, cache):
    """Largest velocity at the end of a run with the sources of a tree, and whether the kernel came from the disk."""
    own = {"PYTHONPATH": str(tree), "NUMBA_CACHE_DIR": str(cache)}
    words, environment = [sys.executable, "-c", PROGRAM], {**os.environ, **own}
    done = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=HANGS, cwd=tree, check=True)
    value, hits = done.stdout.split()
    return float(value), hits == "1"


@pytest.mark.slow
def test_processes_that_compile_at_once_agree_and_what_they_leave_is_not_that_of_a_changed_law(tmp_path):
    value = float(engine.run(find("one-chain").problem().coarser(400)).velocity[-1].max())
    cache, tree = tmp_path / "cache", tmp_path / "tree"
    with ThreadPoolExecutor(2) as pool:
        assert {found for found, _ in pool.map(lambda _: run(ROOT, cache), range(2))} == {value}
    assert run(ROOT, cache) == (value, True)
    place = next(path for path in (cache / "granchain").iterdir() if any(path.glob("*.py")))
    assert len([path for path in place.glob("*") if path.is_file()]) == 1
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


HELPER = "def twice(s):\n    return 2.0 * s\n"


def test_a_change_of_what_a_law_calls_changes_its_digest(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "law_of_mine.py").write_text("from helper_of_mine import twice\n\ndef force(s):\n    return twice(s)\n")
    (tmp_path / "helper_of_mine.py").write_text(HELPER)
    law = importlib.import_module("law_of_mine")
    before = compiled.digest([law.force])
    (tmp_path / "helper_of_mine.py").write_text(HELPER.replace("2.0", "3.0"))
    assert compiled.digest([law.force]) != before
