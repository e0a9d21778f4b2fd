"""What the benchmarks compare must compute the same."""

from pathlib import Path

import numpy as np
import pytest

from analysis.tracking.leading_waves import leading_waves
from analysis.tracking.peaks import find_peaks
from lammps_inputs import file_names
from workflow.runs.run import run
from workflow.studies.bench import alternatives, engines
from workflow.studies.bench import alternatives as bench
from workflow.studies.bench.study import ratio_of


@pytest.mark.slow
def test_the_textbook_way_finds_the_same_waves(tmp_path: Path) -> None:
    scene = bench.paper_scene(30.0)
    problem = scene.problem()
    plain = tmp_path / "plain"
    plain.mkdir()
    (plain / file_names.DATA).write_text(alternatives.plain_data(problem))
    bench.lammps_seconds(plain, alternatives.plain_deck(problem, dump=True))
    alternatives.read_and_analyse(plain, problem)
    table = np.genfromtxt(plain / "waves.csv", delimiter=",", names=True)
    waves = leading_waves(find_peaks([run(scene, tmp_path / "ours", check=False).trajectory]))
    np.testing.assert_array_equal(table["bead"], waves.bead)
    # the neighbour lists differ, so sums are taken in other orders
    np.testing.assert_allclose(table["peak_velocity"], waves.peak_velocity, atol=1e-11)


def test_the_reference_reaches_in_one_run_what_scipy_reaches() -> None:
    problem = bench.paper_scene(5.0).problem()
    difference = np.abs(engines.last_velocities(problem, 16) - engines.scipy_velocities(problem, 1e-12))
    assert np.max(difference) < 1e-8


@pytest.mark.parametrize(("value", "reached"), [(2.0, False), (3.0, True)])
def test_a_ratio_says_whether_it_reached_its_goal(value: float, reached: bool) -> None:
    ratio = ratio_of("x", [(1.0, value)], 2.5)
    assert ratio.reached is reached
