import math
import pickle

import pytest
from hypothesis import given, settings
from strategies import scenes

from lammps_inputs import InputError, Kick, Output, Scene, library, physics, strict_yaml


def scene(**changes):
    return Scene(**{"name": "a", "beads": 9, "kick": (Kick(velocity=1.0),), "duration": 5.0, **changes})


def through_yaml(scene):
    return library.from_plain(strict_yaml.parse(strict_yaml.dump(scene.plain()), "here"), "here")


@pytest.mark.slow
@settings(max_examples=20)
@given(scenes())
def test_a_scene_and_its_resolved_one_come_back_from_yaml_exactly(scene):
    for one in (scene, scene.resolved()):
        assert through_yaml(one) == one


@pytest.mark.slow
@settings(max_examples=20)
@given(scenes(ends=False))
def test_a_scene_is_a_problem_of_finite_numbers_whose_fastest_kick_is_1(scene):
    problem = scene.problem()
    assert scene.resolved().problem() == problem
    assert max(abs(velocity) for _, _, velocity in problem.system.kicks) == 1.0
    found = (physics.kappa(problem.system), physics.gap(problem.system), physics.energy(problem.system))
    assert all(map(math.isfinite, (problem.timestep, *found, problem.duration)))
    assert problem.duration * scene.scale.time >= scene.duration * (1 - 1e-8)
    assert problem.frames >= 1


@pytest.mark.parametrize(("duration", "frames"), [(5.0, 50), (0.3, 3), (0.31, 4), (1e-9, 1)])
def test_the_run_ends_with_the_first_frame_that_is_not_before_the_duration(duration, frames):
    assert scene(duration=duration, output=Output(every=0.1)).problem().frames == frames


@pytest.mark.parametrize("steps", [1, 7, 10**6, 99_999_999, 10**8])
def test_a_time_step_that_divides_a_frame_is_taken_as_it_is(steps):
    problem = scene(duration=1.0, timestep=1.0 / steps, output=Output(every=1.0)).problem()
    assert problem.steps_per_frame == steps


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"kick": 3}, "scene: kick[1]: should hold `key: value` pairs, such as `kick: {velocity: 1}`, 3 given"),
        ({"copling": 1}, "scene: copling: unknown key (did you mean `coupling`?)"),
        ({"duration": None}, "scene: duration: give either duration or until_bead"),
    ],
    ids=str,
)
def test_a_scene_of_wrong_keys_or_values_in_python_is_refused_in_one_line(parts, message):
    with pytest.raises(InputError) as refused:
        scene(**parts)
    assert str(refused.value).startswith(message)
    assert "\n" not in str(refused.value)


def test_a_stored_scene_comes_back_with_its_problem_and_without_what_was_built_of_it():
    scene = library.find("two-chains")
    problem, stored = scene.problem(), pickle.dumps(scene)
    assert b"Hertz" not in stored
    assert pickle.loads(stored) == scene == Scene(**dict(scene))
    assert pickle.loads(stored).problem() == problem
