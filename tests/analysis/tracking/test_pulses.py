"""Pulses are found where they are, with the stated error, on any grid; nothing else is found."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_problems import problem as problem
from synthetic_waves import arrivals, exact_waves, reference, surveyed

from analysis.shape.exact_wave import solitary_wave
from analysis.tracking.peak_bounds import on_a_grid
from analysis.tracking.peaks import find_peaks
from analysis.tracking.pulses import Pulse, local_speed, of_one_kind, track_pulses, train_of
from analysis.trajectory import Trajectory
from lammps_inputs import Kick
from workflow.engines.reference import engine

PEAKS = st.floats(0.05, 1.0)
EVERY = st.floats(0.03, 1.0)


def found_in(trajectory: Trajectory, direction: int = 1) -> tuple[Pulse, ...]:
    return track_pulses(find_peaks(trajectory.blocks(), direction=direction), trajectory.problem)


@pytest.mark.slow
@settings(max_examples=25)
@given(PEAKS, EVERY, st.floats(2.0, 20.0), st.sampled_from([1, -1]), st.sampled_from(["all", tuple(range(1, 41, 3))]))
def test_a_wave_on_any_grid_is_one_pulse_with_the_arrivals_and_amplitude_that_were_put_in(
    peak, every, arrival, direction, recorded
):
    trajectory = exact_waves([(peak, arrival)], every=every, direction=direction, recorded=recorded)
    every = trajectory.problem.every
    (pulse,) = found_in(trajectory, direction)
    assert np.array_equal(np.sort(pulse.bead), trajectory.beads)
    late, off = on_a_grid(every, peak, all_recorded=recorded == "all")
    whole = (pulse.bead > 2) & (pulse.bead < 39)  # the first and last bead lack the neighbour that the wave has
    expected = arrivals(peak, arrival, pulse.bead, 40 if direction < 0 else None)
    assert np.max(np.abs(pulse.arrival - expected)[whole]) < late
    assert np.max(np.abs(pulse.peak_velocity - peak)[whole]) < off


@pytest.mark.slow
@settings(max_examples=25)
@given(PEAKS, st.floats(0.03, 0.5))
def test_the_speed_of_a_wave_is_that_of_the_exact_law_within_the_error_of_its_arrivals(peak, every):
    (pulse,) = found_in(exact_waves([(peak, 8.0)], every=every))
    speed = float(solitary_wave().speed_at(peak))
    bound = on_a_grid(every, peak)[0] * speed**2
    assert np.max(np.abs(pulse.speed[4:-4] - speed)) < bound


def test_nothing_runs_between_beads_that_were_kicked_at_once():
    speed = local_speed(np.array([1, 2, 3, 4]), np.array([0.0, 0.0, 0.5, 1.5]))
    np.testing.assert_array_equal(speed, [np.nan, 4.0, 2.0 / 1.5, 1.0])


@pytest.mark.slow
@settings(max_examples=20)
@given(st.lists(st.floats(0.1, 1.0), min_size=2, max_size=4))
def test_as_many_pulses_are_found_as_follow_each_other_in_a_chain(peaks):
    waves = [(peak, 6.0 + 30.0 * number) for number, peak in enumerate(sorted(peaks, reverse=True))]
    pulses = found_in(exact_waves(waves))
    assert [pulse.peak_velocity[20] for pulse in pulses] == pytest.approx([peak for peak, _ in waves], rel=1e-4)
    assert all(len(pulse) == 40 for pulse in pulses)


def test_two_pulses_that_meet_head_on_are_each_one_pulse_before_and_after():
    trajectory = reference(1, 0.0, 100, 140.0, kicks=[Kick(velocity=1.0), Kick(bead=100, velocity=-0.7)])
    right = max(found_in(trajectory), key=len)
    left = max(found_in(trajectory, -1), key=len)
    assert (right.bead[0], right.bead[-1] > 90) == (2, True)
    assert (left.bead[0], left.bead[-1] < 10) == (99, True)
    assert right.peak_velocity[-10] == pytest.approx(0.6816, abs=0.02)
    assert left.peak_velocity[-10] == pytest.approx(0.7 * 0.6816, abs=0.02)


def test_a_single_chain_holds_one_pulse_and_no_other():
    trajectory = reference(1, 0.0, 120, 160.0)
    (pulse,) = found_in(trajectory)
    assert found_in(trajectory, -1) == ()
    assert (pulse.bead[0], len(pulse)) == (2, 118)
    assert pulse.peak_velocity[50] == pytest.approx(0.6816315, abs=1e-6)
    assert pulse.speed[50] == pytest.approx(0.8405088, abs=1e-5)


def test_beads_that_swing_on_their_springs_are_no_pulses():
    pulses = found_in(reference(2, 0.1, 120, 192.0))
    assert all(np.max(np.diff(pulse.bead)) <= 4 for pulse in pulses)
    assert not any(pulse.bead[-1] <= 5 for pulse in pulses)  # the first rows only swing
    assert sum(len(pulse) > 100 for pulse in pulses) == 2


def test_a_run_that_ended_early_shows_the_pulse_as_far_as_it_came():
    trajectory = reference(1, 0.0, 100, 140.0)
    (pulse,) = found_in(trajectory[:600])
    assert pulse.arrival[-1] < 60.0
    assert pulse.bead[-1] == pytest.approx(1 + (60.0 - 0.77532) * 0.8405, abs=1.5)
    (whole,) = found_in(trajectory)
    assert np.allclose(pulse.peak_velocity, whole.peak_velocity[: len(pulse)], rtol=0, atol=1e-12)


@pytest.mark.parametrize("beads", [8, 30])
def test_beads_are_compared_with_those_of_their_mass_unless_all_differ(beads):
    taper = np.geomspace(1.0, 0.5, beads)[np.newaxis]
    dimer = np.resize([2.0, 1.0], beads)[np.newaxis]
    assert of_one_kind(problem(chains=1, beads=beads, mass=taper)).all()
    np.testing.assert_array_equal(of_one_kind(problem(chains=1, beads=beads, mass=dimer)), dimer[0] == 2.0)


@pytest.mark.slow
def test_two_beads_launched_together_give_two_pulses_of_known_heights():
    one = problem(chains=1, beads=310, kicks=((1, 1, 1.0), (1, 2, 1.0)), timestep=0.25, steps_per_frame=1, frames=1700)
    run = engine.run(one)
    found = surveyed(run)
    train = train_of(found.pulses, 1, 1, 300)
    assert train.peak_velocity == pytest.approx([0.8535, 0.4463], abs=1e-4)
    assert train.ratio[1] == pytest.approx(0.4463 / 0.8535, abs=2e-4)
    assert train.spacing[0] == pytest.approx(train.arrival[1] - train.arrival[0])
