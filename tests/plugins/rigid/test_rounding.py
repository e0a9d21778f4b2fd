"""Collisions that follow rounding are marked, and no others."""

import math

import numpy as np
import pytest
from small_problems import rigid_problem

from workflow.plugins.rigid.engine import run
from workflow.plugins.rigid.rounding import by_rounding


@pytest.mark.slow
@pytest.mark.parametrize(("n", "kappa"), [(1, 0.1), (2, 3.0), (3, 0.5), (4, 0.1), (7, 3.0)])
def test_at_multiples_of_half_pi_the_unmarked_collisions_are_those_of_the_exact_orbit(n, kappa):
    """The row's distance sin(omega t) V / 2 omega is 0 as bead k meets bead k + 1, at t = 2 k D / V, with all of V."""
    gap = n * math.pi / 2.0 / math.sqrt(2.0 * kappa)
    found = run(rigid_problem(beads=12, kappa=kappa, gap=gap, duration=40.0 * gap))
    marked = by_rounding(found)
    assert 4 <= found.row[marked.first] <= 6  # 1e-15 to the power (1/3)^k: 1e-2 V after four rows
    sure = ~marked.collisions
    row = found.row[sure]
    assert np.array_equal(row, np.arange(1, len(row) + 1))
    assert len(row) >= 3
    assert np.array_equal(found.chain[sure], np.ones(len(row)) if n % 2 == 0 else 2 - (row + 1) % 2)
    np.testing.assert_allclose(found.time[sure], 2.0 * row * gap, rtol=1e-3)
    np.testing.assert_allclose(found.impulse[sure], 1.0, atol=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("chains", [2, 3])
@pytest.mark.parametrize("theta", [0.5, math.pi / 2.0, 2.0, math.pi * (1.0 - 1e-14), 5.0])
def test_unmarked_collisions_do_not_depend_on_the_last_digits_of_the_coupling(theta, chains):
    kappa, gap = 0.5, theta
    found, other = (
        run(rigid_problem(chains, 12, kappa=kappa * factor, gap=gap, duration=100.0 * gap))
        for factor in (1.0, 1.0 + 2.0**-52)
    )
    sure = np.flatnonzero(~by_rounding(found).collisions)
    assert len(sure) >= 3
    for k in sure:
        same = (other.chain == found.chain[k]) & (other.row == found.row[k])
        apart = np.abs(other.impulse - found.impulse[k]) + np.abs(other.time - found.time[k]) * found.impulse[k] / gap
        assert apart[same].min() < 0.01  # tenfold the mark's


@pytest.mark.slow
@pytest.mark.parametrize(
    "changes",
    [
        {"gap": math.pi + 1e-9},
        {"gap": 0.3},
        {"gap": 0.7, "kicks": [(1, 1, 1.0), (2, 1, 1.0)]},
        {"gap": 1e4, "kappa": 0.0},
        {"gap": 1.0, "kicks": [(1, 10, 1.0)]},  # no collision
    ],
)
def test_no_collision_is_marked_where_the_scene_determines_all(changes):
    found = run(rigid_problem(kicks=changes.pop("kicks", ((1, 1, 1.0),)), duration=30.0 * changes["gap"], **changes))
    marked = by_rounding(found)
    assert marked.first is None
    assert not marked.collisions.any()


@pytest.mark.slow
def test_in_a_long_run_of_many_collisions_the_mark_is_that_of_a_short_one():
    long, short = (run(rigid_problem(beads=200, gap=0.5, duration=duration)) for duration in (1500.0, 200.0))
    stride = -(-len(long) // 4096)
    assert stride > 1
    marks = by_rounding(long).first, by_rounding(short).first
    assert marks[1] - stride < marks[0] <= marks[1]
