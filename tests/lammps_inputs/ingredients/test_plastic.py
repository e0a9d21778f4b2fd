"""Contacts that yield: Thornton's and Walton and Braun's closed forms, and numbers of an independent program."""

import json
import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from executables import RELEASES
from plain_scene import goes_on_bit_for_bit, one_chain
from stock_lammps import run as run_deck

from analysis.conservation import ConservationMeter
from analysis.gauges.gauge import at_frames, gauges
from analysis.tracking.peaks import find_peaks
from lammps_inputs import laws, materials, physics, references
from lammps_inputs.decks import deck
from lammps_inputs.ingredients.base import Ingredient
from lammps_inputs.ingredients.unequal import neighbours
from lammps_inputs.laws.contact import Hertz
from lammps_inputs.laws.plastic import Thornton
from workflow.engines.reference import engine
from workflow.engines.reference.schemes import VERLET
from workflow.measures.plastic import power_law
from workflow.runs.run import run
from workflow.verdicts.analysis_files import analyse

pytestmark = pytest.mark.usefixtures("lammps_here")

YIELD = {"yield": {"overlap": 0.1}}
WALTON = {"yield": {"law": "walton-braun", "restitution": 0.8}}
STEEL = {"name": "steel", "radius": 4.76e-3, "yield_strength": 0.25e9}


def plastic(contact=YIELD, **keys):
    one = {"beads": 2, "duration": 20.0, "timestep": 0.01, "output": {"every": 0.1}}
    return one_chain(**{**one, "contact": contact, **keys})


def separation(case, steps=8):
    """Velocity with which the last two beads separate, in V."""
    velocity = engine.run(case.problem(), steps_per_frame=steps).velocity[-1, 0]
    return velocity[-1] - velocity[-2]


@pytest.mark.parametrize(("velocity", "restitution"), [(0.2, 0.8739934), (1.0, 0.6069081)])
def test_two_beads_have_the_published_restitution(velocity, restitution):
    found = separation(plastic(kick={"velocity": velocity}, duration=20.0 / velocity**0.2), 64)
    assert found == pytest.approx(restitution, abs=2e-7)
    assert Thornton.restitution_at(velocity, math.sqrt(1.6 * 0.1**2.5)) == pytest.approx(restitution, abs=6e-8)


def test_restitution_over_four_decades_of_velocity_is_thornton_s_closed_form():
    for velocity in np.geomspace(0.02, 200.0, 5):
        case = plastic(
            kick={"velocity": float(velocity)}, timestep=None, output={}, duration=8.0 / float(velocity) ** 0.2
        )
        found = separation(case, 64)
        assert found == pytest.approx(float(Thornton.restitution_at(velocity, math.sqrt(1.6 * 0.1**2.5))), abs=1e-5)


@pytest.mark.slow
def test_walton_and_braun_s_restitution_is_the_same_at_every_velocity():
    for velocity in (0.1, 10.0):
        assert separation(plastic(WALTON, kick={"velocity": velocity}), 64) == pytest.approx(0.8, abs=1e-4)


def test_forces_and_loss_along_a_chain_are_those_of_an_independent_program():
    problem = plastic(beads=80, duration=140.0).problem()
    trajectory = engine.run(problem)
    law = laws.at_state(problem.system.along[0].law, 0.0)
    largest = laws.force(law, trajectory.contact_state[-1, 0])
    assert largest[[1, 10, 50]] == pytest.approx([0.492414, 0.140577, 0.054380], abs=6e-7)
    assert physics.dissipated_by_contacts(trajectory.system)[-1] == pytest.approx(0.475548, abs=6e-7)
    seen = ConservationMeter(problem).read([trajectory])
    assert seen.energy_drift < 3e-8
    assert seen.momentum_drift < 1e-13


def test_peaks_between_frames_are_within_their_uncertainty_those_of_frames_up_to_a_hundred_times_as_near():
    kicks = [{"velocity": 1.5}, {"bead": 5, "velocity": -0.4}]
    run = engine.run(plastic(beads=8, kick=kicks, duration=10.0, output={"every": 0.01}).problem())
    fine = find_peaks([run])
    for stride, largest in ((20, 1e-5), (100, np.inf)):
        coarse = find_peaks([run[::stride]])
        assert np.array_equal(coarse.bead, fine.bead)
        assert np.all(np.abs(coarse.velocity - fine.velocity) <= coarse.velocity_error + fine.velocity_error)
        assert np.all(np.abs(coarse.time - fine.time) <= coarse.time_error + fine.time_error)
        assert np.max(coarse.velocity_error) < largest


