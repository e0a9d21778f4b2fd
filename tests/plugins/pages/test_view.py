"""The pages of `granchain view`, in a real browser."""

import sys

import numpy as np
import pytest
from global_state import assert_state_remains
from refusals import refusal

import granchain
from analysis import motion
from workflow.cli import main
from workflow.plugins.pages import function
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


WHERE = """([name, x, y]) => {
  const plot = Bokeh.documents[0].roots()[0], found = [];
  const look = view => { if (view.model.type == 'Figure') found.push(view);
                         for (const child of view.child_views ?? []) look(child); };
  for (const view of Bokeh.index) look(view);
  const view = found.find(one => one.model.title && one.model.title.text == name);
  const box = view.canvas_view.el.getBoundingClientRect();
  return [box.x + view.frame.x_scale.compute(x), box.y + view.frame.y_scale.compute(y)];
}"""
TRACES = """() => {
  const [plot, {data}] = ['velocity', 'traces'].map(name => Bokeh.documents[0].get_model_by_name(name));
  return plot.below.find(part => part.type == 'Legend').items.filter(item => item.visible).map(item => {
    const [line, mark] = item.renderers;
    return {label: item.label.value, values: Array.from(data[line.glyph.y.field]), colour: line.glyph.line_color.value,
            dash: line.glyph.line_dash.value, mark: mark.glyph.marker.value, visible: line.visible};
  });
}"""
ROWS = """() => {
  const table = [...Bokeh.documents[0]._all_models.values()].find(it => it.type == 'DataTable');
  const rows = [...Bokeh.index.find_one_by_id(table.id).shadow_el.querySelectorAll('.slick-row')];
  return rows.filter(row => row.innerText).map(row => [row.getBoundingClientRect().y, row.innerText])
    .sort(([first], [second]) => first - second).map(([_, text]) => text.split('\\n')[0]);
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


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    return granchain.run(SCENE, tmp_path_factory.mktemp("view") / "run", engine="reference")


def by_name(words):
    return dict(zip(*(map(str.strip, words[k::2]) for k in (0, 1)), strict=True))


def model(page, name, what):
    return page.evaluate(f"() => {{ const it = Bokeh.documents[0].get_model_by_name('{name}'); return {what}; }}")


def test_pages_without_bokeh_are_refused_in_one_line(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "bokeh", None)
    assert "pip install" in refusal(["view", tmp_path], capsys)


@pytest.mark.parametrize(
    ("engine", "says"), [("reference", "computed by the reference integrator"), ("lammps", "computed by LAMMPS 2")]
)
def test_a_page_says_which_engine_computed_the_run_and_states_the_verdict_as_it_is(engine, says, tmp_path):
    scene = {**SCENE, "beads": 3, "foundation": {"stiffness": 1.0}, "duration": 5.0}
    text = granchain.run(scene, tmp_path / "run", engine=engine, check=False).view().path.read_text()
    assert says in text
    assert "<p>Equipartition does not apply: no" in text
    assert ("A. P. Thompson" in text) == (engine == "lammps")


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
    assert overlap > 0.0
    assert int(told["bead:"]) == BEAD
    assert float(told["time:"]) == pytest.approx(time, rel=1e-5)
    assert float(told["velocity:"]) == pytest.approx(frames.velocity[FRAME, 1, BEAD - 1], rel=1e-5)
    assert float(told["overlap with the next:"]) == pytest.approx(overlap, rel=1e-4)

    before = {trace["label"] for trace in page.evaluate(TRACES)}
    page.mouse.click(*page.evaluate(WHERE, ["chain 2", BEAD, time]))
    page.wait_for_function(f"() => ({TRACES})().some(one => one.label == 'bead {BEAD}, chain 2')")
    traces = {trace["label"]: trace for trace in page.evaluate(TRACES)}
    assert set(traces) == before | {f"bead {BEAD}, chain {chain}" for chain in (1, 2)}
    drawn = traces[f"bead {BEAD}, chain 2"]["values"]
    assert drawn == pytest.approx(frames.velocity[:, 1, BEAD - 1].tolist(), abs=1e-7)
    looks = {label: (trace["colour"], tuple(trace["dash"])) for label, trace in traces.items()}
    assert len(set(looks.values())) == 2, "a chain keeps its colour and dashes"
    assert {traces[f"bead {BEAD}, chain {chain}"]["mark"] for chain in (1, 2)} == {"diamond"}

    slider = page.get_by_role("slider", name="time")
    slider.focus()
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    page.wait_for_function("() => Math.abs(Bokeh.documents[0].get_model_by_name('time').value - 0.3) < 1e-9")
    assert slider.get_attribute("aria-valuetext") == "0.30"
    places = model(page, "balls", "Array.from(it.data.x)")
    moved = frames.beads + 0.25 * frames.displacement[3]
    assert places == pytest.approx(moved.ravel().tolist(), abs=1e-6)
    assert model(page, "balls", "Array.from(it.data.d)") == pytest.approx(frames.displacement[3].ravel(), abs=1e-7)
    assert model(page, "balls", "it.data.bead[21] + ' ' + it.data.chain[21]") == "2 2"


def test_the_state_of_the_process_is_as_before(ran, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")  # bars of progress have threads
    assert_state_remains(lambda: granchain.view(ran.directory.path), ran.directory.path)


@pytest.mark.slow
def test_the_page_in_a_notebook_is_part_of_it_wherever_it_is_moved_and_a_large_one_is_a_link(
    ran, tmp_path, look, monkeypatch
):
    shown = ran.view()
    cell = shown._repr_html_()
    (tmp_path / "moved.html").write_text(f"<!DOCTYPE html><script>window.Bokeh = null</script>{cell}")
    page = look(tmp_path / "moved.html", waiting="frames[0].Bokeh && frames[0].Bokeh.documents[0]?.is_idle")
    assert page.frame_locator("iframe").get_by_role("heading").first.inner_text() == "seen: 2 x 20 beads"
    assert page.evaluate("frames[0].Bokeh.documents[0].get_model_by_name('traces').data.time.length") == 201
    monkeypatch.setattr(function, "MOST_EMBEDDED", 1000)
    assert shown._repr_html_() == f'<p><a href="{shown.path.resolve().as_uri()}">{shown.path}</a></p>'


@pytest.mark.slow
@pytest.mark.usefixtures("pool_here")
def test_the_page_of_a_sweep_draws_any_column_over_any_other(tmp_path, look):
    what = {"scene": SCENE, "vary": {"coupling.stiffness": [0.01, 0.1, 1.0]}, "engine": "reference"}
    table = granchain.sweep(what, tmp_path / "swept", jobs=1, check=False)
    assert main(["view", str(tmp_path / "swept"), "--no-open", "--quiet"]) == 0
    page = look(tmp_path / "swept" / "view.html")
    assert "References" in page.locator("footer.provenance").inner_text()
    page.evaluate("() => { Bokeh.documents[0].get_model_by_name('column').value = 'steps'; }")
    assert model(page, "cases", "Array.from(it.data.y)") == [row["steps"] for row in table.rows]
    assert model(page, "cases", "Array.from(it.data.x)") == [0.01, 0.1, 1.0]
    assert model(page, "top", "it.children[0].name") == "plot log"
    page.evaluate("() => { Bokeh.documents[0].get_model_by_name('column').value = 'agree_10'; }")
    agree = [row["agree_10"] for row in table.rows]
    assert None in agree
    assert model(page, "cases", "Array.from(it.data.y, y => isNaN(y) ? null : y)") == agree
    assert (
        model(page, "plot log", "it.title.text")
        == f"{agree.count(None)} of 3 cases have no number; hollow: not settled"
    )
    page.evaluate("() => { Bokeh.documents[0].get_model_by_name('column').value = 'amplitude'; }")
    assert model(page, "plot log", "it.title.text").endswith("hollow: not settled; bars: uncertainty")
    page.evaluate("() => { Bokeh.documents[0].get_model_by_name('over').value = 'steps'; }")
    assert model(page, "top", "it.children[0].name") == "plot linear"
    assert model(page, "plot linear", "it.below[0].axis_label") == table.label("steps").plain
    assert model(page, "plot linear", "it.below[0].ticker.min_interval") == 1  # steps are whole numbers
    assert page.locator(".slick-row a").count() == 0  # no case has a page or a figure
    page.evaluate("() => { Bokeh.documents[0].get_model_by_name('column').value = 'amplitude'; }")
    for active, kept in (([2], [False, False, True]), ([0, 1, 2], [True, True, True])):
        page.evaluate(f"() => {{ Bokeh.documents[0].get_model_by_name('only coupling.stiffness').active = {active}; }}")
        assert model(page, "filter", "it.booleans") == kept


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """A sweep over two fields, three values of each, in which one case has a page and some have not settled."""
    directory = tmp_path_factory.mktemp("view") / "swept"
    vary = {"coupling.stiffness": [0.02, 0.1, 1.0], "duration": [20.0, 30.0, 40.0]}
    table = granchain.sweep({"scene": SCENE, "vary": vary, "engine": "reference"}, directory, jobs=1, check=False)
    granchain.view(directory / table.rows[0]["case"])
    granchain.view(directory)
    return directory, table


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_page_of_a_sweep_over_two_fields_is_used_by_keys_alone(swept, look, scheme):
    directory, table = swept
    page = look(directory / "view.html", color_scheme=scheme)

    def choose(label, text):
        page.get_by_label(label, exact=True).focus()
        page.keyboard.type(text)

    choose("as", "map")
    page.wait_for_function("() => Bokeh.documents[0].get_model_by_name('top').children[0].name.startsWith('map')")
    edges = [model(page, "cases", f"Array.from(it.data.{side})") for side in ("left", "right", "bottom", "top")]
    fields = [table.numbers(name) for name in table.fields]
    for low, high, values in (*zip(edges[::2], edges[1::2], fields, strict=True),):
        assert np.all((np.array(low) < values) & (values < np.array(high)))
    unsettled = table.unsettled("amplitude") & np.isfinite(table.numbers("amplitude"))
    assert model(page, "cases", "Array.from(it.data.open, Boolean)") == unsettled.tolist()

    first, second = (row["case"] for row in table.rows[:2])
    page.get_by_label("case", exact=True).focus()
    for case in (first, second):
        page.keyboard.press("ArrowDown")
        page.wait_for_function(f"() => Bokeh.documents[0].get_model_by_name('named').text.includes('{case}')")
        link = f'<a href="{case}/view.html">' in model(page, "named", "it.text")
        assert link == (case == first)
    assert f"granchain view swept/{second}" in model(page, "named", "it.text")
    assert model(page, "cases", "it.selected.indices") == [1]

    head = page.locator(".slick-header-column", has_text="duration").first
    head.focus()
    for order in (["20"] * 3 + ["30"] * 3 + ["40"] * 3, ["40"] * 3 + ["30"] * 3 + ["20"] * 3):
        page.keyboard.press("Enter")
        page.wait_for_function(
            f"() => ({ROWS})().map(text => text.split('duration=')[1]).join() == '{','.join(order)}'"
        )
    for width in (1280, 600):
        page.set_viewport_size({"width": width, "height": 900})
        page.wait_for_function(f"() => document.documentElement.scrollWidth <= {width}")
