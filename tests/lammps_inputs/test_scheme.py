"""Schemes in the deck: what is named is there, what is not leaves no line."""

import subprocess

import numpy as np
import pytest
from processes import HANGS
from stock_lammps import run, scene

from lammps_inputs import file_names, scheme
from lammps_inputs.decks import scene_files
from workflow.engines.reference import engine
from workflow.engines.reference.schemes import SUZUKI4


def trace(phase, steps):
    """Of the matrix that takes an oscillator through a cycle; it stays bounded while this is at most 2."""
    product = np.eye(2)
    for step in np.array(steps) * phase:
        half = 1.0 - step * step / 2.0
        product = np.array([[half, step], [-step * (1.0 - step * step / 4.0), half]]) @ product
    return abs(np.trace(product))


@pytest.mark.parametrize("name", scheme.WEIGHTS)
def test_a_cycle_has_the_length_one(name):
    assert sum(scheme.WEIGHTS[name]) == pytest.approx(1.0, abs=1e-15)


def test_suzukis_weights_cancel_the_error_of_third_order():
    # the condition that makes a symmetric composition of order 2 one of order 4
    assert sum(step**3 for step in scheme.WEIGHTS["suzuki4"]) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("name", scheme.WEIGHTS)
def test_an_oscillator_is_stable_up_to_the_bound_and_not_beyond(name):
    steps = scheme.WEIGHTS[name]
    bound = len(steps) * scheme.LARGEST_PHASE[name]
    assert all(trace(phase, steps) <= 2.0 + 1e-12 for phase in np.linspace(0.01, bound, 3000))
    assert trace(1.001 * bound, steps) > 2.0


@pytest.mark.slow
def test_lammps_does_step_for_step_what_the_references_table_does(tmp_path):
    case = scene(chains=2, beads=30, kappa=0.1, duration=30.0, every=0.5, timestep=0.02, scheme="suzuki4")
    found, problem = run(case, tmp_path / "run"), case.problem()
    expected = engine.run(problem, scheme=SUZUKI4, steps_per_frame=problem.steps_per_frame // 5)
    # 1500 steps at x = 120, whose last bit is 1.4e-14
    np.testing.assert_allclose(found.velocity, expected.velocity, rtol=0, atol=1e-10)


def test_a_release_that_would_keep_the_old_step_is_refused(lmp_of, tmp_path):
    scene_files.write(scene(scheme="suzuki4", timestep=0.02, every=0.1), tmp_path)
    words = [lmp_of("2021"), "-in", file_names.DECK]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=HANGS, check=False)
    assert done.returncode == 1
    assert scheme.TOO_OLD in done.stdout
    assert not (tmp_path / file_names.DUMP).exists()
