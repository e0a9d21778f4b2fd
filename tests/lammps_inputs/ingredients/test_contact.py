"""Contacts of other exponents: law, published pulses, release of LAMMPS; the motion is in `test_every_ingredient`."""

import subprocess

import numpy as np
import pytest
from plain_scene import one_chain, scene
from processes import HANGS
from truth import Truth

from analysis.shape.exact_wave import solitary_wave
from analysis.shape.unit_cell import cell_of
from lammps_inputs import file_names
from lammps_inputs.decks import scene_files
from lammps_inputs.facts import Fact
from workflow.engines.reference import engine
from workflow.engines.reference.step_halving import StepHalving
from workflow.runs.run import run
from workflow.verdicts.analysis_files import analyse

pytestmark = pytest.mark.usefixtures("lammps_here")


def touching(exponent, **changes):
    """Two coupled chains, so that all tests share one compiled kernel."""
    return scene(**{"contact": {"exponent": exponent}, "beads": 8, "duration": 15.0, **changes})


@pytest.mark.slow
@pytest.mark.parametrize(
    ("exponent", "amplitude", "coefficient"), [(1.25, 0.57734, 0.94668), (3.0, 0.90128, 0.80476)], ids=str
)
def test_a_kicked_chain_has_the_published_amplitude_and_law_of_speed(tmp_path, exponent, amplitude, coefficient):
    """Both chains are hit, so that they move as one alone."""
    kicks = [{"chain": 1, "velocity": 1.0}, {"chain": 2, "velocity": 1.0}]
    found = run(touching(exponent, beads=50, kick=kicks, duration=62.0, output={"every": 0.2}), tmp_path / "run")
    seen = analyse(found.directory, figures=False)
    (leading,) = (c for p, c in zip(seen.survey.pulses, seen.survey.characters, strict=True) if p.chain == 1)
    assert leading.peak_velocity == pytest.approx(amplitude, abs=found.check.amplitude + 1e-5)
    law = leading.speed / leading.peak_velocity ** ((exponent - 1.0) / (exponent + 1.0))
    assert law == pytest.approx(coefficient, abs=3e-5)
    assert law == pytest.approx(solitary_wave(exponent).speed, abs=3e-5)
    assert leading.solitary


def test_linear_contacts_carry_no_pulse():
    for exponent, leads in ((1.0, False), (1.04, False), (1.06, True)):
        assert touching(exponent).system.holds(Fact.PULSE) == leads


@pytest.mark.slow
def test_the_2021_release_says_in_one_line_what_it_cannot_do_and_does_linear_contacts(lmp_of, tmp_path):
    said = {}
    for exponent in (1.0, 2.0):
        folder = tmp_path / str(exponent)
        folder.mkdir()
        scene_files.write(touching(exponent), folder)
        words = [lmp_of("2021"), "-in", file_names.DECK]
        done = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=HANGS)
        said[exponent] = done.stdout
    assert "need LAMMPS of 15Jun2023 or later" in said[2.0].splitlines()[-1]
    assert "Total wall time" in said[1.0]


def test_random_exponents_are_factors_of_numpy_on_that_of_spheres_or_on_their_mean():
    factors = np.random.default_rng(3).uniform(0.9, 1.1, (2, 7))
    for keys, mean in (({}, 1.5), ({"mean": 2.0}, 2.0)):
        law = touching({"spread": 0.1, "seed": 3, **keys}).problem().system.along[0].law
        np.testing.assert_array_equal(law.exponent, mean * factors)


@pytest.mark.slow
def test_contacts_of_unlike_exponents_move_as_an_independent_integration():
    ramp = {"from": 1.2, "to": 2.5, "contacts": [2, 5]}
    contact = {"exponent": ramp, "strength": {"mean": 2.0, "spread": 0.1}}
    case = touching(None, contact=contact, kick={"velocity": 2.5}, timestep=0.01)
    problem = case.problem()
    exact = Truth(case, problem.duration, 1e-11).states(problem.every * np.arange(problem.frames + 1))[1]
    error = np.max(np.abs(engine.run(problem).velocity - exact))
    assert error < StepHalving(problem).run().velocity < 5e-5


def test_contacts_that_alternate_under_load_have_the_bands_of_a_chain_of_two_springs():
    alternating = {"strength": {"amplitude": 0.5, "wavenumber": 0.5}}
    case = one_chain(contact=alternating, beads=40, precompression={"force": 1})
    soft, hard = (1.5 * strength ** (2.0 / 3.0) for strength in (0.5, 1.5))
    bands = cell_of(case.problem().system).bands()
    np.testing.assert_allclose(bands**2, [[0.0, 2.0 * soft], [2.0 * hard, 2.0 * (soft + hard)]], rtol=1e-9, atol=1e-9)
