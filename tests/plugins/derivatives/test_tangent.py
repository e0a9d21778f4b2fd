"""The tangent flow is the derivative of the computed map."""

from contextlib import nullcontext

import numpy as np
import pytest
from smooth_scenes import SMOOTH, WITH_DERIVATIVES, resolved

from granchain import InputError
from workflow.engines.reference.schemes import BLANES_MOAN, VERLET
from workflow.plugins.derivatives import tangent


def moved_by(problem, change, steps, step):
    """State after some steps from the start, changed, [displacement or velocity, line, bead]."""
    flow = tangent.make_flow(problem, 0, step)
    flow.state.x[1:-1] += change[0].T
    flow.state.v[1:-1] += change[1].T
    flow.advance(0, steps)
    return np.stack([flow.state.x[1:-1].T, flow.state.v[1:-1].T])


def random_vectors(flow, count):
    """Vectors that change no bead whose motion is given."""
    vectors = np.random.default_rng(1).normal(size=(count, *flow.vectors.shape[1:]))
    for motion in flow.problem.system.motions:
        vectors[:, :, motion.chain - 1, motion.bead - 1] = 0.0
    return vectors


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in SMOOTH if name not in WITH_DERIVATIVES])
def test_vectors_are_the_derivative_of_the_computed_map(name):
    problem, step, steps = resolved(SMOOTH[name]).problem(), 0.04, 300
    flow = tangent.make_flow(problem, 1, step)
    vectors = random_vectors(flow, 1)
    flow.put(vectors)
    flow.advance(0, steps)
    # central differences at e and e / 2, extrapolated: errors of order e^4 and of rounding, 1e-16 / e
    small = 2e-4
    first, second = (
        (moved_by(problem, e * vectors[0], steps, step) - moved_by(problem, -e * vectors[0], steps, step)) / (2 * e)
        for e in (small, small / 2)
    )
    expected = (4 * second - first) / 3
    assert np.max(np.abs(flow.vectors[0] - expected)) < 1e-8 * np.max(np.abs(expected))


@pytest.mark.slow
@pytest.mark.parametrize("scheme", [BLANES_MOAN, VERLET], ids=lambda scheme: scheme.name)
def test_conservative_flow_keeps_areas_in_phase_space(scheme):
    pair = {"chains": 2, "coupling": {"stiffness": 0.2}, "disorder": {"mass": 0.3, "seed": 1}}
    flow = tangent.make_flow(resolved(pair).problem(), 2, 0.05, scheme)
    flow.put(random_vectors(flow, 2))

    def area():
        (x, v), (y, w) = flow.vectors
        mass = np.broadcast_to(flow.problem.system.mass, x.shape)
        return np.sum(mass * (x * w - y * v))

    before, size = area(), np.max(np.abs(flow.vectors))
    flow.advance(0, 400)
    # rounding of 400 steps of products of vectors of this size
    assert abs(area() - before) < 400 * 2.0**-52 * max(size, np.max(np.abs(flow.vectors))) ** 2 * 24


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"damping": {"contact": 0.1, "tension": "cut"}}, "`tension: cut`"),
        ({"contact": {"yield": {"overlap": 0.1}}}, "contacts that yield"),
        ({"contact": {"exponent": 1}}, "exponent 1"),
        ({"contact": {"exponent": [1.5, 2.0, 1.0, 1.5, 1.5]}}, "exponent 1"),
        ({"contact": {"exponent": [1.5, 2.0, 3.0, 1.7, 1.5]}}, None),
    ],
)
def test_systems_whose_forces_jump_are_refused_and_no_others(changes, reason):
    refused = pytest.raises(InputError, match=reason) if reason else nullcontext()
    with refused:
        tangent.make_flow(resolved(changes).problem(), 1, 0.05)
