"""Figures of runs and of studies, each as a table of what it shows (folder `golden`), and the numbers behind them."""

import functools
import tempfile
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from figure_table import assert_shown
from stock_lammps import scene
from synthetic_waves import of_keys

from analysis.compare.difference import Deviation, ErrorMap
from analysis.figures import averages, spacetime
from analysis.figures.drawing import draw
from analysis.figures.errors import residual_figure, validation_figure
from analysis.figures.panels import (
    BEAD,
    Axis,
    AxisUnit,
    Curve,
    Image,
    Panel,
    Sheet,
    curves_of,
    title,
)
from analysis.figures.studies import Sought, StudyAxis, histogram_figure, logarithmic, map_figure, swept_figure
from analysis.figures.waves import passage, pulses, time_title
from analysis.files.traces import Channel, Traces
from analysis.sharing.energies import Flow
from analysis.statistics import histogram, statistics
from lammps_inputs import Kick, Material, library
from lammps_inputs.units import Label
from workflow.measures.energy import EnergyMeasurement
from workflow.runs.run import run
from workflow.verdicts.analyse import measure

# --- figures of runs --------------------------------------------------------------------------------------------------

FORCES = {"forces": {"wall": True, "contacts": [2, 7], "sensors": [5]}, "spectra": {"beads": [3, 8]}}
RUNS = {
    "steel": {
        "chains": 2,
        "beads": 40,
        "coupling": {"stiffness": 2.4e6},
        "material": {"name": "steel", "radius": 4.76e-3},
        "walls": {"right": "rigid"},
        "duration": 7e-4,
        "output": FORCES,
    },
    "losing": {
        "chains": 12,
        "beads": 12,
        "kick": {"chain": 6, "velocity": 1.0},
        "coupling": {"stiffness": 0.5},
        "foundation": {"stiffness": 0.3},
        "damping": {"beads": 0.02},
        "duration": 30.0,
        "output": {"every": 0.2, "forces": {"contacts": [2]}, "spectra": {"beads": [3]}},
    },
    "nine": {"chains": 9, "beads": 24, "coupling": {"stiffness": 0.2}, "duration": 34.0},
    "plastic": {"beads": 30, "contact": {"yield": {"overlap": 0.1}}, "duration": 45.0, "output": {"every": 0.2}},
    "few": {
        "chains": 2,
        "beads": 20,
        "coupling": {"stiffness": 0.1},
        "gap": 0.5,
        "duration": 40.0,
        "output": {"beads": [5, 9, 12], "every": 0.2},
    },
}
"""In SI units, of more chains than a figure shows, and of beads that are not all recorded."""


@functools.cache
def measured_run(name):
    """Figures of the analysis of a run by the reference: name -> function that makes its panels."""
    case = library.from_plain({"name": "test", "kick": {"velocity": 1.0}, **RUNS[name]}, "test")
    with tempfile.TemporaryDirectory() as folder:
        return measure(run(case, Path(folder) / "run", engine="reference", check=False).directory).figures


def of_run(name, figure):
    return draw(measured_run(name)[figure]())


SHOWN = ("steel-response", "steel-spacetime", "steel-distance", "steel-shape", "steel-forces", "steel-spectra")
SHOWN += ("losing-response", "losing-spacetime", "losing-energy", "losing-forces", "losing-spectra", "losing-budget")
SHOWN += ("nine-response", "nine-spacetime", "nine-distance", "nine-shape", "plastic-distance", "plastic-budget")
SHOWN += ("plastic-plastic", "few-response", "few-spacetime", "few-distance")
OF_RUNS = {name: partial(of_run, *name.split("-")) for name in SHOWN}

# --- figures that compare, with numbers made by hand ------------------------------------------------------------------


def hit():
    """Twelve chains of ten beads in SI units; eight frames, 0.5 T apart."""
    steel = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)
    options = {"chains": 12, "kick": (Kick(chain=6, velocity=0.01),), "material": steel}
    unit = scene(**options).scale.time
    return scene(beads=10, **options, duration=4.0 * unit, every=0.5 * unit).problem()


