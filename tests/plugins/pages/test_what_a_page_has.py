"""What the page of a scene has, and has not, by its ingredients; without a browser."""

import re
from dataclasses import replace
from html import unescape

import numpy as np
import pytest
from bokeh.models import CheckboxGroup, GlyphRenderer, Range1d, Span
from bokeh.plotting import figure
from plug_ins import needs

import granchain
from analysis.figures.panels import shown_chains
from workflow.cli import main
from workflow.plugins.pages import run_page
from workflow.plugins.pages.downsample import thinned
from workflow.plugins.pages.measured import plots_of
from workflow.plugins.pages.plots import NOW
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.analyse import default_beads
from workflow.verdicts.analysis_files import analyse

STEEL = {"name": "steel", "radius": 4.76e-3}
CHAIN = {"name": "made", "chains": 1, "beads": 30, "kick": {"velocity": 1.0}, "duration": 30.0}
SCENES = {
    "coupled": {**CHAIN, "chains": 2, "beads": 40, "coupling": {"stiffness": 1.0}, "duration": 60.0},
    "loaded": {
        **CHAIN,
        "material": STEEL,
        "precompression": {"force": 20},
        "kick": {"velocity": 0.1},
        "duration": 6e-4,
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


class Page:
    """Plots of the page of a scene, and the directory that it is of."""

    def __init__(self, scene, directory):
        granchain.run({key: value for key, value in scene.items() if value}, directory, engine="reference", check=False)
        self.directory = RunDirectory(directory)
        problem = self.problem = self.directory.problem
        self.analysis = analyse(self.directory, figures=False)
        self.part = thinned(problem, self.directory.blocks(), shown_chains(problem))
        self.root = run_page.layout(
            problem,
            self.part,
            self.analysis.survey,
            list(default_beads(problem)),
            measurements=self.analysis.measurements,
        )
        self.plots = {plot.name: plot for plot in self.root.select({"type": figure}) if plot.name}

    def drawn(self, name):
        return list(self.root.select({"type": GlyphRenderer, "name": name}))


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    return {name: Page(scene, tmp_path_factory.mktemp("pages") / name) for name, scene in SCENES.items()}


@needs("sound")
def test_a_page_has_the_plots_that_its_scene_has_measurements_for(pages):
    special = {"budget", "spectra", "dispersion", "phase"}
    assert {name: special & set(page.plots) for name, page in pages.items()} == {
        "coupled": set(),
        "loaded": {"dispersion"},
        "resonating": {"budget"},
        "driven": {"budget", "spectra", "phase"},
    }


@pytest.mark.parametrize("count", [0, 1, 2])
def test_spectra_have_a_line_for_each_drive_and_are_drawn_without_any(pages, count):
    page = pages["driven"]
    measured = page.analysis.measurements["spectra"]
    several = replace(measured, spectra=replace(measured.spectra, drive=np.linspace(0.1, 0.2, count)))
    (plot,) = plots_of(page.problem, {"spectra": several}, Range1d(0.0, 1.0), {})
    assert sum(isinstance(span, Span) for span in plot.center) == count
    assert ("frequency of the drive" in plot.title.text) == (count > 0)


def test_every_plot_over_time_has_a_line_at_the_time(pages):
    for page in pages.values():
        for plot in page.root.select({"type": figure}):
            labels = [str(axis.axis_label) for axis in (plot.xaxis[0], plot.yaxis[0])]
            lines = [span for span in plot.center if isinstance(span, Span) and span.name == NOW]
            assert bool(lines) == any(label.startswith("time t") and plot.name != "arrivals" for label in labels)


@needs("sound")
def test_lines_of_theory_are_named_where_the_theory_applies_and_have_its_speed(pages):
    legends = {name: page.root.select_one({"type": CheckboxGroup, "name": "theory"}) for name, page in pages.items()}
    assert {name for name, legend in legends.items() if legend} == {"coupled", "loaded"}
    page = pages["loaded"]
    sound = page.analysis.measurements["sound"].values.speed
    assert legends["loaded"].labels[0] == f"sound: c0 = {sound[0] / page.problem.scale.time:.6g} beads/s"
    of_sound = (line.data_source.data for line in page.drawn("theory"))
    data = next(data for data in of_sound if len(data["x"]) == page.problem.beads)  # a point at each bead
    time = np.asarray(data["y"]) * (page.part.time[-1] / page.root.select_one({"name": "time"}).end)
    assert np.polyfit(time, data["x"], 1)[0] == pytest.approx(sound[0], rel=1e-3)


def test_walls_and_resonators_are_drawn_where_there_are_any(pages):
    walls = {name: len(page.drawn("walls")) for name, page in pages.items()}
    assert walls == {"coupled": 0, "loaded": 0, "resonating": 1, "driven": 0}
    resonators = pages["resonating"].part.others
    assert np.isfinite(resonators[0]).any(axis=0).tolist() == [10 <= place < 20 for place in range(30)]
    (frames,) = pages["resonating"].directory.blocks()
    assert np.array_equal(resonators[0, :, 10:20], frames.further_lines[:, 0, 0, 10:20])
    assert pages["coupled"].part.others.size == 0


def test_energies_of_the_beads_add_up_to_that_of_the_chain(pages):
    for page in pages.values():
        np.testing.assert_allclose(page.part.density.sum(axis=-1), page.part.energy, atol=1e-12)


def test_curves_of_the_budget_add_up_to_the_energy_input(pages):
    lines = {
        item.label.value: item.renderers[0].data_source.data["y"]
        for item in pages["driven"].plots["budget"].legend[0].items
    }
    energy_input = lines.pop("energy input")
    assert sum(lines.values()) == pytest.approx(energy_input, abs=2e-3 * np.max(energy_input))


def test_a_page_says_in_numbers_what_analyze_prints(pages, capsys):
    path = pages["coupled"].directory.path
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
