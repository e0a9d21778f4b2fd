"""What section 3 of the paper says of beads with gaps, measured: the numbers that the page is written from."""

import numpy as np
import pytest

from workflow.plugins.gallery.entries import paper_gapped as study


@pytest.fixture(scope="module")
def limit():
    return study.rigid_limit()


def test_gapped_hertz_beads_become_rigid_as_the_root_of_kappa(limit):
    # a contact over a swing; the next order is another root of kappa, 1e-3 to 1e-2 here, times numbers of order 1
    assert limit.rate == pytest.approx([0.5, 0.5, 0.5], abs=0.05)
    assert limit.kappa[0] == 0.1  # at couplings of the paper they are far from rigid
    assert limit.difference[0].min() > 0.2
    # a bead that is passed in one model and struck in the other comes before the limit
    assert np.any(limit.hertz[1:3, 1, 0] == 0.0)
    assert limit.rigid[1, 0] > 0.5


def test_rigid_chains_that_come_to_agree_drift_apart_again():
    """The best theta found: a dozen rows within 1%, apart by more than the mean ten rows later."""
    first = study.rigid_impulses(study.rigid_problem(1.376, 42)).first
    assert first[:, 25 - 2] == pytest.approx([0.28982, 0.28922], abs=5e-6)
    one = study.scan(np.array([1.376]), 42)
    assert one.keeping(18, 29) == [1.376]
    assert len(one.keeping(20, 30)) == 0
    assert one.difference[0, one.bead == 41] > 1.0
    every = study.scan(np.linspace(0.05, 7.95, 160))
    by_row = [len(every.keeping(bead, bead)) for bead in range(2, 31)]
    # by chance: uniform differences between 0 and 2 would be below 0.01 in 1 of 200
    assert np.mean(by_row) < 0.02 * len(every.theta)


@pytest.mark.slow
def test_late_rigid_rows_belong_to_the_arithmetic():
    theta = np.linspace(0.05, 7.95, 80)
    assert np.mean(study.sensitivity(theta) > 0.01) > 0.5
    assert np.mean(study.sensitivity(theta, bead=3) > 0.01) < 0.1


@pytest.mark.parametrize(("kappa", "equal_from", "last"), [(1.0, 12, 60), (0.1, 63, 110)])
def test_gapped_hertz_chains_become_equal(kappa, equal_from, last):
    impulses = study.hertz_impulses(study.problem_at(study.THETA_OF_EQ_5, kappa, last))
    found = study.relative_mode(impulses, 5, last)
    assert found.equal_from == equal_from
    assert 0.0 < found.rows_per_e < 20.0


def test_the_relative_mode_of_a_known_decay_is_found():
    impulses = study.hertz_impulses(study.problem_at(study.THETA_OF_EQ_5, 1.0, 40))
    decay = 0.3 * np.exp(-impulses.bead / 7.0)
    known = impulses.__class__(
        impulses.bead, np.array([1.0 + decay, 1.0 - decay]), impulses.total, impulses.contacts, impulses.time, 0.0
    )
    found = study.relative_mode(known, 5, 40)
    assert found.rows_per_e == pytest.approx(7.0, rel=1e-9)
    np.testing.assert_allclose(found.difference, decay[3:39], rtol=1e-12)
    assert study.relative_mode(study.rigid_impulses(study.rigid_problem(2.0, 30)), 5, 30).equal_from is None
