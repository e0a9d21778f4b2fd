"""Pages of statements, and sections kept as files."""

import html
import importlib.metadata
import re

from matplotlib.figure import Figure

from lammps_inputs import references
from workflow.plugins.gallery.statements import FAILS, HOLDS, SECTION, Section, Statement, files_of, kept, render
from workflow.study_kit.page import drawn

STATEMENTS = [
    Statement("fast", "rosas2007, abstract", "", ["1"], HOLDS),
    Statement("<b>", "", "slow", ["<i>"], FAILS, "not so"),
]
SOME = Section("Waves", "of <beads>", STATEMENTS, notes=["read"], sources={"rosas2007": "abstract read"})


def test_a_section_that_was_kept_is_the_same_again(tmp_path):
    section = Section("Waves", "of beads", STATEMENTS, [drawn("one", Figure((1, 1)), "none")], ["read"])
    for name, content in files_of(section).items():
        (tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    assert kept(tmp_path) == section
    (tmp_path / SECTION).write_text('{"title": 1}')  # damaged
    assert kept(tmp_path) is None


def test_a_page_counts_verdicts_ends_with_references_and_versions_and_takes_no_markup():
    text = render("t", "s", [SOME, Section("Lost", "", (), failed="no <disk>")])
    assert re.findall(r'href="#(s\d+)"', text) == re.findall(r'<section id="(\w+)"', text) != []
    listed = text[text.index("<ol") : text.index("</ol>")]
    assert re.findall(r"<strong>(.*?)</strong>", listed) == ["1 holds", "1 does not hold", "failed"]
    assert not any(markup in text for markup in ("<disk>", "<beads>", "<i>"))
    assert 'fast <a href="#r1">[1]</a>, abstract</td>' in text
    foot = text[text.index('<footer class="provenance">') :]
    assert references.text("rosas2007") in html.unescape(foot)
    assert all(importlib.metadata.version(name) in foot for name in ("granchain", "lammps"))
