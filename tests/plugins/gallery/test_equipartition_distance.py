"""Equipartition over coupling and number of chains."""

import pytest

from analysis.sharing.verdict import expected_n_star
from workflow.plugins.gallery.equipartition_distance import (
    DECAY_LENGTH,
    equipartition_distance,
)


@pytest.mark.parametrize(
    ("chains", "kappa", "ten", "one", "amplitude"),
    [
        (2, 0.5, 11, 17, 0.35934),
        (2, 0.1, 33, 62, 0.36524),
        pytest.param(2, 0.01, 265, 507, 0.3196, marks=pytest.mark.slow),
        (3, 0.1, 64, 105, 0.25559),
    ],
)
def test_the_known_distances_and_amplitudes_come_out_and_agree_with_a_window_twice_as_wide(
    chains: int, kappa: float, ten: int, one: int, amplitude: float
) -> None:
    case = equipartition_distance(chains, kappa)
    assert (case.within_10, case.within_1) == (ten, one)
    assert case.amplitude == pytest.approx(amplitude, abs=5e-5)
    assert case.window_error <= 1e-6


def test_a_chain_too_short_to_level_out_says_so() -> None:
    case = equipartition_distance(2, 0.01, most_beads=100)
    assert case.within_1 is None
    assert case.beads == 100


def test_the_rounded_decay_length_is_that_of_the_exact_wave() -> None:
    assert pytest.approx(expected_n_star(1.0), abs=5e-4) == DECAY_LENGTH
