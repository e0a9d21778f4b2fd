"""Beads that fall: exact falls and bounces, energy, units and limits."""

import math

import numpy as np
import pytest
from mirror import mirrored_problem
from scene_keys import units
from truth import Truth

from lammps_inputs import library, physics
from workflow.engines.reference import engine
from workflow.runs.run import run
from workflow.verdicts.analysis_files import analyse

pytestmark = pytest.mark.usefixtures("lammps_here")

DIMER = {"kinds": {"a": {"mass": 1.0}, "b": {"mass": 0.4}}, "pattern": ["a", "b"]}


def scene(acceleration=0.1, **keys):
    gravity = {"acceleration": acceleration, "settled": False}
    return library.from_plain({"name": "fall", "beads": 3, "duration": 6.0, "gravity": gravity, **keys}, "x")


@pytest.mark.slow
@pytest.mark.parametrize("unlike", [{}, DIMER], ids=["equal", "unlike"])
@pytest.mark.parametrize("drag", [{}, {"damping": {"beads": 1e-300}}], ids=["free", "forces"])
def test_beads_without_support_fall_freely(unlike, drag, tmp_path):
    case = scene(gap=0.3, **unlike, **drag)
    done = run(case, tmp_path / "run").trajectory
    time = done.time * case.scale.time
    x, v = done.displacement * case.scale.length, done.velocity * case.scale.velocity
    for found, exact in ((x, 0.05 * time**2), (v, 0.1 * time)):
        np.testing.assert_allclose(found - exact[:, None, None], 0.0, rtol=0.0, atol=1e-12)


@pytest.mark.slow
def test_a_bead_returns_to_the_height_from_which_it_fell_onto_a_floor(tmp_path):
    """The last bead, while the other one is far above: V is 20, so that an accuracy of 1e-6 is 2e-5 in velocity."""
    keys = {"beads": 2, "gap": 40.0, "walls": {"right": "rigid"}, "kick": {"velocity": -20.0}}
    done = run(scene(**keys, duration=90.0, accuracy=1e-6), tmp_path / "run")
    scale = done.trajectory.problem.scale
    x, time = done.trajectory.displacement[:, 0, 1] * scale.length, done.trajectory.time * scale.time
    fall = math.sqrt(2.0 * 40.0 / 0.1)
    assert time[np.argmax(x >= 40.0)] == pytest.approx(fall, abs=done.trajectory.problem.every * scale.time)
    assert np.min(x[time > fall + 1.0]) == pytest.approx(0.0, abs=2e-3)
    report = analyse(done.directory, figures=False).conservation
    assert report.energy_drift < 1e-5
    assert report.budget.energy_input[0] == pytest.approx(0.5, rel=1e-12)


FALLING = {
    "gaps": {"gap": 0.5, "beads": 5, "walls": {"right": "bead"}},
    "unlike, kicked": {"beads": 8, **DIMER, "walls": {"left": "flat", "right": "rigid"}, "kick": {"velocity": -0.4}},
    "coupled, drag": {
        "chains": 2,
        "coupling": {"stiffness": 0.1},
        "beads": 4,
        "walls": {"right": "flat"},
        "damping": {"beads": 0.02},
    },
    "displaced": {"beads": 4, "walls": {"right": "bead"}, "initial": {"bead": 2, "displacement": -1.5}, "gap": 2.0},
}


@pytest.mark.slow
@pytest.mark.parametrize("name", ["gaps", *(pytest.param(name, marks=pytest.mark.slow) for name in list(FALLING)[1:])])
def test_a_column_that_falls_moves_as_by_the_independent_integrator(name, tmp_path):
    case = scene(**{"duration": 20.0, "timestep": 0.005, "output": {"every": 0.5}, **FALLING[name]})
    problem, unit = case.problem(), units(case)
    done = run(case, tmp_path / "run")
    exact = Truth(case, problem.duration, 1e-11).states(problem.every * np.arange(problem.frames + 1))[1]
    assert unit.velocity == pytest.approx(case.scale.velocity, rel=1e-12)
    assert np.max(np.abs(done.trajectory.velocity - exact)) < 1e-3
    reference = engine.run(problem)
    assert np.max(np.abs(reference.velocity - exact)) < done.check.reference.velocity < 1e-3
    report = analyse(done.directory, figures=False).conservation
    assert report.energy_drift < 2e-3
    overlap = np.max(np.diff(-reference.displacement, axis=-1)) - physics.gap(problem.system)
    assert 0.4 * overlap**2.5 < physics.energy(problem.system)
    image = engine.run(mirrored_problem(problem), steps_per_frame=engine.default_steps_per_frame(problem))
    np.testing.assert_allclose(image.velocity, -reference.velocity[..., ::-1], rtol=0.0, atol=1e-9)
