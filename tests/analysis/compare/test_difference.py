"""Differences are reported with their size and place; places without a sharp time are left out."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_problems import problem, written_down
from synthetic_waves import cut

from analysis.compare.common_times import paired_parts
from analysis.compare.difference import QUANTITIES, DifferenceMeter, matched
from analysis.figures.errors import validation_figure
from analysis.tracking.peaks import THRESHOLD, PeakMeter, Peaks, sharp
from workflow.engines.reference import engine
from workflow.engines.reference.schemes import VERLET

LIMITS = {"velocity": 1e-3, "displacement": 1e-3, "amplitude": 1e-3, "arrival": 1e-3, "energy": 1e-3, "momentum": 1e-3}


@pytest.fixture(scope="module")
def run():
    """Two chains of 40 beads, until the pulse has passed bead 25 or so."""
    return engine.run(problem(beads=40, frames=300))


def compared(own, reference, starts=(), limits=LIMITS):
    pairs = zip(cut(own, starts), cut(reference, starts), strict=True)
    return DifferenceMeter(limits).read(paired_parts(pairs))


def changed(run, frame, chain, bead, **by):
    """A run with one number changed."""
    fields = {}
    for name, amount in by.items():
        fields[name] = getattr(run, name).copy()
        fields[name][frame, chain - 1, bead - 1] += amount
    return replace(run, **fields)


def test_a_run_does_not_differ_from_itself(run):
    found = compared(run, run).deviations
    assert tuple(found) == QUANTITIES
    for name in ("velocity", "displacement", "amplitude", "arrival"):
        assert (found[name].largest, found[name].rms, found[name].first) == (0.0, 0.0, None)


@pytest.mark.slow
@given(st.integers(0, 300), st.integers(1, 2), st.integers(1, 40), st.floats(2e-3, 1e3), st.sampled_from([-1.0, 1.0]))
def test_one_wrong_number_is_found_where_it_is(run, frame, chain, bead, size, sign):
    found = compared(changed(run, frame, chain, bead, velocity=sign * size), run, [64, 128]).deviations["velocity"]
    assert found.largest == pytest.approx(size, rel=1e-12)
    assert found.rms == pytest.approx(size / math.sqrt(301 * 80), rel=1e-9)
    for place in (found.where, found.first):
        assert (place.chain, place.bead, place.time) == (chain, bead, pytest.approx(0.1 * frame))


def test_the_first_excess_is_the_earliest_not_the_largest(run):
    wrong = changed(changed(run, 200, 2, 9, displacement=1.0), 50, 1, 3, displacement=2e-3)
    found = compared(wrong, run, [100]).deviations["displacement"]
    assert (found.where.time, found.first.time) == (pytest.approx(20.0), pytest.approx(5.0))


def test_a_number_that_is_none_counts_as_largest_even_if_all_later_ones_are_right(run):
    found = compared(changed(run, 10, 1, 2, velocity=np.nan), run, [30]).deviations["velocity"]
    assert math.isnan(found.largest)
    assert found.where == found.first
    assert found.where.time == pytest.approx(1.0)


@pytest.mark.slow
@pytest.mark.parametrize("value", [1e200, -np.inf, np.nan])
def test_a_run_that_blew_up_is_compared_and_drawn_without_complaint(run, value):
    difference = compared(changed(run, 100, 1, 5, velocity=value, displacement=value), run)
    found = difference.deviations
    assert not found["velocity"].largest <= 1e3
    validation_figure(run.problem, difference.error_map, found, LIMITS, "itself").draw_without_rendering()


def test_arrival_and_amplitude_are_those_of_the_pulse(run):
    finer = engine.run(run.problem, steps_per_frame=16)
    coarse = engine.run(run.problem, scheme=VERLET, steps_per_frame=2)
    found = compared(coarse, finer).deviations
    peaks = [PeakMeter(first_only=True).read(trajectory.blocks()) for trajectory in (coarse, finer)]
    here, there = (peak.where((peak.bead < 22) & (peak.velocity > 0.1)) for peak in peaks)
    assert found["arrival"].largest >= np.max(np.abs(here.time - there.time)) > 1e-3
    assert found["amplitude"].largest >= np.max(np.abs(here.velocity - there.velocity)) > 1e-5
    assert found["arrival"].first.time == pytest.approx(
        there.time[np.abs(here.time - there.time) > LIMITS["arrival"]].min(), abs=1e-6
    )


def peaks(*entries, pressing=1.0):
    """Peaks of (chain, bead, time, velocity)."""
    chain, bead, time, velocity = (np.array(column) for column in zip(*entries, strict=True))
    pressed, sure = np.broadcast_to(pressing, len(chain)).astype(float), np.zeros(len(chain))
    return Peaks(chain, bead, time, velocity, pressed, time, sure, sure, sure)


def test_passages_are_matched_by_bead_without_faint_ones_the_start_and_the_last_bead():
    own = peaks((1, 1, 0.0, 1.0), (1, 2, 1.0, 0.5), (1, 4, 3.0, 1.5 * THRESHOLD), (1, 5, 4.0, 0.3), (2, 2, 1.1, 0.2))
    other = peaks((1, 1, 0.0, 1.0), (1, 3, 2.0, 0.5), (1, 4, 9.0, 0.3), (1, 5, 4.0, 0.3), (2, 2, 1.2, 0.2))
    for found in matched(own, other, 5):
        assert list(zip(found.chain.tolist(), found.bead.tolist(), strict=True)) == [(2, 2)]


@pytest.mark.parametrize(
    ("pressing", "velocity", "is_sharp"),
    [(0.35, 1.0, True), (0.35 * 0.01**2, 0.01, True), (0.0, 1.0, False), (-3.0, 1.0, False), (np.nan, 1.0, True)],
)
def test_a_passage_is_sharp_unless_the_bead_flies_freely(pressing, velocity, is_sharp):
    assert sharp(peaks((1, 1, 0.0, velocity), pressing=pressing)).tolist() == [is_sharp]


@pytest.mark.parametrize(("kappa", "gap"), [(1.0, 0.909), (0.1, 1.0)])
def test_arrivals_of_a_good_run_with_gaps_are_right_to_a_fiftieth_of_a_frame(kappa, gap):
    gapped = problem(beads=60, frames=1300, kappa=kappa, gap=gap)
    own, reference = engine.run(gapped, scheme=VERLET, steps_per_frame=10), engine.run(gapped, steps_per_frame=16)
    assert compared(own, reference).deviations["arrival"].largest < 2e-3


def test_the_map_shows_a_wrong_number_in_its_cell():
    long = problem(beads=1000, frames=900, recorded=tuple(range(1, 1001)))
    run = written_down(long, lambda t: (0.0 * t, 0.0 * t))
    found = compared(changed(run, 451, 2, 700, velocity=0.5), run).error_map
    row, column = np.unravel_index(np.argmax(found.velocity), found.velocity.shape)
    assert found.velocity.max() == 0.5
    assert max(found.velocity.shape) <= 400
    assert found.velocity.shape == (len(found.time) - 1, len(found.bead) - 1)
    assert found.time[row] <= 45.1 < found.time[row + 1]
    assert found.bead[column] <= 700 < found.bead[column + 1]
    assert (found.time[-1], found.bead[-1]) == (pytest.approx(90.0), 1001)
