"""Estimated times of a step, held against LAMMPS: those of formulas follow from their text, whatever law it spells."""

import os
import time
from pathlib import Path

import pytest

from lammps_inputs import library
from lammps_inputs.deck_lines import DeckLines
from lammps_inputs.decks import deck
from workflow import cost_model
from workflow.cost_model import formula_seconds, step_seconds
from workflow.engines.lammps import worker

CHAINS = {"name": "a", "chains": 2, "beads": 40, "coupling": {"stiffness": 0.1}, "kick": {"velocity": 1}}
CHAIN = {"name": "a", "beads": 40, "kick": {"velocity": 1}}
SCENES = {
    "Hertz": CHAINS,
    "exponent": {**CHAINS, "contact": {"exponent": 2}},
    "many beads": {**CHAINS, "beads": 2000, "contact": {"exponent": 2}},
    "formula": {**CHAIN, "contact": {"force": "A*(exp(s) - 1)", "A": 1}},
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


def expect_within_a_factor_of_three(problem, folder):
    beads = problem.chains * problem.beads
    fixed, bead = step_seconds(problem)
    assert 1.0 / 3.0 <= (fixed + bead * beads) / measured(problem, folder) <= 3.0
    assert cost_model.cost(problem, 1).step == pytest.approx(fixed + bead * beads)


@pytest.mark.slow
@pytest.mark.parametrize("kind", SCENES)
def test_a_step_takes_the_estimated_time_within_a_factor_of_three(kind, tmp_path):
    expect_within_a_factor_of_three(scene(SCENES[kind]).problem(), tmp_path)


def test_formulas_are_counted_by_the_distances_and_the_operations_in_their_text():
    nothing = formula_seconds([DeckLines(interactions=("pair_style gran/hertz/history 1 0 0 0 0 0", "pair_coeff * *"))])
    once, twice = (
        formula_seconds([DeckLines(interactions=("pair_style lepton/sphere 4", f'pair_coeff * * "{energy}"'))])
        for energy in ("(4-r)^3", "(4-r)^3+exp(4-r)")
    )
    bond = formula_seconds([DeckLines(style="lepton", coefficients=('0.0 "(r^2-64)^2"', '0.0 "(r^2-256)^2"'))])
    atoms = ("variable u atom x-id*4", "variable push atom -2*v_u-v_u^3", "fix push all addforce v_push 0 0")
    of_atoms = formula_seconds([DeckLines(motion=atoms)])
    assert nothing == (0.0, 0.0)
    assert 0.0 < once[0] < twice[0] < bond[0]
    assert once[1] == twice[1] > 0.0
    # 4 operations of the force, and 2 in each of two displacements
    one = formula_seconds([DeckLines(motion=(*atoms[2:], "variable push atom 1+x"))])
    assert of_atoms[1] == pytest.approx(8.0 * one[1])
