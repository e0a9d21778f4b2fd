"""What `granchain help` says of keys, commands, phrases and quantities."""

import pytest

from workflow.cli import main
from workflow.sweep.collect import QUANTITIES


def said(capsys, *words):
    assert main(list(words)) == 0
    return capsys.readouterr().out


def test_help_explains_keys_and_commands(capsys):
    assert "Springs between" in said(capsys, "help", "coupling.rows")
    assert "Clear distance" in said(capsys, "help", "scene")
    assert all(f"in {key}:" in said(capsys, "help", "restitution") for key in ("contact", "damping"))
    assert all(f"in {key}:" in said(capsys, "help", "stiffness") for key in ("contact", "kinds", "coupling"))
    assert "COMMAND" in said(capsys, "help")
    with pytest.raises(SystemExit):
        main(["help", "run"])
    assert "usage: granchain run" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "explanation"),
    [
        ("leading pulse", "first pulse that reaches a bead of a chain"),
        ("beat length", "beat_length\n"),
        ("peak velocity", "analysis.json: waves > peak_velocity"),
        ("contact force", "Force as a formula of s"),
        ("budget", "analysis.json: budget holds time, energy_input, kinetic"),
        ("budget.closed", "largest missing over the largest energy_input"),
        ("notation", "kappa\n      dimensionless coupling stiffness"),
        ("Static load", "Static load. F_(0,n) is the force in contact n at rest"),
        ("contact constant", "A = 4/3 E^* sqrt(R^*), 1 / (E^*) = 1 / (E'_1)"),
        ("steady", "the variation is at most 1%"),
        ("too short", "no half beat was seen"),
        ("asymptotic amplitude", "mean over chains and the last half beat"),
    ],
)
def test_help_explains_phrases_keys_of_results_sections_of_the_model_and_terms_of_verdicts(words, explanation, capsys):
    assert explanation in said(capsys, "help", *words.split())


def test_all_meanings_of_a_word_stand_where_they_hold_the_phrase(capsys):
    text = said(capsys, "help", "Uncertainty").partition("\n  train.")[0]  # both of *error*: a term, and of spectra.csv
    assert "measured difference from the reference integrator" in text
    assert "uncertainty of each amplitude" in text


@pytest.mark.parametrize("name", QUANTITIES)
def test_help_says_where_a_quantity_stands(name, capsys):
    lines = said(capsys, "help", name).splitlines()
    assert name == lines[0]
    assert any(
        line.strip().startswith(QUANTITIES[name].file) and line.endswith(QUANTITIES[name].path[-1]) for line in lines
    )
    assert any(line.strip().startswith("granchain collect: column") and name in line for line in lines)
