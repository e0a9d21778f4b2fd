"""Quantities of a scene: whatever its time step and cadence, studies measure it in frames of their own."""

import pytest

from lammps_inputs import Output, library
from workflow.quantities.evaluate import of_scene, scene_to_run

PAIR = {"name": "a", "chains": 2, "beads": 16, "coupling": {"stiffness": 0.1}, "kick": {"velocity": 1}, "duration": 20}
BALL = {"name": "steel", "radius": 4.76e-3}
STEEL = {"name": "a", "beads": 16, "material": BALL, "kick": {"velocity": 0.5}, "duration": 3e-4}
SCENES = {
    "frames and step": {**PAIR, "timestep": 0.012, "output": {"every": 0.3}},
    "resolved": library.from_plain({**PAIR, "output": {"every": 0.3}}, "a").resolved().plain(),
    "one step a frame": {**PAIR, "timestep": 0.07, "output": {"every": 0.07}},
    "step longer than the frames of a study": {**PAIR, "timestep": 0.3, "output": {"every": 0.3, "beads": [3, 9]}},
    "a composition": {**PAIR, "scheme": "suzuki4", "timestep": 0.03, "output": {"every": 0.15}},
    "SI": {**STEEL, "timestep": 1e-7, "output": {"every": 3e-6}},
    "SI, step alone": {**STEEL, "timestep": 1.7e-7},
}


@pytest.mark.parametrize("kind", SCENES)
def test_a_scene_of_any_time_step_and_cadence_is_measured_as_with_neither(kind):
    plain = SCENES[kind]
    library.from_plain(plain, kind)
    assert scene_to_run(plain, (), kind).problem().every <= 0.3 * (1.0 + 1e-9)
    name = "peak_velocity@10"
    bare = {key: value for key, value in plain.items() if key not in ("timestep", "output", "scheme")}
    measured, expected = (of_scene(each, (name,), kind)[name] for each in (plain, bare))
    assert measured == pytest.approx(expected, rel=1e-3)


def test_a_scene_that_is_measured_has_all_of_output_but_what_says_which_frames_are_written():
    asked = {"forces": {"contacts": [4]}, "spectra": {"beads": [3]}}
    output = {"every": 0.3, "beads": [3, 9], **asked}
    assert set(output) == set(Output.model_fields)
    scene = scene_to_run({**PAIR, "output": output}, (), "a")
    assert scene.plain()["output"] == {"beads": "all", **asked}
