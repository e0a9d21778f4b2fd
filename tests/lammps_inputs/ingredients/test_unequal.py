"""Beads that differ: numbers published and computed, cells, types; the motion is in `test_every_ingredient`."""

import itertools
import json

import numpy as np
import pytest
from plain_scene import one_chain, scene

from analysis.shape.exact_wave import solitary_wave
from analysis.shape.long_waves import period_of
from analysis.sharing.survey import survey
from analysis.tracking.leading_waves import leading_waves
from analysis.tracking.peaks import find_peaks
from lammps_inputs import find, physics
from lammps_inputs.deck_lines import types_by_contact
from workflow.engines.reference import engine
from workflow.measures.cells import CellMeter, left
from workflow.runs.contacts import measure
from workflow.runs.run import run
from workflow.verdicts.analysis_files import analyse
from workflow.verdicts.validate import validate

pytestmark = pytest.mark.usefixtures("lammps_here")

DIMER = {"kinds": {"heavy": {"mass": 1.0}, "light": {"mass": 0.3428}}, "pattern": ["heavy", "light"]}


HEAVY = {"kinds": {"odd": {"mass": 4.0}}, "replace": {"bead": 20, "kind": "odd"}}


def surveyed(**keys):
    """One chain by the reference: its problem and frames, and what is found in these."""
    problem = one_chain(**keys).problem()
    trajectory = engine.run(problem)
    return trajectory, survey(trajectory.blocks, problem)


def test_walls_are_as_hard_as_the_beads_before_them_make_them():
    """A bead of radius r and modulus e against its like: e sqrt(r); stiffness says it outright."""
    beads = {"kinds": {"big": {}, "odd": {"radius": 0.49, "stiffness": 2.0}}, "pattern": [["big"], ["big", "odd"]]}
    left, right = (link.law.strength for link in scene(**beads, walls={"left": "bead", "right": "flat"}).system.walls)
    np.testing.assert_allclose(left, 1.0, rtol=1e-15)
    np.testing.assert_allclose(right[:, -1], [2.0**0.5, 1.4 * 2.0**0.5], rtol=1e-15)
    (outright,) = scene(**beads, walls={"right": {"stiffness": 3.0}}).system.walls
    assert outright.law.strength == 3.0


def test_beads_in_si_press_as_hard_as_their_own_contact_says(tmp_path):
    """Two beads, one of half the radius and twice the modulus: F = A d^1.5, p = 1.5 F / (pi R* d)."""
    steel = {"radius": 4e-3, "density": 8000.0, "youngs_modulus": 2e11, "poisson_ratio": 0.3}
    beads = {"kinds": {"odd": {"radius": 2e-3, "youngs_modulus": 4e11}}, "replace": {"bead": 2, "kind": "odd"}}
    case = one_chain(material=steel, **beads, beads=2, duration=6e-5, output={"every": 1e-7})
    found = measure(run(case, tmp_path / "run", check=False).directory)
    modulus, radius = 1.0 / (0.91 / 2e11 + 0.91 / 4e11), 4e-3 * 2e-3 / 6e-3
    constant = 4.0 / 3.0 * modulus * radius**0.5
    heavy, light = (4.0 / 3.0 * np.pi * r**3 * 8000.0 for r in (4e-3, 2e-3))
    overlap = (2.5 * 0.5 * heavy * light / (heavy + light) / constant) ** 0.4
    assert found.measured
    assert found.force == pytest.approx(constant * overlap**1.5, rel=1e-3)
    assert found.pressure == pytest.approx(1.5 * constant * overlap**0.5 / (np.pi * radius), rel=1e-3)
    assert found.overlap == pytest.approx(overlap / (2.0 * radius), rel=1e-3)


@pytest.mark.parametrize("number", [1, 19, 300])
def test_few_types_tell_all_contacts_apart(number):
    strength = np.random.default_rng(1).random((1, number))
    types = types_by_contact(strength)
    row = types.of[0].tolist()
    pairs = [types.strength[min(a, b), max(a, b)] for a, b in itertools.pairwise(row)]
    assert pairs == strength[0].tolist()
    assert types.count <= np.sqrt(2.0 * number) + 2.0


# --- published and computed numbers -----------------------------------------------------------------------------------


def peaks(problem):
    return leading_waves(find_peaks([engine.run(problem)], 1e-3), problem)


def peak(waves, bead):
    return float(waves.at(bead).peak_velocity[0])


@pytest.mark.slow
def test_a_dimer_at_an_anti_resonance_keeps_its_pulse():
    waves = peaks(find("dimer").problem())
    heavy = [peak(waves, 2 * cell - 1) for cell in range(20, 101, 10)]
    assert heavy == pytest.approx([0.55089] * len(heavy), abs=1e-5)
    assert np.ptp(heavy) < 1e-5 * heavy[0]


