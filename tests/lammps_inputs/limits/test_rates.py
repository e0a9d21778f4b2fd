"""How fast anything can move, by hand; and the bounds on time steps that follow."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from plain_scene import one_chain
from small_problems import system as pair

from lammps_inputs import Scene, System, laws
from lammps_inputs.laws.contact import Hertz
from lammps_inputs.limits import rates
from lammps_inputs.scene import DEFAULT_ACCURACY
from workflow.engines.reference import engine
from workflow.engines.reference.schemes import SUZUKI4, VERLET
from workflow.engines.reference.step_halving import accurate_reference

TIED = {"chains": 2, "coupling": {"stiffness": 0.1}}

LIGHT = {"kinds": {"light": {"mass": 0.25}}, "replace": {"bead": 3, "kind": "light"}}


def scene(**keys: Any) -> Scene:
    return one_chain(**{"beads": 6, "duration": 10.0, "output": None, **keys})


def system(**keys: Any) -> System:
    return scene(**keys).system


@pytest.mark.parametrize(
    ("keys", "square"),
    [
        ({}, 4.0),  # in units of k = 3/2 F0^(1/3)
        ({"walls": {"right": {"stiffness": 100.0}}}, 2.0 + 100.0 ** (2.0 / 3.0)),  # k of a contact is as A^(2/3)
        (LIGHT, 4.0 / 0.25),
    ],
)
def test_sound_is_bounded_by_contacts_and_walls_on_either_side_of_a_bead(keys: dict[str, Any], square: float) -> None:
    loaded = system(precompression={"force": 8.0}, **keys)
    assert rates.sound_frequency(loaded) ** 2 == pytest.approx(square * 3.0, rel=1e-9)


def test_a_swing_is_that_of_springs_and_sound_together() -> None:
    assert rates.modal_frequency(system(**TIED)) ** 2 == pytest.approx(2.0 * 0.1)
    held = {**TIED, "foundation": {"stiffness": 0.5}}
    assert rates.modal_frequency(system(**held)) ** 2 == pytest.approx(2.0 * 0.1 + 0.5)
    assert rates.modal_frequency(system(**held, precompression={"force": 8.0})) ** 2 == pytest.approx(0.7 + 12.0)


@pytest.mark.parametrize(
    ("damping", "keys", "rate"),
    [
        ({"beads": 0.3}, {}, 0.3),
        ({"beads": 0.3}, LIGHT, 0.3 / 0.25),
        ({"coupling": 0.3}, TIED, 2.0 * 0.3),
        ({"beads": 0.1, "coupling": 0.3}, TIED, 0.1 + 2.0 * 0.3),
        ({"contact": 0.3}, {}, 4.0 * 0.3),
        ({"contact": 0.3}, LIGHT, 4.0 * 0.3 / 0.25),
    ],
)
def test_drag_is_that_of_the_lightest_bead_against_all_beside_it(
    damping: dict[str, Any], keys: dict[str, Any], rate: float
) -> None:
    assert rates.drag(system(damping=damping, **keys)) == pytest.approx(rate)


def test_nothing_is_faster_than_a_drive() -> None:
    """At V = 1 the unit of time is V**-0.2."""
    turn = 2.0 * math.pi * 100.0
    driven = system(kick=None, drive={"displacement": 0.1, "frequency": 100.0})
    assert rates.fastest(driven) == pytest.approx(turn * (0.1 * turn) ** -0.2)


@pytest.mark.slow
@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=12), st.integers(1, 5), st.floats(0.0, 100.0))
def test_no_overlaps_of_this_energy_vibrate_faster_than_the_bound(shares, chains, kappa):
    total = 0.5
    energies = total * np.array(shares) / max(1.0, sum(shares))
    slopes = laws.stiffness(Hertz(), (2.5 * energies) ** 0.4)
    along = np.diff(np.eye(len(slopes) + 1), axis=0)
    across = np.diff(np.eye(chains), axis=0)
    hessian = np.kron(np.eye(chains), along.T @ (slopes[:, None] * along))
    hessian += kappa * np.kron(across.T @ across, np.eye(len(slopes) + 1))
    fastest = math.sqrt(max(np.linalg.eigvalsh(hessian)[-1], 0.0))
    assert fastest * rates.stability_bound(pair(total, kappa, chains)) <= 2.0 + 1e-12


def test_the_bound_is_that_of_the_notes():
    """omega_max^2 = 6 sqrt(overlap_max) + kappa lambda_max, 0.4 overlap_max^2.5 = energy."""
    overlap = (0.5 / 0.4) ** 0.4
    assert rates.stability_bound(pair(0.5, 0.1, 2)) == pytest.approx(2 / math.sqrt(6 * overlap**0.5 + 0.2), rel=1e-14)


@pytest.mark.parametrize(
    "keys",
    [
        {"contact": {"exponent": 3.0}},
        {"kinds": {"light": {"mass": 1e-3}}, "replace": {"bead": 3, "kind": "light"}},
        {"damping": {"contact": 0.1}},
    ],
    ids=["harder", "unlike", "damped"],
)
def test_the_step_is_shorter_where_contacts_are_harder_or_damped_or_beads_differ(keys):
    own, other = (scene(**more).problem().timestep for more in ({}, keys))
    assert other < 0.8 * own


@pytest.mark.slow
@pytest.mark.parametrize("table", [VERLET, SUZUKI4], ids=lambda table: table.name)
@pytest.mark.parametrize("kappa", [1.01, 100.0])
@pytest.mark.parametrize("chains", [2, 3])
def test_the_rule_keeps_the_default_accuracy_where_springs_are_stiff(kappa, chains, table):
    stiff = scene(chains=chains, coupling={"stiffness": kappa}, duration=200.0, scheme=table.name)
    problem = stiff.problem()
    cycles = problem.steps_per_frame // len(table.drifts)
    runs = engine.blocks(problem, scheme=table, steps_per_frame=cycles)
    right = accurate_reference(problem, 1e-5).blocks()
    assert max(np.abs(a.velocity - b.velocity).max() for a, b in zip(runs, right, strict=True)) < DEFAULT_ACCURACY


@pytest.mark.slow
@given(st.floats(1e-10, 0.1), st.floats(1.0, 1e5), st.floats(0.0, 1e4), st.integers(1, 100))
def test_steps_are_at_most_half_the_bound_and_shorter_for_more_accuracy_time_and_stiffness(
    accuracy, duration, kappa, chains
):
    for scheme in ("verlet", "suzuki4"):
        step = rates.timestep_for(accuracy, duration, pair(0.5, kappa, chains), scheme)
        assert step <= rates.stability_bound(pair(0.5, kappa, chains)) / 2.0
        assert 0.0 < rates.timestep_for(accuracy / 2.0, duration, pair(0.5, kappa, chains), scheme) <= step
        assert rates.timestep_for(accuracy, 2.0 * duration, pair(0.5, kappa, chains), scheme) <= step
        assert rates.timestep_for(accuracy, duration, pair(0.5, 2.0 * kappa, chains), scheme) <= step


def test_velocity_verlet_needs_ten_times_the_steps_for_a_hundredth_of_the_error():
    few, many = (rates.timestep_for(accuracy, 192.0, pair(0.5, 0.1, 2)) for accuracy in (1e-3, 1e-5))
    assert few / many == pytest.approx(10.0, rel=1e-12)