def test_the_top_of_an_overlap_is_found_within_the_step_to_third_order():
    exact, steps = float(Thornton.restitution_at(1.0, math.sqrt(1.6 * 0.1**2.5))), np.array([2, 8, 32])
    error = [np.mean([abs(separation(plastic(gap=gap), int(n)) - exact) for gap in (0.0, 0.013, 0.037)]) for n in steps]
    assert -np.polyfit(np.log(steps), np.log(error), 1)[0] > 2.4  # contacts that open allow no more than 2.5


@pytest.mark.slow
@pytest.mark.parametrize(
    ("contact", "step", "restitution", "most"),
    [(YIELD, 0.8, 0.6069081, 4e-3), ({"yield": {"law": "walton-braun", "restitution": 0.3}}, 0.4, 0.3, 1e-2)],
    ids=["thornton", "walton-braun"],
)
def test_a_contact_that_opens_within_a_coarse_step_pushes_back_as_its_largest_overlap_lets_it(
    contact, step, restitution, most
):
    """A contact lasts 3 T; without the push after the largest overlap errors are 2 to 5 times as large."""
    gaps = np.linspace(0.0, 0.7, 8)
    found = [separation(plastic(contact, gap=float(gap), output={"every": step}), 1) for gap in gaps]
    assert np.sqrt(np.mean(np.square(np.array(found) - restitution))) < most


def test_the_centre_of_mass_goes_on_as_before_through_every_contact_that_yields_and_opens():
    """Places and velocities are set right within coarse steps, by as much in one bead as in the other."""
    run = engine.run(plastic(beads=8, kick=[{"velocity": 1.0}, {"bead": 5, "velocity": -0.4}]).problem())
    assert np.max(run.contact_state) > 0.2
    np.testing.assert_allclose(run.displacement.sum(axis=(1, 2)), 0.6 * run.time, rtol=1e-12, atol=1e-12)


def test_a_yield_strength_is_the_overlap_at_which_its_pressure_is_reached():
    law = plastic(None, material=STEEL, kick={"velocity": 0.1}).system.along[0].law
    assert law.onset == pytest.approx(0.0431, abs=5e-5)


@pytest.mark.parametrize(
    ("wall", "size", "modulus"), [("bead", 1.0, 1.0), ("flat", 2.0, 1.0), ("rigid", 2.0, 2.0)], ids=str
)
def test_walls_and_unlike_beads_yield_at_the_overlap_of_their_own_radius_and_modulus(wall, size, modulus):
    keys = {"kinds": {"a": {}, "b": {"radius": 0.5, "stiffness": 2.0}}, "pattern": ["a", "b"], "beads": 4}
    system = plastic(**keys, walls={"right": wall}).system
    assert system.along[0].law.onset == pytest.approx(0.1 * (2 / 3) / (4 / 3) ** 2)
    onset = system.walls[0].law.onset
    assert onset == pytest.approx(0.1 * 0.5 * size / (2.0 * modulus) ** 2)


@pytest.mark.parametrize(("side", "beads", "wall"), [("left", 3, "rigid"), ("right", 3, "flat"), ("right", 4, "bead")])
def test_in_lammps_a_bead_leaves_a_wall_that_yields_with_the_closed_form_s_restitution(side, beads, wall, tmp_path):
    """An end's contact is among the first pairs or the second, by whether the number of beads is odd."""
    bead, velocity = (1, -1.0) if side == "left" else (beads, 1.0)
    case = plastic(walls={side: wall}, gap=3.0, beads=beads, kick={"bead": bead, "velocity": velocity}, duration=8.0)
    law = case.problem().system.walls[0].law
    yields_from = math.sqrt(0.8 * float(np.max(law.strength)) * float(np.max(law.onset)) ** 2.5)
    found = run_deck(case, tmp_path / "run").velocity[-1, 0]
    assert -found[bead - 1] / velocity == pytest.approx(float(Thornton.restitution_at(1.0, yields_from)), abs=1e-4)
    assert np.count_nonzero(found) == 1


class Sized(Ingredient):
    """Contacts as strong as their solids are large, which a user's own ingredient may make."""

    def law_between(self, setting, strength, solids):  # noqa: ARG002
        return Hertz(strength * solids().radius)


def test_an_ingredient_makes_contacts_and_walls_of_a_law_that_depends_on_the_solids():
    case = plastic(None, kinds={"a": {}, "b": {"radius": 0.25}}, pattern=["a", "b"], beads=4, walls={"right": "flat"})
    setting = replace(case.setting, named=(*case.setting.named, ("sized", Sized())))
    np.testing.assert_allclose(setting.law_between(1.0, partial(neighbours, setting)).strength, 0.4, rtol=1e-15)
    (wall,) = case.walls.links(setting)
    assert wall.law.strength == pytest.approx(2.0 * 0.25 * case.walls.links(case.setting)[0].law.strength)


