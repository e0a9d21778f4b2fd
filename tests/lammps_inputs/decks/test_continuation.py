"""Continued decks with stock LAMMPS, without anything of ours between the files and the numbers."""

import subprocess

import numpy as np
import pytest
from kill_many import frames
from processes import HANGS
from stock_lammps import DEBIAN, MPIEXEC, WHEEL, scene

from lammps_inputs import Kick, file_names
from lammps_inputs.decks import continuation, deck
from lammps_inputs.ingredients.damping import Damping
from workflow.engines.lammps import files_on_disk, mpi
from workflow.runs.files import parts
from workflow.runs.run_directory import RunDirectory

TWO = pytest.mark.skipif(mpi.cores() < 2, reason="needs two cores")


def a_scene(**changes):
    """Three chains, whose forces add up in an order that shows in the last bit."""
    return scene(**{"chains": 3, "beads": 12, "kappa": 0.05, "every": 0.5, **changes})


def lmp(executable, ranks, directory, *options):
    launcher = []
    if ranks > 1:
        own = [MPIEXEC] if executable == WHEEL else ["mpirun", "--allow-run-as-root", "--oversubscribe"]
        launcher = [*own, "-n", str(ranks)]
    words = [*launcher, executable, *options, "-screen", "none", "-nocite"]
    done = subprocess.run([str(word) for word in words], cwd=directory, capture_output=True, text=True, timeout=HANGS)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]


CASES = {
    "coupled": a_scene(duration=60.0),
    "gap": a_scene(gap=1.5, kappa=1e-3, duration=100.0),
    "far apart": a_scene(
        kappa=1e-4, duration=100.0, kick=(Kick(chain=1, bead=6, velocity=-1.0), Kick(chain=3, bead=2, velocity=0.7))
    ),
    "recorded": a_scene(chains=1, kappa=None, duration=60.0, recorded=(3, 7)),
    "suzuki4": a_scene(chains=2, duration=60.0, scheme="suzuki4"),
    "damped": a_scene(chains=2, duration=60.0, timestep=0.01, damping=Damping(contact=0.02, beads=0.001)),
    "damped springs": a_scene(chains=2, duration=60.0, timestep=0.01, damping=Damping(contact=0.02, coupling=0.01)),
    "window": a_scene(chains=2, beads=120, duration=100.0, window=64),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "executable", "ranks"),
    [
        *((case, WHEEL, (1, 1)) for case in ("gap", "far apart", "suzuki4", "window")),
        pytest.param("coupled", WHEEL, (1, 2), marks=TWO),
        pytest.param("coupled", WHEEL, (2, 1), marks=TWO),
        pytest.param("damped springs", WHEEL, (2, 1), marks=TWO),
        *((case, DEBIAN, (1, 1)) for case in ("recorded", "damped", "window")),
        pytest.param("coupled", DEBIAN, (2, 2), marks=TWO),
    ],
)
def test_stock_lammps_goes_on_twice_bit_for_bit(case, executable, ranks, tmp_path):
    if not executable.exists():
        pytest.skip(f"no {executable}")
    one = CASES[case]
    problem = one.problem()
    for name in ("whole", "cut"):
        (tmp_path / name).mkdir()
        deck.write(one, tmp_path / name)
    lmp(executable, ranks[0], tmp_path / "whole", "-in", file_names.DECK)
    cut = tmp_path / "cut"
    restart = [*continuation.restart_lines(problem), f"shell mv {file_names.UNFINISHED} {file_names.RESTART}"]
    ending = "\n".join(restart) + "\n"
    (cut / "in.first").write_text(deck.render_deck(problem) + ending)
    (cut / "in.second").write_text(continuation.render_continuation(problem) + ending)
    (cut / file_names.CONTINUE).write_text(continuation.render_continuation(problem))
    # between two frames, and at one; in a window, where it is looked after
    first, second = (1200, 3000) if one.window else (1335, 3000)
    lmp(executable, ranks[0], cut, "-in", "in.first", "-var", "steps", first)
    lmp(executable, ranks[1], cut, "-in", "in.second", "-var", "steps", second)
    assert files_on_disk.step_of(cut / file_names.RESTART) == second
    lmp(executable, ranks[0], cut, "-in", file_names.CONTINUE, "-var", "dump", continuation.dump_part(3))
    assert len(parts(cut)) == 3
    np.testing.assert_array_equal(frames(cut), frames(tmp_path / "whole"))
    blocks = list(RunDirectory(cut).blocks())  # the reader takes them for one run at the right times
    assert blocks[-1].time[-1] == problem.duration
