"""What a person does on the page of a run and on that of a sweep, in a real browser."""

import csv
from pathlib import Path

import numpy as np
import pytest

import granchain
from analysis import motion

pytestmark = pytest.mark.slow

SCENE = {"name": "seen", "chains": 2, "beads": 20, "coupling": {"stiffness": 0.1}, "kick": {"velocity": 1.0}}
SCENE |= {"duration": 20.0}
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


def model(page, name, what):
    return page.evaluate(f"() => {{ const it = Bokeh.documents[0].get_model_by_name('{name}'); return {what}; }}")


def choose(page, label, word):
    """Choose a word of a list by the keyboard alone."""
    select = page.get_by_label(label, exact=False)
    select.focus()
    options = select.locator("option").all_inner_texts()
    steps = options.index(word) - select.evaluate("one => one.selectedIndex")
    for _ in range(abs(steps)):
        page.keyboard.press("ArrowDown" if steps > 0 else "ArrowUp")


def saved(page, plot):
    """Name and lines of a file of the numbers of a plot, which is saved by the keyboard."""
    page.get_by_title("Data as CSV").nth(plot).focus()
    with page.expect_download() as download:
        page.keyboard.press("Enter")
    text = Path(download.value.path()).read_text()
    return download.value.suggested_filename, list(csv.DictReader(text.splitlines()))


def test_a_person_reads_chooses_moves_saves_and_links_the_numbers_of_a_run(tmp_path, open_page):
    ran = granchain.run(SCENE, tmp_path / "run", engine="reference")
    frames, system = ran.trajectory, ran.directory.problem.system
    path, time = ran.view().path, float(frames.time[FRAME])
    page = open_page(path)
    overlap = motion.overlaps(system, frames.displacement)[FRAME]

    # the cursor on a map
    page.mouse.move(*page.evaluate(WHERE, ["chain 2", BEAD, time]))
    page.wait_for_function(f"() => ({TEXT})().length > 0")
    words = [word.strip() for word in page.evaluate(TEXT)]
    told = dict(zip(words[::2], words[1::2], strict=True))
    assert int(told["bead:"]) == BEAD
    assert float(told["time:"]) == pytest.approx(time, rel=1e-5)
    assert float(told["velocity:"]) == pytest.approx(frames.velocity[FRAME, 1, BEAD - 1], rel=1e-5)
    assert float(told["overlap with the next:"]) == pytest.approx(overlap[1, BEAD - 1], rel=1e-4)

    # a click adds a bead
    page.mouse.click(*page.evaluate(WHERE, ["chain 2", BEAD, time]))
    page.wait_for_function(f"() => ({TRACES})().some(one => one.label == 'bead {BEAD}, chain 2')")
    traces = {trace["label"]: trace for trace in page.evaluate(TRACES)}
    drawn = traces[f"bead {BEAD}, chain 2"]["values"]
    assert drawn == pytest.approx(frames.velocity[:, 1, BEAD - 1].tolist(), abs=1e-7)
    looks = {(trace["colour"], tuple(trace["dash"])) for trace in traces.values()}
    assert len(looks) == 2, "a chain keeps its colour and dashes"

    # keys move the time, and the beads with it
    slider = page.get_by_role("slider", name="time")
    slider.focus()
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    page.wait_for_function("() => Math.abs(Bokeh.documents[0].get_model_by_name('time').value - 0.3) < 1e-9")
    assert slider.get_attribute("aria-valuetext") == "0.30"
    moved = frames.beads + 0.25 * frames.displacement[3]
    assert model(page, "balls", "Array.from(it.data.x)") == pytest.approx(moved.ravel().tolist(), abs=1e-6)
    page.get_by_role("button", name="play / pause", exact=True).press("Enter")
    page.wait_for_function("() => Bokeh.documents[0].get_model_by_name('time').value > 0.5")
    page.get_by_role("button", name="play / pause", exact=True).press("Enter")

    # numbers at a time, of a bead and a chain
    choose(page, "of chain", "2")
    page.evaluate(f"() => {{ Bokeh.documents[0].get_model_by_name('time').value = {time}; }}")
    page.wait_for_function("() => Bokeh.documents[0].get_model_by_name('readout').text.includes('t = 10<')")
    row = page.get_by_role("region", name="numbers at the chosen time and bead").locator("tr").nth(1)
    assert row.locator("th").inner_text() == f"bead {BEAD} of chain 2"
    x, v, place = frames.displacement[FRAME], frames.velocity[FRAME], (1, BEAD - 1)
    parts = (v, x, np.maximum(overlap, 0.0), motion.contact_force(system, overlap), motion.bead_energy(system, x, v))
    numbers = [float(cell) for cell in row.locator("td").all_inner_texts()]
    assert numbers == pytest.approx([part[place] for part in parts], rel=1e-5, abs=1e-9)

    # files of the numbers of a map and of curves
    choose(page, "quantity on the maps", "displacement")
    name, rows = saved(page, 0)
    assert name == "seen-map-displacement.csv"
    assert list(rows[0]) == ["time t (reduced)", "chain", "bead", "displacement x (reduced)"]
    assert len(rows) == frames.displacement.size
    line = rows[(frames.frames + FRAME) * 20 + BEAD - 1]
    assert (line["chain"], line["bead"]) == ("2", str(BEAD))
    assert float(line["displacement x (reduced)"]) == pytest.approx(x[place], rel=1e-6)
    name, rows = saved(page, 2)
    assert name == "seen-velocity.csv"
    velocities = [float(row["velocity v (reduced)"]) for row in rows if row["curve"] == "bead 4, chain 1"]
    assert velocities == pytest.approx(frames.velocity[:, 0, 3].tolist(), abs=1e-7)

    # a link to this place
    page.get_by_role("button", name="copy link", exact=True).press("Enter")
    page.wait_for_function("location.hash == '#t=10&bead=8&chain=2'")
    other, states = open_page(path, "#t=12.5&bead=9&chain=1", width=600), []
    assert [model(other, name, "it.value") for name in ("time", "bead", "chain")] == [pytest.approx(12.5), "9", "1"]
    other.wait_for_function("() => document.documentElement.scrollWidth <= 600")
    for fragment in ("", "#t=1e9&bead=400&chain=7"):  # what is invalid is ignored
        opened = open_page(path, fragment)
        states.append([model(opened, name, "it.value") for name in ("time", "bead", "chain")])
    assert states[0] == states[1]


