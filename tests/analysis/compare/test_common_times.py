"""Two trajectories at the same times: pairs of the same frames however the streams are cut, states between frames."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_problems import problem, written_down
from synthetic_waves import cut

from analysis import hermite
from analysis.compare.common_times import OtherFramesError, at_times, interpolation_error, paired, paired_parts
from analysis.trajectory import joined
from lammps_inputs import InputError
from workflow.engines.reference import engine

POWERS = np.arange(8.0)[:, np.newaxis]
AMPLIFIED = np.finfo(float).eps * np.abs(hermite.coefficients((0, 1, 2, 3), np.eye(8).reshape(4, 2, 8), 1.0))
ROUNDING = float(np.sum(3.0**POWERS * AMPLIFIED))
"""Of a displacement of size 1: last bits of the eight data, times coefficients, times powers of up to three frames."""
STEEPER = float(np.sum(POWERS * 3.0 ** (POWERS - 1.0) * AMPLIFIED))
"""Of its derivative, times the time between frames."""


def oscillating(frequency, phase):
    return lambda t: (np.sin(frequency * t + phase) / frequency, np.cos(frequency * t + phase))


def opening(instant, way):
    """A contact that opens or closes at an instant: force ``overlap**1.5`` of an overlap that falls evenly."""

    def motion(t):
        since = np.maximum(way * (t - instant), 0.0)
        return since**3.5 / 8.75, way * since**2.5 / 2.5

    return motion


def errors(motion, every, times):
    run = written_down(problem(chains=1, beads=2, timestep=every, steps_per_frame=1, frames=40), motion)
    found = at_times(run, times)
    displacement, velocity = motion(times[:, np.newaxis, np.newaxis])
    return (
        (float(np.max(np.abs(found.displacement - displacement))), float(np.max(np.abs(found.velocity - velocity)))),
        interpolation_error(run),
    )


def between(every):
    return np.sort(np.random.default_rng(1).uniform(0.0, 40.0 * every, 1000))


def test_a_polynomial_of_degree_seven_is_found_exactly():
    factors = np.array([0.3, -1.0, 0.7, 0.2, -0.4, 0.1, 0.05, -0.02])
    x = np.polynomial.Polynomial(factors)
    (displacement, velocity), bound = errors(lambda t: (x(t), x.deriv()(t)), 0.1, between(0.1))
    size = np.max(np.abs(x(np.linspace(0.0, 4.0, 100))))
    assert displacement < ROUNDING * size
    assert velocity < STEEPER * size / 0.1
    assert max(bound) < STEEPER * size / 0.1


@pytest.mark.slow
@settings(max_examples=200)
@given(st.floats(0.1, 0.9), st.sampled_from([-1.0, 1.0]), st.floats(0.02, 0.5))
def test_the_bound_holds_where_a_contact_opens_or_closes(share, way, every):
    (displacement, velocity), (x, v) = errors(opening(share * 40.0 * every, way), every, between(every))
    size = (40.0 * every) ** 3.5 / 8.75
    assert displacement <= x + ROUNDING * size
    assert velocity <= v + STEEPER * size / every


@pytest.mark.parametrize("every", [0.05, 0.1, 0.2, 0.4, 0.8])
def test_the_bound_holds_for_two_chains_and_is_no_worse_than_two_hundred_times_the_error(every):
    fine = problem(beads=40, timestep=0.0125, steps_per_frame=1, frames=40 * 80)
    truth = engine.run(fine, steps_per_frame=4)
    stride = round(every / fine.timestep)
    run = replace(truth[::stride], problem=fine.coarser(stride))
    found = at_times(run, truth.time)
    for name, bound in zip(("displacement", "velocity"), interpolation_error(run), strict=True):
        error = float(np.max(np.abs(getattr(found, name) - getattr(truth, name))))
        assert error <= bound <= 200.0 * error


def test_uneven_frames_are_refused():
    run = written_down(problem(), oscillating(1.0, 0.0))
    with pytest.raises(InputError, match="not evenly spaced"):
        at_times(replace(run, time=run.time**1.1), np.array([0.1]))


def test_of_eleven_frames_no_bound_is_known():
    assert interpolation_error(written_down(problem(frames=10), oscillating(1.0, 0.0))) == (np.inf, np.inf)


# --- pairs ------------------------------------------------------------------------------------------------------------

RUN = written_down(problem(frames=30), lambda t: (np.sin(t), np.cos(t)))

CUTS = st.lists(st.integers(0, 31), max_size=6).map(sorted)


@pytest.mark.slow
@given(CUTS, CUTS)
def test_parts_of_pairs_are_those_of_each_run_wherever_both_are_cut_even_into_empty_pieces(places, others):
    other = replace(RUN, velocity=2.0 * RUN.velocity)
    pairs = list(paired(cut(RUN, places), cut(other, others)))
    np.testing.assert_array_equal(joined(a for a, _ in pairs).velocity, RUN.velocity)
    for (part, other_part), (a, _) in zip(paired_parts(pairs), pairs, strict=True):
        assert (part.before, part.count, part.start) == (other_part.before, other_part.count, other_part.start)
        assert a.frames > 0
        np.testing.assert_array_equal(part.frames.velocity, a.velocity)
        for ours, theirs in ((part.frames, other_part.frames), (part.around, other_part.around)):
            np.testing.assert_array_equal(theirs.time, ours.time)
            np.testing.assert_array_equal(theirs.velocity, 2.0 * ours.velocity)


def test_frames_at_other_times_are_refused_by_the_first_that_differs():
    late = replace(RUN, time=np.where(RUN.time > 1.95, RUN.time + 1e-3, RUN.time))
    with pytest.raises(OtherFramesError, match=r"t = 2 .*where 2\.001 is expected"):
        list(paired([RUN], [late]))


def test_other_beads_are_refused():
    other = written_down(problem(frames=30, recorded=(1, 2, 3, 4, 5, 6, 7, 8)), lambda t: (np.sin(t), np.cos(t)))
    fewer = written_down(problem(frames=30, recorded=(1, 3)), lambda t: (np.sin(t), np.cos(t)))
    assert len(list(paired([RUN], [other]))) == 1
    with pytest.raises(OtherFramesError, match="different beads"):
        list(paired([RUN], [fewer]))
