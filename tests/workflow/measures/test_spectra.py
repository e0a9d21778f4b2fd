"""Spectra: amplitudes of sines, on a line, between two, and at just one frequency; of which beads, from when on."""

from dataclasses import replace

import numpy as np
import pytest
from small_problems import problem, written_down

from analysis.sharing.run_error import MeasuredError
from lammps_inputs.laws.in_time import Oscillation
from lammps_inputs.loads import Motion
from workflow.measures.spectra import (
    SpectrumMeter,
    VelocitySpectra,
    amplitude_at,
    amplitude_errors,
    amplitudes,
    on_lines,
)

EVERY, COUNT = 0.25, 400
TIME = EVERY * np.arange(COUNT)


@pytest.mark.parametrize("line", [20, 20.5])
def test_a_sine_has_a_line_as_high_as_its_amplitude(line):
    frequency = line / (COUNT * EVERY)
    lines, height = amplitudes(3.0 + 0.7 * np.sin(2 * np.pi * frequency * TIME + 0.4), EVERY)
    assert abs(lines[np.argmax(height)] - frequency) <= 0.51 / (COUNT * EVERY)
    # Hann's window at half a line from its top is 8 / (3 pi)
    assert height.max() == pytest.approx(0.7 * (1.0 if line == 20 else 8.0 / (3.0 * np.pi)), rel=1e-3)
    assert amplitude_at(0.7 * np.sin(2 * np.pi * frequency * TIME), EVERY, frequency) == pytest.approx(0.7, rel=1e-3)


def test_two_sines_far_from_each_other_do_not_leak():
    weak, strong = 60 / (COUNT * EVERY), 10.3 / (COUNT * EVERY)
    signal = 1e-4 * np.sin(2 * np.pi * weak * TIME) + np.sin(2 * np.pi * strong * TIME)
    assert amplitude_at(signal, EVERY, weak) == pytest.approx(1e-4, rel=0.1)


def test_spectra_are_of_the_beads_named_from_the_time_named_or_half_the_duration_on():
    """Until t = 6 all stands still; then bead 3 of chain 2 swings by 0.4, at the drive's frequency."""
    frequency = 0.75  # three swings in the last four of time
    driven = problem(recorded=(2, 3, 8), motions=(Motion(1, 1, (Oscillation(0.1, 2.0 * np.pi * frequency, 0.0),)),))
    here = np.array([[0.0, 0.0, 0.0], [0.0, 0.4, 0.0]])
    trajectory = written_down(
        driven, lambda t: (0.0 * t, here * np.where(t < 6.0, 0.0, np.sin(2.0 * np.pi * frequency * t)))
    )
    parts = trajectory[:33], trajectory[33:]
    found = {after: SpectrumMeter(driven, (3, 8), after).read(parts) for after in (None, 6.05)}
    assert found[None].after == 5.0
    assert found[6.05].at_drive[0] == pytest.approx(np.array([[0.0, 0.0], [0.4, 0.0]]), abs=0.01)
    assert found[None].at_drive[0, 1, 0] < 0.39  # a fifth of the time it stood still
    assert len(found[None].frequency) == 51 // 2 + 1


@pytest.mark.parametrize(("frequency", "seen"), [(4.9, True), (5.1, False)])
def test_a_drive_with_less_than_two_frames_a_cycle_has_no_amplitude(frequency, seen):
    driven = problem(motions=(Motion(1, 1, (Oscillation(0.1, 2.0 * np.pi * frequency, 0.0),)),))
    run = written_down(driven, lambda t: (0.0 * t, np.sin(2.0 * np.pi * frequency * t)))
    assert np.isfinite(SpectrumMeter(driven, (3,), 0.0).read([run]).at_drive).all() == seen


SWINGS = VelocitySpectra(
    beads=(3, 8),
    after=2.0,
    frequency=np.array([0.0, 0.1]),
    amplitude=np.array([[[0.0, 0.0], [0.0, 0.0]], [[0.13, 0.18], [0.23, 0.28]]]),  # [line, chain, bead]
    drive=np.array([0.1]),
    at_drive=np.array([[[0.5, 0.1], [0.2, 0.1]]]),
    amplitude_error=np.array([[[0.0, 0.0], [0.0, 0.0]], [[0.01, 0.02], [0.03, 0.04]]]),
    at_drive_error=np.array([[[0.1, 0.01], [0.3, 0.01]]]),
)


