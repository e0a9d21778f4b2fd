"""Traces as they would have been measured: of which beads, with and without what contacts bear at rest."""

import numpy as np
import pytest
from small_problems import written_down

from analysis.files.traces import Channel
from analysis.gauges.gauge import beads_of, complaint, read, read_at
from lammps_inputs import library

PLAIN = {
    "name": "test",
    "chains": 2,
    "beads": 8,
    "kick": {"velocity": 1.0},
    "duration": 5.0,
    "walls": {"right": "flat"},
    "precompression": {"force": 0.3},
}

PROBLEM = library.from_plain(PLAIN, "test").problem()


@pytest.mark.parametrize(
    ("kind", "first", "last"), [("contact", 1, 7), ("sensor", 2, 7), ("velocity", 1, 8), ("displacement", 1, 8)]
)
def test_channels_are_of_beads_that_have_such(kind, first, last):
    for bead in range(10):
        said = complaint(Channel(kind, 2, bead), PROBLEM)
        assert said == (None if first <= bead <= last else f"beads {first} to {last} of the scene have such")


def test_walls_and_chains_must_be_there():
    assert complaint(Channel("wall", 1, right=True), PROBLEM) is None
    assert complaint(Channel("wall", 1, right=False), PROBLEM) == "the scene has no left wall"
    assert complaint(Channel("velocity", 3, 1), PROBLEM) == "the scene has chains 1 to 2"


def test_a_force_takes_the_beads_on_either_side():
    of = {Channel("contact", 1, 4): (4, 5), Channel("sensor", 1, 4): (3, 4, 5), Channel("velocity", 1, 4): (4,)}
    for channel, beads in of.items():
        assert beads_of((channel,), PROBLEM) == beads
    assert beads_of((Channel("wall", 1, right=True), *of), PROBLEM) == (3, 4, 5, 8)


def test_a_dynamic_force_is_that_above_rest_and_nothing_is_before_the_start():
    channels = tuple(
        Channel(kind, 1, 4, dynamic=dynamic) for kind in ("contact", "sensor") for dynamic in (False, True)
    )
    channels += tuple(Channel("wall", 1, right=True, dynamic=dynamic) for dynamic in (False, True))
    rest = written_down(PROBLEM, lambda t: (0.0 * t, 0.0 * t))
    np.testing.assert_allclose(read(rest, channels), [[0.3, 0.0] * 3] * rest.frames, rtol=1e-9, atol=1e-12)
    before, after = read_at(rest, channels, np.array([-0.5, 1.23]))
    assert not np.any(before)
    np.testing.assert_allclose(after, [0.3, 0.0] * 3, rtol=1e-9, atol=1e-12)
