"""Which frames are compared with a reference."""

import pytest
from small_problems import problem

from workflow.prepare.pilot import stride


@pytest.mark.parametrize(
    ("kappa", "apart"),
    [
        (0.1, 0.4),
        (50.0, 0.15),  # the period of the springs is 0.628
    ],
)
def test_frames_that_are_compared_are_0_4_apart_or_four_in_a_swing(kappa, apart):
    fine = problem(kappa=kappa, timestep=0.001, frames=6000)
    assert stride(fine) * fine.every == pytest.approx(apart)


def test_few_frames_are_all_compared():
    assert stride(problem(timestep=0.001, frames=100)) == 1
