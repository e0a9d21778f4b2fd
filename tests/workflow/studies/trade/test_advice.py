"""What is said about points whose errors and costs are made up."""

import math
from pathlib import Path

import pytest
from small_problems import REDUCED, problem

from lammps_inputs import Scene
from lammps_inputs.units import Scale
from workflow.engines.reference.step_halving import Uncertainty
from workflow.studies.trade import advice, settings
from workflow.studies.trade.points import Findings, Point
from workflow.studies.trade.settings import Setting
from workflow.studies.trade.truth import Interval, Truth


def truth(velocity=1e-11):
    return Truth(problem(), Path("nowhere"), Uncertainty(64, velocity, velocity, 0.0, 0.0), 1.0)


def point(setting, error, seconds):
    return Point(setting, {"velocity": error, "amplitude": 0.1 * error, "arrival": 2.0 * error}, [seconds, seconds])


def by_law(method, factor, power, seconds, own=None):
    """Points of a method with errors ``factor * value**power`` at so many seconds a step."""
    several = [one for one in settings.settings(own or problem()) if one.method == method]
    assert several
    return [point(one, factor * one.value**power, seconds * one.problem.steps) for one in several]


def said(points, uncertainty=1e-11, own=None, **more):
    return advice.sentences(Findings(own or problem(), truth(uncertainty), points, whole=True, **more))


def about(accuracy, sentences):
    (found,) = [sentence for sentence in sentences if sentence.startswith(f"{accuracy:.0e}: ")]
    return found


VERLET = by_law("LAMMPS verlet", 1.6, 2.0, 1e-5)
REFERENCE = by_law("reference blanes-moan", 0.02, 4.0, 1e-6)


def test_each_accuracy_has_one_sentence_with_the_cheapest_engine_and_the_step_of_lammps():
    sentences = said([*VERLET, *REFERENCE])
    step = max(each.setting.value for each in VERLET if each.errors["velocity"] <= 1e-4)
    assert "reference blanes-moan" in about(1e-4, sentences)
    assert f"`timestep: {step:.5g}`" in about(1e-4, sentences)


def test_what_nothing_reaches_is_said_with_the_nearest():
    sentence = about(1e-8, said(VERLET))
    least = min(VERLET, key=lambda each: each.errors["velocity"])
    assert "nothing measured reaches it" in sentence
    assert f"{least.errors['velocity']:.1e} V" in sentence


def test_what_lammps_does_not_reach_is_said():
    exact = point(REFERENCE[-1].setting, 1e-9, 1.0)
    sentence = about(1e-8, said([*VERLET, exact]))
    assert "reference blanes-moan" in sentence
    assert "no measured time step of LAMMPS reaches it" in sentence


def test_errors_that_are_not_well_above_the_uncertainty_are_named_and_not_advised():
    sentences = said([point(REFERENCE[-1].setting, 1e-9, 1.0)], uncertainty=1e-7)
    assert "errors of velocities below 1.0e-06 V are not well known" in sentences[0]
    assert "nothing measured reaches it" in about(1e-8, sentences)


@pytest.mark.parametrize("every", [0.1, 0.12345678901, 1.2238123e-05])
def test_a_step_that_is_advised_is_one_that_the_scene_accepts(every):
    scale = REDUCED if every > 1e-3 else Scale(3.6e-3, 1.224e-5, 1.0, si=True)
    own = problem(scale=scale, timestep=every / scale.time / 8, steps_per_frame=8, frames=400)
    points = by_law("LAMMPS verlet", 1.6, 2.0, 1e-5, own)
    sentence = about(1e-4, said(points, own=own))
    step = float(sentence.split("timestep: ")[1].split("`")[0])
    scene = {"name": "a", "beads": 8, "kick": {"velocity": 1.0}, "duration": 40.0 * every, "output": {"every": every}}
    Scene.model_validate({**scene, "timestep": step})


def test_coarser_frames_are_named():
    sentence = about(1e-2, said(REFERENCE))
    assert "frames 0.4 apart" in sentence


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


def test_windows_are_in_no_advice_for_all_beads_but_have_a_sentence_of_their_own():
    own = problem(beads=100)
    window = by_law("LAMMPS window", 1e-9, 0.0, 0.5e-5, own)
    sentences = said([*by_law("LAMMPS verlet", 1.6, 2.0, 1e-5, own), *window], own=own)
    assert "nothing measured reaches it" in about(1e-8, sentences)
    assert "64 rows take 0.5 of the time of the scene as it is, with no larger errors near the front." in sentences


@pytest.mark.parametrize(
    ("factor", "errors"), [(1.0, "the same errors"), (0.999, "different errors"), (2.0, "larger errors of velocity")]
)
def test_ranks_have_a_sentence_that_says_whether_they_change_an_error(factor, errors):
    (one,) = [each for each in VERLET if each.setting.problem == problem()]
    two = Setting(settings.RANKS, 2.0, problem(), ranks=2)
    more = point(two, one.errors["velocity"], 0.5 * one.seconds)
    more.errors["velocity"] *= factor
    assert f"2 ranks take 0.5 of the time of the scene as it is, with {errors}." in said([one, more])


def test_the_widest_frames_that_show_the_pulse_to_an_accuracy_are_advised():
    frames = [Interval(0.8, 1e-3, 5e-3, 2.0), Interval(0.4, 1e-5, 2e-4, 4.0), Interval(1.6, 1e-5, math.inf, 1.0)]
    sentences = said(VERLET, frames=frames)
    assert "Frames 0.8 apart show amplitudes and arrivals to 1e-02 (2 MB)." in sentences
    assert "No frames measured show amplitudes and arrivals of all beads to 1e-04." in sentences


def test_what_was_left_out_has_one_sentence_a_method():
    gone = [Point(each.setting, left_out="would take 9 s") for each in VERLET[-3:]]
    sentences = [sentence for sentence in said([*VERLET[:-3], *gone]) if sentence.startswith("Left out")]
    assert sentences == [f"Left out: LAMMPS verlet, {gone[0].setting.label} (would take 9 s), and 2 more."]


def test_a_study_without_points_is_no_error():
    assert any("nothing was measured" in sentence for sentence in said([]))
    assert advice.sentences(Findings(problem(), notes=["Interrupted."])) == ["Interrupted."]
