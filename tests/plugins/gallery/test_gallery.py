"""The gallery as a command, and the paper's entries by one of their own; that entries come out as known."""

import json
import re
import shutil
from pathlib import Path

import pytest

import granchain
from workflow.cli import main
from workflow.plugins.gallery import sources
from workflow.plugins.gallery.entries import ENTRIES, GROUPS, LONGEST
from workflow.plugins.gallery.statements import FAILS, kept

pytestmark = pytest.mark.usefixtures("lammps_here", "pool_here")

KNOWN = {
    "paper-touching": (4, 3, 0), "paper-gapped": (1, 1, 2),
    "band-gap": (3, 0, 0), "beats": (1, 1, 0), "collision": (4, 0, 0), "decorated": (5, 1, 0),
    "dimer-resonance": (2, 1, 0), "dimers": (6, 0, 0), "exact-wave": (3, 0, 0), "graded": (3, 2, 0),
    "gravity": (1, 1, 0), "impurity": (2, 1, 0), "kicked-chain": (3, 0, 0), "kuwabara-kono": (1, 1, 0),
    "landau-zener": (2, 1, 0), "nesterenko": (2, 2, 0), "parametric": (4, 0, 0), "plastic": (5, 0, 0),
    "precompressed": (0, 3, 0), "resonators": (4, 0, 0), "rosas": (2, 1, 0), "striker-trains": (3, 1, 0),
    "tapered": (1, 4, 2), "wall": (4, 0, 0),
    "two-spheres": (4, 0, 0), "rigid-plane": (4, 0, 0), "impact-restitution": (2, 0, 0),
    "open-multipliers": (6, 0, 0), "open-map": (4, 0, 0), "open-more-chains": (2, 0, 0), "open-modes": (3, 0, 0),
    "open-arrays": (3, 1, 0), "open-robust": (2, 3, 0),
    "rectifier": (4, 0, 0), "dark-breathers": (4, 0, 0), "gap-breathers": (6, 1, 0), "mode-beats": (4, 0, 0),
}  # fmt: skip
"""Statements that hold, do with a correction and do not, by entry; hard spheres are not elastic beads."""

CHEAP = ("kicked-chain", "tapered")
OWN = (*CHEAP, "collision", "rigid-plane", "wall", "landau-zener", "precompressed", "dark-breathers", "mode-beats")
OWN += ("open-modes", "open-robust", "parametric")
"""`granchain gallery` runs all but those of the open question, which `granchain gallery paper-open` does."""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory of the paper's entries, by the name of their group, and of others."""
    directory = tmp_path_factory.mktemp("gallery")
    assert main(["gallery", "paper", "-o", str(directory)]) == 0
    assert main(["gallery", *OWN, "-o", str(directory), "--quiet"]) == 0
    return directory


@pytest.mark.slow
@pytest.mark.parametrize("name", [*GROUPS["paper"], *OWN])
def test_an_entry_comes_out_as_known_and_statements_that_do_not_hold_are_no_failure(name: str, page: Path) -> None:
    section = kept(page / "entries" / name)
    assert section is not None
    assert tuple(section.verdicts.values()) == KNOWN[name]
    assert {statement.source.partition(", ")[0] for statement in section.statements} <= {*section.sources, ""}
    assert all(bool(statement.published) == bool(statement.source) for statement in section.statements)


@pytest.mark.slow
def test_the_page_has_both_engines_numbers_and_says_where_the_paper_needs_a_correction(page: Path) -> None:
    text = (page / "index.html").read_text()
    for engine in ("LAMMPS", "reference"):
        for amplitude in ("0.36524", "0.35934", "0.25559"):
            assert f"{engine}: final amplitude {amplitude}" in text
    for words in (
        "LAMMPS 0.68163 V, reference 0.68163 V",
        "LAMMPS 0.9332, reference 0.9332",  # computed by two other integrators
        "at bead 55 they still differ by 2.0%",
        "become much weaker",
        "has then moved by 0.2220 D",
        "with 0.750000 V against 0.250000 V",
        "Rigid rows do not equipartition",
        "kappa = 0.1, row 5: first impulses 0.342, 0.724",
        "kappa = 1, row 25: first impulses 0.528, 0.528",
        "reference 0.02499268",  # Floquet's exponent
        "LAMMPS 0.668106, reference 0.668106",  # growth in a chain of 60 beads
        "reference 0.536736",  # shares of the action
        "reference 0.555905",
    ):
        assert words in text
    assert "None" not in text  # a bead that was not reached
    assert not re.findall(r'(?:src|href)="(?!data:|#)', text)  # it needs no other file


@pytest.mark.slow
def test_a_second_start_runs_nothing_again_and_an_entry_that_cannot_be_read_fails_alone(
    page: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    spoilt = page / "entries" / "kicked-chain" / "runs" / "kicked-lammps" / "run.json"
    whole = spoilt.read_text()
    spoilt.write_text("{")
    capsys.readouterr()
    assert main(["gallery", "-o", str(page), "--json", *CHEAP]) == 1
    spoilt.write_text(whole)
    failed = {one["name"]: one["failed"] for one in json.loads(capsys.readouterr().out)}
    assert "run.json" in failed["kicked-chain"]
    assert failed["tapered"] is None
    dumps = {path: path.stat().st_mtime_ns for path in page.rglob("*.bin")}
    assert FAILS in granchain.gallery(str(page), "tapered")._repr_html_()
    assert {path: path.stat().st_mtime_ns for path in page.rglob("*.bin")} == dumps
    assert "A kicked chain" in (page / "index.html").read_text()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["two-chains", "three-chains"])
def test_the_verdict_on_a_run_agrees_with_the_page(name: str, page: Path, tmp_path: Path) -> None:
    run = shutil.copytree(page / "entries" / "paper-touching" / "runs" / f"{name}-lammps", tmp_path / "run")
    assert main(["analyze", str(run), "--no-figures"]) == 0
    found = json.loads((run / "analysis.json").read_text())["equipartition"]
    since = found["amplitudes"]["0.01"]
    said = "not within 1% for half a beat" if since is None else f"within 1% from bead {since} on"
    assert f"{name}: {said}" in (page / "index.html").read_text()
    assert (found["state"] == "equipartitioned and synchronised") == (since is not None)


def test_every_entry_is_listed_also_in_the_manuals_table_of_sources(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["gallery", "--list"]) == 0
    assert capsys.readouterr().out.split() == list(ENTRIES)
    assert set(KNOWN) == set(ENTRIES) - LONGEST
    manual = sources.PAGE.read_text(encoding="utf-8")
    assert sources.renewed(manual) == manual, "run `python -m workflow.plugins.gallery.sources`"
