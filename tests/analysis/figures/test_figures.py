"""Figures of runs and of studies, each as a table of what it shows (folder `golden`), and the numbers behind them."""

import functools
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from figure_table import assert_shown
from small_problems import problem as small
from stock_lammps import scene
from synthetic_waves import of_keys, reference, surveyed

from analysis.compare.difference import Deviation, ErrorMap
from analysis.conservation import Account
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
    axis_unit,
    curves_of,
    title,
)
from analysis.figures.spacetime import HistoryMeter, space_time_meter, spacetime_sheet
from analysis.figures.studies import Sought, StudyAxis, histogram_figure, logarithmic, map_figure, swept_figure
from analysis.figures.waves import distance_sheet, passage, pulses, response_sheet, shape_sheet, time_title
from analysis.files.traces import Channel, Traces
from analysis.gauges.gauge import gauges
from analysis.shape.waveforms import Passages
from analysis.sharing.energies import Flow, ShareMeter
from analysis.sharing.equipartition import Sharing
from analysis.statistics import histogram, statistics
from analysis.tracking.leading_waves import with_speeds
from analysis.trajectory import Trajectory
from lammps_inputs import Kick, Material, physics
from lammps_inputs.units import Label, make_scale
from workflow.measures.budget import BudgetMeasurement
from workflow.measures.energy import EnergyMeasurement
from workflow.measures.forces.measurement import ForceMeasurement
from workflow.measures.forces.readings import Readings
from workflow.measures.plastic import PlasticMeasurement, YieldTable
from workflow.measures.spectra import SpectrumMeasurement, VelocitySpectra

STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)
CHAINS = 12
"""More than a figure shows, so that places and numbers of chains differ."""

# --- problems and motions ---------------------------------------------------------------------------------------------


def hit(si=False, chains=2, kicked=1, velocity=3.0, **changes):
    """Chains of ten beads; eight frames, 0.5 T apart."""
    options = {"chains": chains, "kick": (Kick(chain=kicked, velocity=velocity),), "material": STEEL if si else None}
    unit = scene(**options).scale.time
    return scene(**{"beads": 10, **options, "duration": 4.0 * unit, "every": 0.5 * unit, **changes}).problem()


def moving(problem, chain, bead, frame):
    """One bead of one chain moves, in one frame, with 0.5 V."""
    v = np.zeros((problem.frames + 1, problem.chains, problem.rows.count))
    v[frame, chain - 1, problem.rows.numbers.tolist().index(bead)] = 0.5
    return Trajectory(problem, np.arange(problem.frames + 1) * problem.every, np.zeros_like(v), v)


@functools.cache
def ran():
    """Two chains of 60 beads by the reference, and what is measured of them."""
    trajectory = reference(2, 0.1, 60, 80.0)
    return trajectory, surveyed(trajectory)


@functools.cache
def of_twenty():
    return reference(20, 0.2, 20, 5.0, kicks=[Kick(chain=14, velocity=1.0)])


def history(trajectory, beads, frames=None):
    return HistoryMeter(trajectory.problem, np.array(beads)).read([trajectory[:frames]])


def maps(trajectory, frames=None):
    return draw(spacetime_sheet(space_time_meter(trajectory.problem).read([trajectory[:frames]])))


def distances(problem, shared, direction=1):
    return draw(distance_sheet(problem, shared, ShareMeter(problem, shared).result([]), direction))


def distances_of(trajectory):
    found = surveyed(trajectory)
    return draw(distance_sheet(found.problem, found.shared, found.energies, found.direction))


# --- figures of a run -------------------------------------------------------------------------------------------------


def distances_in_si():
    """Peaks and arrivals at beads 2 to 5, all different; the lag is 0.25 T."""
    problem, bead = hit(si=True), np.arange(2, 6)
    arrival = np.stack([1.2 * bead, 1.2 * bead + 0.25], axis=1)
    amplitude = 0.4 + 0.01 * np.arange(8.0).reshape(4, 2)
    return distances(problem, Sharing(0, bead, arrival, amplitude, physics.energy(problem.system)), direction=-1)


