"""What help and the manual's page say of quantities."""

from pathlib import Path

from plug_ins import needs

from workflow.plugins.help.quantities import explained, manual

PAGE = Path(__file__).parents[3] / "analysis" / "QUANTITIES.md"


@needs("rigid", "sound")
def test_the_manuals_page_is_what_the_types_declare():
    assert PAGE.read_text(encoding="utf-8") == manual(), (
        "python -m workflow.plugins.help.quantities > analysis/QUANTITIES.md"
    )


def test_help_says_of_a_column_unit_meaning_when_undefined_and_where():
    lines = [line.strip() for line in (explained("wall_force") or "").splitlines()]
    assert lines[0] == "wall_force"
    assert lines[1].startswith("largest force on the far wall")
    assert "unit: N with a material, else reduced" in lines
    assert any(line.startswith("undefined where: there is no wall") for line in lines)
    assert lines[-2:] == ["analysis.json: far_end > wall_force", "granchain collect: column wall_force"]


def test_help_says_symbol_and_every_place_of_a_name():
    text = explained("arrival") or ""
    assert "symbol: t" in text
    assert all(place in text for place in ("analysis.json: waves > arrival", "waves.csv: column arrival", "run.json"))
    assert explained("no_such") is None


def test_help_explains_a_quantity_at_a_bead_as_the_quantity():
    assert explained("arrival@30") == explained("arrival")
    assert explained("wall_force@30") is None
