"""The reference against what is independent of it, and its uncertainties against the errors that they are to bound.

Orders, symmetries and scaling of the schemes are in ``test_engine.py``.
"""

from dataclasses import replace

import numpy as np
import pytest
from small_problems import problem

from analysis.compare.difference import errors_of
from analysis.trajectory import joined
from lammps_inputs import find
from workflow.engines.reference import engine
from workflow.engines.reference.schemes import VERLET
from workflow.engines.reference.step_halving import SAFETY, StepHalving, accurate_reference
from workflow.errors import RunError

pytestmark = pytest.mark.usefixtures("lammps_here")

PAPER = find("two-chains").problem()


@pytest.fixture(scope="module")
def to_1e_9():
    """Two chains of 120 beads to t = 192, kappa = 0.1, with an uncertainty of 1e-9: trajectory and uncertainty."""
    halving = accurate_reference(PAPER, 1e-9)
    return engine.run(PAPER, steps_per_frame=halving.steps_per_frame), halving.uncertainty


# --- against the independent ------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_two_chains_are_certified_to_1e_9(to_1e_9):
    _, uncertainty = to_1e_9
    assert uncertainty.velocity <= 1e-9
    assert uncertainty.arrival <= 1e-8
    assert uncertainty.energy <= 1e-9
    assert uncertainty.momentum <= 1e-12


@pytest.mark.slow
def test_two_chains_certified_to_1e_9_are_found_so_by_velocity_verlet_at_very_fine_steps(to_1e_9):
    reference, uncertainty = to_1e_9
    coarse, fine = (engine.run(PAPER, scheme=VERLET, steps_per_frame=steps).velocity for steps in (1500, 3000))
    # Verlet's error falls as h^2, but for terms of h^2.5: what is left of the finer run's, 2e-9, after extrapolation
    left = 0.25 * np.max(np.abs(fine - coarse)) / 3.0
    assert left < 1e-9
    assert np.max(np.abs(reference.velocity - (4.0 * fine - coarse) / 3.0)) <= uncertainty.velocity + left


# --- uncertainties ---------------------------------------------------------------------------------------------------

SCENES = [
    problem(
        beads=30, frames=round(40.0 / every), chains=chains, kappa=kappa, gap=gap, timestep=every / 10.0, kicks=kicks
    )
    for every in (0.1, 0.4, 2.0)
    for chains, kappa in ((1, 0.0), (2, 0.01), (4, 10.0))
    for gap in (0.0, 2.874)
    for kicks in (((1, 1, 1.0),), ((1, 15, -1.0), (1, 4, 0.3)))
]


@pytest.fixture(scope="module")
def measured():
    """Of each of `SCENES`: uncertainty, and deviations from a run with 16 times as many steps."""
    results = []
    for scene in SCENES:
        halving = StepHalving(scene)
        finer = engine.blocks(scene, steps_per_frame=16 * halving.steps_per_frame)
        deviations = errors_of(halving.blocks(), finer)
        results.append((halving.uncertainty, deviations))
    return results


@pytest.mark.slow
@pytest.mark.parametrize("quantity", ["velocity", "arrival"])
def test_the_certificate_bounds_the_error_in_every_scene(quantity, measured):
    told = [(scene, *found) for scene, found in zip(SCENES, measured, strict=True) if quantity in found[1]]
    assert len(told) > 0.6 * len(SCENES)  # with kicks both ways and frames far apart no pulse may lead
    for scene, uncertainty, deviations in told:
        assert deviations[quantity].largest <= getattr(uncertainty, quantity), scene


@pytest.mark.slow
def test_the_certificate_is_no_wilder_than_it_must_be(measured):
    # twice the step makes an error of order 2.5 to 4 larger by 5.7 to 16, less the error itself
    shares = [deviations["velocity"].largest / uncertainty.velocity for uncertainty, deviations in measured]
    assert 1.0 / (SAFETY * 15.0) / 2.0 < np.median(shares) < 1.0 / SAFETY


def test_the_blocks_are_those_of_the_finer_run_and_their_uncertainty_its_distance_from_the_other():
    halving = StepHalving(problem(), steps_per_frame=8)
    fine, coarse = (engine.run(problem(), steps_per_frame=steps).velocity for steps in (8, 4))
    np.testing.assert_array_equal(joined(halving.blocks()).velocity, fine)
    assert halving.uncertainty.velocity == pytest.approx(SAFETY * np.max(np.abs(fine - coarse)), rel=1e-12)


def test_beads_that_fly_freely_have_no_error():
    assert StepHalving(problem(chains=1, beads=3, kappa=0.0, gap=50.0)).run().velocity < 1e-15


@pytest.mark.slow
def test_what_rounding_forbids_is_not_certified():
    with pytest.raises(RunError, match=r"does not reach an error of 1\.0e-20"):
        accurate_reference(replace(problem(beads=4), frames=5), 1e-20)


def test_a_reference_that_diverges_has_no_uncertainty_but_an_error():
    with pytest.raises(RunError, match=r"by t = \S+ velocities of the reference are no longer finite"):
        StepHalving(problem(kappa=1e6), steps_per_frame=2).run()
