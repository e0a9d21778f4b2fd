"""The manual's pages: lengths of paragraphs and cells, and one table of all symbols."""

import re
from pathlib import Path

import pages
import pytest

import lammps_inputs

ROOT = Path(lammps_inputs.__file__).parents[1]
PACKAGES = ("lammps_inputs", "analysis", "workflow")
MANUAL = [page for name in PACKAGES for page in sorted((ROOT / name).rglob("*.md")) if page.name != "DEVELOPING.md"]


@pytest.mark.parametrize("page", MANUAL, ids=lambda page: str(page.relative_to(ROOT)))
def test_no_paragraph_of_the_manual_has_more_than_90_words_and_no_cell_more_than_two_lines(page):
    assert pages.too_long(page.read_text(encoding="utf-8")) == []


def test_every_symbol_of_the_equations_of_the_model_is_in_its_table_of_notation():
    page = (ROOT / "lammps_inputs" / "MODEL.md").read_text(encoding="utf-8")
    equations, _, notation = page.partition("## Notation")
    units = re.findall(r"^\| (\$[^|]*) \|", equations.partition("## Units")[2], re.M)
    table = re.findall(r"^\| (\$[^|]*) \|", notation, re.M)
    assert pages.symbols(equations) - pages.symbols(" ".join([*units, *table])) == set()


def test_no_symbol_has_two_rows_in_the_table_of_notation():
    page = (ROOT / "lammps_inputs" / "MODEL.md").read_text(encoding="utf-8")
    cells = re.findall(r"^\| (\$[^|]*) \|", page.partition("## Notation")[2], re.M)
    names = [name for cell in cells for name in re.findall(r"\$([^$]+)\$", cell)]
    assert len(names) == len(set(names))


def test_every_plug_in_has_a_page_that_the_page_of_commands_links_section_by_section():
    plug_ins = ROOT / "workflow" / "plugins"
    commands = (ROOT / "workflow" / "README.md").read_text(encoding="utf-8")
    links = re.findall(r"^- \[(.+)\]\(plugins/(\w+)/README\.md#", commands, re.M)
    folders = [path.parent.name for path in plug_ins.glob("*/__init__.py")]
    titles = {
        (title, name)
        for name in folders
        for title in re.findall(r"^## (.+)$", (plug_ins / name / "README.md").read_text(encoding="utf-8"), re.M)
    }
    assert {name for _, name in titles} == set(folders)
    assert sorted(links) == sorted(titles)


def test_no_text_is_left_to_be_filled():
    """`tests/support/new_ingredient.py` writes the word where a text is missing."""
    scenes = (ROOT / "lammps_inputs" / "scenes").glob("*.yaml")
    assert [page.name for page in (*MANUAL, *scenes) if "FILL" in page.read_text(encoding="utf-8")] == []
