"""Cases decided on purpose: at once, grazing, resting, free, very near, very far, never."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_problems import problem, rigid_problem

from analysis.trajectory import joined
from lammps_inputs.limits.closing import never_closes
from workflow.plugins.rigid import engine as collisions
from workflow.plugins.rigid.engine import blocks, run, sample


@pytest.mark.slow
def test_both_chains_at_once_carry_the_pulse_on_without_loss():
    found = run(rigid_problem(kicks=[(1, 1, 1.0), (2, 1, 1.0)], beads=50, gap=0.7))
    assert np.array_equal(found.row, np.repeat(np.arange(1, 50), 2))
    assert sorted(found.chain[:2]) == [1, 2]
    np.testing.assert_allclose(found.time, 0.7 * found.row, rtol=1e-13)
    np.testing.assert_allclose(found.impulse, 1.0, rtol=1e-13)


@pytest.mark.slow
def test_a_coupled_bead_struck_from_both_sides_keeps_the_mirror_symmetry():
    t = sample(run(rigid_problem(2, 3, [(1, 1, 1.0), (1, 3, -1.0)], duration=3.0)), np.linspace(0.0, 3.0, 50))
    np.testing.assert_allclose(t.velocity, -t.velocity[:, :, ::-1], rtol=0, atol=1e-13)


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.sampled_from([-1.0, -0.5, 0.0, 0.5, 1.0]), min_size=6, max_size=6).filter(any),
    st.sampled_from([1e-3, 0.25, 1.0]),
)
def test_without_springs_beads_leave_sorted_after_as_many_collisions_as_inversions(v, gap):
    v = np.array(v) / np.abs(v).max()
    kicks = [(1, b + 1, float(u)) for b, u in enumerate(v) if u]
    found = run(rigid_problem(1, 6, kicks, kappa=0.0, gap=gap, duration=1000.0))
    assert len(found) == sum(v[i] > v[j] for i in range(6) for j in range(i + 1, 6))
    assert np.array_equal(joined(blocks(found)).velocity[-1, 0], np.sort(v))


@pytest.mark.slow
def test_an_exact_graze_exchanges_nothing():
    # chain 1 swings by sin(omega t) / omega and just reaches the next bead, without speed, again and again
    kicks = [(1, 1, 1.0), (2, 1, -1.0)]
    for kappa in (0.5, 0.1, 3.0):
        reach = 1.0 / math.sqrt(2.0 * kappa)
        assert len(run(rigid_problem(kicks=kicks, kappa=kappa, gap=reach * (1.0 + 1e-15), duration=1000.0))) == 0
        first = run(rigid_problem(kicks=kicks, kappa=kappa, gap=reach * (1.0 - 1e-10), duration=1000.0), max_events=1)
        assert first.impulse[0] == pytest.approx(math.sqrt(2e-10), rel=1e-4)


@pytest.mark.slow
def test_beads_that_travel_in_step_or_leave_the_row_never_meet():
    in_step = [(c, b, 1.0) for c in (1, 2) for b in range(1, 11)]
    assert len(run(rigid_problem(kicks=in_step, duration=1e6))) == 0
    found = run(rigid_problem(kicks=[(1, 10, 1.0)]))
    assert len(found) == 0
    assert joined(blocks(found)).frames == 101


@pytest.mark.slow
def test_a_contact_after_hundreds_of_quiet_periods_is_found():
    # chain 1 of a row whose centre of mass rests reaches 0.55 + 0.45 / sqrt(3) when both its modes are at their crests
    kicks = [(1, 1, 1.0), (2, 1, -0.9), (3, 1, -0.1)]
    gap = (0.55 + 0.45 / math.sqrt(3.0)) * (1.0 - 1e-6)
    problem = rigid_problem(3, 2, kicks, kappa=1.0, gap=gap, duration=1e5)
    found = run(problem, max_events=1)
    assert found.time[0] > 100.0 * 2.0 * math.pi
    assert sample(found, found.time).displacement[0, :, 0].max() == pytest.approx(gap, rel=1e-12)
    before = np.arange(0.0, found.time[0] - 1e-3, 1e-3)
    assert sample(found, before).displacement[:, :, 0].max() < gap


@pytest.mark.slow
@pytest.mark.parametrize("gap", [1e-6, 1e-300])
def test_through_a_tiny_gap_the_kick_passes_unshared(gap):
    found = run(rigid_problem(beads=101, gap=gap, duration=1.0))
    assert np.array_equal(found.row, np.arange(1, 101))
    assert set(found.chain) == {1}
    np.testing.assert_allclose(found.striker, 1.0, rtol=0, atol=1e-8)
    np.testing.assert_allclose(found.time, gap * found.row, rtol=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("gap", [1e4, 1e8])
def test_across_a_huge_gap_a_row_arrives_with_the_speed_of_its_mass(gap):
    found = run(rigid_problem(beads=3, gap=gap, duration=10 * gap), max_events=1)
    assert found.time[0] == pytest.approx(2.0 * gap, abs=2.0)
    t = found.time[0]
    assert 0.5 * (t + math.sin(t) * (1 if found.chain[0] == 1 else -1)) == pytest.approx(gap, rel=1e-15)


@pytest.mark.slow
def test_beads_of_a_refused_scene_never_meet():
    random = np.random.default_rng(0)
    refused = 0
    for _ in range(400):
        chains, kappa, gap = int(random.integers(1, 5)), random.choice([0.0, 0.1, 1.0]), random.choice([1e-3, 0.5, 3.0])
        kicks = {
            (int(random.integers(1, chains + 1)), bead): (bead - 2 or 1) * random.uniform(0.2, 1.0) for bead in (1, 3)
        }
        kicks[int(random.integers(1, chains + 1)), 2] = random.uniform(-0.3, 0.3)
        fastest = max(map(abs, kicks.values()))
        listed = tuple((chain, bead, float(velocity / fastest)) for (chain, bead), velocity in kicks.items())
        if never_closes(chains, kappa, gap, listed, 3):
            refused += 1
            times = {"timestep": 1e3, "steps_per_frame": 1, "frames": 1}
            apart = problem(chains=chains, beads=3, kicks=listed, kappa=kappa, gap=gap, **times)
            assert len(collisions.run(apart, max_events=1)) == 0
    assert 50 < refused < 400
