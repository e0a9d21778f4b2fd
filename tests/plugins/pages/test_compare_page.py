"""Pages that compare two runs: `granchain view A --against B`, and `granchain validate --page`."""

import json
import shutil

import numpy as np
import pytest
from refusals import refusal

import granchain
from analysis.figures.panels import shown_chains
from workflow.cli import main
from workflow.plugins.pages import compare_page
from workflow.plugins.pages.compared import compared_lines, quantity_table, setting_table, written
from workflow.runs.files import RECORD
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.validate_run import compare_runs, compared_pairs

SCENE = {
    "name": "pair",
    "chains": 2,
    "beads": 40,
    "coupling": {"stiffness": 0.1},
    "kick": {"velocity": 1.0},
    "duration": 40.0,
}


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
    return directory


@pytest.fixture
def runs(made):
    return RunDirectory(made / "A"), RunDirectory(made / "B")


def frames_of(runs):
    comparison, _ = compare_runs(runs)
    problem = comparison.problem
    return compare_page.compared_frames(problem, compared_pairs(runs, comparison), shown_chains(problem))


def test_the_map_is_the_velocity_of_one_run_minus_that_of_the_other_at_each_bead_and_frame(runs):
    frames = frames_of(runs)
    velocities = [run.trajectory.velocity.transpose(1, 0, 2) for run in runs]
    np.testing.assert_array_equal(frames.first.velocity, velocities[0])
    np.testing.assert_array_equal(frames.second.velocity, velocities[1])
    np.testing.assert_array_equal(frames.difference.velocity, velocities[0] - velocities[1])
    assert frames.difference.chains == [1, 2]


def test_frames_at_other_times_are_compared_where_both_have_one(made):
    runs = RunDirectory(made / "A"), RunDirectory(made / "sparse")
    frames = frames_of(runs)
    assert frames.first.time.tolist() == runs[1].trajectory.time.tolist()
    assert np.max(np.abs(frames.difference.velocity)) < 1e-9


def test_of_omitted_frames_the_largest_difference_is_shown(runs, monkeypatch):
    every = frames_of(runs).difference.velocity
    monkeypatch.setattr(compare_page, "MOST_NUMBERS", 2000)
    some = frames_of(runs).difference
    assert some.frame_stride > 1
    assert np.max(np.abs(some.velocity)) == np.max(np.abs(every))


def test_the_table_has_the_quantities_of_both_runs_and_the_sum_of_uncertainties_at_the_difference(runs):
    table = quantity_table(*runs)
    rows = {name: cells for name, *cells in table.rows}
    reports = [json.loads((run.path / "analysis.json").read_text()) for run in runs]
    shares = [report["equipartition"]["energy_share"] for report in reports]
    share, error = (np.array([entry[key] for entry in shares]) for key in ("measured", "measured_error"))
    name = next(name for name in rows if name.startswith("share of the energy"))
    assert rows[name] == [
        *(f"{written(*pair)} (not settled)" for pair in zip(share, error, strict=True)),
        written(share[0] - share[1], error.sum(), digits=4),
    ]
    peaks = [report["waves"][0]["peak_velocity"] for report in reports]
    name = next(name for name in rows if name.startswith("peak velocity at"))
    assert [float(cell) for cell in rows[name]] == pytest.approx([*peaks, peaks[0] - peaks[1]], rel=1e-3)


@pytest.mark.parametrize(
    ("value", "uncertainty", "text"),
    [
        (0.36524, 1e-4, "0.36524 \u00b1 0.00010"),
        (3.0, 1.1, "3.0 \u00b1 1.1"),
        (-3.5e-7, 2e-3, "-3e-07 \u00b1 0.0020"),
        (0.0, 0.5, "0.0 \u00b1 0.50"),
        (1 / 3, 1e-12, "0.3333333"),
        (12.0, np.nan, "12"),
        (np.nan, np.nan, "-"),
    ],
)
def test_numbers_have_two_digits_of_their_uncertainty(value, uncertainty, text):
    assert written(value, uncertainty) == text


def test_the_page_of_other_physics_names_the_field_that_differs_and_no_verdict(runs):
    comparison, _ = compare_runs(runs)
    assert ["coupling.stiffness", "0.1", "0.12"] in setting_table(runs, comparison).rows
    lines = compared_lines(runs, comparison)
    assert not any("passed" in line for line in lines)
    assert any("passed" in line for line in compared_lines((runs[0], runs[0]), comparison))


def test_peaks_of_a_run_of_other_physics_are_those_of_its_own_scene(runs):
    comparison, _ = compare_runs(runs)
    first, second = (run.path for run in runs)
    waves = [granchain.analyze(path).survey.waves for path in (first, second)]
    both = [wave.of_chain(1) for wave in waves]
    beads = np.intersect1d(both[0].bead[1:], both[1].bead[1:])
    arrivals = [wave.arrival[np.isin(wave.bead, beads)] for wave in both]
    largest = comparison.deviations["arrival"].largest
    assert largest == pytest.approx(np.max(np.abs(arrivals[0] - arrivals[1])), rel=0.3)


