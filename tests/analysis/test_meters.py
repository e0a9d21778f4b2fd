"""Parts of a run: every frame belongs to one, and has its neighbours around it, wherever blocks begin."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_problems import problem
from synthetic_waves import cut, reference, surveyed

from analysis import motion
from analysis.conservation import ConservationMeter
from analysis.contacts import OverlapMeter
from analysis.meters import measured, parts_of
from analysis.shape.waveforms import reach
from analysis.sharing.energies import FlowMeter, ShareMeter
from analysis.sharing.impulses import ImpulseMeter
from analysis.sharing.survey import survey
from analysis.tracking.peaks import PeakMeter, find_peaks
from analysis.trajectory import Trajectory
from lammps_inputs import Kick


@pytest.fixture(scope="module")
def gapped():
    """Frames, meters of all kinds, and what these measure in one block."""
    run = reference(chains=2, beads=12, kappa=0.3, gap=0.4, duration=30.0)
    found = survey(run.blocks, run.problem)
    meters = {
        "impulses": ImpulseMeter(run.problem),
        "flow": FlowMeter(run.problem),
        "waveforms": found._waveform_meter(),
        "energies": ShareMeter(run.problem, found.shared),
        "maxima": PeakMeter(),
        "first maxima": PeakMeter(first_only=True),
        "drifts": ConservationMeter(run.problem),
        "overlap": OverlapMeter(run.problem),
    }
    return run, meters, measured(meters, [run])


def numbers_of(result):
    """All numbers that a meter's result has, whatever their shapes."""
    values = [result] if isinstance(result, np.ndarray) else vars(result).values()
    return [np.asarray(value) for value in values if isinstance(value, np.ndarray | float)]


@pytest.mark.slow
@settings(max_examples=6, deadline=None)
@given(st.sets(st.integers(1, 300), max_size=12).map(sorted))
def test_no_number_depends_on_where_blocks_begin(gapped, places):
    run, meters, whole = gapped
    in_blocks = measured(meters, cut(run, places))
    for name in meters:
        assert numbers_of(whole[name])
        for expected, value in zip(numbers_of(whole[name]), numbers_of(in_blocks[name]), strict=True):
            np.testing.assert_allclose(value, expected, rtol=0.0, atol=1e-9 if name == "energies" else 0.0)


def test_beads_that_a_window_leaves_while_they_quicken_have_no_maximum_there():
    what = problem(beads=100, window=64, frames=19)
    time, x = np.arange(20) * what.every, np.zeros((20, what.chains, 64))
    x += 1e-4 * np.arange(64)[::-1] ** 2
    v = 0.5 + time[:, np.newaxis, np.newaxis] * motion.acceleration(what.system, x[:1])
    before = Trajectory(what, time[:10], x[:10], v[:10])
    after = Trajectory(what, time[10:], x[10:, :, 16:], v[10:, :, 16:], first=17)
    first, second = parts_of([before, after])
    assert np.isnan(first.around.velocity[10:, :, :16]).all()
    assert np.isfinite(first.around.velocity[10:, :, 16:]).all()
    assert np.isfinite(second.around.velocity).all()
    peaks = find_peaks([before, after], direction=1)
    assert not np.any((peaks.time > 0.0) & (peaks.bead <= 16))


@pytest.fixture(scope="module")
def complete():
    """Frames of all beads with a fast pulse and slow ones behind it, meters of its waves, and what they measure."""
    kicks = [Kick(velocity=1.0), Kick(chain=2, velocity=0.2), Kick(chain=1, bead=3, velocity=0.1)]
    run = reference(chains=2, beads=100, kappa=0.05, duration=100.0, every=0.5, kicks=kicks)
    found = surveyed(run)
    meters = {"waveforms": found._waveform_meter(), "energies": found._share_meter()}
    return run, meters, measured(meters, [run])


def first_beads(run, moves):
    """First bead of a window of 64 at each frame: it moves on at some frames, and as far as the front makes it."""
    first = np.ones(run.frames, dtype=int)
    for frame, beads in moves:
        first[frame:] += beads
    front = [run.moving_at(slice(frame, frame + 1)).stop for frame in range(run.frames)]
    return np.maximum.accumulate(np.clip(first, np.array(front) - 62, 37))


def in_window(run, first):
    """Frames as a window of 64 beads would hold them, in a block for each place of it."""
    what = replace(run.problem, rows=run.problem.rows.near_front(64))
    edges = [0, *(np.flatnonzero(np.diff(first)) + 1).tolist(), run.frames]
    return [
        replace(run[start:end].on(first[start], first[start] + 63), problem=what)
        for start, end in itertools.pairwise(edges)
    ]


moves = st.lists(st.tuples(st.integers(1, 199), st.integers(1, 36)), max_size=4)


@pytest.mark.slow
@settings(max_examples=8, deadline=None)
@given(moves)
def test_energies_of_waves_in_a_window_are_those_of_all_beads_or_undefined_where_it_has_left_one(complete, moves):
    run, meters, whole = complete
    first = first_beads(run, moves)
    blocks = in_window(run, first)
    held = measured({name: replace(meter, problem=blocks[0].problem) for name, meter in meters.items()}, blocks)
    near, expected = (of["waveforms"].near.value for of in (held, whole))
    np.testing.assert_allclose(near[np.isfinite(near)], expected[np.isfinite(near)], rtol=0.0, atol=1e-9)
    energies = (of["energies"] for of in (held, whole))
    values, expected = (np.stack([of.wave, of.wave_error]) for of in energies)
    # differences over a short time feel the missing bead behind that of the first of their beads a little
    np.testing.assert_allclose(values[np.isfinite(values)], expected[np.isfinite(values)], rtol=0.0, atol=1e-7)
    after = np.minimum(np.floor(meters["energies"]._time / run.spacing).astype(int) + 1, run.frames - 1)
    tail = np.where(first[after] > 1, first[after] + reach(run.problem) + 2, 1)
    inside = meters["energies"]._peaks[0] >= tail[:, np.newaxis]
    np.testing.assert_array_equal(np.isfinite(values[:, inside]), np.isfinite(expected[:, inside]))
