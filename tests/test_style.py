"""Types and style of all that is here."""

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from executables import unavailable
from processes import HANGS

ROOT = Path(__file__).parents[1]

DOCUMENTED = (
    "workflow/python/granchain",
    "workflow/interface",
    "workflow/inputs.py",
    "workflow/runs/check.py",
    "workflow/runs/completed_run.py",
    "workflow/runs/run.py",
    "workflow/runs/run_directory.py",
    "workflow/plugins/design/result.py",
    "workflow/plugins/design/study.py",
    "workflow/plugins/fit/result.py",
    "workflow/plugins/fit/study.py",
    "workflow/plugins/gallery/study.py",
    "workflow/plugins/pages/function.py",
    "workflow/sweep/collect.py",
    "workflow/sweep/statistics.py",
    "workflow/verdicts/analyse.py",
    "workflow/verdicts/analysis_report.py",
    "workflow/verdicts/validate.py",
    "analysis/compare/difference.py",
    "analysis/statistics.py",
    "analysis/tracking/leading_waves.py",
    "analysis/trajectory.py",
    "lammps_inputs/materials.py",
    "lammps_inputs/scene.py",
)
"""Where the module `granchain` and what its functions return are defined."""


@pytest.mark.slow
@pytest.mark.timeout(HANGS)  # mypy takes 4 s, without its cache 45 s of a quiet core
@pytest.mark.parametrize("words", ["mypy", "ruff check .", "ruff format --check ."])
def test_nothing_is_found_by(words):
    program = words.partition(" ")[0]
    if find_spec(program) is None:
        unavailable(f"no {program}: pip install {program}")
    done = subprocess.run([sys.executable, "-m", *words.split()], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
def test_docstrings_that_users_see_have_the_sections_of_what_they_describe():
    words = ("-m", "pydoclint.main", "--config", "pyproject.toml", *DOCUMENTED)
    done = subprocess.run([sys.executable, *words], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
