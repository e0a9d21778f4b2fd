"""What pages of runs, comparisons and sweeps show, as tables (folder `golden`), without a browser."""

import functools
import re
import sys
from dataclasses import replace
from html import unescape
from types import SimpleNamespace

import numpy as np
import pytest
from bokeh.layouts import column
from bokeh.models import GlyphRenderer, Range1d
from global_state import SCENE, assert_state_remains
from page_table import page_table
from plug_ins import needs
from refusals import refusal
from stock_lammps import scene

import granchain
from analysis import motion
from analysis.figures.panels import shown_chains
from analysis.tracking.leading_waves import with_speeds
from analysis.trajectory import Trajectory
from lammps_inputs import Kick, Material
from lammps_inputs.laws.in_time import half_sine
from lammps_inputs.loads import Load
from lammps_inputs.units import Label
from workflow.cli import main
from workflow.measures.forces.measurement import ForceMeasurement
from workflow.measures.forces.readings import Readings
from workflow.plugins.pages import function, run_page, sweep_page
from workflow.plugins.pages.downsample import thinned, units_of
from workflow.quantities.columns import QUANTITIES
from workflow.runs.run_directory import RunDirectory
from workflow.sweep.collect import SweepTable
from workflow.verdicts.analyse import default_beads
from workflow.verdicts.analysis_files import analyse

STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)

# --- runs made by hand ------------------------------------------------------------------------------------------------


def hit(chains=2, duration=4.0, material=None, **changes):
    """A problem of chains of six beads, hit with 0.5 (m/s); duration and coupling in units of T and of the contacts."""
    kick = (Kick(velocity=0.5),)
    unit = scene(chains=chains, kick=kick, material=material).scale
    coupling = {"kappa": 0.1 * unit.stiffness} if chains > 1 else {}
    options = {"beads": 6, "material": material, "duration": duration * unit.time, **coupling, **changes}
    return scene(chains=chains, kick=kick, **options).problem()


def run_by_hand(problem, rows=None):
    """Beads swing fast, and each as far as no other."""
    shape = (problem.frames + 1, problem.chains, rows or problem.rows.count)
    each = np.arange(np.prod(shape)).reshape(shape)
    time = np.arange(problem.frames + 1) * problem.every
    return Trajectory(problem, time, 0.1 * np.cos(each), each % 7 * np.cos(2.0 * each))


def page_by_hand(problem, chains, waves=None, **options):
    survey = waves and SimpleNamespace(waves=waves, shared=SHARED, decay=None, exact_speed=None)
    part = thinned(problem, [run_by_hand(problem)], chains)
    return run_page.layout(problem, part, survey, [1, 3], **options)


SHARED = SimpleNamespace(of_impulses=False, final=None)
SHARED.followed = SHARED


def three_chains():
    """Chain 3 is 0.3 T later than chain 1, and no pulse leads at its bead 4; chain 2, which ties them, is not shown."""
    chain, bead = np.array([1, 1, 1, 1, 3, 3, 3]), np.array([2, 3, 4, 5, 2, 3, 5])
    waves = with_speeds(chain, bead, 1.2 * bead + 0.3 * (chain == 3), 0.1 * chain + 0.01 * bead)
    return page_by_hand(hit(chains=3, material=STEEL), [0, 2], waves)


def gauges_and_pushes():
    """0.25 at contact 2 of chain 3 in the second of three instants, and a push of bead 4 of chain 2."""
    problem = hit(chains=3, material=STEEL)
    part = thinned(problem, [run_by_hand(problem)], [0, 2])
    half = np.zeros((3, 3, 2))
    half[1, 2] = 0.5, 0.25
    places = (SimpleNamespace(name="right wall"), SimpleNamespace(name="contact 2"))
    numbers = [np.ones((3, 2))] * 10
    readings = Readings(places, np.array([0.0, 1.0, 2.0]), half, *numbers, np.zeros((3, 2), dtype=int))
    pushed = replace(problem, system=replace(problem.system, loads=(Load(2, 4, half_sine(0.5, 3.0)),)))
    measured = ForceMeasurement(problem, [], readings)
    return column(*run_page.forces(pushed, part, measured, Range1d(0, 1), units_of(problem, part)))


BY_HAND = {
    "three-chains-si": three_chains,
    "gauges-and-pushes": gauges_and_pushes,
}

# --- runs of the reference --------------------------------------------------------------------------------------------

