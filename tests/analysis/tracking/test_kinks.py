"""Forces that begin near a frame: a maximum is no less sure than it says."""

import itertools

import numpy as np
import pytest
from scipy.interpolate import BPoly

from analysis.tracking.brackets import DOUBT, MARGIN, unfollowed
from analysis.tracking.peaks import Peaks, find_peaks
from lammps_inputs import Scene
from workflow.engines.reference import engine

FINE = 0.01
"""Time between frames of which maxima are known."""


@pytest.mark.parametrize("power", [0.0, 0.5, 1.0, 1.5, 3.0])
@pytest.mark.parametrize(("away", "between"), [(0.3, True), (0.6, True), (0.02, False), (1.0, False)])
def test_what_no_polynomial_follows_is_what_hermites_misses(power, away, between):
    times, worst = np.linspace(0.0, 1.0, 501), np.zeros(2)
    for factor in DOUBT:
        begin = 1.0 - min(factor * away, 1.0) if between else -factor * away
        ends = [max(end - begin, 0.0) for end in (0.0, 1.0)]
        data = [
            [on ** (power + 1.0) / (power + 1.0), on**power * (on > 0), power * on ** (power - 1.0) if on > 0 else 0.0]
            for on in ends
        ]
        fitted, since = BPoly.from_derivatives([0.0, 1.0], data), np.maximum(times - begin, 0.0)
        misses = (
            (fitted(times) - since ** (power + 1.0) / (power + 1.0)),
            fitted(times, 1) - since**power * (since > 0.0),
        )
        worst = np.fmax(worst, [np.abs(missed).max() for missed in misses])
    found = unfollowed(power, np.array([away]), np.array([between]))[:, 0]
    np.testing.assert_allclose(found, MARGIN * worst, rtol=0.12, atol=1e-12)


def test_where_nothing_begins_nothing_is_missed():
    assert not unfollowed(1.5, np.array([np.inf, 10.0]), np.array([False, False])).any()


@pytest.mark.slow
@pytest.mark.parametrize(
    "keys",
    [
        {"damping": {"contact": 0.1}},
        {"damping": {"contact": 0.1, "law": "viscoelastic"}},
        {"contact": {"exponent": 1.0}},
        {"contact": {"exponent": 3.0}},
        {"damping": {"contact": 0.3}, "walls": {"right": "flat", "left": "bead"}, "gap": 0.3},
    ],
    ids=["dashpots", "viscoelastic", "linear", "cubic", "walls"],
)
def test_maxima_are_as_sure_as_they_say_whatever_the_contacts(keys):
    worst = 0.0
    for beads, bead in ((3, 1), (5, 2), (6, 3), (8, 1), (11, 2)):
        plain = {"name": "a", "beads": beads, "kick": {"bead": bead, "velocity": 1.0}, "duration": 24.0}
        run = engine.run(Scene.model_validate({**plain, "output": {"every": FINE}, **keys}).problem())
        for every, way in itertools.product((0.1, 0.2, 0.5), (1, -1)):
            right, found = (find_peaks([part], direction=way) for part in (run, run[:: round(every / FINE)]))
            worst = max([worst, *(_off(found, k, right, every) for k in range(len(found)))])
    assert 0.05 < worst < 1.0


@pytest.mark.slow
def test_beads_that_are_kicked_between_damped_walls_are_fastest_at_the_start():
    plain = {"name": "a", "beads": 3, "kick": {"velocity": 1.0}, "duration": 4.0, "output": {"every": 0.1}}
    plain |= {"damping": {"contact": 0.3}, "walls": {"right": "flat", "left": "bead"}}
    first = find_peaks([engine.run(Scene.model_validate(plain).problem())]).first()
    assert (first.bead[0], first.time[0], first.velocity[0]) == (1, 0.0, 1.0)


def _off(found: Peaks, k: int, right: Peaks, every: float) -> float:
    """Error of a maximum over what it states, if it is the one of the finer record and off by more than that."""
    same = np.flatnonzero((right.bead == found.bead[k]) & (np.abs(right.time - found.time[k]) < every))
    if len(same) == 0 or found.velocity[k] < 0.05:
        return 0.0
    errors = np.abs(right.velocity[same] - found.velocity[k])
    error = errors[np.argmin(np.abs(right.time[same] - found.time[k]))]
    return float(error / found.velocity_error[k]) if error > 2e-6 else 0.0
