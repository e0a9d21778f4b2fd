"""Settings measured in rounds, with errors and costs that are made up."""

import math
from dataclasses import replace

import pytest

from workflow.errors import RunError
from workflow.studies.trade.work_precision import Setting, measure


class Machine:
    """Runs that take a made-up time on a clock of their own; the first call of each setting takes 10 more."""

    def __init__(self):
        self.now = 0.0
        self.calls = []

    def __call__(self, step):
        self.now += 1.0 / step + (10.0 if step not in self.calls else 0.0)
        self.calls.append(step)
        return step, self.calls.count(step)

    def clock(self):
        return self.now


def by_step(*steps, curve="method"):
    return [Setting(curve, step, f"step {step}", 1.0 / step, step) for step in steps]


def measured(settings, machine=None, **options):
    machine = machine or Machine()
    points = measure(
        settings,
        machine,
        lambda result: {"error": result[0] ** 2},
        lambda result: {"seconds": 1.0 / result[0], "call": float(result[1])},
        clock=machine.clock,
        **options,
    )
    return points, machine


def test_the_first_call_gives_the_error_and_stands_apart_from_the_repeats():
    (point,), _ = measured(by_step(0.5), repeats=3)
    assert point.errors == {"error": 0.25}
    assert point.first["call"] == 1.0
    assert point.costs("call") == [2.0, 3.0, 4.0]
    assert point.cost("call") == 3.0


def test_rounds_take_every_setting_in_turn():
    _, machine = measured(by_step(0.5, 0.25), repeats=2)
    assert machine.calls == [0.5, 0.25] * 3


def test_without_repeats_the_first_call_is_what_there_is():
    (point,), _ = measured(by_step(0.5), repeats=0)
    assert point.cost("call") == 1.0


def test_what_would_take_too_long_by_its_effort_is_not_run():
    # calls take 10 and 1 / step: 11, 12, and by these two 14 at a quarter of the step, 18 at an eighth
    points, machine = measured(by_step(1.0, 0.5, 0.25, 0.125), repeats=0, longest=13.0)
    assert machine.calls == [1.0, 0.5]
    assert [point.left_out for point in points] == ["", "", "would take 14 s", "would take 18 s"]


def test_the_time_of_one_setting_alone_is_a_lower_bound_for_those_of_more_effort():
    _, machine = measured(by_step(0.5, 0.25), repeats=0, longest=11.0)
    assert machine.calls == [0.5]
    _, machine = measured(by_step(0.5, 0.25), repeats=0, longest=12.5)
    assert machine.calls == [0.5, 0.25]


@pytest.mark.parametrize(("group", "there"), [("program", False), ("another", True)])
def test_other_curves_of_a_group_tell_how_long_a_setting_takes(group, there):
    more = [replace(setting, group=group) for setting in by_step(0.25, curve="other")]
    less = [replace(setting, group="program") for setting in by_step(1.0, 0.5)]
    points, _ = measured([*less, *more], repeats=0, longest=13.0)
    assert points[-1].measured is there


def test_nothing_is_repeated_beyond_the_budget():
    points, _ = measured(by_step(1.0, 0.5), repeats=5, budget=0.0)
    assert [len(point.repeats) for point in points] == [0, 0]


def test_a_setting_that_takes_long_is_repeated_once_and_then_not_again():
    points, _ = measured(by_step(10.0, 0.01), repeats=5, patience=50.0)
    assert [len(point.repeats) for point in points] == [5, 1]


def test_a_run_that_fails_is_noted_and_the_others_go_on():
    machine = Machine()

    def run(step):
        if step == 0.5:
            raise RunError("it blew up")
        return machine(step)

    points = measure(by_step(0.5, 0.25), run, lambda _: {"error": 0.0}, lambda _: {"seconds": 1.0}, repeats=2)
    assert [point.left_out for point in points] == ["it blew up", ""]
    assert [point.measured for point in points] == [False, True]


def test_progress_counts_to_its_total_also_where_calls_are_left_out():
    seen = []
    measured(
        by_step(10.0, 0.01, 0.0001),
        repeats=4,
        patience=50.0,
        longest=1e3,
        follow=lambda _, done, total: seen.append((done, total)),
    )
    assert [done for done, _ in seen] == sorted(done for done, _ in seen)
    assert seen[-1][0] == seen[-1][1]


def test_an_interruption_leaves_the_points_with_who_follows():
    machine, seen = Machine(), []

    def run(step):
        if len(machine.calls) == 3:
            raise KeyboardInterrupt
        return machine(step)

    with pytest.raises(KeyboardInterrupt):
        measure(
            by_step(0.5, 0.25),
            run,
            lambda result: {"error": result[0] ** 2},
            lambda _: {"seconds": 1.0},
            repeats=4,
            follow=lambda *state: seen.append(state[0]),
        )
    assert [len(point.repeats) for point in seen[-1]] == [1, 0]
    assert all(math.isfinite(point.errors["error"]) for point in seen[-1])