CHAIN = {"name": "made", "chains": 1, "beads": 30, "kick": {"velocity": 1.0}, "duration": 30.0}
SCENES = {
    "coupled": {**CHAIN, "chains": 2, "beads": 40, "coupling": {"stiffness": 1.0}, "duration": 60.0},
    "loaded": {
        **{**CHAIN, "material": {"name": "steel", "radius": 4.76e-3}, "precompression": {"force": 20}},
        **{"kick": {"velocity": 0.1}, "duration": 6e-4},
    },
    "resonating": {
        **CHAIN,
        "resonators": {"mass": 0.3, "stiffness": 1.0, "rows": [11, 20]},
        "walls": {"right": "flat"},
    },
    "driven": {
        **CHAIN,
        "kick": None,
        "foundation": {"stiffness": 0.2},
        "drive": {"displacement": 0.5, "frequency": 0.1, "phase": -90},
        "output": {"every": 0.1, "spectra": {"beads": [1, 2], "after": 10}},
    },
}


QUICK = "coupled"
"""Others are slow, as each is compiled."""


class PageOfRun:
    """The page of a scene, and the directory that it is of."""

    def __init__(self, scene, directory):
        granchain.run({key: value for key, value in scene.items() if value}, directory, engine="reference", check=False)
        self.directory = RunDirectory(directory)
        problem = self.problem = self.directory.problem
        analysis = self.analysis = analyse(self.directory, figures=False)
        self.part = thinned(problem, self.directory.blocks(), shown_chains(problem))
        beads, measured = list(default_beads(problem)), analysis.measurements
        self.root = run_page.layout(problem, self.part, analysis.survey, beads, measurements=measured)


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """A function: name of a scene -> its page."""
    return functools.cache(lambda name: PageOfRun(SCENES[name], tmp_path_factory.mktemp("pages") / name))


@needs("sound")
@pytest.mark.parametrize(
    "name", [QUICK, *(pytest.param(name, marks=pytest.mark.slow) for name in SCENES if name != QUICK)]
)
def test_a_page_has_the_plots_that_its_scene_has_measurements_for(name, page, golden):
    golden(name, page_table(page(name).root))


@pytest.mark.parametrize("name", BY_HAND)
def test_a_page_of_numbers_made_by_hand_has_them_in_its_units_at_their_places(name, golden):
    golden(name, page_table(BY_HAND[name]()))


# --- sweeps -----------------------------------------------------------------------------------------------------------

FIELDS = ["coupling.stiffness", "kick.velocity"]


def case(stiffness, velocity, **quantities):
    name = f"coupling.stiffness={stiffness},kick.velocity={velocity}"
    fields = dict(zip(FIELDS, (stiffness, velocity), strict=True))
    blank = {"outcome": "done", **dict.fromkeys(QUANTITIES), "reason": None}
    return {"case": name, **fields, **blank, "amplitude": 0.3, **quantities}


def page_of(*cases, files=()):
    labels = {"kick.velocity": Label("kick velocity", "", "m/s")}
    table = SweepTable(FIELDS, list(cases), si=True, labels=labels)
    return sweep_page.layout(table, {one["case"]: list(files) for one in cases}, "swept")[0]


SETTLED = {"amplitude_uncertainty": 0.001, "state": "equipartitioned and synchronised"}
SWEEPS = {
    "sweep": lambda: page_of(
        case(0.0285418299448364, 1, amplitude=None),
        case(0.02, 1, amplitude=0.356, amplitude_uncertainty=0.053, state="beating"),
        case(0.1, 1, amplitude=0.365, **SETTLED),
        case(0.4, 1, state="beating"),
        case(0.5, 1, amplitude=0.4, outcome="running"),
        files=("view.html", "distance.png"),
    ),
    "sweep-two-fields": lambda: page_of(case(0.1, 1), case(0.1, 2.5), case(0.2, 1), files=("distance.png",)),
}


@pytest.mark.parametrize("name", SWEEPS)
def test_a_page_of_a_sweep_has_its_cases_their_uncertainties_links_and_what_can_be_chosen(name, golden):
    golden(name, page_table(SWEEPS[name]()))


# --- numbers of a page ------------------------------------------------------------------------------------------------


def test_every_number_is_the_runs_in_the_units_of_its_figures():
    problem = hit(chains=3, material=STEEL)
    run = run_by_hand(problem)
    part = thinned(problem, [run[:7], run[7:]], [0, 2])
    units = units_of(problem, part)
    worth, shown = {name: unit.worth for name, unit in units.items()}, part.measured(units)
    overlap = np.maximum(motion.overlaps(problem.system, run.displacement), 0.0)
    energy = motion.bead_energy(problem.system, run.displacement, run.velocity).sum(axis=-1)
    assert worth["time"] == pytest.approx(1e6 * problem.scale.time)
    np.testing.assert_allclose(shown.time, run.time * worth["time"])
    for place, chain in enumerate((0, 2)):
        np.testing.assert_allclose(shown.displacement[place], run.displacement[:, chain] * worth["length"])
        np.testing.assert_allclose(shown.velocity[place], run.velocity[:, chain] * worth["velocity"])
        np.testing.assert_allclose(shown.overlap[place][:, :-1], overlap[:, chain] * worth["length"])
        np.testing.assert_allclose(shown.force[place][:, :-1], overlap[:, chain] ** 1.5 * worth["force"])
        np.testing.assert_allclose(shown.energy[place], energy[:, chain] * worth["energy"])


