"""Energies that a pulse carries through unlike beads, with their uncertainties."""

import errors_between_frames as errors
import numpy as np
import pytest
from mirror import mirrored_problem
from synthetic_waves import of_keys, surveyed

from analysis.sharing.survey import Survey
from lammps_inputs import library
from workflow.engines.reference import engine
from workflow.measures.cells import CellMeasurement, CellMeter, Left, left
from workflow.measures.measurement import Recorded

NUMBERS = ("carried", "per_cell", "rate")


def carried_in(run) -> Left:
    """Energy of the leading pulse of a diatomic chain in the frames of a run."""
    found = left(Survey(run.problem, run.blocks, "maximum"), 1, 2)
    assert found is not None
    return found


@pytest.fixture(scope="module")
def dimer():
    """Frames 0.05 T apart of a short diatomic chain."""
    return errors.integrated(errors.small("dimer", 0.05, beads=50, duration=55.0).problem())


@pytest.mark.parametrize("stride", [5, 10, 20])
def test_what_a_pulse_carries_and_loses_in_closer_frames_differs_by_no_more_than_the_uncertainties(dimer, stride):
    exact, found = carried_in(dimer), carried_in(errors.thinned(dimer, stride))
    assert (found.first, found.last) == (exact.first, exact.last)
    for name in NUMBERS:
        stated = getattr(found, f"{name}_error") + getattr(exact, f"{name}_error")
        assert abs(getattr(found, name) - getattr(exact, name)) <= stated
        assert np.isfinite(stated)
    assert found.carried_error < 1e-3 * found.carried


def test_a_pulse_that_passes_no_whole_cell_carries_what_it_has_at_the_last_bead_and_loses_nothing_known(dimer):
    whole, found = carried_in(dimer), left(Survey(dimer.problem, dimer.blocks, "maximum"), 1, dimer.problem.beads)
    assert found is not None
    assert (found.carried, found.carried_error) == (whole.carried, whole.carried_error)
    assert np.isnan([found.per_cell, found.rate, found.per_cell_error, found.rate_error]).all()


@pytest.mark.parametrize(
    ("changes", "measured"),
    [
        ({}, True),
        ({"precompression": {"force": 0.01}}, False),
        ({"contact": {"exponent": 1.0}}, False),
        ({"pattern": ["heavy"]}, False),
        ({"output": {"beads": [1, 2]}}, False),
    ],
    ids=["dimer", "sound", "no pulse", "alike", "two beads recorded"],
)
def test_cells_are_measured_where_a_pulse_runs_through_unlike_beads_that_are_all_recorded(changes, measured):
    dimer = {"chains": 1, "beads": 20, "kick": {"velocity": 1.0}, "pattern": ["heavy", "light"], "duration": 9.0}
    kinds = {"heavy": {"mass": 1.0}, "light": {"mass": 0.6}}
    scene = library.from_plain({"name": "a", **dimer, "kinds": kinds, **changes}, "a")
    assert (CellMeasurement.meter(Recorded(scene, scene.problem())) is not None) == measured


def test_the_last_bead_has_a_largest_energy_once_the_pulse_has_come_there(dimer):
    """The kick gives 0.5, and that bead has the mass 0.3428; 40 T after it the pulse is at bead 39."""
    there, before = (
        CellMeter().read([run]).at_end(Survey(run.problem, run.blocks, "maximum"), 1) for run in (dimer, dimer[:800])
    )
    assert there == pytest.approx(0.3428 * np.max(dimer.velocity[:, 0, -1]) ** 2, rel=1e-12)
    assert before is None


def test_a_pulse_to_the_left_comes_to_the_first_bead():
    """The mirror image of a dimer: its first bead is light, and its last is hit."""
    kinds = {"heavy": {"mass": 1.0}, "light": {"mass": 0.6}}
    dimer = of_keys(chains=1, beads=20, kinds=kinds, pattern=list(kinds), kick={"velocity": 1.0}, duration=30.0)
    right, left = engine.run(dimer), engine.run(mirrored_problem(dimer))
    energies = [CellMeter().read([run]).last_bead[0] for run in (right, left)]
    assert energies[1] == pytest.approx(energies[0], rel=1e-12)
    assert energies[0] == pytest.approx(0.3 * np.max(right.velocity[:, 0, -1]) ** 2, rel=1e-12)


def test_the_residual_energy_is_that_of_the_chain_that_was_kicked_the_hardest():
    kicks = [{"chain": 1, "velocity": 0.5}, {"chain": 2, "velocity": 1.0}]
    dimer = {"kinds": {"heavy": {"mass": 1.0}, "light": {"mass": 0.6}}, "pattern": ["heavy", "light"]}
    scene = library.from_plain({"name": "a", "chains": 2, "beads": 50, "kick": kicks, "duration": 70.0, **dimer}, "")
    recorded = Recorded(scene, scene.problem())
    run = engine.run(recorded.problem)
    measurement = CellMeasurement.of_run(recorded, surveyed(run), CellMeter().read([run]))
    found = measurement.values
    weak, strong = (chain.per_cell for chain in found.chains)
    for chain in found.chains:  # from bead 23 to 45 the energy falls as the law says
        kept = (1.0 - chain.rate) ** 11 * (chain.carried + 11.0 * chain.per_cell) / chain.carried
        assert abs(kept - 1.0) <= 2.0 * chain.deviation < 0.1 * chain.rate
    assert found.residual_energy == strong == pytest.approx(4.0 * weak, rel=0.01)  # waves of any velocity are alike
    assert " of the energy input remains in each cell of 2 beads" in next(measurement.lines())
