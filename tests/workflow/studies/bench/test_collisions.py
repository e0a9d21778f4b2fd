import math
from pathlib import Path

import pytest

from workflow.studies.bench import engines as bench_collisions


def test_a_crowd_has_more_collisions_than_are_timed():
    for rows in (100, 1_000):
        problem = bench_collisions.crowd(rows, seed=1)
        found = bench_collisions.collisions.run(problem, max_events=bench_collisions.PER_ROW * rows)
        assert len(found) == bench_collisions.PER_ROW * rows


@pytest.mark.slow
def test_the_ratios_say_what_was_measured(monkeypatch):
    assert math.isfinite(bench_collisions.cost(bench_collisions.crowd(100), 300))
    seconds = {100: 2e-6, 1_000: 2.5e-6}
    monkeypatch.setattr(bench_collisions, "cost", lambda problem, _: seconds[problem.beads])
    monkeypatch.setattr(bench_collisions, "ROWS", tuple(seconds))
    assert bench_collisions.numpy_cost(bench_collisions.crowd(100), 10) > 0.0
    monkeypatch.setattr(bench_collisions, "numpy_cost", lambda _: 1.2e-4)
    rate, growth = bench_collisions.collision_ratios(Path())
    assert (rate.value, rate.reached) == (pytest.approx(48.0), True)
    assert (growth.value, growth.reached) == (pytest.approx(1.25), True)
    assert "1,000 rows" in growth.name
    seconds[1_000] = 4e-6
    assert [ratio.reached for ratio in bench_collisions.collision_ratios(Path())] == [False, False]
