"""What is tried before a run takes at most ten seconds of processor time, whatever the scene; compilation apart."""

import pytest

from lammps_inputs import library
from workflow import processor_time, screen
from workflow.engines.reference import engine
from workflow.prepare.settings import settle

BALL = {"name": "steel-52100", "radius": 0.015}
CRADLE = {"name": "cradle", "beads": 5, "gap": 5e-4, "material": BALL, "kick": {"velocity": 0.3}, "duration": 0.6}
LONG = {
    "gaps and restitution": {
        **{**CRADLE, "foundation": {"stiffness": 3.85}},
        "damping": {"contact": 0.95, "law": "restitution"},
    },
    "frames far apart": {"name": "a", "beads": 20, "kick": {"velocity": 1}, "duration": 2e5, "output": {"every": 1e5}},
    "a million beads": {"name": "a", "chains": 10, "beads": 100000, "kick": {"velocity": 1}, "duration": 1e5},
    "an accuracy": {**CRADLE, "accuracy": 1e-6},
}


@pytest.mark.slow
@pytest.mark.parametrize("plain", LONG.values(), ids=LONG)
def test_trials_take_ten_seconds_of_processor_time_at_most(plain):
    scene, before = library.from_plain(plain, "long"), processor_time.clock()
    settled, step = settle(scene)
    assert settled.timestep == pytest.approx(step.timestep * scene.scale.time)
    assert processor_time.clock() - before <= processor_time.BEFORE_RUN


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"until_bead": 30}, "until_bead: a duration of 80 is given by a rule, as a trial takes more than 4 s"),
        ({"duration": 60.0, "beads": 400, "window": "auto"}, "window: 256 rows by a rule, not by trials"),
    ],
    ids=["duration", "window"],
)
def test_a_duration_and_a_window_are_sought_within_the_same_limit_or_given_by_a_rule(changes, says):
    plain = {"name": "a", "beads": 40, "kick": {"velocity": 1}, **changes}
    scene, hints = library.from_plain(plain, "long"), []
    sought = settle(scene)[0]
    with processor_time.limited(0.0), screen.with_hints(hints.append):
        settled = settle(scene)[0]
    assert [hint for hint in hints if hint.startswith(says)]
    assert settled.until_bead is None
    assert settled.duration >= sought.duration
    assert settled.window is None or settled.window >= sought.window


def test_a_limit_ends_a_run_within_a_frame_of_any_number_of_steps():
    plain = {"name": "a", "beads": 2, "kick": {"velocity": 1}, "duration": 1.0, "output": {"every": 1.0}}
    problem = library.from_plain(plain, "a").problem()
    engine.run(problem)  # compiles
    before = processor_time.clock()
    with processor_time.limited(0.1), pytest.raises(processor_time.LimitReachedError):
        engine.run(problem, steps_per_frame=10**8)
    assert processor_time.clock() - before < 1.0
