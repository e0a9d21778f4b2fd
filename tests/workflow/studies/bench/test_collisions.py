import math

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
    rate, growth = bench_collisions.collision_ratios()
    assert rate.value > 0.0
    assert rate.reached == (rate.value >= bench_collisions.RATE)
    assert growth.value >= 1.0
    assert growth.reached == (growth.value <= 1.3)
    assert "1,000 rows" in growth.name
    seconds[1_000] = 4e-6
    assert [ratio.reached for ratio in bench_collisions.collision_ratios()] == [False, False]
