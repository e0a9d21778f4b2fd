"""Spectra: amplitudes of sines, on a line, between two, and at just one frequency."""

import numpy as np
import pytest

from analysis.gauges.spectra import amplitude_at, amplitudes

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
