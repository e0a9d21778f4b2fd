"""The benchmarks: what they compare computes the same, and ratios say what was measured."""

import numpy as np
import pytest
import ratios
from ratios import coupled_scene

from analysis.tracking.leading_waves import leading_waves
from analysis.tracking.peaks import find_peaks
from workflow.runs.run import run

pytestmark = pytest.mark.usefixtures("lammps_here")


@pytest.mark.slow
def test_the_textbook_way_finds_the_same_waves(tmp_path):
    scene = coupled_scene(2, 120, 30.0)
    ratios.textbook(tmp_path / "plain", scene.problem())
    table = np.genfromtxt(tmp_path / "plain" / "waves.csv", delimiter=",", names=True)
    waves = leading_waves(find_peaks([run(scene, tmp_path / "ours", check=False).trajectory]), scene.problem())
    np.testing.assert_array_equal(table["bead"], waves.bead)
    # the neighbour lists differ, so sums are taken in other orders
    np.testing.assert_allclose(table["peak_velocity"], waves.peak_velocity, atol=1e-11)
    ratios.ours(tmp_path / "read", scene)
    read = np.genfromtxt(tmp_path / "read" / "waves.csv", delimiter=",", names=True)
    np.testing.assert_allclose(read["peak_velocity"], waves.peak_velocity, rtol=1e-15)
