"""Errors of runs in what is measured in them: whatever the strength and the exponent of the contacts."""

import numpy as np
import pytest
from synthetic_waves import of_keys

from analysis.sharing.run_error import MeasuredError, rises, with_run_error
from analysis.sharing.survey import survey
from workflow.engines.reference import engine
from workflow.engines.reference.schemes import VERLET


@pytest.mark.parametrize("exponent", [1.5, 3.0])
@pytest.mark.parametrize("strength", [1e-4, 1.0, 1e4])
def test_what_a_run_of_large_steps_measures_is_off_by_no_more_than_it_states_nor_by_much_less(strength, exponent):
    """Speeds and widths of the pulse of one chain, against the reference; its own error is 1e-4 of theirs."""
    scale = strength ** (-1.0 / (exponent + 1.0))
    problem = of_keys(
        chains=1,
        beads=40,
        contact={"exponent": exponent, "strength": strength},
        kick={"velocity": 1.0},
        duration=40.0 * scale,
        output={"every": 0.1 * scale},
    )
    fine, coarse = engine.run(problem), engine.run(problem, scheme=VERLET, steps_per_frame=5)
    exact, measured = (survey(run.blocks, problem).completed() for run in (fine, coarse))
    assert len(exact.waves) == len(measured.waves)
    off = exact.waves.peak_velocity - measured.waves.peak_velocity, (exact.waves.time - measured.waves.time)[:-1]
    largest = [float(np.max(np.abs(each))) for each in (fine.velocity - coarse.velocity, *off)]
    stated = with_run_error(measured, MeasuredError(*largest, measured=True))
    for name, of in (("speed", "waves"), ("width", "shape")):
        error = np.abs(getattr(getattr(exact, of), name) - getattr(getattr(stated, of), name))
        share = error / getattr(getattr(stated, of), f"{name}_error")
        assert 0.1 < np.nanmax(share) < 1.0, name


def test_the_time_in_which_a_pulse_rises_by_an_error_is_that_of_the_weakest_contacts_and_the_heaviest_beads():
    """It is the error over the largest force over mass, ``(A / m)**(1 / (n + 1)) v**(2 n / (n + 1))``."""
    kinds = {"kinds": {"heavy": {"mass": 8.0}}, "replace": {"chain": 1, "bead": 5, "kind": "heavy"}}
    system = of_keys(
        chains=1, beads=10, **kinds, contact={"strength": 32.0}, kick={"velocity": 1.0}, duration=1.0
    ).system
    assert rises(1e-3, np.array([1.0, 0.5]), system) == pytest.approx(1e-3 / np.array([4.0**0.4, 4.0**0.4 * 0.5**1.2]))
