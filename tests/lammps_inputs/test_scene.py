import math
import re

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from pydantic import ValidationError
from strategies import scenes

from lammps_inputs import InputError, Kick, Output, Scene, library, physics, strict_yaml
from lammps_inputs.ingredients.base import ScenePart
from lammps_inputs.ingredients.coupling import Coupling
from lammps_inputs.units import Unit

ALLOWED = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}", re.ASCII)


def scene(**changes):
    return Scene(**{"name": "a", "beads": 9, "kick": (Kick(velocity=1.0),), "duration": 5.0, **changes})


def through_yaml(scene):
    return library.from_plain(strict_yaml.parse(strict_yaml.dump(scene.plain()), "here"), "here")


@given(scenes())
def test_a_resolved_scene_has_no_default_left_and_resolves_to_itself(scene):
    resolved = scene.resolved()
    assert resolved.timestep is not None
    assert resolved.output.every is not None
    assert resolved.resolved() == resolved


@given(scenes())
def test_a_scene_and_its_resolved_one_come_back_from_yaml_exactly(scene):
    for one in (scene, scene.resolved()):
        assert through_yaml(one) == one


@pytest.mark.parametrize("name", ["1e5", "12E3", "1.5", "7", "true", "null", "yes", "no", "0x1", "a.b", "2020-01-01"])
def test_a_name_that_looks_like_something_else_comes_back_as_a_name(name):
    assert through_yaml(scene(name=name)).name == name


@given(scenes(ends=False))
def test_a_scene_is_a_problem_of_finite_numbers_whose_fastest_kick_is_1(scene):
    problem = scene.problem()
    assert scene.resolved().problem() == problem
    assert max(abs(velocity) for _, _, velocity in problem.system.kicks) == 1.0
    found = (physics.kappa(problem.system), physics.gap(problem.system), physics.energy(problem.system))
    assert all(map(math.isfinite, (problem.timestep, *found, problem.duration)))
    assert problem.duration * scene.scale.time >= scene.duration * (1 - 1e-8)
    assert problem.frames >= 1


@given(st.text(max_size=70) | st.from_regex(ALLOWED), st.sampled_from(["", "/", "$", "\n", "'", "..", " ", "{", "é"]))
def test_a_name_is_letters_digits_dot_underscore_and_hyphen_or_refused(name, extra):
    try:
        accepted = scene(name=name + extra).name
    except InputError:
        assert not ALLOWED.fullmatch(name + extra)
    else:
        assert ALLOWED.fullmatch(accepted)


@given(st.text(max_size=210))
@example("a\x85b")
@example("a\u2028b")
def test_a_description_is_one_line_or_refused(description):
    try:
        accepted = scene(description=description).description
    except InputError:
        assert len(description) > 200 or re.search(r"[\x00-\x1f\x7f-\x9f\u2028\u2029]", description)
    else:
        assert len(f"{accepted}.".splitlines()) == 1
        assert through_yaml(scene(description=accepted)).description == accepted


@pytest.mark.parametrize(
    ("part", "key"), [(scene(), "beads"), (scene().kick[0], "velocity"), (scene().output, "every")]
)
def test_a_scene_and_its_parts_cannot_be_changed(part, key):
    with pytest.raises(ValidationError, match="frozen"):
        setattr(part, key, 3)


def test_what_a_scene_does_not_name_is_not_in_its_yaml():
    assert set(scene().plain()) == {"name", "chains", "beads", "kick", "duration", "output"}


def test_recorded_beads_are_in_ascending_order():
    assert Output(beads=(7, 3)).beads == (3, 7)


@pytest.mark.parametrize(("chains", "stiffness"), [(1, 0.1), (2, 0.0)])
def test_springs_of_one_chain_or_of_no_stiffness_are_none(chains, stiffness):
    assert not physics.coupled(scene(chains=chains, coupling=Coupling(stiffness=stiffness)).system)


