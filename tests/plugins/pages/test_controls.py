"""Controls of the page of a run, by the keyboard, in a real browser: one page for all of them."""

import csv
import math
import struct
from pathlib import Path

import pytest

import granchain
from analysis import motion

pytestmark = pytest.mark.slow

SCENE = {
    "name": "seen",
    "chains": 2,
    "beads": 20,
    "coupling": {"stiffness": 1.0},
    "kick": {"velocity": 1.0},
    "duration": 20.0,
}
BEAD, FRAME = 8, 100

BARS = """() => [...Bokeh.documents[0]._all_models.values()].filter(model => model.type == 'ColorBar')
  .map(bar => [bar.title, bar.ticker.ticks])"""


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    made = granchain.run(SCENE, tmp_path_factory.mktemp("controls") / "run", engine="reference")
    made.view()
    return made


@pytest.fixture(scope="module")
def page(ran, open_page):
    return open_page(ran.directory.path / "view.html", width=1280)


def value(page, name):
    return page.evaluate(f"Bokeh.documents[0].get_model_by_name('{name}').value")


def choose(page, label, word):
    """Choose a word of a list by the keyboard alone."""
    select = page.get_by_label(label, exact=False)
    select.focus()
    options = select.locator("option").all_inner_texts()
    steps = options.index(word) - select.evaluate("one => one.selectedIndex")
    for _ in range(abs(steps)):
        page.keyboard.press("ArrowDown" if steps > 0 else "ArrowUp")


def choose_bead(page, bead):
    """Choose a bead by its digits, past no other bead."""
    select = page.get_by_label("add a bead", exact=False)
    select.focus()
    select.press_sequentially(str(bead))


def press(page, name, key="Enter"):
    page.get_by_role("button", name=name, exact=True).focus()
    page.keyboard.press(key)


def saved(page, plot, title):
    """File saved by a tool of a plot, which is reached by the keyboard."""
    button = page.get_by_title(title).nth(plot)
    button.focus()
    with page.expect_download() as download:
        page.keyboard.press("Enter")
    return download.value.suggested_filename, Path(download.value.path())


def test_the_quantity_of_the_maps_is_chosen_by_keys_and_the_bar_and_the_name_of_pictures_follow(page):
    choose(page, "quantity on the maps", "contact force")
    page.wait_for_function(f"({BARS})()[0][0] == 'contact force F (reduced)'")
    image = "[...Bokeh.documents[0]._all_models.values()].find(model => model.type == 'Image').image.field"
    assert page.evaluate(image) == "force"
    assert saved(page, 0, "Save")[0] == "seen-map-force.png"
    choose(page, "quantity on the maps", "velocity")
    page.wait_for_function(f"({BARS})()[0][0] == 'velocity v (reduced)'")


def test_play_is_as_fast_as_is_chosen_ends_where_the_run_does_and_begins_again(page):
    reached = {}
    for speed in ("4 x", "0.25 x"):
        choose(page, "speed", speed)
        page.evaluate("() => { Bokeh.documents[0].get_model_by_name('time').value = 0.0; }")
        press(page, "play / pause")
        page.wait_for_timeout(1000)
        press(page, "play / pause")
        reached[speed] = value(page, "time")
    assert 0.0 < 5.0 * reached["0.25 x"] < reached["4 x"] < 20.0
    choose(page, "speed", "1 x")
    page.evaluate("() => { const it = Bokeh.documents[0].get_model_by_name('time'); it.value = it.end - it.step; }")
    press(page, "play / pause")
    page.wait_for_function("() => Bokeh.documents[0].get_model_by_name('time').value == 0")
    page.wait_for_function("() => Bokeh.documents[0].get_model_by_name('time').value > 0")
    press(page, "play / pause")


def test_a_bead_and_a_chain_are_chosen_by_keys_and_their_numbers_are_those_of_the_run(page, ran):
    choose(page, "of chain", "2")
    choose_bead(page, BEAD)
    frames = ran.trajectory
    time = float(frames.time[FRAME])
    page.evaluate(f"() => {{ Bokeh.documents[0].get_model_by_name('time').value = {time}; }}")
    page.wait_for_function("() => Bokeh.documents[0].get_model_by_name('readout').text.includes('t = 10<')")
    rows = page.get_by_role("region", name="numbers at the chosen time and bead").locator("tr")
    assert rows.nth(1).locator("th").inner_text() == f"bead {BEAD} of chain 2"
    assert rows.count() == 2
    numbers = [float(cell) for cell in rows.nth(1).locator("td").all_inner_texts()]
    system, x, v = ran.directory.problem.system, frames.displacement[FRAME], frames.velocity[FRAME]
    overlap = motion.overlaps(system, x)
    expected = [
        v[1, BEAD - 1],
        x[1, BEAD - 1],
        max(overlap[1, BEAD - 1], 0.0),
        motion.contact_force(system, overlap)[1, BEAD - 1],
        motion.bead_energy(system, x, v)[1, BEAD - 1],
    ]
    assert numbers == pytest.approx(expected, rel=1e-5, abs=1e-9)
    labels = "Bokeh.documents[0].get_model_by_name('velocity').below.find(part => part.type == 'Legend').items"
    shown = page.evaluate(f"() => {labels}.filter(item => item.visible).map(item => item.label.value)")
    assert f"bead {BEAD}, chain 2" in shown
    assert f"bead {BEAD}, chain 1" not in shown


