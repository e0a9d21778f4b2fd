"""Settings measured in rounds, and what the points say; errors and costs are made up."""

import math
from dataclasses import replace

import numpy as np
import pytest
from small_problems import problem

from workflow.errors import RunError
from workflow.studies.trade.points import Findings, Limits, Point, cheapest, measure, order, pareto
from workflow.studies.trade.settings import RANKS, Setting

OWN = problem()


def by_step(*steps, method="LAMMPS verlet"):
    """Settings of so many steps; their effort."""
    return [Setting(method, 1.0 / n, replace(OWN, timestep=1.0 / n, steps_per_frame=n, frames=1)) for n in steps]


class Machine:
    """Runs that take as many seconds as they have steps, and 10 more in the first call; some fail."""

    def __init__(self, fails=()):
        self.now, self.calls, self.fails = 0.0, [], fails

    def run(self, setting):
        steps = setting.problem.steps
        if steps in self.fails:
            raise RunError("it blew up")
        first = steps not in self.calls
        self.calls.append(steps)
        self.now += steps + 10.0 * first
        return steps + 0.25 * self.calls.count(steps)

    def measured(self, settings, follow=lambda *_: None, **limits):
        errors = lambda setting: {"velocity": setting.value**2}  # noqa: E731
        return measure(settings, self.run, errors, Limits(clock=lambda: self.now, **limits), follow)


def test_the_first_call_gives_the_error_and_stands_apart_from_the_repeats():
    (point,) = Machine().measured(by_step(2), repeats=3)
    assert point.errors == {"velocity": 0.25}
    assert (point.first, point.calls) == (12.0, [2.25, 2.5, 2.75, 3.0])
    assert (point.repeats, point.seconds) == ([2.5, 2.75, 3.0], 2.75)
    assert Machine().measured(by_step(2), repeats=0)[0].seconds == 2.25


def test_rounds_take_every_setting_in_turn():
    machine = Machine()
    machine.measured(by_step(2, 4), repeats=2)
    assert machine.calls == [2, 4] * 3


@pytest.mark.parametrize(("engine", "left_out"), [("LAMMPS suzuki4", "would take 48 s"), ("reference x", "")])
def test_what_would_take_too_long_by_the_effort_of_others_of_its_engine_is_not_run(engine, left_out):
    # the first call of 2 steps takes 12 seconds, so one of 8 steps 48
    several = [*by_step(1, 2, 8), *by_step(8, method=engine)]
    points = Machine().measured(several, repeats=0, longest=40.0)
    assert [point.left_out for point in points] == ["", "", "would take 48 s", left_out]


def test_nothing_is_repeated_beyond_the_budget():
    points = Machine().measured(by_step(1, 2), repeats=5, budget=26.0)
    assert [len(point.calls) for point in points] == [3, 2]


def test_a_run_that_fails_is_noted_and_the_others_continue():
    points = Machine(fails=(2,)).measured(by_step(2, 4), repeats=2)
    assert [(point.left_out, point.measured) for point in points] == [("it blew up", False), ("", True)]


def test_progress_counts_to_its_total_also_where_calls_are_left_out():
    seen = []
    Machine().measured(by_step(1, 2, 100), lambda _, *counts: seen.append(counts), repeats=4, longest=50.0)
    assert seen == [(done, 15) for done in range(1, 16)]


# --- orders, fronts and choices ---------------------------------------------------------------------------------------


def point(error, seconds, step=1.0, first=1e6):
    return Point(Setting("LAMMPS verlet", step, OWN), {"velocity": error}, [first, seconds], first)


def law(steps, power, factor=1.0):
    return [point(factor * step**power, 1.0 / step, step) for step in steps]


STEPS = [0.5**k for k in range(1, 12)]


@pytest.mark.parametrize("power", [2.0, 2.5, 4.0])
def test_an_order_is_found_from_errors_above_the_floor_that_are_small(power):
    floor = 1e-5
    points = law(STEPS, power)
    for each in points:  # what a reference of this uncertainty would show
        each.errors["velocity"] += 0.4 * floor if each.errors["velocity"] < floor else 0.0
    points += [point(math.inf, 1.0, 2.0), point(3.0, 1.0, 1.0)]
    found = order(points, floor)
    used = [step for step in STEPS if floor < step**power < 0.1]
    assert (found.points, found.low, found.high) == (len(used), used[-1], used[0])
    assert found.order == pytest.approx(power, abs=1e-12)


def test_the_standard_error_of_an_order_is_that_of_a_regression():
    points = law(STEPS, 2.0, 0.1)
    for each, by in zip(points, 0.2 * np.random.default_rng(1).standard_normal(len(points)), strict=True):
        each.errors["velocity"] *= math.exp(by)
    found = order(points, 0.0)
    x, y = np.log(STEPS), np.log([each.errors["velocity"] for each in points])
    residual = y - np.polyval(np.polyfit(x, y, 1), x)
    expected = math.sqrt(residual @ residual / (len(x) - 2) / np.sum((x - x.mean()) ** 2))
    assert found.standard_error == pytest.approx(expected, rel=1e-9)


def test_two_steps_have_an_order_without_an_error_and_one_has_none():
    assert math.isnan(order(law([0.1, 0.05], 2.0), 0.0).standard_error)
    assert order(law([0.1], 2.0), 0.0) is None


def test_settings_that_are_no_steps_have_no_order():
    ranks = [Point(Setting(RANKS, count, OWN), {"velocity": 0.01 * count}, [1.0]) for count in (1, 2)]
    assert Findings(OWN, points=ranks).orders() == []


def test_the_front_is_what_no_measured_point_beats_in_both():
    kept = [point(1e-1, 1.0), point(1e-3, 2.0), point(1e-6, 5.0)]
    beaten = [point(1e-1, 1.5), point(2e-3, 2.0), point(1e-3, 6.0), point(math.inf, 0.1)]
    assert pareto([*beaten, Point(kept[0].setting), *reversed(kept)], "velocity") == kept


def test_the_fastest_that_suffices_is_chosen_whatever_its_first_call_took():
    points = [point(1e-2, 1.0), point(1e-5, 3.0, first=0.0), point(5e-5, 2.0), point(1e-9, 100.0)]
    assert cheapest(points, 1e-4) is points[2]
    assert cheapest(points, 1e-10) is None


def test_an_accuracy_within_the_uncertainty_of_the_reference_is_not_reached():
    points = [point(9e-9, 1.0)]
    assert cheapest(points, 1e-8, 0.5e-9) is points[0]
    assert cheapest(points, 1e-8, 2e-9) is None