def test_what_is_passed_on_is_over_the_first_bead_named_of_the_same_chain():
    np.testing.assert_allclose(SWINGS.transmissibility, [[[1.0, 0.2], [1.0, 0.5]]])


def test_the_error_of_what_is_passed_on_is_the_largest_that_errors_of_both_amplitudes_make():
    """That of the first bead itself is 0, and none is known where its amplitude may be 0."""
    expected = [[[0.0, 0.11 / 0.4 - 0.1 / 0.5], [0.0, np.nan]]]
    np.testing.assert_allclose(SWINGS.transmissibility_error, expected)


def test_the_error_of_the_highest_line_reaches_to_lines_that_may_be_as_high():
    lines = np.array([5.0, 0.8, 0.3, 1.0, 0.95])[:, np.newaxis, np.newaxis]
    errors = np.array([0.0, 0.2, 0.1, 0.1, 0.0])[:, np.newaxis, np.newaxis]
    of_drives = np.zeros((0, 1, 1))
    frequency = 0.1 * np.arange(5.0)
    spectra = VelocitySpectra((3,), 0.0, frequency, lines, np.zeros(0), of_drives, errors, of_drives)
    (highest,) = spectra.found(problem(chains=1)).beads
    assert (highest.frequency, highest.amplitude_error) == pytest.approx((0.3, 0.1))
    assert highest.frequency_error == pytest.approx(0.05 + 0.2)  # to line 1; line 0 is no oscillation


@pytest.mark.parametrize("frames", [160, 161])
def test_amplitudes_differ_from_those_of_closer_frames_by_no_more_than_their_errors(frames):
    """Pulses 1 T to 4 T long at random times, as a velocity: of eight times as many frames over the same time."""
    chance, finer, many = np.random.default_rng(1), 8, 200
    time = EVERY / finer * np.arange(finer * (frames - 1) + 1)[:, np.newaxis]
    signal = np.zeros((len(time), many))
    for _ in range(5):
        centre, width = chance.uniform(0.0, EVERY * frames, many), chance.uniform(0.5, 2.0, many)
        signal += chance.uniform(-1.0, 1.0, many) / np.cosh((time - centre) / width) ** 2
    seldom, frequency = signal[::finer], 0.11

    def height(chosen):
        return amplitude_at(seldom[chosen], EVERY * (chosen.step or 1), frequency)

    error = np.abs(height(slice(None)) - amplitude_at(signal, EVERY / finer, frequency))
    stated = amplitude_errors(height)
    assert np.mean(error <= stated) >= 0.95
    assert np.median(stated) < 5.0 * np.median(error)


def test_amplitudes_of_chosen_frames_on_lines_are_those_at_the_frequencies_of_the_lines():
    signal = np.random.default_rng(2).normal(size=(21, 2))
    lines = np.arange(11) / (21 * EVERY)
    for frames in (slice(None), slice(0, None, 2), slice(1, None, 2), slice(0, -1)):
        expected = [amplitude_at(signal[frames], EVERY * (frames.step or 1), line) for line in lines]
        np.testing.assert_allclose(on_lines(signal, frames), expected, atol=1e-12)


def test_amplitudes_have_twice_the_error_of_the_velocities_of_the_run():
    total = SWINGS.with_error(MeasuredError(velocity=0.01, measured=True))
    np.testing.assert_allclose(total.amplitude_error - SWINGS.amplitude_error, 0.02)
    np.testing.assert_allclose(total.at_drive_error - SWINGS.at_drive_error, 0.02)


def test_the_highest_line_is_none_of_a_slow_drift_at_frequency_0():
    drifting = replace(SWINGS, amplitude=np.concatenate([np.ones((1, 2, 2)), SWINGS.amplitude[1:]]))
    found = drifting.found(problem()).beads
    assert [(line.frequency, line.amplitude) for line in found] == [(0.1, 0.13), (0.1, 0.18), (0.1, 0.23), (0.1, 0.28)]