def test_a_named_metal_yields_at_the_strength_of_the_catalogue_only_where_the_scene_asks_for_it():
    named = {"name": "steel", "radius": 4.76e-3}
    kinds = {"a": {"material": "aluminium", "yield_strength": "catalogue"}}
    found, same = (
        plastic(None, material={**named, "yield_strength": strength}, kinds=kinds, pattern=["a"])
        for strength in ("catalogue", materials.CATALOGUE["steel"].yield_strength)
    )
    assert found.system == same.system
    assert found.kinds["a"].yield_strength == 276e6
    assert references.of_scene(found)["yield strength"] == ["thornton1997", materials.YIELD_SOURCE]
    assert not laws.has_state(plastic(None, material=named).system.along[0].law)


def test_the_softer_of_two_beads_yields():
    kinds = {"soft": {"yield_strength": 0.125e9}, "hard": {}}
    case = plastic(None, material=STEEL, kinds=kinds, pattern=["soft", "hard", "hard"], beads=3)
    first, second = case.system.along[0].law.onset[0]
    assert first == pytest.approx(0.25 * second)


def test_an_elastic_limit_is_hertz_s_law_bit_for_bit():
    one, other = (engine.run(plastic(contact, beads=20).problem()) for contact in ({"yield": {"overlap": 5.0}}, None))
    np.testing.assert_array_equal(one.velocity, other.velocity)
    assert not np.any(physics.dissipated_by_contacts(one.system))


def test_a_static_load_beyond_yield_is_the_state_at_the_start():
    law = plastic(precompression={"force": 0.3}, beads=4).system.along[0].law
    assert laws.contact_state(law) == law.rest
    bare = Thornton(1.0, law.onset)
    assert laws.force(bare, law.rest) == pytest.approx(0.3, rel=1e-4)
    assert laws.force(law, 0.0) == 0.0


def test_a_bound_of_the_strain_holds_the_energy_of_first_loading():
    for load in (0.0, 0.01, 0.3):
        law = plastic(precompression={"force": load} if load else None, beads=4).system.along[0].law
        for energy in (1e-5, 1e-3, 0.5):
            s = laws.max_strain(law, energy)
            there = laws.at_state(law, law.rest + s)
            held = laws.energy(there, s) + there.dissipated(*there)
            assert held == pytest.approx(energy, rel=1e-9) or held > energy


UNLIKE = {"kinds": {"a": {}, "b": {"radius": 0.7}}, "pattern": ["a", "b", "b"]}
IN_LAMMPS = {
    "walls": {
        "walls": {"left": "flat", "right": "rigid"},
        "gap": 0.3,
        "kick": {"velocity": 1.0, "bead": 4},
        "beads": 13,
    },
    "coupled": {
        "chains": 3,
        "coupling": {"stiffness": 0.2},
        "foundation": {"stiffness": 0.1},
        "walls": {"right": "bead"},
        "damping": {"beads": 0.1, "coupling": 0.1},
        "push": {"peak": 1.0, "duration": 2.0, "shape": "half-sine"},
    },
}
LOADED = {
    "column": {
        **UNLIKE,
        "gravity": 0.05,
        "precompression": {"force": 0.3},
        "walls": {"left": "bead", "right": "flat"},
        "damping": {"beads": 0.1},
        "beads": 9,
    },
}
NAMES = [pytest.param(name, marks=pytest.mark.slow) for name in (*IN_LAMMPS, *LOADED)]
"""Each compiles a kernel; weights from below yield to beyond it, walls, springs, drag, forces and gaps are in one."""


def in_lammps(name, **keys):
    return plastic(**{"beads": 12, "duration": 30.0, **{**IN_LAMMPS, **LOADED}[name], **keys})


@pytest.mark.parametrize("name", NAMES)
def test_lammps_is_the_reference_with_its_scheme_to_rounding(name, tmp_path):
    done = run(in_lammps(name), tmp_path / "run")
    problem = done.directory.problem
    same = engine.run(problem, scheme=VERLET, steps_per_frame=problem.steps_per_frame)
    np.testing.assert_allclose(done.trajectory.velocity, same.velocity, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(done.trajectory.contact_state, same.contact_state, rtol=0.0, atol=1e-11)
    assert done.check.velocity < 2e-3
    if physics.loaded(problem.system):  # no motion before the pulse comes
        assert not np.any(done.trajectory.displacement[:3, :, -1])


LINEAR = {"contact": WALTON, "walls": {"left": "bead", "right": {"stiffness": 2.0}}}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "changes"), [*((name, {}) for name in IN_LAMMPS | LOADED), ("walls", LINEAR)], ids=str
)
def test_the_budget_closes_beside_other_ingredients(name, changes):
    problem = in_lammps(name, **changes).problem()
    # forces of linear contacts jump in slope where they turn, which leaves an error of second order
    seen = ConservationMeter(problem).read(engine.blocks(problem, steps_per_frame=16))
    assert seen.energy_drift < (1e-4 if changes else 1e-7)


