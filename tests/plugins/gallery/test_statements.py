"""Pages of statements, sections kept as files, and the rule of the verdicts."""

import html
import importlib.metadata
import math
import re

import pytest

from lammps_inputs import references
from workflow.plugins.gallery.criteria import MeasuredQuantity, at_least, at_most, near, state
from workflow.plugins.gallery.statements import FAILS, HOLDS, Section, Statement, render

STATEMENTS = [
    Statement("fast", "rosas2007, abstract", "", ["1"], HOLDS),
    Statement("<b>", "", "slow", ["<i>"], FAILS, "not so"),
]
SOME = Section("Waves", "of <beads>", STATEMENTS, notes=["read"], sources={"rosas2007": "abstract read"})


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


HOLDS, CORRECTED, FAILS = "holds", "holds with a correction", "does not hold"


def judged(value, required, lammps=0.682):
    return state(MeasuredQuantity("V", {"lammps": lammps, "reference": value}, required, "4 V"), published="0.682 V.")


@pytest.mark.parametrize(
    ("value", "required", "text", "holds"),
    [
        (0.6818, near(0.682, 5e-4, 1e-3), "0.682 \u00b1 0.0005 V (\u00b1 0.001 V)", HOLDS),
        (0.6826, near(0.682, 5e-4, 1e-3), "0.682 \u00b1 0.0005 V (\u00b1 0.001 V)", CORRECTED),
        (0.7, near(0.682, 5e-4, 1e-3), "0.682 \u00b1 0.0005 V (\u00b1 0.001 V)", FAILS),
        (0.682, at_least(0.68), "\u2265 0.68 V", HOLDS),
        (0.682, at_most(0.68), "\u2264 0.68 V", FAILS),
        (0.682, at_least(0.7, -math.inf), "\u2265 0.7 V (any value)", CORRECTED),
    ],
)
def test_a_number_holds_in_its_range_and_needs_a_correction_in_the_wider_one(value, required, text, holds):
    statement = judged(value, required)
    assert f"required: {text}" in statement.found[0]
    assert statement.holds == holds
    assert (statement.correction == "") == (holds == HOLDS)


def test_the_worse_engine_and_the_worst_quantity_decide():
    assert judged(0.682, near(0.682, 5e-4), lammps=0.7).holds == FAILS
    good, bad = (MeasuredQuantity("n", {"reference": value}, near(1.0, 0.5)) for value in (1.0, 2.0))
    assert [state(good, last, derived="n is 1").holds for last in (good, bad)] == [HOLDS, FAILS]
