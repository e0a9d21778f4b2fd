"""Parts of a run: every frame belongs to one, and has its neighbours around it, wherever blocks begin."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_problems import problem
from synthetic_waves import reference

from analysis import motion
from analysis.meters import AFTER, BEFORE, Meter, measured, parts_of
from analysis.sharing.energies import FlowMeter, ShareMeter
from analysis.sharing.impulses import ImpulseMeter
from analysis.sharing.survey import survey
from analysis.tracking.peaks import find_peaks
from analysis.trajectory import Trajectory


def numbered(frames):
    """Frames whose displacement is their number, and whose velocity is minus that."""
    what = problem(frames=frames)
    number = np.arange(frames, dtype=float)
    state = np.broadcast_to(number[:, np.newaxis, np.newaxis], (frames, what.chains, what.beads))
    return Trajectory(what, number * what.every, state, -state)


def cut(run, places):
    edges = [0, *sorted({place for place in places if 0 < place < run.frames}), run.frames]
    return [run[start:end] for start, end in itertools.pairwise(edges)]


places = st.lists(st.integers(1, 60), max_size=12)


@given(st.integers(1, 60), places)
def test_every_frame_belongs_to_one_part_and_has_its_neighbours_around_it(frames, places):
    run, after = numbered(frames), 0
    for part in parts_of(cut(run, places)):
        assert part.start == after
        after += part.count
        first, last = max(0, part.start - BEFORE), min(frames, after + AFTER)
        assert part.around.displacement[:, 0, 0].tolist() == list(range(first, last))
        assert part.frames.displacement[:, 0, 0].tolist() == list(range(part.start, after))
        assert part.to_next.displacement[:, 0, 0].tolist() == list(range(part.start, min(frames, after + 1)))
        assert part.is_last == (after == frames)
    assert after == frames


@given(st.integers(1, 60), places, st.integers(1, 7))
def test_every_so_manieth_frame_of_the_run_is_chosen_wherever_blocks_begin(frames, places, stride):
    chosen = [part.frames.time[part.every(stride)] for part in parts_of(cut(numbered(frames), places))]
    assert np.concatenate(chosen).tolist() == numbered(frames).time[::stride].tolist()


@pytest.fixture(scope="module")
def gapped():
    return reference(chains=2, beads=12, kappa=0.3, gap=0.4, duration=30.0)


def arrays(result):
    if isinstance(result, np.ndarray):
        return [result]
    return [value for value in vars(result).values() if isinstance(value, np.ndarray)]


@settings(max_examples=10, deadline=None)
@given(st.lists(st.integers(1, 300), max_size=12))
def test_no_number_depends_on_where_blocks_begin(gapped, places):
    found = survey(gapped.blocks, gapped.problem)
    meters = {
        "impulses": ImpulseMeter(gapped.problem),
        "flow": FlowMeter(gapped.problem),
        "waveforms": found._waveform_meter(),
        "energies": ShareMeter(gapped.problem, found.shared),
    }
    whole, in_blocks = (measured(meters, blocks) for blocks in ([gapped], cut(gapped, places)))
    for name in meters:
        for expected, value in zip(arrays(whole[name]), arrays(in_blocks[name]), strict=True):
            np.testing.assert_allclose(value, expected, rtol=0.0, atol=1e-9 if name == "energies" else 0.0)


def test_beads_that_a_window_leaves_while_they_quicken_have_no_maximum_there():
    what = problem(beads=100, window=64, frames=19)
    time, x = np.arange(20) * what.every, np.zeros((20, what.chains, 64))
    x += 1e-4 * np.arange(64)[::-1] ** 2
    v = 0.5 + time[:, np.newaxis, np.newaxis] * motion.acceleration(what.system, x[:1])
    before = Trajectory(what, time[:10], x[:10], v[:10])
    after = Trajectory(what, time[10:], x[10:, :, 16:], v[10:, :, 16:], first=17)
    assert [part.left for part in parts_of([before, after])] == [16, 0]
    peaks = find_peaks([before, after], direction=1)
    assert not np.any((peaks.time > 0.0) & (peaks.bead <= 16))


def test_a_run_without_frames_has_no_parts_and_no_result():
    class Frames(Meter):
        def of_part(self, part):
            return part.count

        def result(self, pieces):
            return sum(pieces)

    assert Frames().read(cut(numbered(9), [4])) == 9
    assert list(parts_of([])) == []
    with pytest.raises(ValueError, match="no frames to measure"):
        Frames().read([])
