"""Parameters of decks: all that a deck offers are compared with those that LAMMPS's log states."""

import re

import pytest
from executables import RELEASES
from stock_lammps import run, scene

from lammps_inputs import file_names, find, installed_scenes
from lammps_inputs.decks import continuation, deck, parameters


@pytest.mark.parametrize("name", sorted(installed_scenes.installed()))
def test_every_parameter_of_a_deck_is_compared_or_changes_no_frame(name):
    problem = find(name).problem()
    offered = set(re.findall(r"^variable (\S+) index", deck.render_deck(problem), re.MULTILINE))
    assert {*parameters.of_problem(problem), *parameters.FREE} == offered


@pytest.mark.parametrize("render", [deck.render_deck, continuation.render_continuation])
def test_the_log_states_the_values_after_all_of_them_are_set(render):
    text = render(find("two-chains").problem())
    assert text.count(deck.STATED) == 1
    assert text.rindex(" index ") < text.index(deck.STATED)


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


def test_a_log_of_the_scenes_own_values_shows_no_difference(tmp_path):
    case = find("two-chains-steel").model_copy(update={"beads": 4, "duration": 1e-5})
    assert parameters.differences(run(case, tmp_path / "run").log, case.problem()) == []


def test_differences_from_a_scene_in_si_name_the_file_whose_units_they_have():
    log = "Variable[  0]: kick1,            style = index,            def = 0.5\n"
    problem = find("two-chains-steel").problem()
    (text,) = parameters.differences(log, problem)
    assert text == f"kick1: 0.5, in the scene 1 (dimensionless, as in {file_names.DECK})"