def residuals():
    """Data are twice the run at first; residuals are 0.5 and -1.5, and 0 and 4, in units of the noise."""
    problem = hit()
    unit = np.array([problem.scale.force, problem.scale.velocity])
    time = np.array([0.0, problem.scale.time])
    channels = (Channel("contact", 3, 2), Channel("velocity", 1, 5))
    data = Traces(time, channels, np.array([[2.0, 20.0], [4.0, 50.0]]) * unit, True)
    return residual_figure(problem, data, np.array([[1.0, 20.0], [7.0, 10.0]]) * unit, np.array([2.0, 10.0]) * unit)


def validation():
    """The only error is at bead 7 in the second half; one quantity is within its tolerance."""
    error = np.zeros((2, 10))
    error[1, 6] = 1e-3
    edges = ErrorMap(np.array([0.0, 2.0, 4.0]), np.arange(1, 12), error)
    deviations = {"velocity": Deviation(1e-3, 1e-4), "arrival": Deviation(4e-3, 1e-4), "displacement": Deviation(0, 0)}
    limits = {"velocity": 5e-4, "arrival": 1e-2, "displacement": 1e-2}
    return validation_figure(hit(), edges, deviations, limits, "reference")


def actions():
    """All energy passes from one of two chains on springs that vary into the other, from one mode into both."""
    problem = of_keys(chains=2, beads=9, coupling={"stiffness": 0.1}, kick={"velocity": 1.0}, duration=4.0)
    share = np.linspace([1.0, 0.0], [0.0, 1.0], 5)
    flow = Flow(np.arange(5.0), share, np.zeros(5), 1.0 + 2.0 * share, share * (1.0 - share), 0.5 + 0.5 * share)
    return draw(EnergyMeasurement(problem, flow).sheet())


COMPARED = {"action": actions, "residuals-si": residuals, "validation-si": validation}

# --- figures of studies, and what all figures share -------------------------------------------------------------------


def study(values, words="y", **options):
    return StudyAxis(Label(words, unit=options.pop("unit", "")), np.array(values, dtype=float), **options)


FACTORS = study([0.05, 0.1, 0.2], "x")
FROM_0 = study(range(4), "x")


def swept_in_si():
    """120 at 1 kN/m to 40 at 4 kN/m; 100 is sought, and is at 1.5 kN/m."""
    sought = Sought(100.0, np.array([1.5e3]), np.array([10.0]))
    return swept_figure(study([120, 90, 40], "bead"), study([1e3, 2e3, 4e3], "k", unit="N/m"), sought=sought)


def crossing_that_is_not_rounded_down():
    sought = Sought(20.0, np.array([0.215314]), np.array([0.00015]))
    return swept_figure(study([10, 20, 40], "bead"), study([0.1, 0.2, 0.4], "stiffness"), sought=sought)


def swept_with_uncertainties():
    """Cases come in the order of any field; that at 1 has not settled."""
    x, unsettled = np.array([3.0, 1.0, 2.0]), np.array([False, True, False])
    quantity = study(2.0 * x, error=0.1 * x, unsettled=unsettled, error_words="uncertainty")
    return swept_figure(quantity, study(x, "x"), title="scene")


def map_with_holes():
    """x times y at three x and nine y, but at one place; what is at y = 3 has not settled."""
    x, y = (part.ravel() for part in np.meshgrid([0.1, 0.2, 0.4], np.arange(1.0, 10.0)))
    keep = ~((x == 0.2) & (y == 3.0))
    quantity = study((x * y)[keep], "z", unsettled=(y == 3.0)[keep])
    return map_figure(quantity, study(x[keep], "x"), study(y[keep]))


def histogram_of_four():
    values = np.array([1.0, 1.0, 3.0, 7.0])
    return histogram_figure(Label("speed", "c", "m/s"), histogram(values), statistics(values), "seeds")


