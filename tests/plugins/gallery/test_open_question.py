"""What the gallery says of the paper's open question: maps from row to row against runs and closed forms."""

import math

import numpy as np
import pytest

from workflow.plugins.gallery import gapped_pairs, row_map, touching_arrays
from workflow.plugins.gallery.touching_arrays import ring_of, row_of, square_of


@pytest.mark.parametrize("stiffness", [1e-4, 1e-3, 1e-2])
def test_soft_springs_take_4_over_45_of_the_squared_phase_of_a_contact(stiffness):
    phase = math.sqrt(stiffness) * row_map.CONTACT
    tongue = row_map.tongue(stiffness)
    relative = 2.0 * stiffness  # of the next order: 0.09 to 0.9 times the stiffness
    assert row_map.typical_decay(stiffness) == pytest.approx(row_map.LOSS * phase**2 / 2.0, rel=relative)
    assert tongue.shift == pytest.approx(row_map.DELAY * phase, rel=relative)
    assert tongue.half_width == pytest.approx(row_map.LOSS * phase, rel=relative)


@pytest.mark.parametrize("stiffness", [0.05, 0.3])
def test_a_mode_grows_within_the_unstable_range_only_and_keeps_its_size_at_the_border(stiffness):
    tongue = row_map.tongue(stiffness)
    middle = 2.0 * math.pi - tongue.shift
    decay = [row_map.predicted_decay(middle + share * tongue.half_width, stiffness) for share in (0.0, 0.99, 1.0, 1.01)]
    assert decay[0] == pytest.approx(-tongue.growth, abs=1e-12)
    assert decay[1] < 0.0 < decay[3]
    assert decay[2] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.slow
def test_above_a_coupling_the_pulse_is_stable_at_every_gap():
    border = row_map.stable_at_any_gap()
    assert row_map.tongue(0.999 * border).half_width > 0.0
    assert row_map.tongue(1.001 * border).half_width == 0.0
    thetas = np.linspace(2.0, 5.2, 200)
    assert min(row_map.predicted_decay(theta, 1.001 * border) for theta in thetas) > 0.0


@pytest.mark.parametrize(("theta", "kappa"), [(1.3, 0.03), (2.5, 0.3)])
def test_a_nearly_synchronised_pulse_follows_the_map_from_row_to_row(theta, kappa):
    rows, apart = 40, 1e-3
    problem = gapped_pairs.problem_of(gapped_pairs.gapped(theta, kappa, rows, [1.0, 1.0 - apart], every=0.1))
    measured = gapped_pairs.measured(theta, kappa, gapped_pairs.impulses_until(problem, rows), rows)
    # the impulses' error, 1e-7, over the difference of the chains
    assert measured.recurrence.trace == pytest.approx(float(np.trace(measured.predicted)), abs=1e-3)
    assert measured.recurrence.determinant == pytest.approx(float(np.linalg.det(measured.predicted)), abs=1e-3)


def test_the_pulse_of_a_kicked_chain_settles_where_the_map_is_stable():
    cell = gapped_pairs.shared(2.2, 0.3)
    theta, stiffness = cell.at_speed
    assert cell.within(0.01) is not None
    assert row_map.predicted_decay(theta, stiffness) > 0.0
    assert cell.recurrence is not None
    assert cell.recurrence.determinant == pytest.approx(np.linalg.det(row_map.row_map(theta, stiffness)), abs=2e-3)


def test_the_gap_of_eq_5_agrees_to_1_percent_from_row_63_on():
    cell = gapped_pairs.shared(1.2854, 0.1)
    assert cell.within(0.01) == 63
    assert cell.amplitude == pytest.approx(0.5272, abs=1e-4)


@pytest.mark.parametrize(("graph", "number"), [(row_of(2), 1), (row_of(3), 2), (ring_of(4), 3)])
def test_relative_modes_of_touching_arrays_decay_and_beat_as_closed_forms_say(graph, number):
    kappa = 0.03
    values, vectors = graph.modes()
    vector = vectors[:, number] / np.max(np.abs(vectors[:, number]))
    plain = touching_arrays.plain_array(graph, kappa, 1.0 - 2e-3 + 2e-3 * vector, 500)
    stiffness = float(values[number]) * kappa
    mode = touching_arrays.mode_of(touching_arrays.peaks(touching_arrays.problem_of(plain)), vector, stiffness)
    assert mode is not None
    # of the next order in the stiffness, with the factors 0.15 and 0.4
    assert mode.decay == pytest.approx(touching_arrays.decay(stiffness, mode.amplitude), rel=0.2 * stiffness)
    assert mode.wavenumber == pytest.approx(
        touching_arrays.beat(math.sqrt(stiffness), mode.amplitude), rel=0.5 * stiffness
    )


@pytest.mark.parametrize(
    ("graph", "kicked", "slowest", "spread"),
    [
        (row_of(2), (0,), 2.0, 2.0),  # velocities 1/2 and -1/2, mean 1/2
        (row_of(3), (0,), 1.0, 3.0),  # 1/2, 0, -1/2; mean 1/3
        (row_of(3), (1,), 3.0, 3.0),  # -1/3, 2/3, -1/3
        (ring_of(4), (0,), 2.0, 4.0),  # 1/2, 0, -1/2, 0; mean 1/4
        (row_of(4), (0, 3), 2.0, 2.0),  # 1/2, -1/2, -1/2, 1/2; mean 1/2
        (square_of(3), (4,), 3.0, 6.0),
    ],
)
def test_the_slowest_mode_is_that_which_the_kicks_excite(graph, kicked, slowest, spread):
    assert graph.slowest(kicked) == pytest.approx((slowest, spread), abs=1e-9)
