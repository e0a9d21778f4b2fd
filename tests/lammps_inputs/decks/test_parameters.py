"""Parameters of decks: all that a deck offers are compared with those that LAMMPS's log states."""

import re

import pytest
from executables import RELEASES
from stock_lammps import run, scene

from lammps_inputs import find, installed_scenes
from lammps_inputs.decks import deck, parameters


@pytest.mark.parametrize("name", sorted(installed_scenes.installed()))
def test_every_parameter_of_a_deck_is_compared_or_changes_no_frame(name):
    problem = find(name).problem()
    offered = set(re.findall(r"^variable (\S+) index", deck.render_deck(problem), re.MULTILINE))
    assert {*parameters.of_problem(problem), *parameters.FREE} == offered


@pytest.mark.parametrize("release", RELEASES)
def test_values_from_the_command_line_are_those_that_the_log_shows_to_differ(release, lmp_of, tmp_path):
    case = scene(chains=2, kappa=0.1, damping={"contact": 0.1}, duration=1.0)
    options = ("-var", "kappa", "0.3", "-var", "kick1", "9e-1", "-var", "contact_damping", "0.2", "-var", "steps", "10")
    log = run(case, tmp_path / "run", *options, executable=lmp_of(release)).log
    assert sorted(parameters.differences(log, case.problem())) == [
        "contact_damping: 0.2, in the scene 0.1",
        "kappa: 0.3, in the scene 0.1",
        "kick1: 9e-1, in the scene 1",
    ]