@pytest.mark.parametrize(
    "ratio", [0.3428, *(pytest.param(ratio, marks=pytest.mark.slow) for ratio in (0.1548, 0.0901))]
)
def test_least_is_left_behind_at_the_published_anti_resonances(ratio):
    def left_behind(light):
        kinds = {"heavy": {}, "light": {"mass": light}}
        _, found = surveyed(beads=90, kinds=kinds, pattern=DIMER["pattern"], duration=96.0)
        return left(found, 1, 2).per_cell

    offset = np.array([-0.002, -0.001, 0.0, 0.001, 0.002])
    curvature, slope, _ = np.polyfit(offset, [left_behind(ratio + d) for d in offset], 2)
    assert -0.5 * slope / curvature == pytest.approx(0.0, abs=5e-4)
    assert curvature > 0.0


@pytest.mark.slow
@pytest.mark.parametrize(("taper", "share"), [(0.02, 0.9332), (0.08, 0.4618)])
def test_a_taper_hands_on_less_of_the_energy(taper, share):
    trajectory, found = surveyed(beads=20, taper=taper, duration=25.0, output=None)
    system = trajectory.system
    last = trajectory.velocity[:, 0, -1].max()
    assert 0.5 * system.mass[0, -1] * last**2 / physics.energy(system) == pytest.approx(share, abs=5e-5)
    assert CellMeter().read([trajectory]).at_end(found, 1) == pytest.approx(share, abs=5e-5)


@pytest.mark.slow
@pytest.mark.parametrize(("mass", "ratio"), [(2.0, 0.93899), (8.0, 0.51009)])
def test_an_impurity_lets_part_of_the_pulse_through(mass, ratio):
    beads = {"kinds": {"odd": {"mass": mass}}, "replace": {"bead": 201, "kind": "odd"}}
    waves = peaks(one_chain(beads=400, duration=420.0, output=None, **beads).problem())
    assert peak(waves, 300) / peak(waves, 150) == pytest.approx(ratio, abs=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize(("mass", "train"), [(2.0, [0.9481, 0.1860]), (4.0, [1.2131, 0.5505, 0.2658, 0.1324])], ids=str)
def test_a_striker_makes_a_train_of_pulses(mass, train):
    striker = {"mass": mass, "velocity": 1.0}
    case = one_chain(beads=340, striker=striker, kick=None, duration=520.0, output=None)
    found = find_peaks([engine.run(case.problem())], 1e-2, direction=1)
    at = found.where(found.bead == (300 if mass == 2.0 else 200))
    assert sorted(at.velocity.tolist(), reverse=True)[: len(train)] == pytest.approx(train, abs=1e-4)


# --- runs -------------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_energy_of_a_pulse_behind_a_heavy_bead_is_its_own_wherever_it_is_stated(tmp_path):
    """The second pulse runs six beads behind it; what cells lose is undefined, for they are not all alike."""
    directory = run(one_chain(beads=60, duration=80.0, **HEAVY), tmp_path / "run").directory
    analyse(directory, figures=False)
    report = json.loads((tmp_path / "run" / "analysis.json").read_text())
    cells, first, share = report["cells"], report["pulses"][0], report["equipartition"]["energy_share"]["measured"]
    assert (cells["beads"], cells["residual_energy"], cells["chains"][0]["per_cell"]) == (1, None, None)
    # the exact wave of that amplitude; 67 % were said where the second pulse counted
    expected = solitary_wave().energy_at(first["peak_velocity"]) / 0.5
    assert expected == pytest.approx(0.5538, abs=1e-4)
    for stated in (cells["chains"][0]["carried"], share, first["energy"] / 0.5):
        assert stated == pytest.approx(expected, rel=1e-4)
    (odd,) = cells["replaced"]
    assert odd["before"] + odd["at"] + odd["beyond"] == pytest.approx(1.0, abs=1e-3)
    assert odd["incident"] - odd["reflected"] == pytest.approx(odd["at"] + odd["beyond"])
    assert validate(directory).passed


LOSSES = {
    "damped": {**DIMER, "damping": {"beads": 0.001}},
    "coupled": {**DIMER, "chains": 2, "coupling": {"stiffness": 0.01}},
    "tapered": {"taper": 0.01},
    "disordered": {"disorder": {"mass": 0.1, "seed": 3}},
}


@pytest.mark.parametrize(
    "what", [pytest.param(what, marks=[pytest.mark.slow] * (what in ("damped", "tapered"))) for what in LOSSES]
)
def test_residual_energy_per_cell_is_undefined_where_it_is_not_all_that_a_pulse_loses(what):
    trajectory, survey = surveyed(beads=40, duration=45.0, output=None, **LOSSES[what])
    found = left(survey, 1, period_of(trajectory.system))
    assert 0.0 < found.carried < 1.0
    assert np.isnan([found.per_cell, found.rate, found.deviation]).all()


@pytest.mark.parametrize("second", [(2, 1.0), (39, -0.001)])
def test_with_a_second_kick_none_of_the_energy_is_said_to_be_reflected(second):
    kicks = [{"bead": bead, "velocity": velocity} for bead, velocity in ((1, 1.0), second)]
    trajectory, found = surveyed(beads=60, kick=kicks, duration=70.0, output=None, **HEAVY)
    split = CellMeter().read([trajectory]).split(found, 1, 20)
    assert split.before + split.at + split.beyond == pytest.approx(1.0, abs=1e-6)
    assert np.isnan(split.reflected)
