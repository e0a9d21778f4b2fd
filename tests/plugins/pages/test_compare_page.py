"""Pages that compare two runs: `granchain view A --against B`, and `granchain validate --page`."""

import json
import shutil

import numpy as np
import pytest
from page_table import page_table
from refusals import refusal

import granchain
from analysis.figures.panels import shown_chains
from workflow.cli import main
from workflow.plugins.pages import compare_page
from workflow.plugins.pages.compared import compared_lines, quantity_table, setting_table, written
from workflow.runs.files import RECORD
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.validate_run import compare_runs, compared_pairs

SCENE = {"name": "pair", "chains": 2, "beads": 40, "coupling": {"stiffness": 0.1}, "kick": {"velocity": 1.0}}
SCENE |= {"duration": 40.0}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Directory with runs of one scene, one of them with another coupling, others with frames at other times."""
    directory = tmp_path_factory.mktemp("pairs")
    changes = {
        "A": {},
        "B": {"coupling": {"stiffness": 0.12}},
        "sparse": {"output": {"every": 0.5}},
        "window": {"beads": 100, "duration": 100.0},
    }
    for name, change in changes.items():
        granchain.run({**SCENE, **change}, directory / name, engine="reference")
    granchain.run({**SCENE, **changes["window"], "window": 64}, directory / "window-64", engine="lammps", check=False)
    return directory


@pytest.fixture
def runs(made):
    return RunDirectory(made / "A"), RunDirectory(made / "B")


def frames_of(runs):
    comparison, _ = compare_runs(runs)
    problem = comparison.problem
    return compare_page.compared_frames(problem, compared_pairs(runs, comparison), shown_chains(problem))


@pytest.mark.slow
def test_the_map_is_the_velocity_of_one_run_minus_that_of_the_other_at_each_bead_and_common_frame(runs, made):
    frames = frames_of(runs)
    velocities = [run.trajectory.velocity.transpose(1, 0, 2) for run in runs]
    np.testing.assert_array_equal(frames.first.velocity, velocities[0])
    np.testing.assert_array_equal(frames.second.velocity, velocities[1])
    np.testing.assert_array_equal(frames.difference.velocity, velocities[0] - velocities[1])
    assert frames.difference.chains == [1, 2]
    seldom = RunDirectory(made / "sparse")
    few = frames_of((runs[0], seldom))
    assert few.first.time.tolist() == seldom.trajectory.time.tolist()
    assert np.max(np.abs(few.difference.velocity)) < 1e-9
    window = frames_of((RunDirectory(made / "window-64"), RunDirectory(made / "window"))).difference.velocity
    assert np.isnan(window[:, -1, 0]).all()
    assert np.nanmax(np.abs(window)) < 1e-2


def test_of_omitted_frames_the_largest_difference_is_shown(runs, monkeypatch):
    every = frames_of(runs).difference.velocity
    monkeypatch.setattr(compare_page, "MOST_NUMBERS", 2000)
    some = frames_of(runs).difference
    assert some.frame_stride > 1
    assert np.max(np.abs(some.velocity)) == np.max(np.abs(every))


@pytest.mark.slow
def test_pages_of_comparisons_and_validations_replace_earlier_ones_but_no_file_of_the_user(made, tmp_path, capsys):
    copy = shutil.copytree(made / "A", tmp_path / "copy")
    (copy / "against-B.html").write_text("mine")
    assert "against-B.html" in refusal(["view", copy, "--against", made / "B"], capsys)
    assert (copy / "against-B.html").read_text() == "mine"
    (copy / "against-B.html").unlink()
    for _ in range(2):
        assert granchain.view(copy, against=made / "B").path == copy / "against-B.html"
    assert "against-B.html" in json.loads((copy / RECORD).read_text())["files"]
    assert main(["validate", str(copy), "--page", "--against", str(made / "sparse")]) == 0
    assert "against sparse" in (copy / "validation-against.html").read_text()
    assert main(["validate", str(copy), "--page"]) == 0
    assert "B is the reference integrator" in (copy / "validation.html").read_text()
    assert main(["validate", str(copy)]) == 0
    assert not (copy / "validation.html").exists()


def test_a_page_of_a_comparison_says_what_differs_and_has_the_quantities_of_both_runs_with_the_sum_of_uncertainties(
    runs, golden
):
    comparison, _ = compare_runs(runs)
    problem = comparison.problem
    tables = [setting_table(runs, comparison), quantity_table(*runs)]
    rows = [" | ".join(map(str, row)) for table in tables for row in table.rows]
    lines = [*compared_lines(runs, comparison), "", *rows, "", "of the run itself"]
    lines += compared_lines((runs[0], runs[0]), comparison)
    root, _ = compare_page.layout(problem, frames_of(runs), ("A", "B"), 8)
    of_machine = {r"(input files|time of the engine \(s\)|wall time \(s\)) \|.*": r"\1"}
    golden("comparison", "\n".join([*lines, page_table(root)]), of_machine)


def test_numbers_have_two_digits_of_their_uncertainty():
    for value, uncertainty, text in (
        (0.36524, 1e-4, "0.36524 \u00b1 0.00010"),
        (3.0, 1.1, "3.0 \u00b1 1.1"),
        (-3.5e-7, 2e-3, "-3e-07 \u00b1 0.0020"),
        (0.0, 0.5, "0.0 \u00b1 0.50"),
        (1 / 3, 1e-12, "0.3333333"),
        (12.0, np.nan, "12"),
        (np.nan, np.nan, "-"),
    ):
        assert written(value, uncertainty) == text
