"""Which bead, chain and time is where in a figure, in which unit, under which label: numbers made by hand."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from axis_units import unit_on
from stock_lammps import scene
from synthetic_waves import of_keys

from analysis.compare.difference import Deviation, ErrorMap
from analysis.figures.drawing import draw
from analysis.figures.errors import BAD, GOOD, residual_figure, validation_figure
from analysis.figures.panels import shown_chains, title
from analysis.figures.spacetime import HistoryMeter, space_time_meter, spacetime_sheet
from analysis.figures.studies import logarithmic
from analysis.figures.style import CHAIN_COLOURS, head, new_figure
from analysis.figures.waves import distance_sheet, response_sheet, shape_sheet
from analysis.files.traces import Channel, Traces
from analysis.gauges.gauge import gauges
from analysis.shape.exact_wave import solitary_wave
from analysis.shape.waveforms import Passages
from analysis.sharing.energies import Flow, ShareMeter
from analysis.sharing.equipartition import Sharing
from analysis.tracking.leading_waves import with_speeds
from analysis.trajectory import Trajectory
from lammps_inputs import Kick, Material, physics
from workflow.measures.energy import EnergyMeasurement
from workflow.measures.forces.measurement import ForceMeasurement
from workflow.measures.forces.readings import Readings
from workflow.measures.spectra import SpectrumMeasurement, VelocitySpectra

STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)

CHAINS = 12
"""More than a figure shows, so that places and numbers of chains differ."""


@pytest.fixture(scope="module", params=[False, True], ids=["reduced", "SI"])
def problem(request):
    """Chains of ten beads, of which the sixth is hit."""
    kick = (Kick(chain=6, velocity=0.01),)
    material = STEEL if request.param else None
    unit = scene(chains=CHAINS, kick=kick, material=material).scale.time
    return scene(chains=CHAINS, beads=10, kick=kick, material=material, duration=4.0 * unit, every=0.5 * unit).problem()


def of_chains(axis):
    """Chain -> line of an axis, by its label."""
    lines = {line.get_label(): line for line in axis.get_lines()}
    return {int(name.removeprefix("chain ")): line for name, line in lines.items() if name.startswith("chain ")}


def all_shown(axis, problem):
    """The lines of an axis, of each chain that is shown, in the colours that chains have in every figure."""
    found = of_chains(axis)
    assert sorted(found) == [chain + 1 for chain in shown_chains(problem)] != list(range(1, 10))
    assert [line.get_color() for _, line in sorted(found.items())] == list(CHAIN_COLOURS)
    return found.items()


def test_the_energy_figure_has_the_share_centre_and_spread_of_each_chain(problem):
    time = np.array([0.0, 1.0, 4.0])
    number = np.arange(1.0, CHAINS + 1.0)
    later = np.array([[1.0], [2.0], [3.0]])
    flow = Flow(time, later * number / 100.0, np.zeros(3), later * number, np.full((3, CHAINS), 0.5))
    share, centre = draw(EnergyMeasurement(problem, flow).sheet()).axes
    assert share.get_ylabel() == "share of the energy"
    assert centre.get_ylabel().startswith("centre of the energy (bead)")
    seconds = unit_on(centre.get_xlabel(), problem, "s")
    for chain, line in all_shown(share, problem):
        assert line.get_ydata().tolist() == (later[:, 0] * chain / 100.0).tolist()
        assert line.get_xdata() * seconds == pytest.approx(time * problem.scale.time)
    bands = [band.get_paths()[0].get_extents() for band in centre.collections]
    for (chain, line), band in zip(all_shown(centre, problem), bands, strict=True):
        assert line.get_ydata().tolist() == (later[:, 0] * chain).tolist()
        assert (band.y0, band.y1) == (chain - 0.5, 3 * chain + 0.5)


def test_the_force_figure_has_each_gauge_and_chain_where_it_says(problem):
    places = gauges(problem.system, contacts=(2, 7), sensors=(5,))
    time = np.array([0.0, 1.0])
    force = np.add.outer(np.arange(1.0, CHAINS + 1.0), 100.0 * np.arange(1.0, 4.0))  # [chain, gauge]
    nothing = np.zeros(force.shape)
    rest = (*[nothing] * 7, nothing > 0.0, nothing)
    readings = Readings(places, time, np.stack([nothing, force]), nothing, force, *rest)
    axes = draw(ForceMeasurement(problem, [], readings).sheet()).axes
    assert [axis.get_title(loc="left") for axis in axes] == ["(a) contact 2", "(b) contact 7", "(c) sensor 5"]
    for gauge, axis in enumerate(axes, 1):
        newtons = unit_on(axis.figure.get_supylabel(), problem, "N")
        for chain, line in all_shown(axis, problem):
            assert line.get_ydata() * newtons == pytest.approx([0.0, (100 * gauge + chain) * problem.scale.force])
        largest = float(axis.get_title(loc="right").removeprefix("largest "))
        assert largest * newtons == pytest.approx((100 * gauge + CHAINS) * problem.scale.force, rel=1e-3)
        seconds = unit_on(axes[-1].get_xlabel(), problem, "s")
        assert line.get_xdata() * seconds == pytest.approx(time * problem.scale.time)


def test_the_spectra_figure_has_each_bead_chain_and_drive_where_it_says(problem):
    amplitude = np.add.outer(np.array([0.2, 0.1]), np.add.outer(1e-3 * np.arange(CHAINS), np.array([0.3, 0.6])))
    of_drive = np.zeros((1, CHAINS, 2))
    lines, drive = np.array([0.0, 0.1]), np.array([0.07])
    spectra = VelocitySpectra((3, 8), 2.0, lines, amplitude, drive, of_drive, 0.0 * amplitude, of_drive)
    axes = draw(SpectrumMeasurement(problem, None, spectra).sheet()).axes
    hertz = 1.0 / problem.scale.time / unit_on(axes[-1].get_xlabel(), problem, "Hz")
    label = axes[0].figure.get_supylabel()
    velocity = unit_on(label, problem, "m/s")
    assert label.startswith(r"velocity amplitude $\hat v$ (")
    for place, axis in enumerate(axes):
        assert axis.get_title(loc="left") == f"({'ab'[place]}) bead {spectra.beads[place]}"
        for chain, line in all_shown(axis, problem):
            expected = amplitude[:, chain - 1, place] * problem.scale.velocity
            assert line.get_ydata() * velocity == pytest.approx(expected)
            assert line.get_xdata() == pytest.approx(spectra.frequency * hertz)
        (drive,) = (line for line in axis.get_lines() if line.get_label() == "frequency of the drive")
        assert drive.get_xdata()[0] == pytest.approx(0.07 * hertz)


def test_amplitudes_below_the_axis_of_a_spectrum_are_not_drawn_at_its_end(problem):
    amplitude = np.full((3, CHAINS, 1), 0.5)
    amplitude[1:] = 1e-12
    no_drive = np.empty(0), np.zeros((1, CHAINS, 1))
    spectra = VelocitySpectra((3,), 2.0, np.arange(3.0), amplitude, *no_drive, 0.0 * amplitude, no_drive[1])
    (axis,) = draw(SpectrumMeasurement(problem, None, spectra).sheet()).axes
    for _, line in all_shown(axis, problem):
        assert np.all(line.get_ydata()[1:] < axis.get_ylim()[0])


def test_what_is_left_of_a_trace_is_data_minus_run_in_units_of_the_noise(problem):
    scale, time = problem.scale, np.array([0.0, 1.0])
    channels = (Channel("contact", 3, 2), Channel("velocity", 1, 5))
    unit = np.array([scale.force, scale.velocity])
    given = Traces(time * scale.time, channels, np.array([[2.0, 20.0], [4.0, 50.0]]) * unit, scale.si)
    found = np.array([[1.0, 20.0], [7.0, 10.0]]) * unit
    figure = residual_figure(problem, given, found, np.array([2.0, 10.0]) * unit)
    assert figure.get_suptitle().replace("\n", " ").startswith(title(problem).replace("\n", " "))
    traces, left, *others = figure.axes
    assert traces.get_title(loc="left") == "(a) force contact 2 chain 3"
    assert traces.get_ylabel().startswith("force (")
    figure.draw_without_rendering()
    ends = [axis.yaxis.label.get_window_extent() for axis in figure.axes]  # each above the next
    assert all(label.y0 > below.y1 for label, below in itertools.pairwise(ends))
    data, run = (
        next(line for line in traces.get_lines() if line.get_label() == name).get_ydata() for name in ("data", "run")
    )
    assert data[0] / run[0] == pytest.approx(2.0)
    assert left.get_lines()[0].get_ydata() == pytest.approx([0.5, -1.5])
    assert others[1].get_lines()[0].get_ydata() == pytest.approx([0.0, 4.0])


def test_a_validation_of_few_beads_has_a_column_of_one_width_for_each(problem):
    error = np.array([[1e-3, 2e-3, 3e-3]])
    found = ErrorMap(np.array([0.0, 4.0]), np.array([10, 50, 95, 96]), error)
    space = validation_figure(problem, found, {"velocity": Deviation(3e-3, 1e-4)}, {"velocity": 1e-2}, "mine").axes[0]
    corners = space.collections[0].get_coordinates()[0, :, 0]
    np.testing.assert_array_equal(np.diff(corners), 1.0)
    named = dict(zip((label.get_text() for label in space.get_xticklabels()), space.get_xticks(), strict=True))
    assert named == {"10": 0.0, "50": 1.0, "95": 2.0}


def test_a_validation_shows_each_error_at_its_bead_and_as_a_share_of_its_tolerance(problem):
    error = np.zeros((2, 10))
    error[1, 6] = 1e-3  # bead 7, in the second half
    edges = ErrorMap(np.array([0.0, 2.0, 4.0]), np.arange(1, 12), error)
    deviations = {"velocity": Deviation(1e-3, 1e-4), "arrival": Deviation(4e-3, 1e-4)}
    figure = validation_figure(problem, edges, deviations, {"velocity": 5e-4, "arrival": 1e-2}, "reference")
    space, shares = figure.axes[:2]
    (mesh,) = space.collections
    corners = mesh.get_coordinates()
    row, column = np.unravel_index(np.argmax(mesh.get_array()), (2, 10))
    assert corners[row, column : column + 2, 0].mean() == 7.0
    seconds = unit_on(space.get_ylabel(), problem, "s")
    np.testing.assert_allclose(corners[row : row + 2, column, 1] * seconds, np.array([2.0, 4.0]) * problem.scale.time)
    names = [name.get_text() for name in shares.get_yticklabels()]
    points = {
        names[int(point.get_ydata()[0])]: point for point in shares.get_lines() if point.get_marker() in ("o", "X")
    }
    assert points["velocity"].get_xdata() == pytest.approx([2.0])
    assert points["arrival"].get_xdata() == pytest.approx([0.4])
    assert {name: point.get_color() for name, point in points.items()} == {"velocity": BAD, "arrival": GOOD}


def test_samples_from_before_the_peak_are_drawn_ahead_of_it():
    """Velocity falls in time, from 0.3 to 0.1 in chain 1 and half of that in chain 2; peaks of 1, at t = 3."""
    what = scene(chains=2, beads=10)
    both = np.array([1, 2])
    ones = np.ones(2)
    passages = Passages(both, np.array([5, 5]), 3.0 * ones, ones, ones, np.ones(2, dtype=np.int64), *np.zeros((3, 2)))
    time, velocity = np.tile([2.0, 3.0, 4.0], (2, 1)), np.outer([1.0, 0.5], [0.3, 0.2, 0.1])
    waveforms = SimpleNamespace(passages=passages, time=time, velocity=velocity)
    above, below = draw(shape_sheet(what.problem(), waveforms, [5])).axes
    assert above.get_title(loc="left") == "bead 5"
    for chain, line in of_chains(above).items():
        ahead, velocity = line.get_data()
        assert np.array(ahead) == pytest.approx(solitary_wave().speed_at(1.0) * np.array([1.0, 0.0, -1.0]))
        assert velocity == pytest.approx(np.array([0.3, 0.2, 0.1]) / chain)
    assert of_chains(below)[1].get_ydata()[1] == pytest.approx(0.2 - 1.0)


# --- places -----------------------------------------------------------------------------------------------------------


SPEED = 3.0


def pair(si, **changes):
    """Two chains of ten beads; frames 0.5 T apart."""
    options = {"chains": 2, "beads": 10, "kick": (Kick(velocity=SPEED),)}
    material = STEEL if si else None
    unit = scene(kick=(Kick(velocity=SPEED),), material=material).scale.time
    return scene(**{**options, "material": material, "duration": 4.0 * unit, "every": 0.5 * unit, **changes}).problem()


def moving(what, chain, bead, frame, velocity=0.5):
    """One bead of one chain moves, in one frame."""
    v = np.zeros((what.frames + 1, what.chains, what.beads))
    v[frame, chain - 1, bead - 1] = velocity
    return Trajectory(what, np.arange(what.frames + 1) * what.every, np.zeros_like(v), v)


def panel(figure, chain):
    """The image of a chain."""
    several = len([axis for axis in figure.axes if axis.get_images()]) > 1
    title = f"({'ab'[chain - 1]}) chain {chain}" if several else ""
    (axis,) = (axis for axis in figure.axes if axis.get_images() and axis.get_title(loc="left") == title)
    (image,) = axis.get_images()
    return axis, image


@pytest.mark.parametrize("si", [False, True])
@pytest.mark.parametrize(("chain", "bead", "frame"), [(1, 1, 2), (1, 7, 5), (2, 10, 8), (2, 2, 0)])
def test_a_bead_that_moves_is_seen_where_and_when_it_does(chain, bead, frame, si):
    what = pair(si)
    data = space_time_meter(what).read([moving(what, chain, bead, frame)])
    figure = draw(spacetime_sheet(data))
    axis, image = panel(figure, chain)
    values = np.ma.filled(image.get_array(), 0.0)
    rows, columns = values.shape
    left, right, bottom, top = image.get_extent()
    (row,), (column,) = np.nonzero(values)
    assert left + (column + 0.5) * (right - left) / columns == pytest.approx(bead)
    assert axis.get_xlabel() == "bead"
    seen = (bottom + (row + 0.5) * (top - bottom) / rows) * unit_on(figure.axes[0].get_ylabel(), what, "s")
    assert seen == pytest.approx(frame * what.every * what.scale.time, abs=0.51 * what.every * what.scale.time)
    bar, scale = figure.axes[-1].get_ylabel().split("; ")
    assert scale == "colour: signed square root"
    assert values[row, column] * unit_on(bar, what, "m/s") == pytest.approx(0.5 * SPEED)
    assert not np.any(np.ma.filled(panel(figure, 3 - chain)[1].get_array(), 0.0))


@pytest.mark.parametrize("bead", [1, 5, 50])
def test_of_a_few_recorded_beads_each_is_seen_at_its_place(bead):
    what = pair(False, beads=50, recorded=(1, 5, 50))
    v = np.zeros((what.frames + 1, 2, 3))
    v[3, 0, (1, 5, 50).index(bead)] = 0.5
    data = space_time_meter(what).read([Trajectory(what, np.arange(what.frames + 1) * what.every, np.zeros_like(v), v)])
    axis, image = panel(draw(spacetime_sheet(data)), 1)
    values = np.ma.filled(image.get_array(), 0.0)
    left, right, *_ = image.get_extent()
    (column,) = np.nonzero(values[3])[0]
    place = left + (column + 0.5) * (right - left) / values.shape[1]
    named = {text.get_position()[0]: text.get_text() for text in axis.get_xticklabels()}
    assert named[place] == str(bead)
    assert axis.get_xlabel() == "recorded bead"


@pytest.mark.parametrize("si", [False, True])
@pytest.mark.parametrize(("chain", "bead", "frame"), [(1, 3, 2), (2, 8, 5)])
def test_the_response_is_that_of_the_bead_and_chain_it_names(chain, bead, frame, si):
    what = pair(si)
    data = HistoryMeter(what, np.array([3, 8])).read([moving(what, chain, bead, frame)])
    arrival = np.array([frame * what.every])
    waves = with_speeds(np.array([1]), np.array([bead]), arrival, np.array([0.5]))
    whole, near = draw(response_sheet(data, waves)).axes  # of the other bead, which has not moved, there is none
    assert whole.get_title(loc="left") == f"(a) bead {bead}"
    velocities = unit_on(whole.get_ylabel(), what, "m/s")
    for axis, when in ((whole, frame * what.every * what.scale.time), (near, 0.0)):
        times = unit_on(axis.get_xlabel(), what, "s")
        for line in axis.get_lines():
            right = line.get_label() == f"chain {chain}"
            (peak,) = np.nonzero(line.get_ydata())
            assert len(peak) == right
            if right:
                assert line.get_ydata()[peak[0]] * velocities == pytest.approx(0.5 * SPEED)
                assert line.get_xdata()[peak[0]] * times == pytest.approx(when)


def test_the_response_is_that_of_the_bead_it_names_also_where_a_window_has_moved_on():
    what = pair(False, beads=100, window=64)
    blocks = []
    for first, frame in ((1, 0), (30, 1)):
        v = np.tile(np.arange(first, first + 64) / 100.0, (1, 2, 1))
        blocks.append(Trajectory(what, np.array([frame * what.every]), np.zeros_like(v), v, first=first))
    data = HistoryMeter(what, np.array([20, 40, 95])).read(blocks)
    np.testing.assert_array_equal(data.velocity, np.tile([[[0.2, 0.4, 0.0]], [[np.nan, 0.4, 0.0]]], (1, 2, 1)))


def shared(what):
    """Two chains at beads 2 to 5, all different."""
    bead = np.arange(2, 6)
    amplitude = 0.4 + 0.01 * np.arange(8.0).reshape(4, 2)
    return Sharing(0, bead, np.stack([1.2 * bead, 1.2 * bead + 0.25], axis=1), amplitude, physics.energy(what.system))


@pytest.mark.parametrize("si", [False, True])
def test_the_distance_figure_has_each_chain_at_its_beads_in_its_units(si):
    what = pair(si)
    amplitude, _, lag = draw(distance_sheet(what, shared(what), ShareMeter(what, shared(what)).result([]))).axes
    assert amplitude.get_ylabel() == r"peak velocity $v_\mathrm{max} / V$"
    for chain in (1, 2):
        (line,) = (line for line in amplitude.get_lines() if line.get_label() == f"chain {chain}")
        assert line.get_xdata().tolist() == [2.0, 3.0, 4.0, 5.0]
        assert line.get_ydata() == pytest.approx(shared(what).amplitude[:, chain - 1])
    (late,) = (line for line in lag.get_lines() if line.get_label() == "chain 2")
    seconds = late.get_ydata() * unit_on(lag.get_ylabel(), what, "s")
    assert seconds == pytest.approx(0.25 * what.scale.time)
    assert "lag behind\nchain 1" in lag.get_ylabel()


def test_lines_are_interrupted_at_recorded_beads_where_no_pulse_leads():
    what = pair(False, chains=1, kappa=0.0, beads=40)
    bead = np.array([*range(2, 20), *range(25, 28), 30, *range(33, 36)])
    one = np.ones((len(bead), 1))
    sharing = Sharing(0, bead, bead[:, np.newaxis] * one, 0.4 * one, physics.energy(what.system))
    amplitude = draw(distance_sheet(what, sharing, ShareMeter(what, sharing).result([]))).axes[0]
    line, dots = amplitude.get_lines()
    x, y = line.get_data()
    assert np.flatnonzero(np.isnan(y)).tolist() == [18, 22, 24]
    assert x[np.isfinite(y)].tolist() == bead.tolist()
    assert dots.get_xdata().tolist() == [30.0]  # no line leads to it


def test_a_line_marks_the_bead_from_which_on_the_chains_agree():
    amplitude = np.full((80, 2), 0.3)
    amplitude[:60, 0] *= 1.0 + 0.05 * np.cos(np.arange(60))
    what = pair(False, beads=100)
    agreeing = Sharing(0, np.arange(2, 82), np.zeros((80, 2)), amplitude, physics.energy(what.system))
    axis = draw(distance_sheet(what, agreeing, ShareMeter(what, agreeing).result([]))).axes[0]
    (mark,) = (line for line in axis.get_lines() if not line.get_label().startswith("chain"))
    assert set(mark.get_xdata()) == {agreeing.agrees_from(0.01)}
    assert axis.get_title(loc="right") == f"within 1 % from bead {agreeing.agrees_from(0.01)} on"


@pytest.mark.parametrize(("direction", "label"), [(1, "bead"), (-1, "bead, counted from bead 10")])
def test_beads_are_counted_from_the_end_that_was_hit(direction, label):
    what = pair(False)
    figure = draw(distance_sheet(what, shared(what), ShareMeter(what, shared(what)).result([]), direction))
    assert figure.axes[2].get_xlabel() == label


def test_the_title_tells_name_chains_coupling_gap_and_v():
    what = pair(False, kappa=0.25 * SPEED**0.4, gap=0.5 * SPEED**0.8)
    data = space_time_meter(what).read([moving(what, 1, 1, 0)])
    # kappa at V = 1, the gap as in the scene
    gap = f"{0.5 * SPEED**0.8:.4g}"
    written = f"test: 2 chains of 10 beads, $\\kappa = k T^2 / m$ = 0.25, gap {gap}, $V$ = {SPEED:g}"
    assert " ".join(draw(spacetime_sheet(data)).get_suptitle().split()) == written


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"precompression": {"force": 0.1}}, "static load 0.1, $V$ = 1"),
        ({"gravity": 0.01, "walls": {"right": "rigid"}}, "static load 0.01 to 0.09, $V$ = 1"),
        (
            {"material": {"name": "steel", "radius": 5e-3}, "precompression": {"force": 2.38}},
            "load 2.38 N, $V$ = 1 m/s",
        ),
        ({}, "test: 1 chain of 10 beads, $V$ = 1"),
    ],
)
def test_the_title_tells_the_static_load(keys, words):
    duration = 1e-4 if "material" in keys else 5.0
    assert title(of_keys(beads=10, kick={"velocity": 1.0}, duration=duration, **keys)).endswith(words)


@pytest.mark.parametrize("width", [3.2, 6.5])
def test_a_long_title_is_wrapped_between_its_formulas(width):
    figure = new_figure(3.0, width)
    head(
        figure,
        "a-name-of-a-scene: 2 chains of 120 beads, $\\kappa = k T^2 / m$ = 0.25, static load 2.38 N, $V$ = 1 m/s",
    )
    lines = figure.get_suptitle().splitlines()
    assert len(lines) >= 2
    assert all(line.count("$") % 2 == 0 and len(line) <= 13 * width for line in lines)


def coupled(chains, beads=20, **coupling):
    plain = {"chains": chains, "beads": beads, "kick": {"velocity": 1.0}, "duration": 5.0}
    return of_keys(**{**plain, "coupling": coupling})


@pytest.mark.parametrize(
    ("coupling", "words"),
    [
        ({"stiffness": 0.1, "rows": [5, 20]}, "= 0.1 in rows 5 to 20"),
        ({"stiffness": {"from": 0.1, "to": 0.2, "rows": [1, 20]}}, "= 0.1 to 0.2"),
        ({"stiffness": 0.1, "topology": "ring"}, "= 0.1, ring"),
        ({"cubic": 0.1}, "= 0 and cubic"),
        ({"force": "k*s/sqrt(1+(s/s0)^2)", "k": 0.1, "s0": 0.5}, "= 0.1, nonlinear"),
    ],
)
def test_the_title_tells_where_springs_are_and_of_which_kind(coupling, words):
    assert title(coupled(3, **coupling)) == f"test: 3 chains of 20 beads, $\\kappa$ {words}, $V$ = 1"


def test_lattices_have_a_panel_for_each_chain_and_lines_for_those_far_from_each_other():
    lattice = coupled(16, stiffness=0.1, topology={"lattice": [4, 4]})
    assert shown_chains(lattice, panels=True) == list(range(16))
    corners = {0, 3, 12, 15}
    assert len(shown_chains(lattice)) == 9
    assert corners <= set(shown_chains(lattice))


def test_where_few_beads_move_the_picture_shows_those():
    what = pair(False, beads=40)
    data = space_time_meter(what).read([moving(what, 1, 6, 2)])
    assert draw(spacetime_sheet(data)).axes[0].get_xlim() == (5.5, 6.5)


@pytest.mark.parametrize(
    ("values", "by_factors"), [([1, 2, 4, 8], True), ([1, 2, 3, 4], False), ([0.2, np.nextafter(0.2, 1.0), 1.0], False)]
)
def test_an_axis_is_logarithmic_where_values_are_spaced_by_factors_also_beside_equal_ones(values, by_factors):
    assert logarithmic(values) == by_factors
