"""Chains on a foundation: a published beat, and the analysis; the motion is in `test_every_ingredient`."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plain_scene import scene

from analysis.shape.unit_cell import NoDispersionError, cell_of
from analysis.sharing.energies import MOST_CHAINS, FlowMeter, has_modes
from analysis.trajectory import Trajectory
from lammps_inputs import find, physics
from lammps_inputs.laws.spring import Varying
from lammps_inputs.limits import rates
from workflow.engines.reference import engine
from workflow.quantities.evaluate import of_scene

pytestmark = pytest.mark.usefixtures("lammps_here")


@pytest.mark.slow
def test_the_energy_beats_between_two_chains_as_published_numbers_say():
    """k_f = 1, kappa = 0.1, V = 0.1: chain 2 has 0.995 of the energy at t = 34.5, and 0.013 at t = 69."""
    problem = find("beats-on-a-foundation").problem()
    found = FlowMeter(problem).read(engine.blocks(problem))
    time = found.time * problem.scale.time
    assert np.interp([34.5, 69.0], time, found.share[:, 1]) == pytest.approx([0.995, 0.013], abs=5e-4)
    assert np.sum(found.share, axis=1) == pytest.approx(1.0, abs=1e-14)


MODULATED = {"stiffness": 0.3, "modulation": {"depth": 0.5, "frequency": 0.1}}
CROSSING = [{"from": 0.6, "to": 1.4, "times": [1.37, 7.63]}, {"from": 1.4, "to": 0.6, "times": [1.37, 7.63]}]


def test_the_time_step_is_bounded_by_the_largest_stiffness_over_time():
    largest = 200.0 * 1.5
    modulated, constant = ({"stiffness": 200.0, "modulation": MODULATED["modulation"]}, {"stiffness": largest})
    bounds = [rates.stability_bound(scene(foundation=keys).system) for keys in (modulated, constant)]
    assert bounds[0] == pytest.approx(bounds[1], rel=0.01)
    ramp = scene(foundation={"stiffness": {"from": 1.0, "to": largest, "times": [0, 9]}})
    assert rates.stability_bound(ramp.system) == bounds[0]


LAYOUT = scene().problem().layout


def stiffness_in_deck(law, steps, timestep):
    """What LAMMPS evaluates at some steps."""
    lines = law.ground("foundation", LAYOUT)
    number = float(lines.variables[0].split()[3])
    formula = next(line.split(maxsplit=3)[3] for line in lines.motion if line.startswith("variable foundation_now"))
    return eval(f"lambda step, v_foundation, v_timestep: {formula}")(steps, number, timestep)


RAMP = st.tuples(st.floats(1e-2, 10.0), st.floats(-5.0, 1e3), st.floats(1e-6, 1e3))


@pytest.mark.slow
@settings(max_examples=80, derandomize=True, database=None)
@given(RAMP, st.sampled_from([0.0, 5e-324, 1e-20, 1e-10, 1e-3]), st.booleans())
def test_no_ramp_to_or_from_nearly_0_is_negative_by_rounding_in_lammps(ramp, least, falling):
    largest, begin, lasts = ramp
    ends, end = ((largest, least) if falling else (least, largest)), begin + lasts
    law = Varying(ends[0], (ends[1] - ends[0]) / (end - begin), begin, end, 0.0, 0.0, 0.0)
    near = [round(100.0 * (begin + part * lasts)) + more for part in (0.0, 0.3, 0.9, 1.0) for more in range(-2, 3)]
    steps = np.array([step for step in near if step >= 0] + list(range(0, 10**12, 10**12 // 37)), dtype=np.float64)
    stiffness, time = stiffness_in_deck(law, steps, 0.01), 0.01 * steps
    assert np.min(stiffness) >= 0.0
    rounding = 1e-12 * largest + 4.0 * abs(law.rate) * np.spacing(time + abs(begin) + lasts)
    np.testing.assert_array_less(np.abs(stiffness - np.interp(time, [begin, end], ends)), rounding)


def test_modes_have_shares_of_the_action_where_no_contact_is_loaded():
    """Half way the chains are alike; they move by 0.3 and 0.1, so by 0.4 and 0.2 over sqrt(2) in the modes."""
    problem = scene(foundation={"stiffness": CROSSING}).problem()
    shape = (1, problem.chains, problem.beads)
    displacement = np.broadcast_to([[[0.3], [0.1]]], shape).copy()
    flow = FlowMeter(problem).read([Trajectory(problem, np.array([4.5]), displacement, np.zeros(shape))])
    slow, fast = 0.08 * 1.0, 0.02 * np.sqrt(1.0 + 2.0 * physics.kappa(problem.system))
    assert flow.action == pytest.approx(np.array([[slow, fast]]) / (slow + fast))
    assert flow.fastest_mode_action == pytest.approx(fast / (slow + fast))
    displacement[0, 0, 3] += 0.01
    loaded = FlowMeter(problem).read([Trajectory(problem, np.array([4.5]), displacement, np.zeros(shape))])
    assert np.isnan(loaded.fastest_mode_action)


@pytest.mark.parametrize(
    ("keys", "known"),
    [
        ({"foundation": {"stiffness": CROSSING}}, True),
        ({"foundation": {"stiffness": 0.3}}, False),
        ({"foundation": {**MODULATED, "stiffness": {"from": 0.3, "to": 0.6, "rows": [1, 6]}}}, False),
        ({"foundation": MODULATED, "chains": 1, "coupling": None}, False),
        ({"foundation": MODULATED, "precompression": {"force": 0.3}}, False),
        ({"foundation": MODULATED, "chains": MOST_CHAINS}, True),
        ({"foundation": MODULATED, "chains": MOST_CHAINS + 1}, False),
    ],
    ids=["over time", "constant", "along the chains", "one chain", "loaded", "most chains", "too many chains"],
)
def test_modes_are_those_of_rows_that_are_alike_whose_springs_change_in_time(keys, known):
    assert has_modes(scene(**keys).system) == known


def test_sound_on_springs_that_vary_has_no_dispersion():
    pressed = {"precompression": {"force": 0.3}}
    assert cell_of(scene(foundation={"stiffness": 0.3}, **pressed).system).beads == 1
    with pytest.raises(NoDispersionError, match="springs to the ground vary in time"):
        cell_of(scene(foundation=MODULATED, **pressed).system)


@pytest.mark.slow
def test_the_share_of_the_action_that_stays_is_a_quantity_of_studies():
    """That of the installed scene is the formula's, but for a start that is no pure mode."""
    share = of_scene(find("landau-zener").plain(), ("fastest_mode_action",), "landau-zener")["fastest_mode_action"]
    coupling, rate, sweep = 0.03, 1.6 / 320.0, 0.8
    stays = math.exp(-math.pi * coupling**2 / (math.sqrt(1.0 + coupling) * rate))
    assert share == pytest.approx(stays, abs=2.0 * coupling / sweep * math.sqrt(stays * (1.0 - stays)))
