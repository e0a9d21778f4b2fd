"""Settings measured in rounds, what the points say, and what is said about them; errors and costs are made up."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from small_problems import REDUCED, problem

from analysis.compare.difference import Uncertainty
from lammps_inputs import Scene
from lammps_inputs.units import Scale
from workflow.errors import RunError
from workflow.plugins.trade import settings
from workflow.plugins.trade.points import (
    Findings,
    MeasuredSetting,
    TrialLimits,
    cheapest,
    measure,
    order,
    pareto,
    sentences,
)
from workflow.plugins.trade.settings import RANKS, EngineSetting, Truth

OWN = problem()


def by_step(*steps, method="LAMMPS verlet"):
    """Settings of so many steps; their effort."""
    return [EngineSetting(method, 1.0 / n, replace(OWN, timestep=1.0 / n, steps_per_frame=n, frames=1)) for n in steps]


def error_of(setting):
    return {"velocity": setting.value**2}


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

    def measured(self, settings, **limits):
        return measure(settings, self.run, error_of, TrialLimits(clock=lambda: self.now, **limits))


def test_the_first_call_gives_the_error_and_stands_apart_from_the_repeats_which_take_turns():
    (point,) = Machine().measured(by_step(2), repeats=3)
    assert point.errors == {"velocity": 0.25}
    assert (point.first, point.calls) == (12.0, [2.25, 2.5, 2.75, 3.0])
    assert (point.repeats, point.seconds) == ([2.5, 2.75, 3.0], 2.75)
    assert Machine().measured(by_step(2), repeats=0)[0].seconds == 2.25
    machine = Machine()
    assert [one.pooled for one in machine.measured(by_step(2, 4), repeats=2)] == [None, None]  # medians rise
    assert machine.calls == [2, 4] * 3


@pytest.mark.parametrize(("engine", "left_out"), [("LAMMPS suzuki4", "would take 48 s"), ("reference x", "")])
def test_what_would_take_too_long_by_the_effort_of_others_of_its_engine_is_not_run(engine, left_out):
    # the first call of 2 steps takes 12 seconds, so one of 8 steps 48
    several = [*by_step(1, 2, 8), *by_step(8, method=engine)]
    points = Machine().measured(several, repeats=0, longest=40.0)
    assert [point.left_out for point in points] == ["", "", "would take 48 s", left_out]


def test_times_of_a_method_rise_with_its_evaluations_of_forces_whatever_else_runs():
    chance = np.random.default_rng(1)
    several = by_step(1, 2, 4, 8, 16) + by_step(2, 4, 8, method="LAMMPS suzuki4")

    def busy(setting):
        return setting.problem.steps * chance.lognormal(0.0, 2.0)

    studies = [measure(several, busy, error_of, TrialLimits()) for _ in range(20)]
    assert sum(any(point.pooled is not None for point in points) for points in studies) > 5
    for points in studies:
        for method in ("LAMMPS verlet", "LAMMPS suzuki4"):
            of_method = [point for point in points if point.setting.method == method]
            seconds = [point.seconds for point in of_method]
            medians = [np.median(point.calls[1:]) for point in of_method]
            assert seconds == sorted(seconds)
            assert sum(seconds) == pytest.approx(sum(medians))
            assert all(
                point.pooled or point.seconds == median for point, median in zip(of_method, medians, strict=True)
            )


def test_nothing_is_repeated_beyond_the_budget():
    points = Machine().measured(by_step(1, 2), repeats=5, budget=26.0)
    assert [len(point.calls) for point in points] == [3, 2]


def test_a_run_that_fails_is_noted_and_the_others_continue():
    points = Machine(fails=(2,)).measured(by_step(2, 4), repeats=2)
    assert [(point.left_out, point.measured) for point in points] == [("it blew up", False), ("", True)]


# --- orders, fronts and choices ---------------------------------------------------------------------------------------


def point(error, seconds, step=1.0, first=1e6):
    return MeasuredSetting(EngineSetting("LAMMPS verlet", step, OWN), {"velocity": error}, [first, seconds], first)


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


def test_two_steps_have_an_order_without_an_error_and_one_step_or_ranks_have_none():
    assert math.isnan(order(law([0.1, 0.05], 2.0), 0.0).standard_error)
    assert order(law([0.1], 2.0), 0.0) is None
    ranks = [MeasuredSetting(EngineSetting(RANKS, count, OWN), {"velocity": 0.01 * count}, [1.0]) for count in (1, 2)]
    assert Findings(OWN, points=ranks).orders() == []


def test_the_front_is_what_no_measured_point_beats_in_both():
    kept = [point(1e-1, 1.0), point(1e-3, 2.0), point(1e-6, 5.0)]
    beaten = [point(1e-1, 1.5), point(2e-3, 2.0), point(1e-3, 6.0), point(math.inf, 0.1)]
    assert pareto([*beaten, MeasuredSetting(kept[0].setting), *reversed(kept)], "velocity") == kept


def test_the_fastest_that_suffices_above_the_uncertainty_is_chosen_whatever_its_first_call_took():
    points = [point(1e-2, 1.0), point(1e-5, 3.0, first=0.0), point(5e-5, 2.0), point(1e-9, 100.0)]
    assert cheapest(points, 1e-4) is points[2]
    assert cheapest(points, 1e-10) is None
    points = [point(9e-9, 1.0)]
    assert cheapest(points, 1e-8, 0.5e-9) is points[0]
    assert cheapest(points, 1e-8, 2e-9) is None


# --- advice -----------------------------------------------------------------------------------------------------------


def truth(velocity=1e-11):
    return Truth(problem(), Path("nowhere"), Uncertainty(64, velocity, velocity, 0.0, 0.0), 1.0)


def found(setting, error, seconds):
    return MeasuredSetting(
        setting, {"velocity": error, "amplitude": 0.1 * error, "arrival": 2.0 * error}, [seconds, seconds]
    )


def by_law(method, factor, power, seconds, own=None):
    """Points of a method with errors ``factor * value**power`` at so many seconds a step."""
    several = [one for one in settings.settings(own or problem()) if one.method == method]
    assert several
    return [found(one, factor * one.value**power, seconds * one.problem.steps) for one in several]


def said(points, uncertainty=1e-11, own=None, **more):
    return sentences(Findings(own or problem(), truth(uncertainty), points, complete=True, **more))


def about(accuracy, words):
    (found,) = [sentence for sentence in words if sentence.startswith(f"{accuracy:.0e}: ")]
    return found


VERLET = by_law("LAMMPS verlet", 1.6, 2.0, 1e-5)
REFERENCE = by_law("reference blanes-moan", 0.02, 4.0, 1e-6)


def test_advice_names_what_is_not_reached_not_known_left_out_or_of_coarser_frames(golden):
    gone = [MeasuredSetting(each.setting, left_out="would take 9 s") for each in VERLET[-3:]]
    exact = found(REFERENCE[-1].setting, 1e-9, 1.0)
    many = problem(beads=100)
    window = by_law("LAMMPS window", 1e-9, 0.0, 0.5e-5, many)
    cases = {
        "both": said([*VERLET, *REFERENCE]),
        "verlet alone, some left out": said([*VERLET[:-3], *gone]),
        "one exact": said([*VERLET, exact]),
        "uncertain reference": said([exact], uncertainty=1e-7),
        "window": said([*by_law("LAMMPS verlet", 1.6, 2.0, 1e-5, many), *window], own=many),
        "nothing": said([]),
        "interrupted": sentences(Findings(problem(), notes=["Interrupted."])),
    }
    golden("advice", "\n".join(line for title, lines in cases.items() for line in (f"{title}:", *lines, "")))


@pytest.mark.parametrize("every", [0.1, 0.12345678901, 1.2238123e-05])
def test_a_step_that_is_advised_is_one_that_the_scene_accepts(every):
    scale = REDUCED if every > 1e-3 else Scale(3.6e-3, 1.224e-5, 1.0, si=True)
    own = problem(scale=scale, timestep=every / scale.time / 8, steps_per_frame=8, frames=400)
    points = by_law("LAMMPS verlet", 1.6, 2.0, 1e-5, own)
    sentence = about(1e-4, said(points, own=own))
    step = float(sentence.split("timestep: ")[1].split("`")[0])
    scene = {"name": "a", "beads": 8, "kick": {"velocity": 1.0}, "duration": 40.0 * every, "output": {"every": every}}
    Scene.model_validate({**scene, "timestep": step})


@pytest.mark.parametrize(
    ("times", "says"),
    [(0.1, "beats Verlet from an error of"), (7.0, "beats Verlet from an error of"), (100.0, "does not beat Verlet")],
)
def test_one_sentence_says_from_which_error_on_suzuki4_is_faster(times, says):
    # 1.6 h**2 at a cost of 1/h and 2 h**3 at 7/h are equally expensive at an error of 1e-5
    points = [*VERLET, *by_law("LAMMPS suzuki4", 2.0, 3.0, times * 1e-5)]
    (sentence,) = [sentence for sentence in said(points) if sentence.startswith("In LAMMPS suzuki4 ")]
    assert says in sentence
    assert "16 beads" in sentence
    if times == 7.0:
        error = float(sentence.split("error of ")[1].split(" V")[0])
        assert 1e-6 < error <= 1e-5  # the next step of suzuki4
