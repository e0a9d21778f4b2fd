"""Continued decks with stock LAMMPS, without anything of ours between the files and the numbers."""

import subprocess

import numpy as np
import pytest
from kill_many import frames
from processes import HANGS
from stock_lammps import MPIEXEC, scene

from lammps_inputs import file_names
from lammps_inputs.decks import continuation, deck, scene_files
from lammps_inputs.ingredients.damping import Damping
from workflow.engines.lammps import files_on_disk, mpi
from workflow.runs.files import parts
from workflow.runs.run_directory import RunDirectory

TWO = pytest.mark.skipif(mpi.cores() < 2, reason="needs two cores")


def a_scene(**changes):
    """Three chains, whose forces add up in an order that shows in the last bit."""
    return scene(**{"chains": 3, "beads": 12, "kappa": 0.05, "every": 0.5, **changes})


@pytest.fixture
def lmp(executable, lmp_of):
    """Runs LAMMPS of a release on some ranks."""

    def run(release, ranks, directory, *options):
        launcher = []
        if ranks > 1:
            debian = release == "2021"
            own = [executable("mpirun"), "--allow-run-as-root", "--oversubscribe"] if debian else [MPIEXEC]
            launcher = [*own, "-n", ranks]
        words = [str(word) for word in (*launcher, lmp_of(release), *options, "-screen", "none", "-nocite")]
        done = subprocess.run(words, cwd=directory, capture_output=True, text=True, timeout=HANGS)
        assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]

    return run


CASES = {
    "coupled": a_scene(duration=60.0),
    "recorded": a_scene(chains=1, kappa=None, duration=60.0, recorded=(3, 7)),
    "suzuki4": a_scene(chains=2, duration=60.0, scheme="suzuki4"),
    "damped springs": a_scene(chains=2, duration=60.0, timestep=0.01, damping=Damping(contact=0.02, coupling=0.01)),
    "window": a_scene(chains=2, beads=120, duration=100.0, window=64),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "release", "ranks"),
    [
        *((case, "wheel", (1, 1)) for case in ("suzuki4", "window")),
        pytest.param("coupled", "wheel", (1, 2), marks=TWO),
        pytest.param("coupled", "wheel", (2, 1), marks=TWO),
        pytest.param("damped springs", "wheel", (2, 1), marks=TWO),
        *((case, "2021", (1, 1)) for case in ("recorded", "window")),
        pytest.param("coupled", "2021", (2, 2), marks=TWO),
    ],
)
def test_stock_lammps_goes_on_twice_bit_for_bit(case, release, ranks, lmp, tmp_path):
    one = CASES[case]
    problem = one.problem()
    for name in ("whole", "cut"):
        (tmp_path / name).mkdir()
        scene_files.write(one, tmp_path / name)
    lmp(release, ranks[0], tmp_path / "whole", "-in", file_names.DECK)
    cut = tmp_path / "cut"
    restart = [*continuation.restart_lines(problem), f"shell mv {file_names.UNFINISHED} {file_names.RESTART}"]
    ending = "\n".join(restart) + "\n"
    (cut / "in.first").write_text(deck.render_deck(problem) + ending)
    (cut / "in.second").write_text(continuation.render_continuation(problem) + ending)
    (cut / file_names.CONTINUE).write_text(continuation.render_continuation(problem))
    # between two frames, and at one; in a window, where it is looked after
    first, second = (1200, 3000) if one.window else (1335, 3000)
    lmp(release, ranks[0], cut, "-in", "in.first", "-var", "steps", first)
    lmp(release, ranks[1], cut, "-in", "in.second", "-var", "steps", second)
    assert files_on_disk.step_of(cut / file_names.RESTART) == second
    lmp(release, ranks[0], cut, "-in", file_names.CONTINUE, "-var", "dump", continuation.dump_part(3))
    assert len(parts(cut)) == 3
    np.testing.assert_array_equal(frames(cut), frames(tmp_path / "whole"))
    blocks = list(RunDirectory(cut).blocks())  # the reader takes them for one run at the right times
    assert blocks[-1].time[-1] == problem.duration
