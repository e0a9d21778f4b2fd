"""Pages of statements, and sections kept as files."""

import html
import importlib.metadata
import re

from matplotlib.figure import Figure

from lammps_inputs import references
from workflow.plugins.gallery.statements import FAILS, HOLDS, SECTION, Section, Statement, files_of, kept, render
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
    (tmp_path / SECTION).write_text('{"title": 1}')  # damaged
    assert kept(tmp_path) is None


def test_the_contents_lead_to_each_section_and_count_its_verdicts():
    text = render("t", "s", [SOME, Section("Lost", "", (), failed="no <disk>")])
    assert re.findall(r'href="#(s\d+)"', text) == re.findall(r'<section id="(\w+)"', text) != []
    listed = text[text.index("<ol") : text.index("</ol>")]
    assert re.findall(r"<strong>(.*?)</strong>", listed) == ["1 holds", "1 does not hold", "failed"]
    assert "no &lt;disk&gt;" in text


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
