"""Two streams of one run, cut anywhere, come out as pairs of the same frames."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_problems import problem, written_down

from analysis.against.common_times import OtherFramesError, paired
from analysis.trajectory import joined

RUN = written_down(problem(frames=30), lambda t: (np.sin(t), np.cos(t)))

CUTS = st.lists(st.integers(0, 31), max_size=6).map(sorted)


def cut(trajectory, places):
    ends = [0, *places, trajectory.frames]
    return [trajectory[start:end] for start, end in itertools.pairwise(ends)]


@given(CUTS, CUTS)
def test_cuts_do_not_matter_even_empty_pieces(places, others):
    pairs = list(paired(cut(RUN, places), cut(RUN, others)))
    for a, b in pairs:
        assert a.frames > 0
        np.testing.assert_array_equal(a.time, b.time)
    np.testing.assert_array_equal(joined(a for a, _ in pairs).velocity, RUN.velocity)


@given(CUTS, CUTS, st.integers(1, 30))
def test_pairs_end_with_the_shorter_stream(places, others, frames):
    pairs = list(paired(cut(RUN, places), [piece for piece in cut(RUN[:frames], []) if others is not None]))
    assert sum(a.frames for a, _ in pairs) == frames


def test_no_frame_is_lost_when_one_stream_is_empty():
    assert list(paired([RUN], [])) == []


def test_frames_at_other_times_are_refused_by_the_first_that_differs():
    late = replace(RUN, time=np.where(RUN.time > 1.95, RUN.time + 1e-3, RUN.time))
    with pytest.raises(OtherFramesError, match=r"t = 2 .*where 2\.001 is expected"):
        list(paired([RUN], [late]))


def test_times_that_differ_by_rounding_are_the_same():
    assert len(list(paired([RUN], [replace(RUN, time=RUN.time * (1.0 + 1e-12))]))) == 1


def test_other_beads_are_refused():
    other = written_down(problem(frames=30, recorded=(1, 2, 3, 4, 5, 6, 7, 8)), lambda t: (np.sin(t), np.cos(t)))
    fewer = written_down(problem(frames=30, recorded=(1, 3)), lambda t: (np.sin(t), np.cos(t)))
    assert len(list(paired([RUN], [other]))) == 1
    with pytest.raises(OtherFramesError, match="different beads"):
        list(paired([RUN], [fewer]))
