"""Each thing that LAMMPS does not notice is found in a state that has it."""

import re

import numpy as np
import pytest
from stock_lammps import scene

from lammps_inputs import physics
from workflow.engines.lammps.worker import fault

REMEDY = r"take a smaller timestep \(it is 0\.01, unstable above 0\.\d+\)$"


@pytest.fixture
def problem():
    return scene(chains=2, beads=4, kappa=0.1).problem()


@pytest.fixture
def state(problem):
    """A state with the energy of the kick: nothing has moved yet."""
    return np.zeros((2, 4)), physics.initial_velocity(problem.system)


def test_the_start_has_no_fault(problem, state):
    assert fault(problem, *state) is None


@pytest.mark.parametrize("which", [0, 1])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_number_that_is_not_finite_is_found(which, value, problem, state):
    state[which][1, 2] = value
    assert "no longer a finite number" in fault(problem, *state)


def test_beads_that_passed_each_other_are_named(problem, state):
    state[0][1, 1] = 4.5  # the diameter is 4
    assert fault(problem, *state).startswith("beads 2 and 3 of chain 2 have passed through each other")


def test_beads_exactly_on_each_other_have_passed(problem, state):
    state[0][0, 0] = 4.0
    assert "passed" in fault(problem, *state)


def test_an_overlap_of_more_than_half_a_diameter_is_named(problem, state):
    state[0][0, 2] = 2.5
    assert fault(problem, *state).startswith("beads 3 and 4 of chain 1 overlap by 2.5, more than half a diameter (2)")


@pytest.mark.parametrize("factor", [0.97, 1.03])
def test_a_change_of_energy_by_three_per_cent_is_found(factor, problem, state):
    x, v = state
    assert f"energy has changed by {100 * (factor - 1):.3g}%" in fault(problem, x, v * np.sqrt(factor))


@pytest.mark.parametrize("factor", [0.99, 1.01])
def test_a_change_of_energy_by_one_per_cent_is_no_fault(factor, problem, state):
    x, v = state
    assert fault(problem, x, v * np.sqrt(factor)) is None


def test_energy_in_contacts_and_springs_counts(problem):
    # all of it at rest: 2/5 r^2.5 in one contact and 0.05 r^2 in one spring make 1/2
    overlap = 1.0
    for _ in range(60):
        overlap = ((0.5 - 0.05 * overlap**2) / 0.4) ** 0.4
    x = np.zeros((2, 4))
    x[0, 3] = overlap
    x[0, :3] = overlap
    x[1, :3] = (
        overlap  # so that chain 1 is whole, chain 2 is pressed between beads 3 and 4, and one spring is stretched
    )
    assert fault(problem, x, np.zeros((2, 4))) is None


@pytest.mark.parametrize("spoiled", [(0, np.nan), (0, 5.0), (0, 2.5), (1, 9.0)])
def test_every_fault_tells_the_remedy_and_the_bound(spoiled, problem, state):
    which, value = spoiled
    state[which][0, 1] = value
    message = fault(problem, *state)
    assert len(message.splitlines()) == 1
    assert re.search(REMEDY, message)


def test_the_gap_is_no_overlap(state):
    gapped = scene(chains=2, beads=4, kappa=0.1, gap=5.0).problem()
    state[0][0, 0] = 4.9
    assert fault(gapped, *state) is not None  # the spring holds 1.2 of an energy of 0.5
    state[0][1, 0] = 4.9
    assert fault(gapped, *state) is None