@pytest.mark.usefixtures("pool_here")
def test_a_person_draws_a_sweep_over_two_fields_by_keys_alone(tmp_path, open_page):
    vary = {"coupling.stiffness": [0.02, 0.1, 1.0], "duration": [20.0, 30.0]}
    directory = tmp_path / "swept"
    table = granchain.sweep({"scene": SCENE, "vary": vary, "engine": "reference"}, directory, jobs=1, check=False)
    granchain.view(directory / table.rows[0]["case"])
    granchain.view(directory)
    page = open_page(directory / "view.html")

    # columns over a field, with what has no number or has not settled
    for column in ("steps", "agree_10", "amplitude"):
        page.evaluate(f"() => {{ Bokeh.documents[0].get_model_by_name('column').value = '{column}'; }}")
        values = model(page, "cases", "Array.from(it.data.y, y => isNaN(y) ? null : y)")
        assert values == [row[column] for row in table.rows]
    assert model(page, "cases", "Array.from(it.data.x)") == [row["coupling.stiffness"] for row in table.rows]
    assert model(page, "plot log", "it.title.text").endswith("hollow: not settled; bars: uncertainty")
    unsettled = table.unsettled("amplitude") & np.isfinite(table.numbers("amplitude"))
    assert model(page, "cases", "Array.from(it.data.open, Boolean)") == unsettled.tolist()
    page.evaluate("() => { Bokeh.documents[0].get_model_by_name('only coupling.stiffness').active = [2]; }")
    assert model(page, "filter", "it.booleans") == [False] * 4 + [True] * 2
    page.evaluate("() => { Bokeh.documents[0].get_model_by_name('only coupling.stiffness').active = [0, 1, 2]; }")

    # a map of both fields
    page.get_by_label("as", exact=True).focus()
    page.keyboard.type("map")
    page.wait_for_function("() => Bokeh.documents[0].get_model_by_name('top').children[0].name.startsWith('map')")
    edges = [model(page, "cases", f"Array.from(it.data.{side})") for side in ("left", "right", "bottom", "top")]
    for low, high, name in zip(edges[::2], edges[1::2], table.fields, strict=True):
        assert np.all((np.array(low) < table.numbers(name)) & (table.numbers(name) < np.array(high)))

    # a case, and the link to its page where it has one
    first, second = (row["case"] for row in table.rows[:2])
    page.get_by_label("case", exact=True).focus()
    for case in (first, second):
        page.keyboard.press("ArrowDown")
        page.wait_for_function(f"() => Bokeh.documents[0].get_model_by_name('named').text.includes('{case}')")
        link = f'<a href="{case}/view.html">' in model(page, "named", "it.text")
        assert link == (case == first)
    assert f"granchain view swept/{second}" in model(page, "named", "it.text")
    assert model(page, "cases", "it.selected.indices") == [1]

    # the table in the order of a column
    page.locator(".slick-header-column", has_text="duration").first.focus()
    for order in (["20"] * 3 + ["30"] * 3, ["30"] * 3 + ["20"] * 3):
        page.keyboard.press("Enter")
        page.wait_for_function(
            f"() => ({ROWS})().map(text => text.split('duration=')[1]).join() == '{','.join(order)}'"
        )
