"""Where the leading pulse of a loaded chain is measured, either way."""

import numpy as np
import pytest

from analysis import motion
from analysis.sound.loaded_pulse import LoadedPulse
from lammps_inputs import laws, library
from workflow.engines.reference import engine


def found(bead, velocity):
    """Forty beads, one of them kicked."""
    plain = {"name": "test", "beads": 40, "precompression": {"force": 0.3}, "duration": 36.0}
    kick = {"bead": bead, "velocity": velocity}
    problem = library.from_plain({**plain, "kick": kick, "output": {"every": 0.05}}, "test").problem()
    pulse, run = LoadedPulse(problem), engine.run(problem)
    for block in (run[:100], run[100:]):
        pulse.add(block)
    return pulse.result(), run


@pytest.mark.parametrize(("bead", "first"), [(1, 24), (29, 29)])
def test_it_is_over_ten_contacts_before_the_last_five_and_not_before_the_kick(bead, first):
    wave, run = found(bead, 1.0)
    assert (wave.chain, wave.first, wave.last) == (1, first, 34)
    overlap = motion.overlaps(run.problem, run.displacement)[:, 0, first - 1 : 34]
    force = np.maximum(overlap, 0.0) ** 1.5 / float(laws.load(run.problem.along[0].law))
    assert wave.force_ratio == pytest.approx(np.mean(np.max(force, axis=0)), rel=1e-3)
    assert wave.speed == pytest.approx((34 - first) / np.ptp(run.time[np.argmax(force[:, [0, -1]], axis=0)]), rel=0.02)


@pytest.mark.parametrize("bead", [1, 29])
def test_in_the_mirror_it_is_the_same(bead):
    (one, _), (other, _) = found(bead, 1.0), found(41 - bead, -1.0)
    assert (other.first, other.last) == (40 - one.first, 40 - one.last)
    for name in ("force_ratio", "speed", "sound", "theory"):
        assert getattr(other, name) == pytest.approx(getattr(one, name), rel=1e-9)
