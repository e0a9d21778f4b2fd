"""The leading pulse at every bead without frames."""

import numpy as np
import pytest

from analysis.tracking.leading_waves import leading_waves
from analysis.tracking.peaks import find_peaks
from lammps_inputs import Coupling, Kick, Problem, Scene
from workflow.engines.reference import engine
from workflow.engines.reference.engine import passages


def problem(chains: int, beads: int, kappa: float, duration: float) -> Problem:
    coupling = Coupling(stiffness=kappa) if kappa else None
    scene = Scene(
        name="long", chains=chains, beads=beads, coupling=coupling, kick=(Kick(velocity=1.0),), duration=duration
    )
    return scene.problem()


def test_peaks_are_those_of_recorded_frames() -> None:
    short = problem(2, 60, 0.1, 90.0)
    recorded = leading_waves(find_peaks([engine.run(short, steps_per_frame=1)]))
    noted = passages(short, timestep=0.1).waves
    clear = recorded.bead < 55  # the free end makes arrivals ill-defined
    np.testing.assert_array_equal(noted.bead, recorded.bead)
    # both interpolate steps of 0.1 with polynomials of degree 3 and 5: v'''' h**4 / 384 with v'''' about 10
    np.testing.assert_allclose(noted.peak_velocity[clear], recorded.peak_velocity[clear], atol=5e-6)
    np.testing.assert_allclose(noted.arrival[clear], recorded.arrival[clear], atol=5e-5)


@pytest.mark.slow
@pytest.mark.parametrize(("chains", "kappa", "window"), [(1, 0.0, 40), (2, 0.1, 40), (3, 0.1, 40), (2, 0.01, 40)])
def test_a_window_behind_the_front_changes_no_bit_of_the_leading_pulse(chains: int, kappa: float, window: int) -> None:
    long = problem(chains, 400, kappa, 2000.0)
    whole, windowed = passages(long, until_bead=390), passages(long, until_bead=390, window=window)
    ahead = windowed.waves.bead <= 390
    np.testing.assert_array_equal(windowed.waves.arrival[ahead], whole.waves.where(whole.waves.bead <= 390).arrival)
    np.testing.assert_array_equal(
        windowed.waves.peak_velocity[ahead], whole.waves.where(whole.waves.bead <= 390).peak_velocity
    )


def test_what_is_let_go_is_slower_than_what_leads() -> None:
    found = passages(problem(2, 400, 0.1, 2000.0), until_bead=390, window=40)
    assert 0.0 < found.let_go < found.waves.at(390).peak_velocity.min()


def test_the_published_beads_of_agreement_come_out_of_a_window() -> None:
    waves = passages(problem(2, 120, 0.1, 500.0), until_bead=110, window=60).waves
    np.testing.assert_allclose(waves.at(55).peak_velocity, (0.36892, 0.36157), atol=1e-5)


def test_a_window_narrower_than_the_pulse_is_refused() -> None:
    with pytest.raises(ValueError, match="too narrow"):
        passages(problem(1, 100, 0.0, 10.0), window=10)