def distances_that_agree():
    """Peaks are within 1 % from bead 62 on."""
    amplitude = np.full((80, 2), 0.3)
    amplitude[:60, 0] *= 1.0 + 0.05 * np.cos(np.arange(60))
    problem = hit(beads=100)
    shared = Sharing(0, np.arange(2, 82), np.zeros((80, 2)), amplitude, physics.energy(problem.system))
    assert shared.agrees_from(0.01) == 62
    return distances(problem, shared)


def response_in_si():
    problem = hit(si=True)
    waves = with_speeds(np.array([1]), np.array([8]), np.array([5 * problem.every]), np.array([0.5]))
    return draw(response_sheet(history(moving(problem, 2, 8, 5), (3, 8)), waves))


def shape_by_hand():
    """Velocity falls in time, from 0.3 to 0.1 in chain 1 and half of that in chain 2; peaks of 1, at t = 3."""
    both, ones = np.array([1, 2]), np.ones(2)
    passages = Passages(both, np.array([5, 5]), 3.0 * ones, ones, ones, np.ones(2, dtype=np.int64), *np.zeros((3, 2)))
    time, velocity = np.tile([2.0, 3.0, 4.0], (2, 1)), np.outer([1.0, 0.5], [0.3, 0.2, 0.1])
    waveforms = SimpleNamespace(passages=passages, time=time, velocity=velocity)
    return draw(shape_sheet(scene(chains=2, beads=10).problem(), waveforms, [5]))


RUNS = {
    "distance": lambda: distances_of(ran()[0]),
    "distance-si": distances_in_si,
    "distance-agreement": distances_that_agree,
    "distance-nine-chains": lambda: distances_of(reference(9, 0.2, 30, 40.0)),
    "response": lambda: draw(response_sheet(history(ran()[0], (50,)), ran()[1].waves)),
    "response-si": response_in_si,
    "response-cut": lambda: draw(response_sheet(history(ran()[0], (10, 50, 60), frames=200))),
    "response-twenty-chains": lambda: draw(response_sheet(history(of_twenty(), (1,)))),
    "spacetime": lambda: maps(reference(2, 0.1, 60, 110.0)),
    "spacetime-si": lambda: maps(moving(hit(si=True), 2, 10, 7)),
    "spacetime-few-beads": lambda: maps(moving(hit(beads=50, recorded=(1, 5, 50)), 1, 5, 3)),
    "spacetime-few-move": lambda: maps(moving(hit(beads=40), 1, 6, 2)),
    "spacetime-twenty-chains": lambda: maps(of_twenty()),
    "shape-by-hand": shape_by_hand,
}

# --- figures of measurements, with numbers made by hand ---------------------------------------------------------------


def many():
    return hit(si=True, chains=CHAINS, kicked=6, velocity=0.01)


def energy():
    number, later = np.arange(1.0, CHAINS + 1.0), np.array([[1.0], [2.0], [3.0]])
    flow = Flow(
        np.array([0.0, 1.0, 4.0]), later * number / 100.0, np.zeros(3), later * number, np.full((3, CHAINS), 0.5)
    )
    return draw(EnergyMeasurement(many(), flow).sheet())


def forces():
    """100 for each gauge and 1 for each chain, at the second instant."""
    problem = many()
    places = gauges(problem.system, contacts=(2, 7), sensors=(5,))
    force = np.add.outer(np.arange(1.0, CHAINS + 1.0), 100.0 * np.arange(1.0, 4.0))
    nothing = np.zeros(force.shape)
    rest = (*[nothing] * 7, nothing > 0.0, nothing)
    readings = Readings(places, np.array([0.0, 1.0]), np.stack([nothing, force]), nothing, force, *rest)
    return draw(ForceMeasurement(problem, [], readings).sheet())


