"""Walls at the ends of the chains: strength, symmetry, forces; the motion is in `test_every_ingredient`."""

import json
import math

import numpy as np
import pytest
from ingredient_scenes import STEEL
from plain_scene import scene

from analysis.sharing.survey import survey
from analysis.trajectory import joined
from lammps_inputs import find, library
from lammps_inputs.limits.rates import stability_bound
from workflow.cli import main
from workflow.engines.reference import engine
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.analysis_files import analyse

pytestmark = pytest.mark.usefixtures("lammps_here")


def walled(walls, **changes):
    return scene(walls=walls, **{"duration": 40.0, **changes})


@pytest.mark.slow
def test_a_weak_wall_is_reached_into_without_second_beads_meeting_it(tmp_path):
    case = walled({"right": {"stiffness": 1e-3}}, chains=1, coupling=None, beads=4, duration=60.0)
    assert case.problem().layout.diameter > 4.0
    found = run(case, tmp_path / "run")
    assert found.trajectory.displacement.max() > 8.0
    assert found.check.velocity < 5e-4


BLOCKS = {
    "steel": ({"right": {"material": "steel"}}, {"right": "flat"}, {}),
    "brass": (
        {"left": {"material": "brass"}},
        {"left": {"stiffness": 4.0 / 3.0 * math.sqrt(4.76e-3) / ((1 - 0.3**2) / 193e9 + (1 - 0.34**2) / 103e9)}},
        {},
    ),
    "softer bead": (
        {"right": {"material": "steel"}},
        {"right": {"stiffness": 4.0 / 3.0 * math.sqrt(2e-3) / ((1 - 0.3**2) / 193e9 + (1 - 0.46**2) / 1.46e9)}},
        {"kinds": {"end": {"material": "ptfe", "radius": 2e-3}}, "replace": {"bead": 20, "kind": "end"}},
    ),
}


@pytest.mark.parametrize("block", BLOCKS)
def test_a_block_of_a_material_is_that_of_hertz(block):
    walls, same, changes = BLOCKS[block]
    base = {"name": "a", "beads": 20, "kick": {"velocity": 1.0}, "duration": 1e-4, **changes}
    base |= {"material": {"name": "steel", "radius": 4.76e-3}}
    found, given = (library.from_plain(base | {"walls": one}, "").system for one in (walls, same))
    strengths = [np.asarray(system.walls[0].law.strength) for system in (found, given)]
    assert strengths[0] == pytest.approx(strengths[1], rel=1e-12)
    assert strengths[0].max() > 0.0


@pytest.mark.parametrize("exponent", [1.5, 2.0])
def test_a_wall_like_a_bead_needs_no_shorter_steps_and_one_of_a_hundred_does(exponent):
    plain, bead, hard = (
        stability_bound(walled(walls, contact={"exponent": exponent}).system)
        for walls in (None, {"right": "bead"}, {"right": {"stiffness": 100.0}})
    )
    assert plain == bead > hard


def test_a_wall_like_a_bead_is_the_middle_of_a_chain_hit_from_both_ends():
    """Two pulses that meet head on see a contact of twice the strength sqrt(2): half of the overlap for each bead."""
    half = walled({"right": {"stiffness": 2.0**1.5}}, chains=1, coupling=None).problem()
    whole = walled(
        None,
        chains=1,
        coupling=None,
        beads=24,
        kick=[{"velocity": 1.0}, {"bead": 24, "velocity": -1.0}],
    ).problem()
    one, both = (engine.run(problem, steps_per_frame=200).velocity[:, 0, :12] for problem in (half, whole))
    np.testing.assert_allclose(one, both, atol=1e-9)


