"""What is said about points whose errors and costs are made up."""

import math
from dataclasses import replace
from pathlib import Path

import pytest
from small_problems import REDUCED, problem

from lammps_inputs import Scene
from lammps_inputs.units import Scale
from workflow.engines.reference.step_halving import Uncertainty
from workflow.studies.trade import advice, settings
from workflow.studies.trade.settings import Job
from workflow.studies.trade.study import Findings
from workflow.studies.trade.truth import Truth
from workflow.studies.trade.work_precision import Point, Setting


def truth(velocity=1e-11):
    return Truth(problem(), Path("nowhere"), Uncertainty(64, velocity, velocity, 0.0, 0.0, None), 1.0)


def point(setting, error, seconds):
    errors = {"velocity": error, "amplitude": 0.1 * error, "arrival": 2.0 * error}
    costs = {"seconds": seconds, "start": 0.1, "forces": float(setting.what.problem.steps)}
    return Point(setting, errors, costs, [costs])


def by_law(curve, factor, power, seconds, own=None):
    """Points of a curve with errors ``factor * step**power`` at so many seconds a force."""
    found = []
    for setting in settings.settings(own or problem()):
        if setting.curve == curve:
            found.append(point(setting, factor * setting.value**power, seconds * setting.what.problem.steps))
    assert found
    return found


def said(points, sure=1e-11, own=None, **more):
    study = Findings(own or problem(), truth(sure), points, whole=True, **more)
    return advice.sentences(study)


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


def test_a_reference_that_is_no_surer_than_the_errors_says_so_and_advises_nothing_beyond():
    sentences = said([point(REFERENCE[-1].setting, 1e-9, 1.0)], sure=1e-7)
    assert "below ten times" in sentences[0]
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
    [(1.0, "beats Verlet at all errors"), (7.0, "beats Verlet from an error of"), (100.0, "does not beat Verlet")],
)
def test_one_sentence_says_from_where_suzuki4_wins(times, says):
    # 1.6 h**2 at a cost of 1/h and 2 h**3 at 7/h are equally dear at an error of 1e-5
    points = [*VERLET, *by_law("LAMMPS suzuki4", 2.0, 3.0, times * 1e-5)]
    sentences = [sentence for sentence in said(points) if sentence.startswith("In LAMMPS suzuki4 ")]
    assert len(sentences) == 1
    assert says in sentences[0]
    assert "16 beads" in sentences[0]


def test_windows_are_in_no_advice_for_all_beads_but_have_a_sentence_of_their_own():
    own = problem(beads=100)
    windows = by_law("LAMMPS window", 1e-9, 0.0, 1e-9, own)
    for each, seconds in zip(windows, (1.0, 2.0, 4.0), strict=False):
        each.repeats[0] = {**each.repeats[0], "seconds": seconds}
    sentences = said([*by_law("LAMMPS verlet", 1.6, 2.0, 1e-5, own), *windows], own=own)
    assert "nothing measured reaches it" in about(1e-8, sentences)
    assert any("a window of 64 rows takes 0.5" in sentence for sentence in sentences)


def test_ranks_that_change_an_error_are_told():
    ranks = Setting("LAMMPS ranks", 1.0, "1 rank", 1.0, Job("lammps", problem()))
    more = replace(ranks, value=2.0, label="2 ranks", what=Job("lammps", problem(), ranks=2))
    same = [point(ranks, 1e-4, 2.0), point(more, 1e-4, 1.0)]
    assert "2 ranks take 0.5 of the time of one; the errors are the same." in said(same)
    other = [point(ranks, 1e-4, 2.0), point(more, 2e-4, 1.0)]
    assert any("THE ERRORS DIFFER" in sentence for sentence in said(other))


def test_rigid_beads_whose_pulse_stops_say_so():
    rigid = point(Setting(settings.RIGID, 1.0, "exact", 1.0, Job("collisions", problem(gap=1.0))), 0.8, 0.1)
    rigid.errors["arrival"] = math.inf
    assert any("their pulse does not reach all beads" in sentence for sentence in said([rigid]))


def test_what_was_left_out_has_one_sentence_a_method():
    gone = [Point(each.setting, left_out="would take 9 s") for each in VERLET[-3:]]
    sentences = [sentence for sentence in said([*VERLET[:-3], *gone]) if sentence.startswith("Left out")]
    assert sentences == [f"Left out: LAMMPS verlet, {gone[0].setting.label} (would take 9 s), and 2 more."]


def test_a_study_without_points_is_no_error():
    assert any("nothing was measured" in sentence for sentence in said([]))
    assert advice.sentences(Findings(problem(), notes=["Interrupted."])) == ["Interrupted."]
