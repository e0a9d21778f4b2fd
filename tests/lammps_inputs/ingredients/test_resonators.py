"""Resonators: peaks, bands and decay in a gap against independent programs; what their deck and data file hold."""

import math

import numpy as np
import pytest

from analysis.files import recording
from analysis.mda.universe import universe
from analysis.shape.unit_cell import NoDispersionError, cell_of
from lammps_inputs import library, physics
from lammps_inputs.facts import Fact
from lammps_inputs.limits import rates
from workflow.engines.reference import engine
from workflow.runs.run import run
from workflow.verdicts.analysis_files import analyse

LIGHT, HEAVY = {"mass": 0.1, "stiffness": 1.0}, {"mass": 0.5, "stiffness": 0.1}


def scene(resonators, **more):
    keys = {"name": "test", "beads": 160, "duration": 190.0, "timestep": 0.005, "kick": {"velocity": 1.0}}
    return library.from_plain({**keys, "output": {"every": 0.1}, "resonators": resonators, **more}, "test")


def small(resonators=LIGHT, **more):
    return scene(resonators, **{"beads": 12, "duration": 10.0, **more})


def test_edges_of_the_bands_and_the_ratio_in_the_gap_are_the_derived_ones():
    case = small(precompression={"force": 0.125}, kick={"velocity": 1e-3}, timestep=None)
    cell, second = cell_of(case.system), case.scale.time
    assert cell.bands().ravel() / second == pytest.approx([0.0, 1.625146, 3.316625, 3.370297], abs=5e-7)
    assert cell.ratio(2.5 * second) == pytest.approx(-0.118525, abs=5e-7)
    assert math.isnan(cell.ratio(1.0 * second))
    assert cell.ratio(4.0 * second) < 0.0
    with pytest.raises(NoDispersionError, match="single chain of equal beads"):
        cell_of(small(precompression={"force": 0.125}, chains=2).system).ratio(1.0)


def test_slow_waves_carry_the_resonators_along():
    case = small(precompression={"force": 0.125}, kick={"velocity": 1e-3}, timestep=None)
    cell, q = cell_of(case.system), 1e-3
    assert cell.branches(np.array([q]))[0, 0] / q == pytest.approx(math.sqrt(0.75 / 1.1) * case.scale.time, rel=1e-5)


def test_the_bound_of_the_step_holds_the_frequency_of_a_bead_and_its_resonator():
    plain, own = rates.fastest(small([]).system) ** 2, rates.fastest(small().system) ** 2
    assert own - plain == pytest.approx(1.0 * (1.0 + 1.0 / 0.1), rel=1e-12)


@pytest.mark.slow
def test_frames_hold_the_resonators_and_tables_of_beads_do_not(tmp_path, lammps_here):  # noqa: ARG001
    case = small([{**LIGHT, "rows": [3, 4]}, {**HEAVY, "rows": [4, 5]}], timestep=0.01)
    done = run(case, tmp_path / "run", check=False)
    found, exact = done.trajectory, engine.run(case.problem())
    assert found.velocity.shape == (101, 1, 12)
    np.testing.assert_allclose(found.further_lines, exact.further_lines, rtol=0.0, atol=2e-4)
    seen = universe(done.directory.problem, [done.directory.dump])
    assert seen.segments.segids.tolist() == ["C1", "R1", "R2"]
    velocity = seen.trajectory[-1].data["velocity"]
    np.testing.assert_array_equal(velocity[12:], found.further_lines[-1, 1].ravel()[[2, 3, 15, 16]])
    assert recording.all_ids(case.problem()).tolist() == [*range(1, 13), 15, 16, 28, 29]
    shares = analyse(done.directory, figures=False).conservation.budget
    assert shares.in_resonators == pytest.approx(shares.resonators[-1] / 0.5)
    assert shares.in_resonators > 0.1
    assert np.max(np.abs(shares.missing)) < 1e-4


def test_in_lammps_a_bead_and_the_damped_mass_inside_it_swing_about_their_centre_of_mass(tmp_path, lammps_here):  # noqa: ARG001
    """The bead flies freely: m w' = -k s - c w of their distance s, with the reduced mass m."""
    inner = {"mass": 0.5, "stiffness": 0.3, "damping": 0.2, "rows": [2, 3]}
    case = small(inner, beads=5, gap=20.0, kick={"bead": 3, "velocity": 1.0}, duration=8.0, timestep=0.002)
    found, reduced = run(case, tmp_path / "run", check=False).trajectory, 0.5 / 1.5
    gamma, t = 0.2 / (2.0 * reduced), found.time
    omega = math.sqrt(0.3 / reduced - gamma**2)
    apart = np.exp(-gamma * t) * (np.cos(omega * t) - gamma / omega * np.sin(omega * t))
    np.testing.assert_allclose(found.velocity[:, 0, 2], (1.0 + 0.5 * apart) / 1.5, rtol=0.0, atol=1e-3)
    np.testing.assert_allclose(found.further_lines[:, 1, 0, 2], (1.0 - apart) / 1.5, rtol=0.0, atol=1e-3)
    assert not np.any(np.delete(found.velocity[:, 0], 2, axis=1))


@pytest.mark.slow
@pytest.mark.parametrize(
    "contact", [{"exponent": 2.4}, {"force": "A/(d+s)^p", "A": 1.0, "d": 1.0, "p": 4.0}], ids=["overlapping", "magnets"]
)
def test_resonators_do_not_touch_where_the_contacts_are_a_formula_of_the_distance(contact, tmp_path, lammps_here):  # noqa: ARG001
    walls = {} if "exponent" in contact else {"walls": {"left": "bead", "right": "bead"}}
    keys = {"beads": 4, "contact": contact, "duration": 3.0, "timestep": 0.002, **walls}
    case = small({"mass": 0.1, "stiffness": 3.0}, **keys)
    # 0.3 V where they touch; of the step (omega dt)**2 / 24, omega = 5.7 / T, of each oscillation: 1.5e-5 V in three,
    # in which the resonators, of a tenth of the mass, oscillate with ten times the velocity of their beads
    assert run(case, tmp_path / "run").check.velocity < 1.5e-4


@pytest.mark.parametrize(("resonators", "leads"), [(LIGHT, True), (HEAVY, False), ({**HEAVY, "rows": [5, 6]}, True)])
def test_resonators_slower_than_a_pulse_at_all_beads_leave_none(resonators, leads):
    system = small(resonators).system
    assert system.holds(Fact.PULSE) == leads
    assert leads or "angular frequency 0.447 / T are slower than a pulse" in physics.why_no_pulse(system)


@pytest.mark.slow
def test_pulses_that_slow_resonators_end_and_those_that_lead_after_them_are_not_one(tmp_path):
    done = run(scene(HEAVY, beads=60, duration=80.0), tmp_path / "run", engine="reference", check=False)
    found = analyse(done.directory, figures=False)
    assert found.waves.pulse[found.waves.bead == 20] == [1]
    assert found.waves.pulse[-1] == 3
    for pulse in (1, 2, 3):
        assert np.all(np.diff(found.waves.peak_velocity[found.waves.pulse == pulse]) < 0.0)
    assert "slower than a pulse" in found.survey.verdict.sentence
