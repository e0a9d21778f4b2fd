"""Derivatives by numbers of a scene are those of the computed motion."""

import numpy as np
import pytest
from smooth_scenes import SMOOTH, resolved

import granchain
from workflow.engines.reference import engine
from workflow.plugins.derivatives.motion import Sides, derivatives_of_motion
from workflow.sweep import fields

STEPS = (-1e-4, -5e-5, 5e-5, 1e-4)
FIELDS = {
    "coupled": ("coupling.stiffness", "coupling.cubic", "precompression.force"),
    "foundation in time": ("foundation.stiffness.from",),
    "resonators": ("resonators.mass", "resonators.stiffness", "resonators.damping"),
    "driven": ("drive.frequency", "damping.beads"),
}


def beside(scene, name, share):
    """Problem of a scene with a number that is off by a share of it, and by how much."""
    value = fields.look_up(scene, fields.parse(name, scene))
    return granchain.load(fields.put_all(scene, {name: value * (1.0 + share)})).problem(), value * share


def sides_of(scene, name):
    return Sides(*zip(*(beside(scene, name, share) for share in STEPS), strict=True))


@pytest.mark.slow
@pytest.mark.parametrize("kind", FIELDS)
def test_derivatives_are_those_of_the_computed_motion(kind):
    scene = resolved({**SMOOTH[kind], "duration": 10}).plain()
    problem = granchain.load(scene).problem()
    steps = engine.default_steps_per_frame(problem)
    motion = derivatives_of_motion(problem, [sides_of(scene, name) for name in FIELDS[kind]], steps)
    run = engine.run(problem, steps_per_frame=steps)
    assert np.array_equal(np.stack([motion.x, motion.v]), np.stack(run.atoms))
    for number, name in enumerate(FIELDS[kind]):
        differences = []
        for share in (4e-4, 2e-4):
            runs, changes = zip(*(beside(scene, name, sign * share) for sign in (-1.0, 1.0)), strict=True)
            low, high = (np.stack(engine.run(run, steps_per_frame=steps).atoms) for run in runs)
            differences.append((high - low) / (changes[1] - changes[0]))
        expected = (4 * differences[1] - differences[0]) / 3
        # rounding in the differences of forces, 1e-7 for beads whose motion is given; far below otherwise
        error = np.max(np.abs(np.stack([motion.dx[number], motion.dv[number]]) - expected))
        assert error < 3e-7 * np.max(np.abs(expected)), name
