"""The paper recomputed as one page: its entries of the gallery, by a command of their own."""

import json
import os
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from processes import HANGS

from workflow.cli import main
from workflow.studies.page import kept


@pytest.fixture(scope="module", params=[pytest.param("", marks=pytest.mark.slow)])
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("report")
    assert main(["reproduce", "-o", str(directory)]) == 0
    return directory


@pytest.mark.slow
def test_the_page_holds_the_final_amplitudes_of_both_engines(report: Path) -> None:
    page = (report / "index.html").read_text()
    for engine in ("LAMMPS", "reference"):
        for amplitude in ("0.36524", "0.35934", "0.25559"):
            assert re.search(rf"{engine}: final amplitude {amplitude}", page)


def test_the_page_says_where_the_paper_needs_a_correction(report: Path) -> None:
    page = (report / "index.html").read_text()
    assert "at bead 55 they still differ by 2.0%" in page
    assert "become much weaker" in page


@pytest.mark.parametrize(("name", "counts"), [("paper-touching", [4, 3, 0]), ("paper-gapped", [1, 1, 2])])
def test_statements_of_the_paper_that_hold_with_a_correction_or_not(name: str, counts: list[int], report: Path) -> None:
    section = kept(report / "entries" / name)
    assert section is not None
    assert list(section.verdicts.values()) == counts


def test_all_figures_of_section_2_are_there(report: Path) -> None:
    for number in range(1, 7):
        assert (report / "entries" / "paper-touching" / f"fig{number}.png").stat().st_size > 10_000


@pytest.mark.slow
def test_the_page_opens_in_a_browser_without_errors(report: Path, tmp_path: Path) -> None:
    browser = shutil.which("chromium")
    if browser is None:
        assert not os.environ.get("CI"), "continuous integration installs chromium"
        pytest.skip("chromium is not installed")
    found = subprocess.run(
        [
            browser,
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            f"--user-data-dir={tmp_path}",
            "--enable-logging=stderr",
            "--dump-dom",
            (report / "index.html").as_uri(),
        ],
        capture_output=True,
        text=True,
        timeout=HANGS,
        check=True,
    )
    assert "section 2" in found.stdout
    assert "CONSOLE" not in found.stderr


def test_section_3_says_what_the_rigid_model_does_not_show(report: Path) -> None:
    page = (report / "index.html").read_text()
    assert "has then moved by 0.2220 D" in page
    assert "with 0.750000 V against 0.250000 V" in page
    assert "Rigid rows do not equipartition" in page


def test_gapped_hertz_rows_come_out_as_known(report: Path) -> None:
    page = (report / "index.html").read_text()
    for line in ("kappa = 0.1, row 5: first impulses 0.342, 0.724", "kappa = 1, row 25: first impulses 0.528, 0.528"):
        assert line in page


@pytest.mark.parametrize("name", ["two-chains", "two-chains-strong", "three-chains"])
def test_the_verdict_on_a_run_agrees_with_the_page(name: str, report: Path, tmp_path: Path) -> None:
    run = shutil.copytree(report / "entries" / "paper-touching" / "runs" / f"{name}-lammps", tmp_path / "run")
    assert main(["analyze", str(run), "--no-figures"]) == 0
    found = json.loads((run / "analysis.json").read_text())["equipartition"]
    since = found["amplitudes"]["0.01"]
    said = "not within 1% for half a beat" if since is None else f"within 1% from bead {since} on"
    assert f"{name}: {said}" in (report / "index.html").read_text()
    assert (found["state"] == "equipartitioned and synchronised") == (since is not None)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "kappa"),
    [("two-chains-gapped-strong", "1"), ("two-chains-gapped", "0.1")],
)
def test_the_verdict_on_chains_with_gaps_agrees_with_the_page(
    name: str, kappa: str, report: Path, paper: Callable[[str], Path]
) -> None:
    found = json.loads((paper(name) / "analysis.json").read_text())["equipartition"]
    assert re.search(rf"impulses agree within 1%: .*kappa = {kappa}: [0-9]+[,;]", (report / "index.html").read_text())
    assert found["state"] == "equipartitioned and synchronised"


def test_a_bead_that_was_not_reached_is_no_number(report: Path) -> None:
    assert "None" not in (report / "index.html").read_text()
