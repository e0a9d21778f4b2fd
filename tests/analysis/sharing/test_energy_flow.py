"""Where the energy is over time: by states made by hand."""

import numpy as np
import pytest
from small_problems import problem

from analysis.sharing.energies import Flow, FlowMeter
from analysis.sharing.run_error import UNMEASURED, MeasuredError, flow_with_error
from analysis.trajectory import Trajectory


def flow_of(what, displacement, velocity):
    """Of one frame, [chain, bead]."""
    frame = Trajectory(what, np.zeros(1), np.asarray(displacement)[np.newaxis], np.asarray(velocity)[np.newaxis])
    return FlowMeter(what).read([frame])


def test_each_chain_has_its_share_around_its_beads():
    """Chain 1 has bead 2 and bead 6 moving, with four times the energy of bead 3 of chain 2."""
    velocity = np.zeros((2, 8))
    velocity[0, [1, 5]], velocity[1, 2] = np.sqrt(2.0), 1.0
    found = flow_of(problem(), np.zeros((2, 8)), velocity)
    assert found.share[0] == pytest.approx([0.8, 0.2])
    assert found.centre[0] == pytest.approx([4.0, 3.0])
    assert found.spread[0] == pytest.approx([2.0, 0.0])
    assert found.between[0] == 0.0


def test_springs_between_chains_hold_energy_that_is_no_chains():
    """All eight beads of chain 1 are ahead by 0.3; the kick has the energy 1/2."""
    displacement = np.zeros((2, 8))
    displacement[0] = 0.3
    found = flow_of(problem(kappa=0.1), displacement, np.ones((2, 8)))
    assert found.between[0] == pytest.approx(8 * 0.5 * 0.1 * 0.3**2 / 0.5)
    assert found.share[0] == pytest.approx([0.5, 0.5])


@pytest.mark.parametrize("velocity", [0.0, 6e-17])  # the cosine of 90 degrees, as a drive at rest has it
def test_shares_are_undefined_where_no_chain_has_energy(velocity):
    found = flow_of(problem(), np.zeros((2, 8)), np.eye(2, 8) * velocity)
    assert np.isnan(found.share).all()
    share = np.array([[np.nan, np.nan], [np.nan, np.nan], [0.4, 0.6]])
    assert Flow(np.arange(3.0), share, *(np.zeros(3),) * 3).extremes(1) == ((0.6, 2.0), (0.6, 2.0))


def test_the_least_and_most_that_a_chain_has_are_told_with_their_times():
    time, share = np.array([0.0, 1.0, 2.0, 3.0]), np.array([1.0, 0.7, 0.2, 0.4])
    flow = Flow(time, np.stack([share, 1.0 - share], axis=1), *(np.zeros(4),) * 3)
    assert flow.extremes(0) == ((0.2, 2.0), (0.7, 1.0))
    assert flow.extremes(1) == ((pytest.approx(0.3), 1.0), (0.8, 2.0))
    assert Flow(time[:2], flow.share[:2], *(np.zeros(2),) * 3).extremes(0) == ((0.7, 1.0), (0.7, 1.0))


@pytest.mark.slow
def test_shares_centres_and_spreads_are_off_by_no_more_than_errors_of_velocities_make_them():
    """Velocities of 200 states, each off by the largest error either way."""
    chance, error, what = np.random.default_rng(1), 1e-3, problem()
    for _ in range(200):
        velocity = chance.normal(size=(2, 8))
        exact, moved = (
            flow_of(what, np.zeros((2, 8)), velocity + off)
            for off in (0.0, error * chance.choice([-1.0, 1.0], size=(2, 8)))
        )
        stated = flow_with_error(exact, MeasuredError(error, measured=True), what)
        assert np.all(np.abs(moved.share - exact.share) <= stated.share_error[:, np.newaxis])
        assert np.all(np.abs(moved.centre - exact.centre) <= stated.centre_error)
        assert np.all(np.abs(moved.spread - exact.spread) <= stated.spread_error)
    assert flow_with_error(exact, UNMEASURED, what).share_error is None