STUDIES = {
    "swept-si": swept_in_si,
    "swept-crossing": crossing_that_is_not_rounded_down,
    "swept-uncertainties": swept_with_uncertainties,
    "swept-from-0": lambda: swept_figure(study([0, 40, 120, 120]), FROM_0),
    "swept-holes": lambda: swept_figure(study([0, 40, np.nan, 120]), FROM_0),
    "swept-lines": lambda: swept_figure(study([np.nan, 1, 2]), FACTORS, study([1, 1, 3], "z", unit="m")),
    "swept-log": lambda: swept_figure(study(range(20)), study(np.geomspace(0.02, 0.5, 20), "x")),
    "map-holes": map_with_holes,
    "histogram": histogram_of_four,
}

TIME = np.arange(30.0)
SECONDS, SPEED = Axis(Label("time", "t", "s")), Axis(Label("speed", "v", "m/s"))
LINES = curves_of([0, 2], TIME, np.stack([TIME, 2.0 * TIME], axis=1))
PANEL = Panel(SECONDS, SPEED, LINES, "bead 5")


def sheet_of_lines():
    """Labels that panels share stand once; a line with dots where it is alone; a row that belongs to the one above."""
    gaps = np.where(TIME % 5 < 3, TIME, np.nan)
    gaps[20:25] = [np.nan, np.nan, 7.0, np.nan, np.nan]
    total = Curve("sum", TIME, TIME, look={"color": "black"})
    rows = [
        [PANEL, replace(PANEL, curves=(*LINES, total))],
        [replace(PANEL, curves=(Curve("a", TIME, gaps, 0),)), None],
    ]
    return draw(Sheet("of a run", rows, 4.0, heights=(2.0, 1.0)))


def sheet_of_an_image():
    """A white line over it has an outline."""
    image = Image(np.array([[0.0, np.nan]]), (0.5, 2.5), (0.0, 1.0), Label("speed", "v"), (-1.0, 1.0), True, "gone")
    line = Curve("line", np.array([1.0, 2.0]), np.array([0.5, 0.5]), look={"color": "white", "linestyle": "--"})
    return draw(Sheet("of a run", [[Panel(BEAD, SECONDS, (line,), image=image)]], 4.0))


SHEETS = {
    "lines": sheet_of_lines,
    "image": sheet_of_an_image,
    "one-line": lambda: draw(Sheet("of a run", [[replace(PANEL, curves=LINES[:1])]], 4.0)),
}

FIGURES = {**OF_RUNS, **COMPARED, **STUDIES, **SHEETS}
NARROW = [name for name in FIGURES if name.startswith(("steel", "losing"))]
NARROW += ["plastic-plastic", "residuals-si", "validation-si", "swept-si", "map-holes", "histogram"]


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * name.startswith(("losing", "nine"))) for name in FIGURES]
)
def test_a_figure_shows_what_its_table_says_and_no_text_of_it_is_cut_or_covered(name, golden):
    assert_shown(name, FIGURES[name], None, golden)


@pytest.mark.slow
@pytest.mark.parametrize("name", NARROW)
def test_no_text_of_a_figure_of_one_column_is_cut_or_covered(name, golden):
    assert_shown(name, FIGURES[name], 3.4, golden)


# --- numbers behind figures -------------------------------------------------------------------------------------------


def test_the_largest_pulses_are_shown_in_their_order_each_from_where_it_is_small_and_no_long_one():
    time = np.linspace(0.0, 200.0, 2001)
    bumps = [(30.0, 0.5), (60.0, 1.0), (100.0, 0.05), (140.0, 0.7), (180.0, 0.3)]
    found = pulses(time, sum(height * np.exp(-((time - peak) ** 2)) for peak, height in bumps))
    assert [peak for peak, _, _ in found] == pytest.approx([30.0, 60.0, 140.0])
    assert all(2.0 < peak - low < 8.0 and 2.0 < high - peak < 8.0 for peak, low, high in found)
    assert pulses(time, np.sin(0.01 * time)) == []
    plateau = 0.5 * (np.tanh(2.0 * (time - 20.0)) - np.tanh(2.0 * (time - 30.0)))
    low, high = passage(time, plateau, 20.0)  # to the end of a long one
    assert low < 19.0
    assert 31.0 < high < 40.0