def test_a_link_opens_at_its_time_bead_and_chain_and_what_is_invalid_is_ignored(page, ran, open_page):
    choose(page, "of chain", "2")
    choose_bead(page, BEAD)
    page.evaluate("() => { Bokeh.documents[0].get_model_by_name('time').value = 10.0; }")
    press(page, "copy link")
    page.wait_for_function("location.hash == '#t=10&bead=8&chain=2'")
    path = ran.directory.path / "view.html"
    other = open_page(path, "#t=12.5&bead=9&chain=1")
    assert (value(other, "time"), value(other, "bead"), value(other, "chain")) == (pytest.approx(12.5), "9", "1")
    at_first = None
    for fragment in ("", "#t=1e9&bead=400&chain=7", "#t=soon&bead=&chain=-1", "#r1"):
        opened = open_page(path, fragment)
        state = [value(opened, name) for name in ("time", "bead", "chain")]
        at_first = at_first or state
        assert state == at_first
        opened.close()


def test_the_numbers_behind_plots_are_saved_as_csv_with_units_and_pictures_in_print_resolution(page, ran):
    frames = ran.trajectory
    choose(page, "of chain", "all")
    choose(page, "quantity on the maps", "displacement")
    name, path = saved(page, 0, "Data as CSV")
    rows = list(csv.DictReader(path.read_text().splitlines()))
    assert name == "seen-map-displacement.csv"
    assert list(rows[0]) == ["time t (reduced)", "chain", "bead", "displacement x (reduced)"]
    assert len(rows) == frames.displacement.size
    row = rows[(frames.frames + FRAME) * 20 + BEAD - 1]
    assert (row["chain"], row["bead"]) == ("2", str(BEAD))
    assert float(row["time t (reduced)"]) == pytest.approx(frames.time[FRAME])
    assert float(row["displacement x (reduced)"]) == pytest.approx(frames.displacement[FRAME, 1, BEAD - 1], rel=1e-6)
    choose(page, "quantity on the maps", "velocity")
    name, path = saved(page, 1, "Data as CSV")
    rows = list(csv.DictReader(path.read_text().splitlines()))
    assert (name, list(rows[0])) == (
        "seen-beads.csv",
        ["chain", "bead", "displacement x (reduced)", "velocity v (reduced)"],
    )
    name, path = saved(page, 2, "Data as CSV")
    rows = [row for row in csv.DictReader(path.read_text().splitlines()) if row["curve"] == "bead 4, chain 1"]
    assert name == "seen-velocity.csv"
    velocities = [float(row["velocity v (reduced)"]) for row in rows]
    assert velocities == pytest.approx(frames.velocity[:, 0, 3].tolist(), abs=1e-7)
    name, path = saved(page, 2, "Save")
    assert name == "seen-velocity.png"
    assert struct.unpack(">I", path.read_bytes()[16:20])[0] >= 2100


@pytest.mark.parametrize("width", [1280, 600])
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_a_page_fits_wide_and_narrow_screens_in_both_themes(width, theme, ran, open_page):
    opened = open_page(ran.directory.path / "view.html", width=width, color_scheme=theme)
    opened.wait_for_function(f"() => document.documentElement.scrollWidth <= {width}")
    paper = opened.evaluate("getComputedStyle(document.body).backgroundColor")
    assert paper == {"light": "rgb(255, 255, 255)", "dark": "rgb(27, 29, 33)"}[theme]
    field = opened.get_by_label("quantity on the maps").evaluate("one => getComputedStyle(one).backgroundColor")
    assert (field == "rgb(38, 41, 47)") == (theme == "dark")
    opened.close()


STEEL = {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3}


@pytest.fixture(scope="module")
def narrow(tmp_path_factory, open_page):
    """Page of 60 beads in SI units in a window of 600 pixels."""
    scene = {**SCENE, "beads": 60, "material": STEEL, "coupling": {"stiffness": 2.41e6}, "duration": 6e-4}
    made = granchain.run(scene, tmp_path_factory.mktemp("narrow") / "run", engine="reference")
    made.view()
    return open_page(made.directory.path / "view.html", width=600)


def move_to(page, share):
    page.evaluate(
        """share => { const one = Bokeh.documents[0].get_model_by_name('time');
        one.value = one.start + one.step * Math.round(share * (one.end - one.start) / one.step); }""",
        share,
    )
    page.wait_for_function("() => Bokeh.documents[0].is_idle")


def test_a_narrow_page_shows_the_whole_table_of_the_chosen_bead_and_says_which_beads_its_picture_has(narrow):
    cells = narrow.get_by_role("region", name="numbers at the chosen time and bead").locator("td, th")
    seen = """() => { const plot = Bokeh.documents[0].get_model_by_name('beads'), {start, end} = plot.x_range;
      return [plot.title.text, start, end]; }"""
    firsts = []
    for share in (0.0, 0.3, 0.6):
        move_to(narrow, share)
        assert any("energy of the bead" in text.replace("\n", " ") for text in cells.all_inner_texts())
        right = cells.evaluate_all("all => Math.max(...all.map(one => one.getBoundingClientRect().right))")
        assert 300 < right <= 600
        title, start, end = narrow.evaluate(seen)
        first, last = math.ceil(start), math.floor(end)
        assert title == f"beads {max(first, 1)} to {min(last, 60)} of 60"
        firsts.append(first)
    assert firsts[-1] > firsts[0]