def test_a_page_of_a_comparison_is_listed_and_replaces_no_file_of_the_user(made, tmp_path, capsys):
    copy = shutil.copytree(made / "A", tmp_path / "copy")
    (copy / "against-B.html").write_text("mine")
    assert "against-B.html" in refusal(["view", copy, "--against", made / "B"], capsys)
    assert (copy / "against-B.html").read_text() == "mine"
    (copy / "against-B.html").unlink()
    page = granchain.view(copy, against=made / "B")
    assert page.path == copy / "against-B.html"
    assert "against-B.html" in json.loads((copy / RECORD).read_text())["files"]
    granchain.view(copy, against=made / "B")


def test_a_validation_writes_its_page_on_request_and_removes_that_of_an_earlier_one(made, tmp_path, capsys):
    copy = shutil.copytree(made / "A", tmp_path / "copy")
    (tmp_path / "mine.csv").write_text("time,chain,bead,velocity\n0,1,1,1\n")
    assert "--page" in refusal(["validate", copy, "--page", "--against", tmp_path / "mine.csv"], capsys)
    for more in ([], ["--against", str(made / "sparse")]):
        assert main(["validate", str(copy), "--page", *more]) == 0
        page = "validation-against.html" if more else "validation.html"
        assert page in capsys.readouterr().out
        text = (copy / page).read_text()
        assert "against sparse" in text if more else "B is the reference integrator" in text
    assert main(["validate", str(copy)]) == 0
    assert not (copy / "validation.html").exists()
    assert (copy / "validation-against.html").exists()


def test_runs_of_chains_whose_beads_and_contacts_are_not_all_alike_are_compared(tmp_path):
    scene = {**SCENE, "beads": 12, "duration": 4.0, "walls": {"right": "rigid"}}
    runs = [granchain.run(scene, tmp_path / name, engine="reference").directory for name in ("A", "B")]
    frames = frames_of(runs)
    assert frames.difference.velocity.shape[::2] == (2, 12)
    assert not frames.difference.velocity.any()


@pytest.mark.usefixtures("lammps_here")
def test_rows_that_a_window_has_left_have_no_difference(made, tmp_path):
    scene = {**SCENE, "beads": 100, "duration": 100.0, "window": 64}
    window = granchain.run(scene, tmp_path / "run", check=False).directory
    page = granchain.view(window, against=made / "window")
    assert "the window has left" in page.path.read_text()
    frames = frames_of((window, RunDirectory(made / "window")))
    assert np.isnan(frames.difference.velocity[:, -1, 0]).all()
    assert np.nanmax(np.abs(frames.difference.velocity)) < 1e-2


# --- in a browser -----------------------------------------------------------------------------------------------------

DRAWN = """() => {
  const {data} = Bokeh.documents[0].get_model_by_name('traces');
  return ['first', 'second', 'difference'].map(name => Array.from(data[name]));
}"""
TITLES = """() => ['velocities', 'velocity-difference'].map(
  name => Bokeh.documents[0].get_model_by_name(name).title.text)"""
MARKS = """() => [...Bokeh.documents[0]._all_models.values()].filter(it => it.type == 'Span' && it.visible)
  .map(it => it.location)"""
CLICK = """([name, x, y]) => {
  const found = [];
  const look = view => { if (view.model.type == 'Figure') found.push(view);
                         for (const child of view.child_views ?? []) look(child); };
  for (const view of Bokeh.index) look(view);
  const view = found.find(it => it.model.title && it.model.title.text == name);
  const box = view.canvas_view.el.getBoundingClientRect();
  return [box.x + view.frame.x_scale.compute(x), box.y + view.frame.y_scale.compute(y)];
}"""


@pytest.mark.slow
def test_a_bead_and_a_chain_are_chosen_by_keys_and_by_clicks(runs, look):
    page = look(granchain.view(*runs).path)
    velocity = [run.trajectory.velocity for run in runs]

    def drawn(bead, chain):
        first, second = (values[:, chain - 1, bead - 1] for values in velocity)
        shown = page.evaluate(DRAWN)
        assert shown[0] == pytest.approx(first.tolist(), abs=1e-7)
        assert shown[1] == pytest.approx(second.tolist(), abs=1e-7)
        assert shown[2] == pytest.approx((first - second).tolist(), abs=1e-7)
        words = f"bead {bead}, chain {chain}"
        assert page.evaluate(TITLES) == [f"velocity: {words}", f"velocity, A minus B: {words}"]
        assert page.evaluate(MARKS) == [bead]

    drawn(8, 1)
    page.get_by_label("bead (or click a map)").focus()
    page.keyboard.press("ArrowDown")
    page.get_by_label("chain", exact=True).focus()
    page.keyboard.press("End")
    page.wait_for_function(f"() => ({TITLES})()[0] == 'velocity: bead 9, chain 2'")
    drawn(9, 2)
    page.mouse.click(*page.evaluate(CLICK, ["chain 1", 14, 15.0]))
    page.wait_for_function(f"() => ({TITLES})()[0] == 'velocity: bead 14, chain 1'")
    drawn(14, 1)


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_page_of_a_comparison_fits_narrow_and_wide_screens(runs, look, scheme):
    page = look(granchain.view(*runs).path, color_scheme=scheme)
    for width in (1280, 600):
        page.set_viewport_size({"width": width, "height": 900})
        page.wait_for_function(f"() => document.documentElement.scrollWidth <= {width}")
