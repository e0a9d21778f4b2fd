"""Fits of traces that jump: where contacts with a dashpot close, an instant depends on the fields."""

from dataclasses import replace

import numpy as np
import pytest

from workflow.plugins.fit.estimate import estimate, jumping
from workflow.plugins.fit.model import Model, derivative_beside_jumps

TIME = np.arange(0.0, 10.0, 0.05)
NOISE = 0.03
JUMP = 0.4


def smooth(p):
    """A decaying oscillation, [row, channel]."""
    return (np.exp(-0.2 * np.exp(p[0]) * TIME) * np.sin(2.0 * np.exp(p[1]) * TIME))[:, np.newaxis]


def trace(p):
    """The same, that jumps at two instants, which the second parameter moves."""
    late = 4.0 * np.exp(p[1])
    return smooth(p) + JUMP * ((late < TIME).astype(float) - (1.7 * late < TIME))[:, np.newaxis]


def slopes(p, step=1e-4):
    middle = trace(p)
    pairs = ((trace(p + h) - middle, middle - trace(p - h)) for h in step * np.eye(2))
    return np.stack([derivative_beside_jumps(*pair, step) for pair in pairs], -1)


def smooth_slopes(p, step=1e-5):
    """Derivatives of the trace without its jumps."""
    return np.stack([(smooth(p + h) - smooth(p - h)) / (2.0 * step) for h in step * np.eye(2)], -1)


@pytest.mark.parametrize("late", np.log(TIME[90:100:3] / 4.0) + 5e-5)
def test_a_sample_that_a_jump_passes_has_the_derivative_of_its_own_side(late):
    p = np.array([0.1, late])  # the jump moves over a sample within a step of 1e-4
    step = np.array([0.0, 1e-4])
    crossed = np.abs(trace(p + step) - trace(p - step)).max() > 0.9 * JUMP
    assert crossed
    np.testing.assert_allclose(slopes(p), smooth_slopes(p), atol=5e-3)  # a step times the second derivative, 40


def test_a_smooth_trace_has_the_central_difference_also_where_its_derivative_is_0():
    ahead, behind = np.array([1.1, -1e-9, 3.0]), np.array([0.9, 2e-9, 3.2])
    np.testing.assert_allclose(derivative_beside_jumps(ahead, behind, 0.5), [2.0, -2e-9, 6.2], rtol=1e-12)


def test_values_jump_where_an_instant_passes_them_within_two_standard_errors_and_nowhere_else():
    p, error = np.array([0.0, 1e-5]), np.array([0.05, 0.004])
    found = jumping(lambda q: -trace(q), p, np.diag(error**2), np.array([NOISE]))[:, 0]
    late = 4.0 * np.exp(p[1])
    for factor in (1.0, 1.7):
        assert np.array_equal(
            found & (np.abs(TIME - factor * late) < 0.5),
            np.abs(np.log(TIME / (factor * late), where=TIME > 0.0, out=np.full_like(TIME, 9.0))) < 2.0 * error[1],
        )
    assert np.count_nonzero(found) < 10


def test_a_smooth_model_does_not_jump_however_uncertain_its_parameters():
    for covariance in (np.diag([10.0, 10.0]), np.array([[np.inf, np.nan], [np.nan, 1e-4]])):
        assert not jumping(smooth, np.zeros(2), covariance, np.array([NOISE])).any()


@pytest.mark.slow
def test_intervals_of_a_model_that_jumps_contain_the_truth_as_often_as_stated_and_do_not_shrink():
    """Numbers of 100 fits within 2.6 standard deviations of 95%; errors follow the noise, of 200 values, to 5% each."""
    count, inside, errors = 100, np.zeros(2), []
    for seed in range(count):
        chance = np.random.default_rng(seed)
        truth = np.array([0.0, chance.uniform(-0.02, 0.02)])
        data = trace(truth) + NOISE * chance.standard_normal((len(TIME), 1))
        found = estimate(lambda p, data=data: data - trace(p), slopes, truth + 0.02, np.array([1.0]))
        inside += np.abs(found.parameters - truth) <= found.half_width
        errors.append(found.error)
    assert np.all(inside >= 0.95 * count - 2.6 * np.sqrt(0.95 * 0.05 * count))
    assert np.all(np.max(errors, axis=0) < 1.5 * np.min(errors, axis=0))


# --- scenes -----------------------------------------------------------------------------------------------------------

PLAIN = {
    **{"name": "jumps", "chains": 2, "beads": 6, "duration": 15.0, "kick": {"velocity": 1.0}},
    **{"coupling": {"stiffness": 0.2}, "damping": {"contact": 0.2}},
}
SCENES = {
    "gap": ({**PLAIN, "gap": 0.3}, ("damping.contact", "gap"), ("force_contact_2_chain_1", "force_contact_2_chain_2")),
    "kinds, resonators, foundation": (
        {
            **{**PLAIN, "kinds": {"heavy": {"mass": 1.0}, "light": {"mass": 0.4}}, "pattern": ["heavy", "light"]},
            **{"resonators": {"mass": 0.3, "stiffness": 0.6}, "foundation": {"stiffness": 0.1}},
        },
        ("coupling.stiffness", "damping.contact"),
        ("force_contact_2_chain_1", "velocity_1_4"),
    ),
}
FITS = 3
"""Of each scene."""


@pytest.mark.slow
def test_intervals_of_fields_contain_the_truth_as_often_as_stated_where_contacts_with_dashpots_close(tmp_path):
    """6 fits of two fields to traces with 3% noise; binomial: of 12 intervals at least 11.4 - 2.6 * 0.75 hold."""
    inside = left_out = 0
    for scene, names, channels in SCENES.values():
        time = np.arange(0.0, scene["duration"], 0.1)
        table = tmp_path / "data.csv"
        empty = np.column_stack([time, np.zeros((len(time), len(channels)))])
        np.savetxt(table, empty, delimiter=",", header=",".join(("time", *channels)), comments="")
        model = Model(scene, "jumps", names, table, 0.0)
        exact = model.traces(np.zeros(len(names)))
        size, errors = np.abs(exact).max(axis=0), []
        for seed in range(FITS):
            chance = np.random.default_rng(seed)
            noisy = exact + 0.03 * size * chance.standard_normal(exact.shape)
            model.measured = replace(model.measured, values=noisy)
            found = estimate(model.residuals, model.slopes, 0.03 * chance.standard_normal(len(names)), size)
            inside += int(np.sum(np.abs(found.parameters) <= found.half_width))
            left_out += int(found.jumps.sum())
            errors.append(found.error)
        assert np.all(np.max(errors, axis=0) < 1.5 * np.min(errors, axis=0))
    assert left_out > 0
    count = 2 * FITS * len(SCENES)
    assert inside >= 0.95 * count - 2.6 * np.sqrt(0.95 * 0.05 * count)
