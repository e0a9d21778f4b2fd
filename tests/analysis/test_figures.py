"""Figures hold what they were given, labelled, and warn of nothing."""

import io

import numpy as np
import pytest
from synthetic_waves import reader, reference

from analysis.figures import distance_figure, shape_figure
from analysis.survey import survey
from lammps_inputs import Kick


@pytest.fixture(scope="module")
def found():
    trajectory = reference(2, 0.1, 60, 80.0)
    return survey(reader(trajectory), trajectory.problem)


def test_distance_figure_shows_amplitudes_energies_and_lags(found):
    amplitude, energy, lag = distance_figure(found.problem, found.shared, found.energies).axes
    drawn = [line.get_ydata() for line in amplitude.get_lines() if len(line.get_xdata()) > 2]
    assert np.array_equal(drawn, found.shared.amplitude.T)
    assert np.array_equal([line.get_ydata() for line in lag.get_lines()], found.shared.lag.T)
    assert any(np.array_equal(line.get_ydata(), found.energies.chain[:, 0]) for line in energy.get_lines())
    assert all(axis.get_ylabel() for axis in (amplitude, energy, lag))
    assert lag.get_xlabel() == "bead"


def test_shape_figure_shows_the_samples_on_the_exact_wave(found):
    figure = shape_figure(found.problem, found.waveforms, [10, 50])
    above, late = figure.axes[:2]
    assert [axis.get_title(loc="left") for axis in (above, late)] == ["bead 10", "bead 50"]
    exact = late.get_lines()[0]
    for line in late.get_lines()[1:]:
        difference = line.get_ydata() - np.interp(line.get_xdata(), exact.get_xdata(), exact.get_ydata())
        assert np.max(np.abs(difference)) < 0.03


@pytest.mark.parametrize("kicks", [[Kick(velocity=1.0)], [Kick(bead=30, velocity=-1.0)]])
@pytest.mark.parametrize("chains", [1, 2, 9])
@pytest.mark.parametrize("recorded", ["all", (4, 11, 20)])
def test_any_scene_can_be_drawn(kicks, chains, recorded):
    trajectory = reference(chains, 0.1, 30, 40.0, recorded=recorded, kicks=kicks)
    result = survey(reader(trajectory), trajectory.problem)
    for figure in (
        distance_figure(result.problem, result.shared, result.energies, result.direction),
        shape_figure(result.problem, result.waveforms, [11, 20]),
    ):
        figure.savefig(io.BytesIO(), format="png")
