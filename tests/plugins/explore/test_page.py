"""The page of `granchain explore`, in a real browser."""

import csv
import http.client
import json
import signal
import sys
import urllib.error
import urllib.parse
import urllib.request
from contextlib import contextmanager

import pytest
from processes import started, wait_until

import granchain
from lammps_inputs import strict_yaml
from workflow.cli import main
from workflow.verdicts.pulse_sentences import pulse_sentences

SCENE = {
    "name": "two",
    "chains": 2,
    "beads": 24,
    "coupling": {"stiffness": 0.1},
    "kick": {"velocity": 1.0},
    "duration": 30.0,
}

pytestmark = pytest.mark.slow

STATUS = "Bokeh.documents[0].get_model_by_name('status').text"
COMPUTED = f"{STATUS}.includes('computed in')"
WRONG = f"{STATUS}.includes('alert')"
YAML = "Bokeh.documents[0].get_model_by_name('yaml').tags[0]"
# plots that were replaced stay for some seconds
LINES = """name => [...Bokeh.documents[0]._all_models.values()].filter(one => one.name == name).at(-1).renderers.map(
  line => Array.from(line.data_source.data[line.glyph.y.field], value => isNaN(value) ? null : value))"""
SHOWN = "Bokeh.documents[0].get_model_by_name('status').tags[0]"
TEXT = f"new DOMParser().parseFromString({STATUS}, 'text/html')"


@contextmanager
def served(path):
    """The command on a scene's file, and the address that it prints."""
    with started([sys.executable, "-m", "workflow", "explore", path, "--no-open"]) as process:
        yield process, process.stdout.readline().split()[-1]


@pytest.fixture(scope="module")
def scene_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("explore") / "two.yaml"
    path.write_text(json.dumps(SCENE))
    return path


@pytest.fixture(scope="module")
def address(scene_file):
    with served(scene_file) as (_, printed):
        yield printed


@pytest.fixture
def opened(browser):
    """Opens a page; fails at its end if it complained, or asked another address for anything."""
    complaints, contexts = [], []

    def page_of(address, width=1280, **options):
        contexts.append(browser.new_context(viewport={"width": width, "height": 1000}, **options))
        page = contexts[-1].new_page()
        page.set_default_timeout(120_000)
        page.on("console", lambda said: complaints.append(said.text) if said.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda asked: None if asked.url.startswith(address) else complaints.append(asked.url))
        page.goto(address)
        page.wait_for_function("window.Bokeh && Bokeh.documents.length && Bokeh.documents[0].is_idle")
        page.wait_for_function(f"{COMPUTED} && Bokeh.documents[0].get_model_by_name('velocity')")
        return page

    yield page_of
    for context in contexts:
        context.close()
    assert complaints == []


def type_into(page, name, words):
    """Give a field another value with the keyboard."""
    page.get_by_label(name, exact=True).first.fill(words)
    page.keyboard.press("Enter")


def wait_for(page, yaml_words):
    """Wait until a scene with these words has been computed."""
    page.wait_for_function(f"words => {YAML}.includes(words) && {SHOWN} == {YAML}", arg=yaml_words)


def computed_by_the_command(scene, directory):
    """Peak velocities at every bead of each chain, by waves.csv, and sentences of the analysis, of a run of a scene."""
    (directory / "scene.yaml").write_text(scene)
    run = directory / "run"
    assert main(["run", str(directory / "scene.yaml"), "-o", str(run), "--engine", "reference", "-q"]) == 0
    analysis = granchain.analyze(run)
    with (run / "waves.csv").open() as file:
        rows = list(csv.DictReader(file))
    peaks = [
        [float(row["peak_velocity"]) for row in rows if row["chain"] == str(chain + 1)]
        for chain in range(analysis.problem.chains)
    ]
    return peaks, list(pulse_sentences(analysis.survey))


def shown(page):
    """Peak velocities and sentences that a page shows."""
    peaks = [[peak for peak in chain if peak is not None] for chain in page.evaluate(LINES, "peaks")]
    listed = page.evaluate(f"{TEXT}.body.innerText")
    return peaks, listed


def test_a_changed_number_shows_what_a_run_of_the_saved_scene_by_the_reference_would(address, opened, tmp_path):
    page = opened(address)
    type_into(page, "coupling stiffness k (reduced)", "0.15")
    wait_for(page, "stiffness: 0.15")
    assert page.evaluate("Bokeh.documents[0].get_model_by_name('units').text").endswith("kappa = 0.15")
    with page.expect_download() as download:
        page.get_by_role("button", name="save YAML").click()
    assert download.value.suggested_filename == "two.yaml"
    saved = (tmp_path / "saved.yaml").absolute()
    download.value.save_as(saved)
    peaks, sentences = computed_by_the_command(saved.read_text(), tmp_path)
    shown_peaks, listed = shown(page)
    for chain, expected in zip(shown_peaks, peaks, strict=True):
        assert chain == pytest.approx(expected, rel=1e-12)  # frames of a file are rounded
    for sentence in sentences:
        assert sentence in listed