@pytest.mark.slow
def test_the_wave_that_leads_and_its_verdict_do_not_know_of_the_wall_it_comes_to():
    free, held = (
        walled(walls, beads=60, duration=110.0, output={"every": 0.2}).problem() for walls in (None, {"right": "bead"})
    )
    found = [survey(lambda problem=problem: iter([engine.run(problem)]), problem) for problem in (free, held)]
    before = [one.waves.where(one.waves.bead <= 55) for one in found]
    np.testing.assert_array_equal(before[0].peak_velocity, before[1].peak_velocity)
    np.testing.assert_array_equal(before[0].arrival, before[1].arrival)
    assert found[0].verdict == found[1].verdict
    back = [pulse for pulse in found[1].pulses if pulse.direction < 0 and pulse.bead[0] > 50]
    assert {pulse.chain for pulse in back} == {1, 2}
    assert not any(found[1].leads(pulse) for pulse in back)


def test_what_a_wall_behind_the_hit_bead_throws_back_does_not_lead():
    problem = walled({"left": "bead"}, chains=1, coupling=None, beads=60, kick={"bead": 20, "velocity": 1.0}).problem()
    found = survey(lambda: iter([engine.run(problem.coarser(1))]), problem)
    assert found.waves.bead.min() == 20


@pytest.mark.slow
def test_the_installed_scene_shows_the_known_numbers_through_lammps(tmp_path, draw_only):
    """Wall over bulk force 1.75040, reflected over incident velocity 0.9998."""
    found = run(find("wall-reflection"), tmp_path / "run")
    draw_only("forces")
    analysed = analyse(found.directory)
    assert "forces.png" in {path.name for path in analysed.figures}
    wall, contact, sensor = json.loads((tmp_path / "run" / "analysis.json").read_text())["forces"]
    error = 4.0 * found.check.amplitude
    assert wall["largest"] / contact["largest"] == pytest.approx(1.75040, abs=error + 5e-6)
    assert contact["largest"] == pytest.approx(0.63955, abs=error + 5e-6)
    reflected = wall["reflected"]
    assert reflected["ratio"] == pytest.approx(0.99977, abs=reflected["uncertainty"] + 1e-5)
    # of two peaks of 0.68 V: the reflected one does not lead, so that it has the error of all velocities
    assert reflected["uncertainty"] < (error + 2.0 * found.check.velocity) / 0.68
    assert (wall["kind"], contact["kind"], sensor["kind"]) == ("wall", "contact", "sensor")
    assert contact["reflected"] is None


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "ratio"), [("flat", 1.94390), ({"stiffness": 100.0}, 1.86245)], ids=str)
def test_harder_walls_feel_the_known_forces_through_lammps(tmp_path, kind, ratio):
    output = {"every": 0.05, "forces": {"wall": True, "contacts": [30]}}
    case = walled({"right": kind}, chains=1, coupling=None, beads=60, duration=80.0, timestep=0.0025, output=output)
    found = run(case, tmp_path / "run")
    readings = analyse(found.directory, figures=False).measurements["forces"].readings
    wall, contact = readings.largest[0]
    # an error of the last bead's velocity, for the time in which it is stopped, over its way: as large a part of both
    assert wall / contact == pytest.approx(ratio, abs=4.0 * found.check.velocity + 2e-5)


def test_forces_are_written_in_newtons(tmp_path, capsys):
    output = {"every": 1e-6, "forces": {"wall": True, "contacts": [3]}}
    case = walled({"right": "bead"}, material=STEEL, coupling=None, duration=3e-4, output=output)
    run(case, tmp_path / "run", check=False)
    assert main(["analyze", str(tmp_path / "run"), "--no-figures"]) == 0
    header, *rows = (tmp_path / "run" / "forces.csv").read_text().splitlines()
    assert header.split(",")[:3] == ["time (s)", "right wall chain 1 (N)", "right wall chain 2 (N)"]
    wall = np.array([float(row.split(",")[1]) for row in rows])
    bead = joined(RunDirectory(tmp_path / "run").blocks()).displacement[:, 0, -1]
    constant = STEEL["youngs_modulus"] * math.sqrt(2.0 * STEEL["radius"]) / (3.0 * (1.0 - 0.3**2))
    metres = np.maximum(bead, 0.0) * case.scale.length
    np.testing.assert_allclose(wall, constant * metres**1.5, rtol=1e-12)
    assert "forces.csv" in capsys.readouterr().out