@pytest.mark.slow
def test_errors_of_lammps_fall_as_the_square_of_the_step_on_average():
    problem, errors = plastic(beads=20, duration=30.0).problem(), []
    exact = engine.run(problem, steps_per_frame=64).velocity
    for step in (0.02, 0.01, 0.005, 0.0025):
        found = engine.run(problem, scheme=VERLET, steps_per_frame=round(0.1 / step)).velocity
        errors.append(np.max(np.abs(found - exact)))
    assert np.log2(errors[0] / errors[-1]) / 3 == pytest.approx(2.0, abs=0.6)


@pytest.mark.parametrize("name", NAMES)
def test_an_interrupted_run_goes_on_bit_for_bit_in_places_velocities_and_states_of_contacts(name, tmp_path):
    case = in_lammps(name, duration=20.0)
    assert "v_memory" in deck.columns(case.problem())
    goes_on_bit_for_bit(case, tmp_path, after=500)


DIVERSE = ("walls", "column", "coupled")


def diverse(name):
    """A case without dashpots of springs, which the release of 2021 lacks."""
    return in_lammps(name, timestep=0.05, **({"damping": {"beads": 0.1}} if name == "coupled" else {}))


@pytest.mark.slow
@pytest.mark.parametrize("name", DIVERSE)
def test_two_ranks_compute_the_bits_of_one(name, tmp_path):
    one, two = (run_deck(diverse(name), tmp_path / f"{ranks}", ranks=ranks) for ranks in (1, 2))
    np.testing.assert_array_equal(two.vx, one.vx)


@pytest.mark.slow
@pytest.mark.parametrize("name", DIVERSE)
def test_the_release_of_2021_computes_the_same(name, lmp_of, tmp_path):
    new, old = (run_deck(diverse(name), tmp_path / release, executable=lmp_of(release)) for release in RELEASES)
    np.testing.assert_allclose(old.velocity, new.velocity, rtol=0.0, atol=1e-11)


@pytest.mark.slow
def test_an_analysis_has_permanent_overlaps_forces_and_a_decay_but_no_final_amplitude(tmp_path):
    case = plastic(beads=80, duration=140.0)
    done = analyse(run(case, tmp_path / "run", engine="reference").directory)
    report = json.loads((tmp_path / "run" / "analysis.json").read_text())
    assert report["equipartition"]["final"] is None
    table = np.genfromtxt(tmp_path / "run" / "plastic.csv", delimiter=",", names=True)
    assert table["force"][[0, 9, 49]] == pytest.approx([0.492414, 0.140577, 0.054380], abs=6e-7)
    assert np.sum(table["dissipated"]) == pytest.approx(0.475548, abs=6e-7)
    law = Thornton(1.0, 0.1, table["overlap"])
    np.testing.assert_allclose(table["permanent"], law.permanent(*law), atol=1e-14)
    assert report["plastic"]["dissipated"] == pytest.approx(2.0 * 0.475548, abs=2e-6)
    assert -0.6 < report["plastic"]["decay"] < -0.2
    assert done.conservation.energy_drift < 3e-8


@pytest.mark.slow
def test_forces_on_a_wall_are_the_same_from_frames_of_the_last_bead_alone():
    problem = plastic(walls={"right": "rigid"}, beads=10, duration=40.0).problem()
    whole, part = engine.run(problem), engine.run(replace(problem, rows=problem.rows.only((10,))))
    wall = gauges(problem.system, wall=True)
    np.testing.assert_array_equal(at_frames(part, wall), at_frames(whole, wall))
    assert np.max(at_frames(whole, wall)) == pytest.approx(0.2937, abs=1e-3)


def test_the_exponent_of_the_largest_forces_is_off_by_no_more_than_errors_of_forces_make_it():
    contact, chance, size = np.arange(1.0, 41.0), np.random.default_rng(3), 1e-3
    force, opened = contact**-0.4, np.ones(40, dtype=bool)
    exact, stated = power_law(force, opened), power_law(force, opened, size)
    assert exact.exponent_error < 1e-12
    for _ in range(100):
        moved = power_law(force + size * chance.choice([-1.0, 1.0], size=40), opened)
        assert abs(moved.exponent - exact.exponent) <= 1.02 * stated.exponent_error  # to first order
