"""Walls at the ends of the chains: strength, symmetry, forces; the motion is in `test_every_ingredient`."""

import json
import math

import numpy as np
import pytest
from plain_scene import one_chain

from lammps_inputs import find
from lammps_inputs.limits.rates import stability_bound
from workflow.engines.reference import engine
from workflow.runs.run import run
from workflow.verdicts.analysis_files import analyse

pytestmark = pytest.mark.usefixtures("lammps_here")


def walled(walls, **changes):
    return one_chain(walls=walls, **{"duration": 40.0, **changes})


@pytest.mark.slow
def test_a_weak_wall_is_reached_into_without_second_beads_meeting_it(tmp_path):
    case = walled({"right": {"stiffness": 1e-3}}, beads=4, duration=60.0)
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
    steel = {"beads": 20, "material": {"name": "steel", "radius": 4.76e-3}, "duration": 1e-4, "output": None}
    found, given = (walled(one, **steel, **changes).system for one in (walls, same))
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
    half = walled({"right": {"stiffness": 2.0**1.5}}).problem()
    whole = walled(None, beads=24, kick=[{"velocity": 1.0}, {"bead": 24, "velocity": -1.0}]).problem()
    one, both = (engine.run(problem, steps_per_frame=200).velocity[:, 0, :12] for problem in (half, whole))
    np.testing.assert_allclose(one, both, atol=1e-9)


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
    case = walled({"right": kind}, beads=60, duration=80.0, timestep=0.0025, output=output)
    found = run(case, tmp_path / "run")
    readings = analyse(found.directory, figures=False).measurements["forces"].readings
    wall, contact = readings.largest[0]
    # an error of the last bead's velocity, for the time in which it is stopped, over its way: as large a part of both
    assert wall / contact == pytest.approx(ratio, abs=4.0 * found.check.velocity + 2e-5)


ABSORBING = {"matched": ("matched", 1.0), "soft": ({"damping": 0.5}, 0.25), "hard": ({"damping": 6.0}, 3.0)}
"""Ends of a bar with Z = sqrt(k m) = 2, and c / Z."""


@pytest.mark.slow
@pytest.mark.parametrize(("end", "side"), [("matched", "right"), ("soft", "left"), ("hard", "right")])
def test_a_dashpot_at_the_end_of_a_bonded_bar_reflects_what_is_exact_for_waves_of_any_length(end, side):
    """R = (e^(-iq/2) - c/Z) / (e^(iq/2) + c/Z) for q radians a bead, from m u'' = k (u_N-1 - u_N) - c u'."""
    kind, g = ABSORBING[end]
    beads, middle = 160, 80
    moments = np.arange(41.0)
    table = np.stack([moments, 1e-3 * np.exp(-0.5 * ((moments - 20.0) / 3.0) ** 2)], axis=1)
    table[[0, -1], 1] = 0.0
    push = {"bead": 1 if side == "right" else beads, "table": table.tolist()}
    bonded = {"contact": {"force": "k*s", "k": 4, "tension": "allowed"}, "output": {"every": 0.125}}
    case = walled({side: kind}, beads=beads, kick=None, push=push, duration=175.0, **bonded)
    motion = engine.run(case.problem(), steps_per_frame=8)
    time = motion.time * case.scale.time
    velocity = motion.velocity[0:, 0, middle - 1 if side == "right" else beads - middle]
    omega = np.array([0.1, 0.2, 0.4, 0.6, 0.8])  # of at most 2 sqrt(k / m) = 4
    q = 2.0 * np.arcsin(omega / 4.0)
    waves = np.exp(-1j * omega[:, np.newaxis] * time)
    came, left = (np.sum(waves * velocity * now, axis=1) for now in (time < 100.0, time >= 100.0))
    exact = (np.exp(-0.5j * q) - g) / (np.exp(0.5j * q) + g) * np.exp(-2j * q * (beads - middle))
    np.testing.assert_allclose(left / came, exact, atol=1e-8)
    if end == "matched":
        np.testing.assert_allclose(np.abs(exact), np.tan(q / 4.0), rtol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "stiffness"),
    [
        ({"precompression": {"force": 0.3}}, 1.5 * 0.3 ** (1.0 / 3.0)),
        ({"precompression": {"force": 0.3}, "contact": {"exponent": 2.0}}, 2.0 * 0.3**0.5),
        ({"contact": {"exponent": 1.0}}, 1.0),
        ({"contact": {"force": "a*s+b*s^3", "a": 0.7, "b": 1.0, "tension": "allowed"}}, 0.7),
    ],
    ids=["Hertz", "exponent 2", "exponent 1", "formula"],
)
def test_matched_is_the_root_of_stiffness_at_rest_times_mass_of_the_last_bead(changes, stiffness):
    heavy = {"kinds": {"heavy": {"mass": 3.0, "radius": 1.0}}, "replace": {"bead": 20, "kind": "heavy"}}
    case = walled({"right": "matched"}, beads=20, **changes, **heavy)
    [damper] = case.problem().system.dampers
    unit = case.scale.force / case.scale.velocity
    assert damper.law.coefficient[0, -1] * unit == pytest.approx(math.sqrt(3.0 * stiffness), rel=1e-12)
    assert not np.any(damper.law.coefficient[:, :-1])


@pytest.mark.slow
def test_what_a_matched_end_takes_is_all_the_energy_of_a_long_push(tmp_path):
    """LAMMPS: of a push of 20 T in a loaded chain a share below 1e-2 is left, and the balance is closed."""
    push, pressed = {"peak": 0.01, "duration": 20.0, "shape": "half-sine"}, {"force": 1.0}
    case = walled({"right": "matched"}, beads=50, kick=None, push=push, precompression=pressed, duration=120.0)
    found = run(case, tmp_path / "run")
    account = analyse(found.directory, figures=False).measurements["budget"].values
    taken = account.losses["dissipated in right end"][-1]
    assert taken / account.energy_input[-1] == pytest.approx(1.0, abs=1e-2)
    assert account.closed < 1e-4