@pytest.mark.parametrize(
    ("values", "log"),
    [
        ([1, 2, 4, 8], True),
        ([1, 2, 3, 4], False),
        ([0.05, 0.1, 0.2], True),
        ([0.2, np.nextafter(0.2, 1.0), 1.0], False),
        ([0, 0.1, 1], False),
        ([1, 1000], False),
    ],
)
def test_an_axis_is_logarithmic_where_values_are_spaced_by_factors_also_beside_equal_ones(values, log):
    assert logarithmic(values) == log


@pytest.mark.slow
def test_titles_tell_chains_coupling_gap_load_and_v(golden):
    kick, rows = {"velocity": 1.0}, {"stiffness": {"from": 0.1, "to": 0.2, "rows": [1, 20]}}
    steel = {"material": {"name": "steel", "radius": 5e-3}, "duration": 1e-4}
    scenes = [
        {},
        {"chains": 2, "coupling": {"stiffness": 0.1}, "gap": 0.5, "kick": {"velocity": 3.0}},
        {"precompression": {"force": 0.1}},
        {"gravity": 0.01, "walls": {"right": "rigid"}},
        {"precompression": {"force": 2.38}, **steel},
        {"chains": 3, "coupling": {"stiffness": 0.1, "rows": [5, 20]}},
        {"chains": 3, "coupling": rows},
        {"chains": 3, "coupling": {"stiffness": 0.1, "topology": "ring"}},
        {"chains": 3, "coupling": {"cubic": 0.1}},
        {"chains": 3, "coupling": {"force": "k*s/sqrt(1+(s/s0)^2)", "k": 0.1, "s0": 0.5}},
    ]
    titles = [title(of_keys(**{"beads": 20, "kick": kick, "duration": 5.0, **one})) for one in scenes]
    of_panels = [time_title("arrival", time, AxisUnit(1.0, "reduced")) for time in (21.0, 124.0, 1397.2)]  # four digits
    golden("titles", "\n".join([*titles, *of_panels]))


def test_what_lies_between_bands_is_shaded():
    x = np.array([1.0, 5.0, 9.0])
    bands = np.array([[6.0, 7.0], [0.0, 3.0], [2.0, 4.0]])
    axis = swept_figure(StudyAxis(Label("y"), x), StudyAxis(Label("x"), x), None, "", bands).axes[0]
    first, last = axis.get_xlim()
    shaded = [(patch.get_x(), patch.get_x() + patch.get_width()) for patch in axis.patches]
    np.testing.assert_allclose(shaded, [(4.0, 6.0), (7.0, last)])
    assert first < 1.0 < 9.0 < last


@pytest.mark.parametrize(("period", "largest"), [(2.7, 0.01), (40.0, 0.8)])
def test_oscillations_that_instants_do_not_resolve_are_drawn_as_means(period, largest):
    time = np.arange(400.0)
    values = 0.5 + 0.4 * np.sin(2.0 * np.pi * time / period)
    width = averages.oscillations_to_average(values, 1.0)
    assert np.ptp(averages.moving_mean(values, width)[50:350]) == pytest.approx(largest, abs=0.01)
    undefined = np.where(time == 200.0, np.nan, 0.5)
    assert np.nanmean(averages.moving_mean(undefined, width)) == pytest.approx(0.5, rel=1e-12)
    assert averages.half_width(time, width) == 0.5 * width


def test_a_map_shows_the_beads_that_move_and_as_many_around_or_all():
    velocity, beads = np.zeros((3, 1, 100)), np.arange(1, 101)
    velocity[1, 0, [39, 48]] = 1.0
    scale = spacetime.RootScale(1.0)
    assert scale.moving_part(velocity, beads, (0.5, 100.5)) == (34.5, 54.5)
    velocity[2, 0, 95] = 1.0
    assert scale.moving_part(velocity, beads, (0.5, 100.5)) == (0.5, 100.5)


def test_maps_of_a_lattice_stand_as_its_chains_do():
    lattice = {"chains": 6, "beads": 9, "coupling": {"stiffness": 0.1, "topology": {"lattice": [3, 2]}}}
    problem = of_keys(**lattice, kick={"velocity": 1.0}, duration=4.0)
    assert spacetime.panels(problem, 6) == spacetime.grid(problem) == (3, 2)
    assert spacetime.panels(problem, 3) == (1, 3)
