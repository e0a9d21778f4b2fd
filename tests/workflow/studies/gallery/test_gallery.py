"""The gallery as a command; that its entries come out as known."""

import importlib
import json
import pkgutil
import re
from pathlib import Path

import pytest

from workflow import api
from workflow.cli import main
from workflow.studies.gallery import entries, sources
from workflow.studies.gallery.entries import ENTRIES
from workflow.studies.gallery.entry import Entry
from workflow.studies.page import CORRECTED, FAILS, HOLDS, kept

CHEAP = ("kicked-chain", "tapered")

KNOWN = {
    "band-gap": (3, 0, 0), "beats": (1, 1, 0), "collision": (4, 0, 0), "decorated": (5, 1, 0),
    "dimer-resonance": (2, 1, 0), "dimers": (6, 0, 0), "exact-wave": (3, 0, 0), "graded": (3, 2, 0),
    "gravity": (1, 1, 0), "impurity": (2, 1, 0), "kicked-chain": (3, 0, 0), "kuwabara-kono": (1, 1, 0),
    "landau-zener": (2, 1, 0), "nesterenko": (2, 2, 0), "parametric": (4, 0, 0), "plastic": (5, 0, 0),
    "precompressed": (0, 3, 0), "resonators": (4, 0, 0), "rosas": (2, 1, 0), "striker-trains": (3, 1, 0),
    "tapered": (1, 4, 2), "wall": (4, 0, 0),
}  # fmt: skip
"""Statements that hold, do with a correction and do not, by entry; hard spheres are not elastic beads."""


def verdicts(page: Path, name: str) -> list[str]:
    section = kept(page / "entries" / name)
    assert section is not None
    assert {statement.source.partition(", ")[0] for statement in section.statements} <= {*section.sources, ""}
    assert all(bool(statement.published) == bool(statement.source) for statement in section.statements)
    return [statement.holds for statement in section.statements]


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("gallery")
    words = [word for name in CHEAP for word in ("--only", name)]
    assert main(["gallery", "-o", str(directory), *words]) == 0
    return directory


@pytest.mark.slow
def test_an_entry_whose_numbers_do_not_hold_is_red_and_no_failure(page):
    for name in CHEAP:
        assert tuple(map(verdicts(page, name).count, (HOLDS, CORRECTED, FAILS))) == KNOWN[name]


@pytest.mark.slow
def test_the_page_has_both_engines_numbers_and_needs_no_other_file(page):
    text = (page / "index.html").read_text()
    assert "LAMMPS 0.68163 V, reference 0.68163 V" in text
    assert "LAMMPS 0.9332, reference 0.9332" in text  # computed by two other integrators
    assert not re.findall(r'(?:src|href)="(?!data:|#)', text)


@pytest.mark.slow
def test_an_entry_that_cannot_be_run_fails_alone(page, capsys):
    spoilt = page / "entries" / "kicked-chain" / "runs" / "kicked-lammps" / "run.json"
    whole = spoilt.read_text()
    spoilt.write_text("{")
    capsys.readouterr()
    words = [word for name in CHEAP for word in ("--only", name)]
    assert main(["gallery", "-o", str(page), "--json", *words]) == 1
    spoilt.write_text(whole)
    failed = {one["name"]: one["failed"] for one in json.loads(capsys.readouterr().out)}
    assert "run.json" in failed["kicked-chain"]
    assert failed["tapered"] is None


@pytest.mark.slow
def test_a_second_start_runs_nothing_again_and_keeps_what_is_not_asked_for_on_the_page(page):
    dumps = {path: path.stat().st_mtime_ns for path in page.rglob("*.bin")}
    found = api.gallery(str(page), "tapered")
    assert repr(found) == "<gallery: tapered>"
    assert FAILS in found._repr_html_()
    assert {path: path.stat().st_mtime_ns for path in page.rglob("*.bin")} == dumps
    assert "A kicked chain" in (page / "index.html").read_text()


def test_every_entry_is_listed(capsys):
    assert main(["gallery", "--list"]) == 0
    assert capsys.readouterr().out.split() == list(ENTRIES)


def test_every_entry_of_every_module_is_listed():
    modules = [
        importlib.import_module(f"{entries.__name__}.{one.name}") for one in pkgutil.iter_modules(entries.__path__)
    ]
    found = [value for module in modules for value in vars(module).values() if isinstance(value, Entry)]
    assert {one.title for one in found} == {one.title for one in ENTRIES.values()}


def test_the_table_of_sources_in_the_manual_is_that_of_models_and_entries():
    page = sources.PAGE.read_text(encoding="utf-8")
    assert sources.renewed(page) == page, "run `python -m workflow.studies.gallery.sources`"


@pytest.mark.slow
def test_every_third_entry_comes_out_as_known(tmp_path):
    own = [name for name in ENTRIES if not name.startswith("paper")][::3]  # `granchain gallery` runs them all
    own = [name for name in own if name not in CHEAP]
    words = [word for name in own for word in ("--only", name)]
    assert main(["gallery", "-o", str(tmp_path), "--quiet", *words]) == 0
    found = {name: tuple(map(verdicts(tmp_path, name).count, (HOLDS, CORRECTED, FAILS))) for name in own}
    assert found == {name: KNOWN[name] for name in own}
