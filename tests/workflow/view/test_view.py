"""The pages of `granchain view`, in a real browser."""

import os
import shutil
import sys

import numpy as np
import pytest
from refusals import refusal

from analysis import motion
from workflow import api
from workflow.cli import main
from workflow.runs.run_directory import RunDirectory

SCENE = {
    "name": "seen",
    "chains": 2,
    "beads": 20,
    "coupling": {"stiffness": 0.1},
    "kick": {"velocity": 1.0},
    "duration": 20.0,
}
BEAD, FRAME = 8, 100

FEW = {
    "name": "few",
    "chains": 12,
    "beads": 30,
    "material": {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3},
    "coupling": {"stiffness": 1e5},
    "kick": {"velocity": 0.01},
    "duration": 0.002,
    "output": {"beads": [3, 10, 28]},
}

WHERE = """([name, x, y]) => {
  const plot = Bokeh.documents[0].roots()[0], found = [];
  const look = view => { if (view.model.type == 'Figure') found.push(view);
                         for (const child of view.child_views ?? []) look(child); };
  for (const view of Bokeh.index) look(view);
  const view = found.find(one => one.model.title && one.model.title.text == name);
  const box = view.canvas_view.el.getBoundingClientRect();
  return [box.x + view.frame.x_scale.compute(x), box.y + view.frame.y_scale.compute(y)];
}"""
TEXT = """() => {
  const words = [];
  const walk = node => { for (const child of node.querySelectorAll('*')) if (child.shadowRoot) {
    for (const tip of child.shadowRoot.querySelectorAll('.bk-tooltip-row-label, .bk-tooltip-row-value'))
      words.push(tip.textContent);
    walk(child.shadowRoot); } };
  walk(document);
  return words;
}"""
LABELS = """() => {
  const plot = Bokeh.documents[0].get_model_by_name('plot log');
  const axis = Bokeh.index.find_one_by_id(plot.below[0].id), ticks = axis.tick_coords.major[0];
  return axis.compute_labels(Array.from(ticks)).items.map(one => one.text);
}"""


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    return api.run(SCENE, tmp_path_factory.mktemp("view") / "run", engine="reference")


@pytest.fixture(scope="module")
def browser():
    path = shutil.which("chromium")
    if path is None:
        assert not os.environ.get("CI"), "continuous integration installs chromium"
        pytest.skip("chromium is not installed")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        started = driver.chromium.launch(executable_path=path, args=["--no-sandbox", "--disable-gpu"])
        yield started
        started.close()


