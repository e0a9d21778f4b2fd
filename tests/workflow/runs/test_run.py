"""From a scene to the waves through real LAMMPS: the published numbers, and what a run leaves and refuses."""

import csv

import numpy as np
import pytest
from stock_lammps import scene

from analysis.motion import overlaps
from lammps_inputs import Material
from workflow.runs.run import run
from workflow.verdicts.analysis_files import analyse

pytestmark = pytest.mark.usefixtures("lammps_here")


STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)

VERLET_ERROR = 1.5e-5
"""Of velocities at the default step; published numbers of five digits add half of the last."""


def small(**changes):
    """Twelve rows, a thousand steps."""
    return scene(**{"chains": 2, "beads": 12, "kappa": 0.1, "duration": 10.0, **changes})


def waves(directory):
    """waves.csv as (chain, bead) -> row of numbers."""
    with (directory / "waves.csv").open() as file:
        return {(int(row["chain"]), int(row["bead"])): row for row in csv.DictReader(file)}


def test_two_chains_have_the_published_peaks(paper):
    found = [float(row["peak_velocity"]) for (_, at), row in sorted(waves(paper("two-chains")).items()) if at == 55]
    assert found == pytest.approx([0.36892, 0.36157], abs=5e-5)


@pytest.mark.slow
def test_one_chain_has_the_published_solitary_wave_at_bead_55(paper):
    wave = waves(paper("one-chain"))[1, 55]
    assert float(wave["peak_velocity"]) == pytest.approx(0.68163, abs=5e-6 + VERLET_ERROR)
    assert float(wave["speed"]) == pytest.approx(0.84051, abs=5e-6 + VERLET_ERROR)


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


@pytest.mark.slow
@pytest.mark.parametrize("bead", [1, 12, 40])
def test_a_run_until_a_bead_ends_soon_after_its_peaks(bead, tmp_path):
    ended = small(beads=40, until_bead=bead, duration=None)
    result = run(ended, tmp_path / "run", check=False)
    fastest = analyse(result.directory, figures=False).survey.waves.at(bead).time  # also of the last, which flies on
    assert len(fastest) == 2
    assert fastest.max() + 1.0 < result.trajectory.time[-1] < fastest.max() + 10.0


def test_a_directory_with_any_name_will_do(tmp_path):
    path = tmp_path / "a 'b' \"c\" ${x} $(1+1) #; é" / "d"
    assert run(small(), path, check=False).trajectory.frames == 101