def test_an_ingredient_that_is_switched_off_is_left_out_and_comes_back_as_it_was(address, opened):
    page = opened(address)
    before = page.evaluate(LINES, "peaks")
    page.get_by_label("coupling", exact=True).uncheck()
    page.wait_for_function(f"!{YAML}.includes('coupling:') && {SHOWN} == {YAML}")
    assert strict_yaml.parse(page.evaluate(YAML), "page").keys() == granchain.load(SCENE).plain().keys() - {"coupling"}
    assert not page.get_by_label("coupling stiffness k (reduced)", exact=True).first.is_visible()
    second = page.evaluate(LINES, "peaks")[1]
    assert {value for value in second if value} == set()
    page.get_by_label("coupling", exact=True).check()
    page.wait_for_function(f"{YAML}.includes('coupling:') && {SHOWN} == {YAML}")
    assert page.evaluate(LINES, "peaks") == before


def test_a_refused_value_or_one_that_takes_long_is_one_line_and_the_last_picture_stays(address, opened):
    page = opened(address)
    for words, says, valid in (
        ("1000", "kick.bead: 1000 is outside the array", "2"),
        ("x", "kick.bead: should be a whole number", "3"),
        ("[", "kick.bead", "4"),
    ):
        before = page.evaluate(LINES, "peaks"), page.evaluate(YAML)
        type_into(page, "kicked bead", words)
        page.wait_for_function(WRONG)
        line = page.evaluate(f"{TEXT}.querySelector('p').innerText")
        assert says in line
        assert "\n" not in line
        assert (page.evaluate(LINES, "peaks"), page.evaluate(YAML)) == before
        type_into(page, "kicked bead", valid)
        wait_for(page, f"bead: {valid}")
    before = page.evaluate(LINES, "peaks")
    type_into(page, "duration (reduced)", "1e6")
    page.wait_for_function(WRONG)
    assert "this scene takes about" in page.evaluate(STATUS)
    assert "duration: 1000000" in page.evaluate(YAML)  # can be saved
    assert page.evaluate(LINES, "peaks") == before


def test_keys_alone_move_a_slider_and_choose_the_bead(address, opened):
    page = opened(address)
    page.get_by_role("slider", name="kick velocity (reduced)").focus()
    page.keyboard.press("ArrowRight")
    wait_for(page, "velocity: 1.01")
    assert page.get_by_label("kick velocity (reduced)", exact=True).first.input_value() == "1.01"
    before = page.evaluate(LINES, "velocity")
    page.get_by_label("bead (or click a map)").focus()
    page.keyboard.press("ArrowDown")
    page.wait_for_function(f"before => JSON.stringify(({LINES})('velocity')) != before", arg=json.dumps(before))


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_page_fits_a_narrow_screen_and_has_the_colours_of_its_theme(address, opened, scheme):
    page = opened(address, width=600, color_scheme=scheme)
    page.wait_for_function("document.documentElement.scrollWidth <= 600")
    background = {"light": "#ffffff", "dark": "#1b1d21"}[scheme]
    for name in ("velocity", "peaks", "energy"):
        page.wait_for_function(
            "([name, colour]) => Bokeh.documents[0].get_model_by_name(name).background_fill_color == colour",
            arg=[name, background],
        )


def test_only_the_printed_address_is_answered(address):
    host = address.rsplit("/", 2)[0]
    for path in ("/", "/wrong/", "/static/js/bokeh.min.js", "/ws", "/metadata"):
        with pytest.raises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(host + path)
        refused.value.close()
        assert refused.value.code == 404
    place = urllib.parse.urlsplit(address)
    connection = http.client.HTTPConnection(place.netloc)
    handshake = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13"}
    handshake |= {"Sec-WebSocket-Key": "x" * 16, "Sec-WebSocket-Protocol": "bokeh, x"}
    connection.request("GET", f"{place.path}ws", headers={"Origin": "http://elsewhere.example", **handshake})
    assert connection.getresponse().status == 403
    connection.close()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_server_ends_as_other_commands_do(scene_file, number):
    with served(scene_file) as (process, _):
        process.send_signal(number)
        assert wait_until(lambda: process.poll() is not None)
        assert process.returncode == 130
        assert process.stderr.read() == "granchain: interrupted\n"
