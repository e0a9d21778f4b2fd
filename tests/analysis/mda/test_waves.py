"""The leading waves as MDAnalysis users expect an analysis."""

from pathlib import Path

import MDAnalysis as mda
import numpy as np
import pytest

from analysis.mda.waves import LeadingWaves
from analysis.tracking.leading_waves import leading_waves
from analysis.tracking.peaks import find_peaks
from lammps_inputs import Coupling, Kick, Scene
from workflow.runs.run import run

pytestmark = pytest.mark.usefixtures("lammps_here")

SCENE = Scene(
    name="small", chains=2, beads=30, coupling=Coupling(stiffness=0.1), kick=(Kick(velocity=1.0),), duration=40.0
)


def test_results_are_those_of_the_arrays(tmp_path: Path) -> None:
    result = run(SCENE, tmp_path / "r", check=False)
    universe = mda.Universe(str(tmp_path / "r" / "data.chains"), str(tmp_path / "r" / "chains.dump.bin"))
    found = LeadingWaves(universe, SCENE.problem()).run().results
    expected = leading_waves(find_peaks([result.trajectory]))
    np.testing.assert_array_equal(found.bead, expected.bead)
    np.testing.assert_allclose(found.peak_velocity, expected.peak_velocity, rtol=1e-12)
    inner = expected.bead < 29
    np.testing.assert_allclose(found.arrival[inner], expected.arrival[inner], rtol=1e-9)


def test_every_second_frame_from_the_tenth_on_can_be_chosen(tmp_path: Path) -> None:
    result = run(SCENE, tmp_path / "r", check=False)
    universe = mda.Universe(str(tmp_path / "r" / "data.chains"), str(tmp_path / "r" / "chains.dump.bin"))
    found = LeadingWaves(universe, SCENE.problem()).run(start=10, stop=300, step=2).results
    expected = leading_waves(find_peaks([result.trajectory[10:300:2]]))
    np.testing.assert_allclose(found.peak_velocity, expected.peak_velocity, rtol=1e-9)
