"""Estimated times of a step, held against LAMMPS: those of formulas follow from their text, whatever law it spells."""

import os
import time
from pathlib import Path

import pytest

from lammps_inputs import library
from lammps_inputs.decks import deck
from workflow import cost_model
from workflow.cost_model import step_seconds
from workflow.engines.lammps import worker

CHAINS = {"name": "a", "chains": 2, "beads": 40, "coupling": {"stiffness": 0.1}, "kick": {"velocity": 1}}
CHAIN = {"name": "a", "beads": 40, "kick": {"velocity": 1}}
SCENES = {
    "Hertz": CHAINS,
    "exponent": {**CHAINS, "contact": {"exponent": 2}},
    "long formula": {
        **CHAIN,
        "contact": {"force": "A*s^1.5*(1 + b*s + c*s^2) + d*s*exp(s)", "A": 1, "b": 1, "c": 1, "d": 1},
    },
    "coupling": {**CHAINS, "coupling": {"force": "k*s + b*s^3", "k": 0.1, "b": 0.1}},
    "foundation": {**CHAIN, "beads": 400, "foundation": {"force": "k*s + b*s^3", "k": 0.1, "b": 0.1}},
    "plastic": {**library.find("plastic-contacts").plain(), "output": {}},
}


def scene(plain):
    step = 1e-3 * library.from_plain({**plain, "duration": 1.0}, "a").scale.time
    return library.from_plain({**plain, "timestep": step, "duration": step, "until_bead": None}, "a")


def measured(problem, folder):
    """Processor time of a step in LAMMPS without frames, in s."""
    (folder / "in.chains").write_text(deck.render_deck(problem))
    (folder / "data.chains").write_text(deck.render_data(problem))
    where = Path.cwd()
    os.chdir(folder)
    try:
        lammps = worker.instance(1)
        steps, seconds = 4, 0.0
        while seconds < 0.1:
            steps *= 3
            started = time.process_time()
            lammps.command(f"run {steps} post no")
            seconds = time.process_time() - started
        lammps.close()
    finally:
        os.chdir(where)
    return seconds / steps


@pytest.mark.slow
@pytest.mark.parametrize("kind", SCENES)
def test_a_step_takes_the_estimated_time_within_a_factor_of_three(kind, tmp_path):
    problem = scene(SCENES[kind]).problem()
    fixed, bead = step_seconds(problem)
    expected = fixed + bead * problem.chains * problem.beads
    assert 1.0 / 3.0 <= expected / measured(problem, tmp_path) <= 3.0
    assert cost_model.cost(problem, 1).step == pytest.approx(expected)
