"""Numbers of scenes on the page of `granchain explore`, and what computes them: without a browser."""

import time

import numpy as np
import pytest

import granchain
from lammps_inputs import InputError
from lammps_inputs.installed_scenes import installed
from workflow.plugins.explore.compute import computed
from workflow.plugins.explore.picture import Picture
from workflow.plugins.explore.scene_numbers import numbers_of, read, slider_range, written
from workflow.sweep import fields

SCENE = {"name": "two", "chains": 2, "beads": 20, "coupling": {"stiffness": 0.1}, "kick": {"velocity": 1.0}}
SCENE |= {"duration": 20.0}


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(installed())[::5])
def test_every_number_of_an_installed_scene_can_be_set_to_what_it_is(name):
    scene = granchain.load(name).plain()
    numbers = numbers_of(scene)
    assert len({number.name for number in numbers}) == len(numbers) >= 5
    for number in numbers:
        value = read(written(number.value), number)
        assert value == number.value
        assert granchain.load(fields.put(scene, number.path, value)) == granchain.load(scene)
        if number.slides:
            area = slider_range(number, number.value)
            assert area.start <= number.value <= area.end
            assert area.start < area.end


def number_called(name, scene):
    return next(number for number in numbers_of(granchain.load(scene).plain()) if number.name == name)


@pytest.mark.parametrize(
    ("name", "value", "ends"),
    [
        ("coupling.stiffness", 0.1, (0.0, 0.3, 0.001)),
        ("coupling.stiffness", 0.0, (0.0, 1.0, 0.01)),
        ("kick.velocity", -0.4, (-1.2, 0.0, 0.01)),
        ("beads", 20, (2.0, 60.0, 1.0)),
    ],
)
def test_a_slider_goes_from_0_to_three_times_the_value_within_the_bounds_of_the_key(name, value, ends):
    area = slider_range(number_called(name, SCENE), value)
    assert (area.start, area.end, area.step) == pytest.approx(ends)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"duration": 1e6}, r"takes about .*, more than the 2 s"),
        ({"window": 64, "beads": 200}, "only lammps records a window"),
        ({"output": {"every": 5.0}}, r"output\.every: frames are 5 apart"),
    ],
)
def test_what_cannot_be_computed_at_once_is_refused_before_it_is_tried(changes, says):
    scene = granchain.load({key: value for key, value in (SCENE | changes).items() if value is not None})
    started = time.perf_counter()
    with pytest.raises(InputError, match=says):
        computed(scene)
    assert time.perf_counter() - started < 30.0  # days of work were asked for


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "renewed"),
    [
        ({"coupling.stiffness": 0.11}, True),
        ({"duration": 25.0}, True),
        ({"chains": 3}, False),
        ({"beads": 21}, False),
        ({"kick.velocity": 3.0}, False),
    ],
    ids=str,
)
def test_a_picture_shows_another_result_of_the_same_chains_and_beads_in_the_same_plots(changes, renewed):
    picture, result = Picture(computed(granchain.load(SCENE))), computed(granchain.load(SCENE, changes))
    assert picture.renew(result) is renewed
    if renewed:
        peaks = picture.root.select_one({"name": "peaks"}).renderers[1].data_source.data["y"]
        waves = result.survey.waves.of_chain(2)
        np.testing.assert_array_equal(peaks[waves.bead - 1], waves.peak_velocity)


def test_each_of_several_kicks_has_its_numbers():
    kicks = [{"bead": 1, "velocity": 1.0}, {"bead": 9, "velocity": -0.3}]
    scene = granchain.load(SCENE | {"kick": kicks}).plain()
    found = {number.name: number for number in numbers_of(scene)}
    assert (found["kick[1].velocity"].value, found["kick[2].velocity"].value) == (1.0, -0.3)
    changed = granchain.load(fields.put(scene, found["kick[2].velocity"].path, -0.5))
    assert [kick.velocity for kick in changed.kicks] == [1.0, -0.5]
