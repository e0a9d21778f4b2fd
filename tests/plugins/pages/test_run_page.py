"""What a page of a run holds, without a browser: hand-made frames, in the page's units."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from axis_units import unit_on
from bokeh.models import ColorBar, Div, GridPlot, HoverTool, LinearColorMapper, Range1d, Span
from bokeh.plotting import figure
from stock_lammps import scene

from analysis import motion
from analysis.tracking.leading_waves import with_speeds
from analysis.trajectory import Trajectory
from lammps_inputs import Kick, Material, Output
from lammps_inputs.ingredients.foundation import Foundation
from lammps_inputs.ingredients.unequal import BeadKind, radii
from lammps_inputs.laws.in_time import half_sine
from lammps_inputs.loads import Load
from workflow.measures.forces.measurement import ForceMeasurement
from workflow.measures.forces.readings import Readings
from workflow.plugins.pages import moving, plots, run_page
from workflow.plugins.pages.downsample import thinned, units_of
from workflow.plugins.pages.write import _left_out

STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)


def hit(chains=2, duration=4.0, kappa=0.1, material=None, **changes):
    """A problem of chains of six beads, hit with 0.5 (m/s); duration and coupling in units of T and of the contacts."""
    kick = (Kick(velocity=0.5),)
    unit = scene(chains=chains, kick=kick, material=material).scale
    coupling = {"kappa": kappa * unit.stiffness} if chains > 1 else {}
    options = {"beads": 6, "material": material, "duration": duration * unit.time, **coupling, **changes}
    return scene(chains=chains, kick=kick, **options).problem()


@pytest.fixture(scope="module", params=[None, STEEL], ids=["reduced", "SI"])
def held(request):
    """A problem of three chains, a run in which each number is another, and what a page holds of chains 1 and 3."""
    problem = hit(chains=3, material=request.param)
    shape = (problem.frames + 1, 3, 6)
    displacement = 0.1 * np.cos(np.arange(np.prod(shape))).reshape(shape)
    time = np.arange(problem.frames + 1) * problem.every
    run = Trajectory(problem, time, displacement, 1.0 + np.arange(np.prod(shape)).reshape(shape))
    part = thinned(problem, [run[:7], run[7:]], [0, 2])
    units = units_of(problem, part)
    return problem, run, part.measured(units), units


def test_every_number_is_the_runs_in_the_units_of_its_figures(held):
    problem, run, part, units = held
    overlap = np.maximum(motion.overlaps(problem.system, run.displacement), 0.0)
    assert (overlap == 0.0).any()
    scale = SimpleNamespace(**{name: unit.worth for name, unit in units.items()})
    if problem.scale.si:
        assert units["time"].symbol == "\N{MICRO SIGN}s"
        assert scale.time == pytest.approx(1e6 * problem.scale.time)
    else:
        assert {unit.symbol for unit in units.values()} == {"reduced"}
    assert part.chains == [1, 3]
    np.testing.assert_allclose(part.time, run.time * scale.time)
    for place, chain in enumerate((0, 2)):
        np.testing.assert_allclose(part.displacement[place], run.displacement[:, chain] * scale.length)
        np.testing.assert_allclose(part.velocity[place], run.velocity[:, chain] * scale.velocity)
        np.testing.assert_allclose(part.overlap[place][:, :-1], overlap[:, chain] * scale.length)
        force = overlap[:, chain] ** 1.5
        np.testing.assert_allclose(part.force[place][:, :-1], force * scale.force, atol=1e-12 * scale.force)
        own = motion.bead_energy(problem.system, run.displacement, run.velocity)[:, chain].sum(axis=-1)
        np.testing.assert_allclose(part.energy[place], own * scale.energy)


def found(waves):
    """What a survey found, where chains are compared by peak velocities."""
    shared = SimpleNamespace(of_impulses=False, final=None)
    shared.followed = shared
    return SimpleNamespace(waves=waves, shared=shared, decay=None, exact_speed=None)


def test_lines_over_beads_break_at_recorded_beads_without_a_wave_and_show_those_that_stand_alone(held):
    problem, _, part, units = held
    bead = np.array([1, 2, 4, 6])
    waves = with_speeds(np.ones(4, dtype=int), bead, 1.2 * bead, 0.1 * bead)
    (peaks,) = run_page.distances(problem, part, found(waves), Range1d(0, 7), units)
    line, points = peaks.renderers
    np.testing.assert_array_equal(line.data_source.data["x"], [1.0, 2.0, np.nan, 4.0, np.nan, 6.0])
    worth = units["velocity"].worth
    expected = worth * np.array([0.1, 0.2, np.nan, 0.4, np.nan, 0.6])
    np.testing.assert_allclose(line.data_source.data["y"], expected)
    assert list(points.data_source.data["x"]) == [4, 6]
    np.testing.assert_allclose(points.data_source.data["y"], [0.4 * worth, 0.6 * worth])


def test_the_arrival_after_that_in_the_first_chain_is_positive_where_a_chain_is_later(held):
    problem, _, part, units = held
    chain, bead = np.repeat([1, 3], 3), np.tile([2, 3, 4], 2)
    waves = with_speeds(chain, bead, 1.2 * bead + 0.3 * (chain == 3), 0.1 * chain + 0.01 * bead)
    peaks, lags = run_page.distances(problem, part, found(waves), Range1d(0, 6), units)
    for plot, expected in (
        (peaks, {"chain 1": 0.1 + 0.01 * bead[:3], "chain 3": 0.3 + 0.01 * bead[:3]}),
        (lags, {"chain 1": np.zeros(3), "chain 3": np.full(3, 0.3)}),
    ):
        lines = dict(zip((item.label.value for item in plot.legend[0].items), plot.renderers, strict=True))
        for name, values in expected.items():
            glyph, data = lines[name].glyph, lines[name].data_source.data
            assert list(data[glyph.x]) == [2, 3, 4]
            worth = units["velocity" if plot is peaks else "time"].worth
            np.testing.assert_allclose(data[glyph.y], values * worth, atol=1e-12)


def test_the_line_of_peak_velocities_ends_where_another_pulse_leads(held):
    problem, _, part, units = held
    bead, pulse = np.array([2, 3, 4]), np.array([1, 1, 2])
    waves = with_speeds(np.ones(3, dtype=int), bead, 1.2 * bead, 0.1 * bead, pulse)
    (peaks,) = run_page.distances(problem, part, found(waves), Range1d(0, 6), units)
    line, alone = peaks.renderers
    np.testing.assert_array_equal(line.data_source.data["x"], [2.0, 3.0, 3.5, 4.0])
    assert np.isnan(line.data_source.data["y"]).tolist() == [False, False, True, False]
    assert alone.data_source.data["x"].tolist() == [4.0]


def test_axes_cursors_and_bars_have_the_unit_of_what_they_show(held):
    problem, run, _, units = held
    waves = with_speeds(np.repeat([1, 3], 3), np.tile([2, 3, 4], 2), np.arange(6.0), np.full(6, 0.1))
    root = run_page.layout(problem, thinned(problem, [run], [0, 2]), found(waves), [1, 3])

    def unit(name):
        return f" {units[name].symbol}" if problem.scale.si else ""

    def axis(name):
        symbols = {"time": "t", "velocity": "v", "energy": "U"}
        return f"{name} {symbols[name]} ({units[name].symbol if problem.scale.si else 'reduced'})"

    assert len({unit(name) for name in units}) == (5 if problem.scale.si else 1)
    labels = {plot.title.text: (plot.xaxis.axis_label, plot.yaxis.axis_label) for plot in root.select({"type": figure})}
    assert {title: label for title, label in labels.items() if title} == {
        "chain 1": ("bead", axis("time")),
        "chain 3": ("bead", axis("time")),
        "velocity over time": (axis("time"), axis("velocity")),
        "peak velocity of the leading pulse": ("bead", axis("velocity")),
        "arrival after that in chain 1": ("bead", axis("time")),
        "energy of each chain, without coupling": (axis("time"), axis("energy")),
    }
    said = {}
    for tool in root.select({"type": HoverTool}):
        for word, value in tool.tooltips:
            told = tool.formatters.get(value.removesuffix("{custom}"))
            said[word] = told and told.args.get("unit")
    assert not said.pop("bead")
    assert said == {
        "chain": None,
        "energy": unit("energy"),
        "time": unit("time"),
        "velocity": unit("velocity"),
        **{word: unit("length") for word in ("displacement", "overlap with the next")},
        "force on the next": unit("force"),
        "energy of the bead": unit("energy"),
    }
    assert [bar.title for bar in root.select({"type": ColorBar})] == [axis("velocity")]
    assert root.select_one({"name": "time"}).format.args["unit"] == unit("time")


def test_springs_are_drawn_between_chains_that_are_tied(held):
    problem, _, part, units = held
    images = [plots.image_source(part, place) for place in range(2)]
    both = thinned(problem, [Trajectory(problem, *(np.zeros(s) for s in ((1,), (1, 3, 6), (1, 3, 6))))], [1, 2])
    for kept, springs in ((part, []), (both, [[0, 1]])):  # chains 1 and 3 are tied to chain 2 only
        colours = LinearColorMapper(palette=["#000"], low=-1.0, high=1.0)
        plot, _ = moving.moving_beads(problem, kept, images, [Span()], colours, units, np.ones((2, 6)))
        (move,) = (code for codes in plot.js_property_callbacks.values() for code in codes if "springs" in code.args)
        assert move.args["springs"] == springs


def made(problem, *, rows=None):
    """Frames of a problem in which beads swing fast, and each bead as far as no other."""
    shape = (problem.frames + 1, problem.chains, rows or problem.rows.count)
    number = np.arange(np.prod(shape)).reshape(shape)
    time = np.arange(problem.frames + 1) * problem.every
    return Trajectory(problem, time, np.zeros(shape), number % 7 * np.cos(2.0 * number))


@pytest.mark.parametrize("stride", [4, 7])
def test_thinning_in_time_keeps_the_velocity_of_largest_size_around_each_frame(stride):
    problem = hit(duration=4.8)
    run, frames = made(problem), problem.frames + 1
    blocks = [run[:3], run[3:4], run[4:17], run[17:]]
    part = thinned(problem, blocks, [1], most_numbers=-(-frames * 6 // stride))
    assert part.frame_stride == stride
    assert np.array_equal(part.time, run.time[::stride])
    last = len(part.time) - 1
    nearest = np.minimum((np.arange(frames) + stride // 2) // stride, last)
    for place in range(last + 1):
        around = run.velocity[nearest == place, 1]
        largest = np.take_along_axis(around, np.abs(around).argmax(axis=0)[None], axis=0)[0]
        assert np.array_equal(part.velocity[0, place], largest)


def test_what_a_window_has_left_does_not_make_frames_fewer():
    problem = hit(beads=600, duration=3.0, window=64)
    run = replace(made(problem, rows=64), first=301)
    part = thinned(problem, [run], [0, 1], most_numbers=(problem.frames + 1) * 2 * 64)
    assert (part.bead_stride, part.frame_stride) == (2, 1)
    assert np.isnan(part.velocity[:, :, :150]).all()
    assert np.array_equal(part.velocity[0, :, 150:182], run.velocity[:, 0, ::2])


def words(problem, part):
    """What a page says of how beads and forces are drawn."""
    units = units_of(problem, part)
    part, colours = part.measured(units), LinearColorMapper(palette=["#000"], low=-1.0, high=1.0)
    images = [plots.image_source(part, place) for place in range(2)]
    _, controls = moving.moving_beads(problem, part, images, [], colours, units, np.ones((2, 6)))
    return " ".join(div.text for div in controls.select({"type": Div}))


def test_forces_of_rounding_and_of_rigid_beads_have_no_bars():
    problem = hit(duration=2.0)
    rounding = np.zeros((problem.frames + 1, 2, 6))
    rounding[:, :, 0] = 1e-12
    frames = replace(made(problem), displacement=rounding)
    part = thinned(problem, [frames], [0, 1])
    assert 0.0 < np.nanmax(part.force) < 1e-17
    assert "contact forces" not in words(problem, part)
    assert np.isnan(thinned(problem, [frames], [0, 1], deforms=False).force).all()
    closed = thinned(problem, [replace(frames, displacement=0.5 + 1e12 * rounding)], [0, 1])
    assert f"contact forces, the highest {problem.scale.force:.3g}." in words(problem, closed)


@pytest.fixture(scope="module")
def lattice():
    """A page of nine chains that stand in a square."""
    problem = hit(chains=9, duration=2.0, coupling={"stiffness": 0.1, "topology": {"lattice": [3, 3]}})
    return problem, run_page.layout(problem, thinned(problem, [made(problem)], list(range(9))), None, [1, 3])


def test_maps_of_a_lattice_stand_as_its_chains_do(lattice):
    _, root = lattice
    (grid,) = root.select({"type": GridPlot})
    places = {plot.title.text: (row, column) for plot, row, column in grid.children}
    assert places == {f"chain {3 * row + column + 1}": (row, column) for row in range(3) for column in range(3)}


def test_nine_chains_differ_in_dashes(lattice):
    _, root = lattice
    (energy,) = root.select({"name": "energy"})
    assert len({tuple(line.glyph.line_dash) for line in energy.renderers}) == 9


def test_plots_over_time_and_maps_mark_the_time_and_end_where_the_run_does(lattice):
    problem, root = lattice
    (grid,) = root.select({"type": GridPlot})
    plots = list(root.select({"type": figure}))
    maps = [plot for plot, _, _ in grid.children]
    (move,) = (
        code for plot in plots for codes in plot.js_property_callbacks.values() for code in codes if "now" in code.args
    )
    over_time = [plot for plot in plots if plot.name in ("velocity", "energy")]
    assert len(over_time) == 2
    for plot, dimension in [*((one, "width") for one in maps), *((one, "height") for one in over_time)]:
        spans = [span for span in plot.center if isinstance(span, Span)]
        assert {span.dimension for span in spans} == {dimension}
        assert all(span in move.args["now"] for span in spans)
        time_range = plot.y_range if plot in maps else plot.x_range
        half, end = (time * problem.scale.time for time in (0.5 * problem.every, problem.duration))
        assert time_range.bounds == pytest.approx((-half, end + half))
    assert maps[0].x_range.bounds == (0.5, 6.5)
    assert all(plot.toolbar.active_scroll in (None, "auto") for plot in plots)


def test_axes_of_beads_have_ticks_at_whole_numbers_only(lattice):
    _, root = lattice
    for plot in root.select({"type": figure}):
        if plot.xaxis[0].axis_label == "bead":
            assert (plot.xaxis[0].ticker.min_interval, plot.xaxis[0].ticker.num_minor_ticks) == (1, 0)


@pytest.mark.parametrize("material", [None, STEEL], ids=["reduced", "SI"])
def test_a_page_says_how_far_apart_frames_are_that_cannot_follow_a_pulse(material):
    problem = hit(duration=4.8, material=material)
    for stride, said in ((1, False), (3, False), (8, True)):
        part = thinned(problem, [made(problem)], [0, 1], most_numbers=-(-(problem.frames + 1) * 12 // stride))
        told, apart = " ".join(_left_out(problem, part)), part.frame_stride * problem.every
        distance = f"{apart:.3g} T" if material is None else f"{apart * problem.scale.time * 1e6:.3g} \N{MICRO SIGN}s"
        assert f"{distance} apart, too far" in told or not said
        assert ("too far" in told) == said
        assert ("largest in size" in told) == (stride > 1)


@pytest.mark.parametrize(("beads", "even"), [((1, 3, 5), True), ((1, 2, 6), False)])
def test_the_middle_of_a_pixel_is_its_time_and_its_recorded_bead_however_they_are_spaced(beads, even):
    problem = hit(duration=2.0, output=Output(every=0.1, beads=beads))
    part = thinned(problem, [made(problem)], [0, 1])
    assert part.even == even
    data = plots.image_source(part, 0).data
    width = data["dw"][0] / 3
    middles = data["x"][0] + width * (0.5 + np.arange(3))
    assert middles == pytest.approx(part.places)
    assert middles == pytest.approx(beads if even else (0, 1, 2))
    height = data["dh"][0] / len(part.time)
    assert data["y"][0] + height * (0.5 + np.arange(len(part.time))) == pytest.approx(part.time, abs=1e-12)


def headings(root):
    return [model.title.text for model in root.select({"type": figure})]


def test_no_peaks_are_drawn_where_no_pulse_leads():
    waves = with_speeds(np.array([1, 1]), np.array([2, 3]), np.array([1.0, 2.0]), np.array([0.2, 0.1]))
    for foundation, drawn in ((None, True), (Foundation(stiffness=0.5), False)):
        problem = hit(chains=1, duration=2.0, foundation=foundation)
        root = run_page.layout(problem, thinned(problem, [made(problem)], [0]), found(waves), [1, 3])
        assert ("peak velocity of the leading pulse" in headings(root)) == drawn
        assert "energy of each chain, without coupling" in headings(root)


def test_forces_of_gauges_and_pushes_are_drawn_over_time_in_the_units_of_the_page(held):
    problem, run, part, units = held
    half = np.zeros((3, 3, 2))
    half[1, 2] = 0.5, 0.25
    places = (SimpleNamespace(name="right wall"), SimpleNamespace(name="contact 2"))
    numbers = [np.ones((3, 2))] * 8
    readings = Readings(places, np.array([0.0, 1.0, 2.0]), half, *numbers, *numbers[:2], np.zeros((3, 2), dtype=int))
    push = Load(2, 4, half_sine(0.5, 3.0))
    pushed = replace(problem, system=replace(problem.system, loads=(push,)))
    gauged, external = run_page.forces(pushed, part, ForceMeasurement(problem, [], readings), Range1d(0, 1), units)
    assert (gauged.title.text, external.title.text) == ("total force at gauges", "external force on beads")
    lines = {item.label.value: item.renderers for item in gauged.legend[0].items}
    assert list(lines) == [f"{place.name}, chain {chain}" for place in places for chain in (1, 2, 3)]
    # a chain has its colour and dashes, a gauge its mark
    assert lines["contact 2, chain 3"][0].glyph.line_dash == lines["right wall, chain 3"][0].glyph.line_dash != []
    assert [lines[name][1].glyph.marker for name in lines] == ["circle"] * 3 + ["square"] * 3
    data = lines["contact 2, chain 3"][0].data_source.data
    newtons = unit_on(gauged.yaxis.axis_label, problem, "N")
    np.testing.assert_allclose(data["y"] * newtons, np.array([0.0, 0.25, 0.0]) * problem.scale.force)
    np.testing.assert_allclose(data["x"], readings.time * units["time"].worth)
    (line,) = external.renderers
    assert external.legend[0].items[0].label.value == "bead 4, chain 2"
    expected = [push.force(time) * units["force"].worth for time in run.time]
    np.testing.assert_allclose(line.data_source.data["y"], expected)


def test_beads_are_drawn_at_their_sizes():
    kinds = {"a": BeadKind(radius=1.0), "b": BeadKind(radius=0.5)}
    what = scene(chains=1, beads=6, kick=(Kick(velocity=0.5),), duration=2.0, kinds=kinds, pattern=("a", "b"))
    part = thinned(what.problem(), [made(what.problem())], [0])
    root = run_page.layout(what.problem(), part, None, [1], radius=radii(what.setting))
    codes = [
        code for plot in root.select({"type": figure}) for one in plot.js_property_callbacks.values() for code in one
    ]
    (sizes,) = (code.args["radius"] for code in codes if "radius" in code.args)
    assert sizes == [[1.0, 0.5, 1.0, 0.5, 1.0, 0.5]]