@pytest.mark.parametrize(("duration", "frames"), [(5.0, 50), (0.3, 3), (0.31, 4), (1e-9, 1)])
def test_the_run_ends_with_the_first_frame_that_is_not_before_the_duration(duration, frames):
    assert scene(duration=duration, output=Output(every=0.1)).problem().frames == frames


@pytest.mark.parametrize("every", [0.1, 0.05, 1.0, 0.123])
def test_frames_are_as_far_apart_as_asked(every):
    assert scene(output=Output(every=every)).problem().every == pytest.approx(every, rel=1e-15)


@pytest.mark.parametrize("steps", [1, 7, 10**6, 99_999_999, 10**8])
def test_a_time_step_that_divides_a_frame_is_taken_as_it_is(steps):
    problem = scene(duration=1.0, timestep=1.0 / steps, output=Output(every=1.0)).problem()
    assert problem.steps_per_frame == steps


def test_the_suggested_time_step_is_accepted():
    with pytest.raises(InputError) as caught:
        scene(timestep=0.0123, output=Output(every=0.1))
    suggested = float(re.search(r"try (\S+)", str(caught.value)).group(1))
    assert scene(timestep=suggested, output=Output(every=0.1)).timestep == suggested


@given(st.floats(-12.0, 12.0), st.floats(0.0, 1e3))
def test_a_scene_at_any_v_is_the_published_problem_at_v_equal_1(exponent, gap):
    """The exact scaling: x = V^0.8 x^, t = V^-0.2 t^, kappa_eff = kappa V^-0.4, D_eff = D V^-0.8."""
    v = 10.0**exponent
    problem = scene(
        chains=2, coupling=Coupling(stiffness=0.1), gap=gap * v**0.8, duration=5.0 * v**-0.2, kick=(Kick(velocity=v),)
    ).problem()
    assert physics.kappa(problem.system) == pytest.approx(0.1 * v**-0.4, rel=1e-14)
    assert physics.gap(problem.system) == pytest.approx(gap, rel=1e-14)
    assert problem.duration == pytest.approx(5.0, rel=1e-8)


def test_an_input_error_is_one_printable_line_whatever_it_is_given():
    assert str(InputError("a\n  b\x1b\0\u2028c")) == "a b\\x1b\\x00 c"


def numbers(model, above=""):
    """Path and all that the type is made of, of every field of a scene that may be a number with a fraction."""
    for name, field in model.model_fields.items():
        parts = [*field.metadata, *inside(field.annotation)]
        if float in parts:
            yield f"{above}{name}", parts
        for part in parts:
            if isinstance(part, type) and issubclass(part, ScenePart):
                yield from numbers(part, f"{above}{name}.")


def inside(declared):
    found = (*getattr(declared, "__metadata__", ()), *getattr(declared, "__args__", ()))
    return [declared, *(part for each in found for part in inside(each))]


def test_every_number_of_a_scene_says_its_unit_beside_it():
    found = dict(numbers(Scene))
    assert {"kick.velocity", "coupling.stiffness.from", "gravity.acceleration", "kinds.mass"} <= found.keys()
    assert [name for name, parts in found.items() if not any(isinstance(part, Unit) for part in parts)] == []


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"beads": "x"}, "scene: beads: should be a whole number, 'x' given"),
        ({"kick": 3}, "scene: kick[1]: should hold `key: value` pairs, such as `kick: {velocity: 1}`, 3 given"),
        ({"copling": 1}, "scene: copling: unknown key (did you mean `coupling`?)"),
        ({"kick": Kick(bead=99, velocity=1.0)}, "scene: kick.bead: 99 is outside the array (beads 1 to 9)"),
        ({"duration": None}, "scene: duration: give either duration or until_bead"),
    ],
    ids=str,
)
def test_a_scene_of_wrong_keys_or_values_in_python_is_refused_in_one_line(parts, message):
    with pytest.raises(InputError) as refused:
        scene(**parts)
    assert str(refused.value).startswith(message)
    assert "\n" not in str(refused.value)


def test_values_without_keys_are_no_scene():
    with pytest.raises(InputError, match="keys by name"):
        Scene({"name": "a", "beads": 9})
