"""The stability bound of velocity Verlet."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lammps_inputs import Scene, contact, coupling, find, library, timestep


def growth(omega, step):
    """Size of the larger eigenvalue of one Verlet step of an oscillator: 1 when stable."""
    square = (omega * step) ** 2
    verlet = [[1 - square / 2, step], [-(omega**2) * step * (1 - square / 4), 1 - square / 2]]
    return max(abs(np.linalg.eigvals(verlet)))


@pytest.mark.parametrize("chains", [2, 3, 10])
def test_with_springs_alone_verlet_is_stable_up_to_the_bound_and_not_beyond(chains):
    kappa = 0.7
    bound = timestep.stability_bound(0.0, kappa, chains)
    omega = math.sqrt(kappa * coupling.largest_eigenvalue(chains))
    assert growth(omega, 0.999 * bound) == pytest.approx(1.0, abs=1e-12)
    assert growth(omega, 1.001 * bound) > 1.05


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=12), st.integers(1, 5), st.floats(0.0, 100.0))
def test_no_overlaps_of_this_energy_vibrate_faster_than_the_bound(shares, chains, kappa):
    total = 0.5
    energies = total * np.array(shares) / max(1.0, sum(shares))
    slopes = contact.stiffness((2.5 * energies) ** 0.4)
    along = np.diff(np.eye(len(slopes) + 1), axis=0)
    across = np.diff(np.eye(chains), axis=0)
    hessian = np.kron(np.eye(chains), along.T @ (slopes[:, None] * along))
    hessian += kappa * np.kron(across.T @ across, np.eye(len(slopes) + 1))
    fastest = math.sqrt(max(np.linalg.eigvalsh(hessian)[-1], 0.0))
    assert fastest * timestep.stability_bound(total, kappa, chains) <= 2.0 + 1e-12


def test_the_bound_is_that_of_the_notes():
    """omega_max^2 = 6 sqrt(overlap_max) + kappa lambda_max, 0.4 overlap_max^2.5 = energy."""
    overlap = (0.5 / 0.4) ** 0.4
    assert timestep.stability_bound(0.5, 0.1, 2) == pytest.approx(2 / math.sqrt(6 * overlap**0.5 + 0.2), rel=1e-14)


@pytest.mark.parametrize("name", library.installed())
def test_the_scenes_of_the_paper_step_by_0_01(name):
    assert find(name).problem().timestep == pytest.approx(0.01, rel=1e-12)


@given(st.floats(1e-6, 1e6), st.floats(0.0, 1e12), st.integers(1, 100))
def test_the_default_is_a_small_part_of_the_bound(energy, kappa, chains):
    step = timestep.default_timestep(energy, kappa, chains)
    assert 0.0 < step <= min(0.01, timestep.stability_bound(energy, kappa, chains) / 50)


def test_a_stiff_scene_gets_a_shorter_step():
    stiff = {"name": "a", "chains": 2, "beads": 9, "kick": {"velocity": 1.0}, "coupling": {"stiffness": 1e6}}
    assert Scene.model_validate({**stiff, "until_bead": 9}).resolved().timestep < 1e-4
