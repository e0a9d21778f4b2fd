"""From a scene to the waves through real LAMMPS: the published numbers, and what a run leaves and refuses."""

import csv

import numpy as np
import pytest
from stock_lammps import scene

from analysis.motion import overlaps
from lammps_inputs import Material
from workflow.cli import main
from workflow.runs.run import run
from workflow.verdicts.analysis_files import analyse

pytestmark = pytest.mark.usefixtures("lammps_here")


STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)


def small(**changes):
    """Twelve rows, a thousand steps."""
    return scene(**{"chains": 2, "beads": 12, "kappa": 0.1, "duration": 10.0, **changes})


def test_two_chains_have_the_published_peaks_in_the_table_of_waves(tmp_path):
    assert main(["run", "two-chains", "-o", str(tmp_path / "run"), "--no-check"]) == 0
    assert main(["analyze", str(tmp_path / "run"), "--no-figures"]) == 0
    with (tmp_path / "run" / "waves.csv").open() as file:
        found = {row["chain"]: float(row["peak_velocity"]) for row in csv.DictReader(file) if row["bead"] == "55"}
    assert found == pytest.approx({"1": 0.36892, "2": 0.36157}, abs=5e-5)


def test_a_steel_chain_has_the_speed_and_the_force_of_its_material(tmp_path):
    steel = scene(beads=60, material=STEEL, duration=0.8e-3)
    result = run(steel, tmp_path / "run", check=False)
    found = analyse(result.directory, figures=False).waves
    length = 2 * STEEL.radius
    assert found.at(40).speed[0] * length == pytest.approx(654, abs=0.5)
    strongest = (
        overlaps(result.trajectory.problem.system, result.trajectory.displacement)[:, 0, 29:49].max(axis=0) ** 1.5
    )
    # the largest of samples 0.1 T apart, a full width of 2.3 T: 0.05**2 / 2 * 5 low at most
    assert strongest.max() * steel.scale.force == pytest.approx(189, abs=0.5 + 189 * 0.006)


def test_a_run_has_every_frame_it_was_asked_for(tmp_path):
    result = run(small(every=0.25, recorded=(3, 7)), tmp_path / "run", check=False)
    assert result.trajectory.velocity.shape == (41, 2, 2)
    np.testing.assert_array_equal(result.trajectory.time, 0.25 * np.arange(41))


def test_a_directory_with_any_name_will_do(tmp_path):
    path = tmp_path / "a 'b' \"c\" ${x} $(1+1) #; é" / "d"
    assert run(small(), path, check=False).trajectory.frames == 101