def spectra():
    """Lines at 0 and 0.1, a drive at 0.07, and an amplitude of chain 3 that is below the axis."""
    amplitude = np.add.outer(np.array([0.2, 0.1]), np.add.outer(1e-3 * np.arange(CHAINS), np.array([0.3, 0.6])))
    amplitude[1, 2] = 1e-12
    of_drive, drive = np.zeros((1, CHAINS, 2)), np.array([0.07])
    found = VelocitySpectra((3, 8), 2.0, np.array([0.0, 0.1]), amplitude, drive, of_drive, 0.0 * amplitude, of_drive)
    return draw(SpectrumMeasurement(many(), None, found).sheet())


def budget(kinetic, time, problem=None, **others):
    nothing = np.zeros(len(time))
    stored = dict.fromkeys(("springs", "ground", "walls", "resonators"), nothing)
    stored |= {"kinetic": kinetic, "contacts": 1.0 - kinetic, "dissipated": {}, **others}
    supplied = stored.pop("supplied", np.ones(len(time)))
    account = Account(time, supplied, **stored, other_atoms=None, in_resonators_error=None)
    return draw(BudgetMeasurement(problem or small(), account).sheet())


def oscillating_budget(period):
    time = np.arange(400.0)
    return budget(0.5 + 0.4 * np.sin(2.0 * np.pi * time / period), time)


def plastic():
    """Contacts 39 and 40 have not begun to open; the law is 5 n^(-1/2)."""
    contact = np.arange(1, 41)
    force = 5.0 * contact**-0.5
    opened = (contact <= 38).astype(np.int64)
    force[38:] = 1e-3
    found = YieldTable(np.ones(40, dtype=np.int64), contact, force, force, 0.1 * force, opened, force)
    return draw(PlasticMeasurement(small(chains=1), None, found).sheet())


def residuals():
    """Data are twice the run at first; residuals are 0.5 and -1.5, and 0 and 4, in units of the noise."""
    problem = many()
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
    return validation_figure(many(), edges, deviations, limits, "reference")


MEASUREMENTS = {
    "energy-si": energy,
    "forces-si": forces,
    "spectra-si": spectra,
    "budget-resolved": lambda: oscillating_budget(40.0),
    "budget-mean": lambda: oscillating_budget(2.7),
    "plastic": plastic,
    "residuals-si": residuals,
    "validation-si": validation,
}


def layers_in_si():
    """0.3 - 0.02 t, 0.19, 0.01 and 0.02 t, which add up to 0.5."""
    time = np.linspace(0.0, 10.0, 5)
    held = {"contacts": np.full(5, 0.19), "walls": np.full(5, 0.01), "dissipated": {"contact_damping": 0.02 * time}}
    return budget(0.3 - 0.02 * time, time, hit(si=True), supplied=np.full(5, 0.5), **held)


MEASUREMENTS["budget-si"] = layers_in_si

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

FIGURES = {**RUNS, **MEASUREMENTS, **STUDIES, **SHEETS}
NARROW = ("distance-si", "distance-nine-chains", "response-si", "spacetime-twenty-chains", "shape-by-hand", "forces-si")
NARROW += ("spectra-si", "budget-si", "plastic", "residuals-si", "validation-si", "swept-si", "map-holes", "histogram")


@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_shows_what_its_table_says_and_no_text_of_it_is_cut_or_covered(name, golden):
    assert_shown(name, FIGURES[name], None, golden)


@pytest.mark.parametrize("name", NARROW)
def test_no_text_of_a_figure_of_one_column_is_cut_or_covered(name, golden):
    assert_shown(name, FIGURES[name], 3.4, golden)


# --- numbers behind figures -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("velocity", "symbol", "worth"), [(3.0, "m/s", 3.0), (5e-6, "\N{MICRO SIGN}m/s", 5.0), (1e-30, "pm/s", 1e-18)]
)
def test_units_have_the_prefix_that_leaves_one_to_three_digits(velocity, symbol, worth):
    unit = axis_unit(replace(small(), scale=make_scale(1.0, 1.0, velocity, si=True)), "velocity", 1.0)
    assert (unit.symbol, unit.worth) == (symbol, pytest.approx(worth))


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
