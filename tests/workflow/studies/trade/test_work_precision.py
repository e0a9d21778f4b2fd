"""Settings measured in rounds, and what the points say; errors and costs are made up."""

import math
from dataclasses import replace

import numpy as np
import pytest

from workflow.errors import RunError
from workflow.studies.trade.work_precision import (
    Limits,
    Point,
    Setting,
    better_from,
    cheapest,
    measure,
    order,
    pairs,
    pareto,
)


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


def measured(settings, machine=None, follow=None, **limits):
    machine = machine or Machine()
    points = measure(
        settings,
        machine,
        lambda result: {"error": result[0] ** 2},
        lambda result: {"seconds": 1.0 / result[0], "call": float(result[1])},
        Limits(clock=machine.clock, **limits),
        follow,
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

    points = measure(by_step(0.5, 0.25), run, lambda _: {"error": 0.0}, lambda _: {"seconds": 1.0}, Limits(2))
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
            Limits(4),
            lambda *state: seen.append(state[0]),
        )
    assert [len(point.repeats) for point in seen[-1]] == [1, 0]
    assert all(math.isfinite(point.errors["error"]) for point in seen[-1])


# --- orders, fronts and choices ---------------------------------------------------------------------------------------


def point(error, seconds, *, step=1.0, curve="method", first=1e6):
    setting = Setting(curve, step, f"step {step:g}", 1.0 / step, None)
    return Point(setting, {"error": error}, {"seconds": first}, [{"seconds": seconds}])


def law(steps, power, factor=1.0):
    return [point(factor * step**power, 1.0 / step, step=step) for step in steps]


STEPS = [0.5**k for k in range(1, 12)]


@pytest.mark.parametrize("power", [2.0, 2.5, 4.0])
def test_a_made_up_order_is_found(power):
    found = order(law(STEPS, power), "error", 0.0)
    assert found.value == pytest.approx(power, abs=1e-12)
    assert found.spread < 1e-12


def test_errors_of_the_reference_and_of_runs_gone_bad_do_not_count():
    floor = 1e-5
    points = law(STEPS, 2.0)
    for each in points:  # what a reference that is only so sure would show
        each.errors["error"] += 0.5 * floor if each.errors["error"] < floor else 0.0
    points += [point(math.inf, 1.0, step=2.0), point(3.0, 1.0, step=1.0)]
    found = order(points, "error", floor)
    told = [step for step in STEPS if floor < step**2 < 0.1]
    assert (found.points, found.low, found.high) == (len(told), told[-1], told[0])
    assert found.value == pytest.approx(2.0, abs=1e-12)


def test_the_spread_of_an_order_is_its_standard_error():
    random = np.random.default_rng(1)
    points = law(STEPS, 2.0, 0.1)
    off = 0.2 * random.standard_normal(len(points))
    for each, by in zip(points, off, strict=True):
        each.errors["error"] *= math.exp(by)
    found = order(points, "error", 0.0)
    x = np.log(STEPS)
    design = np.stack([x, np.ones_like(x)], axis=1)
    slope, start = np.linalg.lstsq(design, np.log([each.errors["error"] for each in points]), rcond=None)[0]
    left = np.log([each.errors["error"] for each in points]) - slope * x - start
    covariance = np.linalg.inv(design.T @ design) * (left @ left) / (len(x) - 2)
    assert found.value == pytest.approx(slope, rel=1e-9)
    assert found.spread == pytest.approx(math.sqrt(covariance[0, 0]), rel=1e-9)


def test_one_step_has_no_order():
    assert order(law([0.1], 2.0), "error", 0.0) is None
    assert order([], "error", 0.0) is None


def test_the_front_is_what_no_point_beats_in_both():
    kept = [point(1e-1, 1.0), point(1e-3, 2.0), point(1e-6, 5.0)]
    beaten = [point(1e-1, 1.5), point(2e-3, 2.0), point(1e-3, 6.0), point(math.inf, 0.1)]
    assert pareto([*beaten, *reversed(kept)], "error", "seconds") == kept


def test_what_was_not_measured_is_on_no_front():
    assert pareto([Point(Setting("method", 1.0, "", 1.0, None))], "error", "seconds") == []


def test_the_cheapest_that_suffices_is_chosen_and_not_the_most_accurate():
    points = [point(1e-2, 1.0), point(1e-5, 3.0), point(5e-5, 2.0), point(1e-9, 100.0)]
    assert cheapest(points, 1e-4, "error", "seconds") is points[2]
    assert cheapest(points, 1e-10, "error", "seconds") is None


def test_the_first_call_plays_no_part_in_the_choice():
    points = [point(1e-5, 2.0, first=0.0), point(1e-5, 1.0, first=1e9)]
    assert cheapest(points, 1e-4, "error", "seconds") is points[1]


def test_an_accuracy_within_the_error_of_the_reference_is_not_reached():
    points = [point(9e-9, 1.0)]
    assert cheapest(points, 1e-8, "error", "seconds", floor=0.5e-9) is points[0]
    assert cheapest(points, 1e-8, "error", "seconds", floor=2e-9) is None


def test_a_better_scheme_wins_from_where_the_laws_cross():
    # error h**2 at a cost of 1/h, and h**4 at 10/h: equal at an error e where e**-0.5 = 10 e**-0.25, e = 1e-4
    one, two = law(np.geomspace(0.3, 1e-4, 30), 2.0), law(np.geomspace(0.5, 1e-2, 30), 4.0)
    dear = [(error, 10.0 * cost) for error, cost in pairs(two, "error", "seconds", 0.0)]
    start, low, high = better_from(dear, pairs(one, "error", "seconds", 0.0))
    # laws are straight lines in logarithms; the errors looked at are 400, equally far apart
    assert start == pytest.approx(1e-4, rel=(high / low) ** (1 / 399) - 1.0)


def test_a_scheme_that_never_wins_and_one_that_always_does_say_so():
    one, two = ([(error, factor / error) for error in (1e-2, 1e-4, 1e-6)] for factor in (1.0, 2.0))
    start, low, high = better_from(one, two)
    assert start == pytest.approx(high)
    assert better_from(two, one)[0] == 0.0
    assert (low, high) == pytest.approx((1e-6, 1e-2))


def test_curves_without_a_common_error_are_not_compared():
    assert better_from([(1e-1, 1.0), (1e-2, 2.0)], [(1e-5, 1.0), (1e-6, 2.0)]) is None
    assert better_from([(1e-1, 1.0)], [(1e-1, 1.0), (1e-6, 2.0)]) is None
