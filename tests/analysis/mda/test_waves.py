"""The leading waves as MDAnalysis users expect an analysis."""

import MDAnalysis as mda
import numpy as np
import pytest
from lammps_here import run as run_here
from stock_lammps import scene

from analysis.mda.universe import universe
from analysis.mda.waves import LeadingWaves
from analysis.tracking.leading_waves import leading_waves
from analysis.tracking.peaks import find_peaks
from lammps_inputs import Output
from workflow.engines.lammps import engine
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory

SCENE = scene(name="small", chains=2, beads=30, kappa=0.1, duration=40.0)
COLUMNS = ("chain", "bead", "pulse", "arrival", "peak_velocity", "speed")


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> tuple[RunDirectory, RunDirectory]:
    """Of all beads, and of a window that moves on."""
    place = tmp_path_factory.mktemp("runs")
    moving = SCENE.model_copy(update={"beads": 100, "window": 64, "duration": 130.0, "output": Output(every=0.5)})
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(engine, "run_deck", run_here)
        whole, window = (run(one, place / name, check=False).directory for name, one in (("a", SCENE), ("b", moving)))
    return whole, window


def test_results_are_those_of_the_arrays(runs: tuple[RunDirectory, RunDirectory]) -> None:
    directory, problem = runs[0].path, SCENE.problem()
    ran = mda.Universe(directory / "data.chains", directory / "chains.dump.bin")
    found, wanted = LeadingWaves(ran, problem).run().results, leading_waves(find_peaks([runs[0].trajectory]), problem)
    assert set(found) == set(COLUMNS)
    np.testing.assert_array_equal(found.bead, wanted.bead)
    np.testing.assert_allclose(found.peak_velocity, wanted.peak_velocity, rtol=1e-12)
    inner = wanted.bead < 29
    np.testing.assert_allclose(found.arrival[inner], wanted.arrival[inner], rtol=1e-9)


@pytest.mark.slow
def test_several_processes_find_what_one_does_also_of_few_frames_each_and_of_a_window(
    runs: tuple[RunDirectory, RunDirectory],
) -> None:
    for directory, options in zip((*runs, runs[0]), [{}, {}, {"stop": 21}], strict=True):
        waves = LeadingWaves(universe(directory.problem, directory.dumps), directory.problem)
        alone = waves.run(**options).results
        shared = waves.run(backend="multiprocessing", n_workers=2, n_parts=8, **options).results
        assert len(alone.bead) > 1
        for name in COLUMNS:
            np.testing.assert_array_equal(shared[name], alone[name])


def test_frames_unevenly_spaced_and_universes_that_do_not_fit_are_refused(
    runs: tuple[RunDirectory, RunDirectory],
) -> None:
    directory, problem = runs[0].path, SCENE.problem()
    ran = mda.Universe(directory / "data.chains", directory / "chains.dump.bin")
    for frames in ([0, 1, 2, 5, 6, 7], [30, 20, 10, 0]):
        with pytest.raises(ValueError, match="evenly spaced and ascending"):
            LeadingWaves(ran, problem).run(frames=frames)
    with pytest.raises(ValueError, match="small has 62 recorded beads"):
        LeadingWaves(ran, SCENE.model_copy(update={"beads": 31}).problem())
    with pytest.raises(ValueError, match=r"there is a frame of step \d+, but the problem's are \d+ steps apart"):
        LeadingWaves(ran, SCENE.model_copy(update={"output": Output(every=7.0)}).problem()).run()
    ran.transfer_to_memory(stop=3)
    with pytest.raises(ValueError, match=r"ts\.data has no 'x'; .* not in memory"):
        LeadingWaves(ran, problem)
