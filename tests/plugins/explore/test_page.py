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

SCENE = {"name": "two", "chains": 2, "beads": 24, "coupling": {"stiffness": 0.1}, "kick": {"velocity": 1.0}}
SCENE |= {"duration": 30.0}

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
def page(browser, address):
    """The page; fails at its end if it complained, or asked another address for anything."""
    complaints, context = [], browser.new_context(viewport={"width": 1280, "height": 1000})
    page = context.new_page()
    page.set_default_timeout(120_000)
    page.on("console", lambda said: complaints.append(said.text) if said.type in ("error", "warning") else None)
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("request", lambda asked: None if asked.url.startswith(address) else complaints.append(asked.url))
    page.goto(address)
    page.wait_for_function("window.Bokeh && Bokeh.documents.length && Bokeh.documents[0].is_idle")
    page.wait_for_function(f"{COMPUTED} && Bokeh.documents[0].get_model_by_name('velocity')")
    yield page
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


def test_a_person_changes_saves_and_switches_numbers_and_sees_what_a_run_of_the_reference_would_give(page, tmp_path):
    # a changed number, and the run of the scene that is saved
    type_into(page, "coupling stiffness k (reduced)", "0.15")
    wait_for(page, "stiffness: 0.15")
    assert page.evaluate("Bokeh.documents[0].get_model_by_name('units').text").endswith("kappa = 0.15")
    with page.expect_download() as download:
        page.get_by_role("button", name="save YAML").click()
    assert download.value.suggested_filename == "two.yaml"
    saved = (tmp_path / "saved.yaml").absolute()
    download.value.save_as(saved)
    peaks, sentences = computed_by_the_command(saved.read_text(), tmp_path)
    for chain, expected in zip(page.evaluate(LINES, "peaks"), peaks, strict=True):
        assert [peak for peak in chain if peak is not None] == pytest.approx(expected, rel=1e-12)  # rounded in the file
    listed = page.evaluate(f"{TEXT}.body.innerText")
    assert all(sentence in listed for sentence in sentences)

    # an ingredient is switched off and comes back as it was
    before = page.evaluate(LINES, "peaks")
    page.get_by_label("coupling", exact=True).uncheck()
    page.wait_for_function(f"!{YAML}.includes('coupling:') && {SHOWN} == {YAML}")
    assert strict_yaml.parse(page.evaluate(YAML), "page").keys() == granchain.load(SCENE).plain().keys() - {"coupling"}
    assert {value for value in page.evaluate(LINES, "peaks")[1] if value} == set()
    page.get_by_label("coupling", exact=True).check()
    page.wait_for_function(f"{YAML}.includes('coupling:') && {SHOWN} == {YAML}")
    assert page.evaluate(LINES, "peaks") == before

    # what is refused, or takes long, is one line, and the last picture stays
    type_into(page, "kicked bead", "1000")
    page.wait_for_function(WRONG)
    line = page.evaluate(f"{TEXT}.querySelector('p').innerText")
    assert "kick.bead: 1000 is outside the array" in line
    assert "\n" not in line
    assert page.evaluate(LINES, "peaks") == before
    type_into(page, "kicked bead", "2")
    wait_for(page, "bead: 2")
    before = page.evaluate(LINES, "peaks")
    type_into(page, "duration (reduced)", "1e6")
    page.wait_for_function(WRONG)
    assert "this scene takes about" in page.evaluate(STATUS)
    assert "duration: 1000000" in page.evaluate(YAML)  # can be saved
    assert page.evaluate(LINES, "peaks") == before
    type_into(page, "duration (reduced)", "30")

    # keys alone move a slider
    page.get_by_role("slider", name="kick velocity (reduced)").focus()
    page.keyboard.press("ArrowRight")
    wait_for(page, "velocity: 1.01")
    assert page.get_by_label("kick velocity (reduced)", exact=True).first.input_value() == "1.01"


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


def test_an_interrupted_server_ends_as_other_commands_do(scene_file):
    with served(scene_file) as (process, _):
        process.send_signal(signal.SIGINT)
        assert wait_until(lambda: process.poll() is not None)
        assert process.returncode == 130
        assert process.stderr.read() == "granchain: interrupted\n"
