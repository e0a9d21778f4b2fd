"""Pages of statements, and sections kept as files."""

import html
import importlib.metadata
import re

import pytest
from matplotlib.figure import Figure

from lammps_inputs import references
from workflow import provenance
from workflow.plugins.gallery.statements import FAILS, HEADS, HOLDS, SECTION, Section, Statement, files_of, kept, render
from workflow.study_kit.page import drawn

SOME = Section(
    "Waves",
    "of beads",
    [
        Statement("fast", "rosas2007, abstract", "", ["1"], HOLDS),
        Statement("", "", "slow", ["2"], FAILS, "not so"),
    ],
    notes=["read"],
    sources={"rosas2007": "abstract read"},
)


def keep(section, folder):
    for name, content in files_of(section).items():
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())


def test_a_section_that_was_kept_is_the_same_again(tmp_path):
    section = Section("Waves", "of beads", SOME.statements, [drawn("one", Figure((1, 1)), "none")], ["read"])
    keep(section, tmp_path)
    assert kept(tmp_path) == section


def test_a_damaged_section_is_none(tmp_path):
    keep(SOME, tmp_path)
    (tmp_path / SECTION).write_text('{"title": 1}')
    assert kept(tmp_path) is None


def test_the_contents_link_to_each_section_and_count_its_verdicts():
    text = render("t", "s", [SOME, Section("Lost", "", (), failed="no <disk>")])
    targets = re.findall(r'<section id="(\w+)"', text)
    assert re.findall(r'href="#(s\d+)"', text) == targets
    listed = text[text.index("<ol") : text.index("</ol>")]
    assert re.findall(r"<strong>(.*?)</strong>", listed) == ["1 holds", "1 does not hold", "failed"]
    assert "no &lt;disk&gt;" in text


def test_a_page_has_a_way_back_to_its_contents_and_cells_name_their_column():
    text = render("t", "s", [SOME])
    assert text.count('<ol id="contents">') == text.count('href="#contents"') == 1
    assert re.findall(r'<td class="\w*" data-head="([a-z ]+)"', text) == [*HEADS, *HEADS]


def test_text_from_outside_cannot_become_markup():
    section = Section("<script>", "a & b", [Statement("<b>", "", "", ["<i>"], HOLDS)])
    assert "<script>" not in render("t", "s", [section])


def test_a_page_ends_with_full_references_versions_date_and_machine():
    text = render("t", "s", [SOME])
    foot = text[text.index('<footer class="provenance">') :]
    assert references.text("rosas2007") in html.unescape(foot)
    assert '<a href="#r1">[1]</a> abstract read' in text
    assert 'fast <a href="#r1">[1]</a>, abstract</td>' in text
    for name in ("granchain", "lammps"):
        assert importlib.metadata.version(name) in foot
    assert re.search(r"Date: \d{4}-\d\d-\d\d \d\d:\d\d[+-]", foot)
    assert re.search(r"Machine: .+, \d+ cores", foot)


def test_an_installed_package_has_no_commit(tmp_path, monkeypatch):
    provenance.commit.cache_clear()
    monkeypatch.setattr(provenance, "HOME", tmp_path)
    assert provenance.commit() == ""
    provenance.commit.cache_clear()


@pytest.mark.slow
def test_a_page_of_statements_fits_a_narrow_screen(tmp_path, browser):
    long = Statement("rosas2007" * 9, "rosas2007, abstract", "derived", ["LAMMPS 0.68163 V, " * 9], HOLDS, "corrected")
    (tmp_path / "index.html").write_text(render("t", "s", [Section("Waves", "of beads", [long])]))
    page = browser.new_page(viewport={"width": 600, "height": 800})
    page.goto((tmp_path / "index.html").as_uri())
    assert page.evaluate("document.documentElement.scrollWidth") == 600
    page.get_by_role("link", name="contents").click()
    assert page.url.endswith("#contents")
