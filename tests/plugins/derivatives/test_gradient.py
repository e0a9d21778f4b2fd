"""Derivatives of quantities by fields: exact scaling laws, differences of accurate runs, and what is refused."""

import derivative_scenes
import numpy as np
import pytest
from derivative_scenes import PLAIN, SCENES, STEEL

import granchain
from granchain import InputError
from workflow.plugins.derivatives.gradient import gradient

CHAIN = {"name": "chain", "chains": 1, "beads": 24, "kick": {"velocity": 1}, "duration": 30}
PAIR = {**CHAIN, "chains": 2, "coupling": {"stiffness": 0.2}}


def scene_of(keys):
    return granchain.load({key: value for key, value in keys.items() if value is not None}).plain()


@pytest.mark.slow
@pytest.mark.parametrize(("name", "field"), [("pair", "coupling.stiffness"), ("viscoelastic, drag", "damping.contact")])
def test_derivatives_are_those_of_differences_of_accurate_runs_to_six_digits(name, field):
    expected, _ = derivative_scenes.differences(name, field)
    lines = gradient(derivative_scenes.scene_of(name), PLAIN[:2], [field], name)
    for line, right in zip(lines, expected[:2], strict=True):
        assert abs(line.derivative - right) < 1e-6 * abs(right), line.quantity
        assert line.uncertainty < 3e-5 * abs(right)


@pytest.mark.slow
def test_quantities_that_bend_or_are_undefined_have_no_derivative():
    """Of two equal kicks either becomes the larger, and its chain that of the leading wave."""
    scene = scene_of({**CHAIN, "chains": 2, "kick": [{"velocity": 1}, {"chain": 2, "velocity": 1}]})
    [line] = gradient(scene, ["peak_velocity@12"], ["kick[1].velocity"], "pair")
    assert line.value == pytest.approx(0.68, abs=0.01)
    assert line.derivative is None
    assert line.cells()[3] == "jumps"
    [line] = gradient(scene_of({**PAIR, "duration": 5}), ["arrival@20"], ["coupling.stiffness"], "short")
    assert (line.value, line.derivative, line.uncertainty, line.relative) == (None, None, None, None)


def test_without_fields_all_numbers_of_the_scene_are_varied():
    lines = gradient(scene_of({**PAIR, "gap": 0}), ["peak_velocity@12"], None, "pair")
    assert [line.field for line in lines] == ["coupling.stiffness", "kick.velocity"]


STIFF = {
    "strength": {"contact": {"strength": 100.0}, "duration": 4.0},
    "timestep and frames": {"contact": {"strength": 100.0}, "timestep": 0.002, "output": {"every": 0.5}},
}


@pytest.mark.slow
@pytest.mark.parametrize("name", STIFF)
def test_pulses_that_are_short_against_default_frames_have_the_derivatives_of_the_scaling_law(name):
    """Velocities grow as the kick's, whatever the strength and mass of equal beads, and times as its power -1/5."""
    scene = scene_of({**CHAIN, "beads": 12, **STIFF[name]})
    for line in gradient(scene, ["peak_velocity@8", "arrival@8"], ["kick.velocity", "contact.strength"], name):
        of_velocity, of_strength = (1.0, 0.0) if line.quantity.startswith("peak") else (-0.2, -0.4)
        right = of_velocity if line.field == "kick.velocity" else of_strength
        value = 1.0 if line.field == "kick.velocity" else 100.0
        assert abs(line.derivative - right * line.value / value) <= line.uncertainty
        assert line.uncertainty < 5e-6 * abs(line.value / value)


def test_the_end_is_that_of_the_run_whatever_its_time_step_and_frames():
    """A run of 7 with frames 0.3 apart lasts 7.2."""
    given = {**PAIR, "beads": 8, "duration": 7}
    [line] = gradient(
        scene_of({**given, "timestep": 0.012, "output": {"every": 0.3}}), ["participation"], ["coupling.stiffness"], "a"
    )
    [longer] = gradient(scene_of({**given, "duration": 7.2}), ["participation"], ["coupling.stiffness"], "b")
    assert abs(line.derivative - longer.derivative) < 1e-6 * abs(longer.derivative)


@pytest.mark.slow
def test_uncertainties_hold_in_95_percent_of_derivatives_of_scenes_of_all_ingredients():
    held, decisive = [], []
    for name, scene in SCENES.items():
        plain = derivative_scenes.scene_of(name)
        lines = gradient(plain, scene.quantities, scene.by, name)
        for place, field in enumerate(scene.by):
            right, doubt = derivative_scenes.differences(name, field)
            for line, value, error in zip(lines[place :: len(scene.by)], right, doubt, strict=True):
                if line.value is None:  # undefined numbers, as a speed where beads are not passed in order
                    assert line.derivative is None
                    continue
                assert line.derivative is not None
                decisive.append(error < 0.5 * line.uncertainty)
                held.append(abs(line.derivative - value) <= line.uncertainty + error)
    # of 91 derivatives of which 85 of 100 held, 95 of 100 would by a chance of 1 in 780, were they independent
    assert len(held) > 90
    assert np.mean(held) >= 0.95
    assert np.mean(decisive) >= 0.9  # less accurate differences would show nothing


@pytest.mark.slow
def test_frames_as_fine_as_memory_allows_are_taken_and_else_fewer_fields_are_asked_for(monkeypatch):
    scene = scene_of({**CHAIN, "beads": 8, "duration": 12})
    # 121 frames of 8 beads with a derivative take 31 kB, and twice as many fit
    monkeypatch.setattr("workflow.plugins.derivatives.varied_scene.MOST_BYTES", 63e3)
    [line] = gradient(scene, ["arrival@6"], ["kick.velocity"], "chain")
    assert abs(line.derivative + 0.2 * line.value) <= line.uncertainty
    monkeypatch.setattr("workflow.plugins.derivatives.varied_scene.MOST_BYTES", 40e3)
    with pytest.raises(InputError, match=r"chain: the frames of 1 derivatives .* name fewer fields with `--by`"):
        gradient(scene, ["arrival@6"], ["kick.velocity"], "chain")


@pytest.mark.slow
def test_without_fields_those_that_move_the_times_of_abrupt_changes_are_left_out():
    """In units of T, the times of a ramp of the foundation change with what the unit is made of."""
    ramp = {"stiffness": {"from": 2e5, "to": 4e5, "times": [2e-5, 4e-5]}}
    scene = scene_of({**CHAIN, "material": STEEL, "beads": 4, "duration": 6e-5, "foundation": ramp})
    lines = gradient(scene, ["peak_velocity@3"], None, "ramp")
    fields_of_lines = {line.field for line in lines}
    assert {"kick.velocity", "foundation.stiffness.from"} <= fields_of_lines
    assert not [name for name in fields_of_lines if name.startswith("material.")]
