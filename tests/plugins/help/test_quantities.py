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


def test_help_says_unit_symbol_meaning_and_every_place_of_a_quantity_also_at_a_bead(golden):
    golden("quantities", "\n\n".join(explained(name) or "" for name in ("wall_force", "arrival")))
    assert explained("arrival@30") == explained("arrival")
    assert [explained(name) for name in ("no_such", "wall_force@30")] == [None] * 2