@pytest.fixture
def look(browser):
    """Opens a page without a network; fails at its end if the page complained."""
    complaints = []

    def opened(path, **options):
        page = browser.new_context(offline=True, viewport={"width": 1300, "height": 1700}, **options).new_page()
        page.set_default_timeout(120_000)
        page.on("console", lambda said: complaints.append(said.text) if said.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(path.resolve().as_uri())
        page.wait_for_function("window.Bokeh && Bokeh.documents.length && Bokeh.documents[0].is_idle")
        return page

    yield opened
    assert complaints == []


def by_name(words):
    return dict(zip(*(map(str.strip, words[k::2]) for k in (0, 1)), strict=True))


def model(page, name, what):
    return page.evaluate(f"() => {{ const it = Bokeh.documents[0].get_model_by_name('{name}'); return {what}; }}")


def test_pages_without_bokeh_are_refused_in_one_line(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "bokeh", None)
    assert "pip install" in refusal(["view", tmp_path], capsys)


@pytest.mark.slow
def test_the_page_of_a_run_says_the_right_numbers_and_moves_the_right_beads(ran, look):
    path = ran.directory.path
    shown = ran.view()
    assert shown.path == path / "view.html"
    assert "<iframe" in shown._repr_html_()
    page, frames = look(path / "view.html"), RunDirectory(path).trajectory
    assert "view.html" in ran.directory.job.files
    assert "Starosvetsky" in page.locator("footer.provenance").inner_text()

    time = float(frames.time[FRAME])
    page.mouse.move(*page.evaluate(WHERE, ["chain 2", BEAD, time]))
    page.wait_for_function(f"() => ({TEXT})().length > 0")
    words = page.evaluate(TEXT)
    told = by_name(words)
    overlap = motion.overlaps(ran.directory.problem.system, frames.displacement)[FRAME, 1, BEAD - 1]
    assert int(told["bead:"]) == BEAD
    assert float(told["time:"]) == pytest.approx(time, rel=1e-5)
    assert float(told["velocity:"]) == pytest.approx(frames.velocity[FRAME, 1, BEAD - 1], rel=1e-5)
    assert float(told["overlap with the next:"]) == pytest.approx(overlap, rel=1e-4)

    before = model(page, "traces", "it.data.label.length")
    page.mouse.click(*page.evaluate(WHERE, ["chain 2", BEAD, time]))
    page.wait_for_function(
        f"() => Bokeh.documents[0].get_model_by_name('traces').data.label.includes('bead {BEAD}, chain 2')"
    )
    assert model(page, "traces", "it.data.label.length") == before + 2
    drawn = model(page, "traces", f"Array.from(it.data.ys[it.data.label.indexOf('bead {BEAD}, chain 2')])")
    assert drawn == pytest.approx(frames.velocity[:, 1, BEAD - 1].tolist(), abs=1e-7)

    dashes, colours = (model(page, "traces", f"Array.from(it.data.{name})") for name in ("dash", "colour"))
    assert len(set(zip(dashes, colours, strict=True))) == len(dashes)
    assert colours == colours[:2] * (len(dashes) // 2), "a chain keeps its colour"

    page.locator(".noUi-handle").first.focus()
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    page.wait_for_function("() => Bokeh.documents[0].get_model_by_name('time').value == 3")
    places = model(page, "balls", "Array.from(it.data.x)")
    moved = frames.beads + 0.25 * frames.displacement[3]
    assert places == pytest.approx(moved.ravel().tolist(), abs=1e-6)
    assert model(page, "balls", "Array.from(it.data.d)") == pytest.approx(frames.displacement[3].ravel(), abs=1e-7)
    assert model(page, "balls", "it.data.bead[21] + ' ' + it.data.chain[21]") == "2 2"
    system = ran.directory.problem.system
    force = motion.contact_force(system, motion.overlaps(system, frames.displacement))
    chain, contact = np.nonzero(force[3] > 0.0)
    bars = {name: model(page, "pushes", f"Array.from(it.data.{name})") for name in ("x", "y", "h")}
    assert bars["x"] == (contact + 1.5).tolist()  # between bead n and the next
    assert bars["h"] == pytest.approx(0.45 * force[3, chain, contact] / force.max(), rel=1e-4, abs=1e-6)
    assert bars["y"] == pytest.approx(0.3 - chain + 0.5 * np.array(bars["h"]))


@pytest.mark.slow
def test_the_page_of_many_chains_and_few_beads_answers_clicks_and_keys(tmp_path, look):
    ran = api.run(FEW, tmp_path / "run", engine="reference", check=False)
    frames, chains = ran.trajectory, (1, 2, 3, 4, 5, 6, 7, 9, 12)
    page = look(ran.view().path)
    top, late = "chain 12", 0.5e3 * float(frames.measured().time[-1])

    # a cursor says which bead, and units
    page.mouse.move(*page.evaluate(WHERE, [top, 2.3, late]))
    page.wait_for_function(f"() => ({TEXT})().length > 0")
    told = by_name(page.evaluate(TEXT))
    assert told["bead:"] == "28"
    assert float(told["time:"].removesuffix(" ms")) == pytest.approx(late, rel=0.01)
    assert told["velocity:"].endswith("m/s")

    # clicks add beads; chains keep their colours
    first = [f"bead 3, chain {chain}" for chain in chains]
    labels = model(page, "traces", "Array.from(it.data.label)")
    assert labels == first
    colours = model(page, "traces", "Array.from(it.data.colour)")
    assert len(set(colours)) == len(chains)
    page.mouse.click(*page.evaluate(WHERE, [top, 1, late]))
    page.wait_for_function(
        "() => Bokeh.documents[0].get_model_by_name('traces').data.label.includes('bead 10, chain 1')"
    )
    assert model(page, "traces", "Array.from(it.data.label)") == [f"bead 10, chain {chain}" for chain in chains]
    assert model(page, "traces", "Array.from(it.data.colour)") == colours

    # all beads are in sight; keys start and stop them
    assert model(page, "balls", "new Set(it.data.bead).size") == 3
    page.get_by_role("button", name="play").focus()
    value = "Bokeh.documents[0].get_model_by_name('time').value"
    page.keyboard.press("Enter")
    page.wait_for_function(f"() => {value} > 2")
    assert page.get_by_role("button", name="pause").count() == 1
    page.keyboard.press("Enter")
    assert model(page, "play", "it.active") is False
    still = f"const before = {value}; await new Promise(done => setTimeout(done, 200)); return {value} == before;"
    assert page.evaluate(f"async () => {{ {still} }}")

    # a narrow window has all of it
    page.set_viewport_size({"width": 800, "height": 1700})
    page.wait_for_function("() => document.documentElement.scrollWidth <= 800")


@pytest.mark.slow
def test_the_page_of_a_run_is_readable_in_dark_mode(ran, tmp_path, look):
    shutil.copytree(ran.directory.path, tmp_path / "run")
    assert main(["view", str(tmp_path / "run"), "--no-open"]) == 0
    page = look(tmp_path / "run" / "view.html", color_scheme="dark")
    page.wait_for_function(
        "() => [...Bokeh.documents[0]._all_models.values()].filter(one => one.type == 'Figure')"
        ".every(one => one.background_fill_color == '#1b1d21')"
    )
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(27, 29, 33)"


@pytest.mark.slow
@pytest.mark.usefixtures("pool_here")
def test_the_page_of_a_sweep_draws_any_column_over_any_other(tmp_path, look):
    what = {"scene": SCENE, "vary": {"coupling.stiffness": [0.01, 0.1, 1.0]}, "engine": "reference"}
    table = api.sweep(what, tmp_path / "swept", jobs=1, check=False)
    assert main(["view", str(tmp_path / "swept"), "--no-open", "--quiet"]) == 0
    page = look(tmp_path / "swept" / "view.html")
    assert "References" in page.locator("footer.provenance").inner_text()
    page.evaluate("() => { Bokeh.documents[0].get_model_by_name('column').value = 'steps'; }")
    assert model(page, "cases", "Array.from(it.data.y)") == [row["steps"] for row in table.rows]
    assert model(page, "cases", "Array.from(it.data.x)") == [0.01, 0.1, 1.0]
    assert model(page, "top", "it.children[0].name") == "plot log"
    page.wait_for_function(f"({LABELS})()[0] == '0.01'")  # after the layout of the plot
    assert page.evaluate(LABELS) == ["0.01", "0.02", "0.05", "0.1", "0.2", "0.5", "1"]
    page.evaluate("() => { Bokeh.documents[0].get_model_by_name('column').value = 'agree_10'; }")
    agree = [row["agree_10"] for row in table.rows]
    assert None in agree
    assert model(page, "cases", "Array.from(it.data.y, y => isNaN(y) ? null : y)") == agree
    assert model(page, "plot log", "it.title.text") == f"{agree.count(None)} of 3 cases have no number here"
    page.evaluate("() => { Bokeh.documents[0].get_model_by_name('over').value = 'steps'; }")
    assert model(page, "top", "it.children[0].name") == "plot linear"
    assert model(page, "plot linear", "it.below[0].axis_label") == table.heading("steps")
    assert page.locator("a").first.get_attribute("href") == f"{table.rows[0]['case']}/"
    page.evaluate("() => { Bokeh.documents[0].get_model_by_name('column').value = 'amplitude'; }")
    for value, kept in (("1", [False, False, True]), ("all", [True, True, True])):
        page.evaluate(f"() => {{ Bokeh.documents[0].get_model_by_name('only coupling.stiffness').value = '{value}'; }}")
        assert model(page, "filter", "it.booleans") == kept
