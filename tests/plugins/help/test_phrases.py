"""What `granchain help` says of keys, commands, phrases and quantities."""

import pytest

from workflow.cli import main
from workflow.sweep.collect import QUANTITIES


def said(capsys, *words):
    assert main(list(words)) == 0
    return capsys.readouterr().out


def test_help_explains_keys_phrases_results_sections_of_the_model_and_terms_of_verdicts(capsys, golden):
    asked = ("restitution", "tension", "beat length", "peak velocity", "budget.closed", "contact constant", "steady")
    golden("phrases", "\n".join(f"{words}\n{said(capsys, 'help', *words.split())}" for words in asked))


@pytest.mark.parametrize("name", QUANTITIES)
def test_help_says_where_a_quantity_stands(name, capsys):
    lines = said(capsys, "help", name).splitlines()
    assert name == lines[0]
    assert any(
        line.strip().startswith(QUANTITIES[name].file) and line.endswith(QUANTITIES[name].path[-1]) for line in lines
    )
    assert any(line.strip().startswith("granchain collect: column") and name in line for line in lines)