@pytest.mark.parametrize("stride", [4, 7])
def test_thinning_in_time_keeps_the_velocity_of_largest_size_around_each_frame(stride):
    problem = hit(duration=4.8)
    run, frames = run_by_hand(problem), problem.frames + 1
    blocks = [run[:3], run[3:4], run[4:17], run[17:]]
    part = thinned(problem, blocks, [1], most_numbers=-(-frames * 6 // stride))
    assert np.array_equal(part.time, run.time[::stride])
    last = len(part.time) - 1
    nearest = np.minimum((np.arange(frames) + stride // 2) // stride, last)
    for place in range(last + 1):
        around = run.velocity[nearest == place, 1]
        largest = np.take_along_axis(around, np.abs(around).argmax(axis=0)[None], axis=0)[0]
        assert np.array_equal(part.velocity[0, place], largest)


def test_what_a_window_has_left_does_not_make_frames_fewer():
    problem = hit(beads=600, duration=3.0, window=64)
    run = replace(run_by_hand(problem, rows=64), first=301)
    part = thinned(problem, [run], [0, 1], most_numbers=(problem.frames + 1) * 2 * 64)
    assert (part.bead_stride, part.frame_stride) == (2, 1)
    assert np.isnan(part.velocity[:, :, :150]).all()
    assert np.array_equal(part.velocity[0, :, 150:182], run.velocity[:, 0, ::2])


@pytest.mark.slow
def test_energies_of_the_beads_add_up_and_resonators_are_those_of_the_run(page):
    for name in SCENES:
        part = page(name).part
        np.testing.assert_allclose(part.density.sum(axis=-1), part.energy, atol=1e-12)
    others = page("resonating").part.others
    assert np.isfinite(others[0]).any(axis=0).tolist() == [10 <= place < 20 for place in range(30)]
    (frames,) = page("resonating").directory.blocks()
    assert np.array_equal(others[0, :, 10:20], frames.further_lines[:, 0, 0, 10:20])


@pytest.mark.slow
def test_curves_of_the_budget_add_up_to_the_energy_input(page):
    (plot,) = page("driven").root.select({"name": "budget"})
    lines = {item.label.value: item.renderers[0].data_source.data["y"] for item in plot.legend[0].items}
    energy_input = lines.pop("energy input")
    assert sum(lines.values()) == pytest.approx(energy_input, abs=2e-3 * np.max(energy_input))


@pytest.mark.slow
@needs("sound")
def test_the_line_of_sound_has_its_speed(page):
    loaded = page("loaded")
    lines = (one.data_source.data for one in loaded.root.select({"type": GlyphRenderer, "name": "theory"}))
    data = next(data for data in lines if len(data["x"]) == loaded.problem.beads)  # a point at each bead
    time = np.asarray(data["y"]) * (loaded.part.time[-1] / loaded.root.select_one({"name": "time"}).end)
    speed = loaded.analysis.measurements["sound"].values.speed[0]
    assert np.polyfit(time, data["x"], 1)[0] == pytest.approx(speed, rel=1e-3)


def test_a_page_says_in_numbers_what_analyze_prints(page, capsys):
    path = page("coupled").directory.path
    assert main(["analyze", str(path), "--no-figures"]) == 0
    printed = capsys.readouterr().out.splitlines()
    assert main(["view", str(path), "--no-open", "--quiet"]) == 0
    text = (path / "view.html").read_text()
    results = text[text.index('id="results"') : text.index("</details></details>")]
    sentences = [unescape(sentence) for sentence in re.findall(r"<p>(.*?)\.</p>", results)]
    assert {sentence.lower() for sentence in sentences} <= {line.lower() for line in printed}
    assert sum("asymptotic amplitude" in sentence or "has" in sentence for sentence in sentences) >= 2
    cells = re.findall(r"<td[^>]*>([^<]+)</td>", results)
    assert cells
    assert set(cells) <= {word for line in printed for word in line.split()}


def test_pages_without_bokeh_are_refused_in_one_line(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "bokeh", None)
    assert "pip install" in refusal(["view", tmp_path], capsys)


@pytest.mark.slow
def test_a_page_is_listed_shown_in_a_notebook_and_leaves_the_state_of_the_process(tmp_path, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")  # bars of progress have threads
    path = granchain.run(SCENE, tmp_path / "run", engine="reference").directory.path
    assert_state_remains(lambda: granchain.view(path), path)
    assert "view.html" in granchain.open(path).directory.job.files
    shown = granchain.open(path).view()
    assert "<iframe" in shown._repr_html_()
    monkeypatch.setattr(function, "MOST_EMBEDDED", 1000)
    assert shown._repr_html_() == f'<p><a href="{shown.path.resolve().as_uri()}">{shown.path}</a></p>'
