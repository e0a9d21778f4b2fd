"""The benchmark of collisions: it counts those that it times, and its ratios say what was measured."""

import pytest
import ratios

from workflow.plugins.rigid import engine as collisions


def test_a_crowd_has_more_collisions_than_are_timed():
    for rows in (100, 1_000):
        found = collisions.run(ratios.crowd(rows, seed=1), max_events=ratios.PER_ROW * rows)
        assert len(found) == ratios.PER_ROW * rows


@pytest.mark.slow
def test_ratios_of_collisions_say_what_was_measured(tmp_path, monkeypatch):
    monkeypatch.setattr(ratios, "EVENTS", 300)
    collisions.run(ratios.crowd(100), max_events=1)  # compiled before any clock runs
    assert ratios.collision_seconds(100) > 0.0
    assert ratios.force_seconds(ratios.crowd(100), 10) > 0.0
    seconds = {100: 2e-6, 1_000: 2.5e-6}
    monkeypatch.setattr(ratios, "collision_seconds", seconds.get)
    monkeypatch.setattr(ratios, "COLLISION_ROWS", tuple(seconds))
    monkeypatch.setattr(ratios, "force_seconds", lambda _: 1.2e-4)
    rate, growth = ratios.collision_ratios(tmp_path)
    assert (rate.value, rate.reached) == (pytest.approx(48.0), True)
    assert (growth.value, growth.reached) == (pytest.approx(1.25), True)
    assert "1,000 rows" in growth.name
    seconds[1_000] = 4e-6
    assert [ratio.reached for ratio in ratios.collision_ratios(tmp_path)] == [False, False]
