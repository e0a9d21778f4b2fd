"""The root search against dense sampling: what it rules out does not happen, and what it finds does."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from workflow.plugins.rigid.roots import CONTACT, LOOK_AGAIN, NEVER, PairDistance, first_contact

SAMPLES = 4001
amplitude = st.floats(-2.0, 2.0).map(lambda a: round(a, 6))


class Distance:
    def __init__(self, start, drift, waves, omega):
        self.start, self.drift, self.waves, self.omega = start, drift, np.array(waves, float), np.array(omega, float)

    def at(self, t):
        phase = np.multiply.outer(np.asarray(t, float), self.omega)
        return self.start + self.drift * np.asarray(t) + np.cos(phase) @ self.waves[0] + np.sin(phase) @ self.waves[1]

    def slope(self, t):
        phase = np.multiply.outer(np.asarray(t, float), self.omega)
        return self.drift + np.cos(phase) @ (self.omega * self.waves[1]) - np.sin(phase) @ (self.omega * self.waves[0])

    def search(self, limit, now=0.0, gap=1.0):
        now_at, slope = float(self.at(0.0)), float(self.slope(0.0))
        distance = PairDistance(now_at, slope, self.start, self.drift, self.waves, self.omega)
        return first_contact(distance, limit, now, gap)


@st.composite
def distances(draw, fewest=0):
    count = draw(st.integers(fewest, 4))
    omega = [draw(st.floats(0.05, 5.0)) for _ in range(count)]
    waves = [[draw(amplitude) for _ in omega] for _ in "ab"]
    now = draw(st.one_of(st.just(0.0), st.floats(0.0, 3.0)))  # touching, or some way apart
    return Distance(now - sum(waves[0]), draw(st.floats(-0.5, 0.5)), waves, omega)


@pytest.mark.slow
@settings(max_examples=100, deadline=None)
@given(distances(), st.floats(0.1, 300.0))
def test_nothing_closes_before_the_time_that_the_search_returns(distance, limit):
    found, outcome = distance.search(limit)
    until = min(found, limit)
    before = distance.at(np.linspace(0.0, until, SAMPLES))
    scale = 1.0 + abs(distance.start) + abs(distance.drift) * until + abs(distance.waves).sum() * (1.0 + until)
    touching_from_the_start = min(0.0, float(distance.at(0.0)))
    assert before.min() >= touching_from_the_start - 20.0 * np.finfo(float).eps * scale
    if outcome == CONTACT:
        assert abs(distance.at(found)) <= 20.0 * np.finfo(float).eps * scale
        assert distance.slope(found) <= 1e-12
    elif outcome == NEVER:
        assert found == math.inf
    else:
        assert outcome == LOOK_AGAIN
        assert found > 0.0


@pytest.mark.slow
@settings(max_examples=100, deadline=None)
@given(distances(fewest=1), st.floats(1e-13, 1e-3))
def test_a_dip_is_found_however_shallow(distance, depth):
    t = np.linspace(0.0, 30.0, 60001)
    inner = np.flatnonzero(np.diff(np.sign(distance.slope(t))) > 0.0)
    if len(inner) == 0:
        return
    low = t[inner[distance.at(t[inner]).argmin()]]
    for _ in range(6):  # Newton on the slope
        phase = distance.omega * low
        bend = -(distance.omega**2) @ (distance.waves[0] * np.cos(phase) + distance.waves[1] * np.sin(phase))
        low -= float(distance.slope(low)) / bend if bend > 1e-3 else 0.0
    lowered = Distance(distance.start - float(distance.at(low)) - depth, distance.drift, distance.waves, distance.omega)
    if lowered.at(0.0) <= 1e-9 or low < 0.0:
        return
    found, outcome = lowered.search(100.0)
    assert outcome == CONTACT
    assert found <= low + 1e-9
