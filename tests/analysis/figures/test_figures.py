"""Figures hold what they were given, labelled, and warn of nothing."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.text import Text
from small_problems import problem as small
from synthetic_waves import of_keys, reference, surveyed

from analysis.conservation import Account
from analysis.figures.drawing import draw
from analysis.figures.panels import (
    MAX_PANELS,
    Axis,
    AxisUnit,
    Curve,
    Image,
    Panel,
    Sheet,
    axis_unit,
    shown_chains,
)
from analysis.figures.spacetime import HistoryMeter, RootScale, space_time_meter, spacetime_sheet
from analysis.figures.style import CHAIN_DASHES
from analysis.figures.waves import distance_sheet, passage, pulses, response_sheet, shape_sheet, time_title
from analysis.sharing.energies import Flow
from analysis.sharing.survey import survey
from lammps_inputs import Kick
from lammps_inputs.units import Label, make_scale
from workflow.engines.reference import engine
from workflow.formats import written_as
from workflow.measures.budget import BudgetMeasurement
from workflow.measures.energy import EnergyMeasurement
from workflow.measures.plastic import PlasticMeasurement, YieldTable
from workflow.runs.figures import write_figure


@pytest.fixture(scope="module")
def found():
    return surveyed(reference(2, 0.1, 60, 80.0))


def curves(axis):
    """Label -> curve of an axis; reference lines are left out."""
    return {line.get_label(): line for line in axis.get_lines() if not line.get_label().startswith("_")}


def legends(figure):
    """Labels in all legends of a figure."""
    found = [*figure.legends, *(legend for axis in figure.axes if (legend := axis.get_legend()))]
    return [text.get_text() for legend in found for text in legend.get_texts()]


def history(trajectory, beads, frames=None):
    return HistoryMeter(trajectory.problem, np.array(beads)).read([trajectory[:frames]])


def spacetime(trajectory, frames=None):
    return space_time_meter(trajectory.problem).read([trajectory[:frames]])


def test_the_distance_figure_shows_the_energies_of_waves_and_chains(found):
    _, waves, chains, _ = draw(distance_sheet(found.problem, found.shared, found.energies)).axes
    for k, name in enumerate(("chain 1", "chain 2")):
        assert np.array_equal(curves(waves)[name].get_ydata(), found.energies.wave[:, k], equal_nan=True)
        assert np.array_equal(curves(chains)[name].get_ydata(), found.energies.chain[:, k])


def test_the_distance_figure_has_no_panel_without_a_curve():
    recorded = {"beads": [5, 9, 12], "every": 0.2}  # which have no energy, and with a gap no exact waves
    keys = {"coupling": {"stiffness": 0.1}, "kick": {"velocity": 1.0}, "output": recorded}
    few = surveyed(engine.run(of_keys(chains=2, beads=20, gap=0.5, duration=40.0, **keys)))
    panels = distance_sheet(few.problem, few.shared, few.energies).panels
    assert len(panels) == 2
    assert all(panel.curves for panel in panels)


def test_chains_differ_by_dash_in_every_panel_so_that_grey_tells_them(found):
    for axis in draw(distance_sheet(found.problem, found.shared, found.energies)).axes:
        one, two = (curves(axis)[name] for name in ("chain 1", "chain 2"))
        assert one.get_linestyle() != two.get_linestyle()
    assert len({str(dash) for dash in CHAIN_DASHES}) == MAX_PANELS


@pytest.mark.slow
@pytest.mark.parametrize(
    ("recorded", "chains", "kick"),
    [
        ("all", 1, Kick(velocity=1.0)),
        ((4, 11, 20), 2, Kick(velocity=1.0)),
        ((4, 11, 20), 1, Kick(bead=30, velocity=-1.0)),
        ("all", 9, Kick(bead=30, velocity=-1.0)),
    ],
)
def test_any_scene_of_steel_beads_is_drawn_with_prefixed_units_and_a_curve_for_each_entry_of_a_legend(
    recorded, chains, kick
):
    trajectory = reference(chains, 0.1, 30, 40.0, recorded=recorded, kicks=[kick])
    steel = replace(trajectory.problem, scale=make_scale(3.6e-3, 1.4e10, 0.01, si=True))
    trajectory = replace(trajectory, problem=steel)
    result = survey(trajectory.blocks, steel)
    distance = draw(distance_sheet(steel, result.shared, result.energies, result.direction))
    response = draw(response_sheet(history(trajectory, (4, 11, 20)), result.waves))
    label = response.get_supylabel() or response.axes[0].get_ylabel()
    assert (response.axes[-2].get_xlabel(), label) == (
        "time $t$ (\N{MICRO SIGN}s)",
        "velocity $v$ (mm/s)",
    )
    for figure in (distance, response, draw(shape_sheet(steel, result.waveforms, [11, 20]))):
        drawn = {name for axis in figure.axes for name in curves(axis)}
        assert set(legends(figure)) == (drawn if len(drawn) > 1 else set())
        assert all(any(len(line.get_xdata()) for line in axis.get_lines()) for axis in figure.axes)
        figure.draw_without_rendering()
    for axis in (*distance.axes, *response.axes):  # a number has no power of ten
        assert axis.xaxis.get_offset_text().get_text() == axis.yaxis.get_offset_text().get_text() == ""


def test_no_legend_lies_over_data():
    result = surveyed(reference(9, 0.2, 30, 40.0))
    figure = draw(distance_sheet(result.problem, result.shared, result.energies))
    figure.draw_without_rendering()
    boxes = [legend.get_window_extent() for legend in figure.legends]
    boxes += [legend.get_window_extent() for axis in figure.axes if (legend := axis.get_legend())]
    assert len(boxes) == 1
    for axis in figure.axes:
        inside = axis.get_window_extent()
        assert all(min(inside.y1, box.y1) - max(inside.y0, box.y0) < 1.0 for box in boxes)


@pytest.mark.slow
@pytest.mark.parametrize("hit", [1, 14])
def test_of_many_chains_the_one_that_was_hit_is_shown_and_the_title_says_which(hit):
    trajectory = reference(20, 0.2, 20, 5.0, kicks=[Kick(chain=hit, velocity=1.0)])
    shown = shown_chains(trajectory.problem)
    assert (len(shown), shown) == (MAX_PANELS, sorted(set(shown)))
    assert {0, 19, hit - 1} <= set(shown)
    for figure in (draw(spacetime_sheet(spacetime(trajectory))), draw(response_sheet(history(trajectory, (1,))))):
        assert f"(chains {', '.join(str(chain + 1) for chain in shown)} are shown)" in figure.get_suptitle()
    panels = draw(spacetime_sheet(spacetime(trajectory))).axes[:MAX_PANELS]
    assert [axis.get_title(loc="left")[4:] for axis in panels] == [f"chain {chain + 1}" for chain in shown]
    fastest = [float(axis.get_images()[0].get_array().max()) for axis in panels]
    assert fastest.index(max(fastest)) == shown.index(hit - 1)
    lines = curves(draw(response_sheet(history(trajectory, (1,)))).axes[0])
    assert np.array_equal(lines[f"chain {hit}"].get_ydata(), trajectory.velocity[:, hit - 1, 0])


def test_velocities_of_both_signs_are_seen_and_only_the_bead_that_was_hit_is_cut_off():
    trajectory = reference(2, 0.1, 60, 110.0)
    panel = draw(spacetime_sheet(spacetime(trajectory))).axes[0]
    (image,) = panel.get_images()
    low, high = image.get_clim()
    assert low == -high
    far = trajectory.velocity[:, :, 6:]
    assert high == pytest.approx(np.abs(far).max())
    shade = image.norm(np.array([-0.06, 0.0, 0.06])).tolist()
    assert shade[1] == 0.5
    assert min(0.5 - shade[0], shade[2] - 0.5) > 0.1  # the tail is a good part of the scale away from nothing


def test_beside_the_whole_run_the_passage_of_the_leading_pulse_of_the_kicked_chain_is_shown_close_up(found):
    trajectory = reference(2, 0.1, 60, 80.0)
    whole, near = draw(response_sheet(history(trajectory, (50,)), found.waves)).axes
    assert np.ptp(curves(whole)["chain 1"].get_xdata()) == pytest.approx(80.0)
    x, y = curves(near)["chain 1"].get_data()
    assert np.ptp(x) < 15.0
    at = found.waves.at(50)
    assert y.max() == pytest.approx(at.peak_velocity[0], abs=2e-3)
    assert abs(x[np.argmax(y)]) < 0.5
    assert near.get_title(loc="left") == f"(b) arrival {at.arrival[0]:#.4g}"
    assert near.get_xlabel() == "time after arrival\nin chain 1 (reduced)"


def test_the_passage_is_that_of_the_leading_pulse_also_where_a_later_one_is_larger():
    trajectory = reference(1, 0.0, 30, 60.0)
    first = surveyed(trajectory).waves
    late = replace(trajectory, velocity=trajectory.velocity - 2.0 * trajectory.velocity[::-1])
    _, near = draw(response_sheet(history(late, (15,)), first)).axes
    assert near.get_title(loc="left") == f"(b) arrival {first.at(15).arrival[0]:#.4g}"


def test_the_passage_of_a_pulse_with_a_plateau_is_shown_to_its_end():
    time = np.arange(0.0, 60.0, 0.1)
    rise, fall = (0.5 * (1.0 + np.tanh(2.0 * (time - instant))) for instant in (20.0, 30.0))
    low, high = passage(time, rise - fall, 20.0)
    assert low < 19.0
    assert 31.0 < high < 40.0


def test_the_time_over_a_panel_has_four_digits_also_where_they_are_zeros():
    unit = AxisUnit(1.0, "reduced")
    titles = [time_title("arrival", time, unit) for time in (21.0, 124.0, 1397.2)]
    assert titles == ["arrival 21.00", "arrival 124.0", "arrival 1397"]


def test_where_no_pulse_leads_there_is_no_passage_beside_the_whole_run():
    trajectory = reference(2, 0.1, 60, 80.0)
    figure = draw(response_sheet(history(trajectory, (10, 50))))
    assert [axis.get_title(loc="left") for axis in figure.axes] == ["(a) bead 10", "(b) bead 50"]


def test_a_cut_run_says_so_and_beads_that_have_not_moved_are_named_not_drawn():
    trajectory = reference(2, 0.1, 60, 80.0)
    figure = draw(response_sheet(history(trajectory, (10, 50, 60), frames=len(trajectory.time) // 4)))
    assert [axis.get_title(loc="left") for axis in figure.axes] == ["bead 10"]
    assert "beads 50, 60 have not moved" in figure.get_suptitle()
    for cut in (figure, draw(spacetime_sheet(spacetime(trajectory, len(trajectory.time) // 4)))):
        assert "cut short at 25% of its time" in cut.get_suptitle()
    assert "cut short" not in draw(spacetime_sheet(spacetime(trajectory))).get_suptitle()


@pytest.mark.parametrize(
    ("velocity", "symbol", "worth"),
    [
        (3.0, "m/s", 3.0),
        (2e-3, "mm/s", 2.0),
        (5e-6, "\N{MICRO SIGN}m/s", 5.0),
        (2e3, "km/s", 2.0),
        (1e-30, "pm/s", 1e-18),
    ],
)
def test_units_have_the_prefix_that_leaves_one_to_three_digits(velocity, symbol, worth):
    problem = replace(small(), scale=make_scale(1.0, 1.0, velocity, si=True))
    unit = axis_unit(problem, "velocity", 1.0)
    assert unit.symbol == symbol
    assert unit.worth == pytest.approx(worth)


@pytest.mark.slow
def test_letters_in_a_pdf_can_be_searched_and_embedded(tmp_path):
    with written_as(("pdf",)):
        write_figure(tmp_path, "f", draw(response_sheet(history(reference(1, 0.0, 10, 8.0), (5,)))))
    pdf = (tmp_path / "f.pdf").read_bytes()
    assert b"/CIDFontType2" in pdf  # Type 42
    assert b"/Type3" not in pdf


def test_shape_figure_shows_the_samples_on_the_exact_wave(found):
    figure = draw(shape_sheet(found.problem, found.waveforms, [10, 50]))
    above, late = figure.axes[:2]
    assert [axis.get_title(loc="left") for axis in (above, late)] == ["(a) bead 10", "(b) bead 50"]
    exact = late.get_lines()[0]
    for line in late.get_lines()[1:]:
        difference = line.get_ydata() - np.interp(line.get_xdata(), exact.get_xdata(), exact.get_ydata())
        assert np.max(np.abs(difference)) < 0.03


def test_the_layers_of_the_budget_add_up_to_what_was_put_in_in_the_units_of_the_scene():
    time = np.linspace(0.0, 10.0, 5)
    held = {"kinetic": 0.3 - 0.02 * time, "contacts": np.full(5, 0.19), "springs": np.zeros(5)}
    held |= {"ground": np.zeros(5), "walls": np.full(5, 0.01), "resonators": np.zeros(5)}
    account = Account(
        time,
        np.full(5, 0.5),
        **held,
        dissipated={"contact_damping": 0.02 * time},
        other_atoms=None,
        in_resonators_error=None,
    )
    si = replace(small(), scale=make_scale(3.6e-3, 1.4e10, 0.01, si=True))
    figure = draw(BudgetMeasurement(si, account).sheet())
    (axis,) = figure.axes
    assert legends(figure) == ["energy input", "dissipated in contact damping", "walls", "contacts", "kinetic"]
    tops = [layer.get_paths()[0].vertices[:, 1].max() for layer in axis.collections]
    nano = si.scale.energy * 1e9
    assert tops == pytest.approx([0.3 * nano, 0.49 * nano, 0.5 * nano, 0.5 * nano])
    assert curves(axis)["energy input"].get_ydata() == pytest.approx(np.full(5, 0.5 * nano))
    assert axis.get_ylabel() == "energy $U$ (nJ)"
    hatches = [layer.get_hatch() for layer in axis.collections]
    assert hatches[-1]  # tells what is lost from what is there in grey
    assert not any(hatches[:-1])


def account_of(kinetic, time):
    nothing = np.zeros(len(time))
    stored = dict.fromkeys(("springs", "ground", "walls", "resonators"), nothing)
    stored |= {"kinetic": kinetic, "contacts": 1.0 - kinetic}
    return Account(time, np.ones(len(time)), **stored, dissipated={}, other_atoms=None, in_resonators_error=None)


@pytest.mark.parametrize(("period", "mean"), [(2.7, True), (40.0, False)])
def test_oscillations_that_instants_do_not_resolve_are_drawn_as_means(period, mean):
    time = np.arange(400.0)
    kinetic = 0.5 + 0.4 * np.sin(2.0 * np.pi * time / period)
    (axis,) = draw(BudgetMeasurement(small(), account_of(kinetic, time)).sheet()).axes
    x, y = axis.collections[0].get_paths()[0].vertices.T
    top = y[(y > 0.0) & (x > 50.0) & (x < 350.0)]
    assert axis.get_title(loc="right").startswith("mean over") == mean
    assert np.ptp(top) == pytest.approx(0.8 * (not mean), abs=0.01)


def test_modes_are_grey_as_colours_are_those_of_chains():
    problem = reference(2, 0.1, 10, 8.0).problem
    time, values = np.arange(3.0), np.add.outer(np.arange(3.0), np.arange(2.0))
    flow = Flow(time, values / 10.0, np.zeros(3), values, 0.1 * values, action=values / 10.0)
    modes = draw(EnergyMeasurement(problem, flow).sheet()).axes[-1].get_lines()
    colours = {to_rgb(line.get_color()) for line in modes}
    assert len(colours) == 2
    assert all(len(set(colour)) == 1 for colour in colours)


def test_a_panel_that_is_constant_is_left_out_of_the_energy():
    problem = reference(1, 0.0, 10, 8.0).problem
    time, one = np.arange(3.0), np.ones((3, 1))
    flow = Flow(time, one, np.zeros(3), time[:, np.newaxis] + one, 0.1 * one)
    (panel,) = draw(EnergyMeasurement(problem, flow).sheet()).axes
    assert panel.get_ylabel().startswith("centre of the energy")


def test_contacts_that_have_not_begun_to_open_are_not_drawn_and_a_printed_power_law_is():
    contact = np.arange(1, 41)
    force = 5.0 * contact**-0.5
    opened = (contact <= 38).astype(np.int64)
    force[38:] = 1e-3
    table = YieldTable(np.ones(40, dtype=np.int64), contact, force, force, 0.1 * force, opened, force)
    figure = draw(PlasticMeasurement(small(chains=1), None, table).sheet())
    curve, law = figure.axes[0].get_lines()
    assert curve.get_xdata().tolist() == list(range(1, 39))
    assert law.get_xdata().tolist() == list(range(20, 39))
    np.testing.assert_allclose(law.get_ydata(), 5.0 * law.get_xdata() ** -0.5)
    assert legends(figure) == ["chain 1", r"$\propto n^{-0.500}$"]
    assert figure.axes[1].get_ylabel() == "permanent overlap $\\delta_r$ (reduced)"


@pytest.mark.parametrize("width", [3.4, 7.0])
def test_figures_of_a_width_that_is_asked_for_have_that_width_and_no_title(found, width):
    trajectory = reference(2, 0.1, 60, 80.0)
    with written_as(("png",), width):
        figures = [
            draw(distance_sheet(found.problem, found.shared, found.energies)),
            draw(response_sheet(history(trajectory, (10, 50)), found.waves)),
            draw(spacetime_sheet(spacetime(trajectory))),
            draw(shape_sheet(found.problem, found.waveforms, [10, 50])),
        ]
    for figure in figures:
        assert figure.get_figwidth() == width
        assert figure.get_suptitle() == ""
        figure.draw_without_rendering()
        for axis in figure.axes:  # no panel has vanished between labels
            assert axis.get_window_extent().width > 10.0


def test_titles_of_close_ups_in_si_units_end_within_a_narrow_figure(found):
    trajectory = reference(2, 0.1, 60, 80.0)
    si = replace(trajectory.problem, scale=make_scale(3.6e-3, 1.4e10, 0.01, si=True))
    with written_as(("png",), 3.4):
        figure = draw(response_sheet(history(replace(trajectory, problem=si), (10, 50)), found.waves))
    figure.draw_without_rendering()
    shown = figure.findobj(lambda part: isinstance(part, Text) and ") arrival" in part.get_text())
    assert len(shown) == 2
    assert all(title.get_window_extent().x1 <= figure.bbox.x1 for title in shown)


@pytest.mark.parametrize("top", [1.0, 0.55, 4.3e2, 2.0001e-6])
def test_ticks_of_colours_are_round_and_reach_most_of_the_scale(top):
    ticks = RootScale(top).ticks
    assert ticks == sorted(ticks) == [-tick for tick in reversed(ticks)]
    assert 0.4 * top <= ticks[-1] <= top
    assert {f"{tick:.3e}"[:5] for tick in ticks if tick > 0.0} <= {"1.000", "2.000", "5.000"}


def test_the_largest_pulses_are_shown_in_their_order_each_from_where_it_is_small_and_no_long_one():
    time = np.linspace(0.0, 200.0, 2001)
    bumps = [(30.0, 0.5), (60.0, 1.0), (100.0, 0.05), (140.0, 0.7), (180.0, 0.3)]
    size = sum(height * np.exp(-((time - peak) ** 2)) for peak, height in bumps)
    found = pulses(time, size)
    assert [peak for peak, _, _ in found] == pytest.approx([30.0, 60.0, 140.0])
    for peak, low, high in found:
        assert 2.0 < peak - low < 8.0
        assert 2.0 < high - peak < 8.0
    assert pulses(time, np.sin(0.01 * time)) == []


@pytest.mark.parametrize("dashes", ["-", "--"])
def test_a_white_line_over_an_image_has_an_outline_without_gaps(dashes):
    nothing = Axis(Label(""), ends=(0.0, 1.0))
    bright = Image(np.ones((2, 2)), (0.0, 1.0), (0.0, 1.0), Label(""), (0.0, 1.0))
    line = Curve("line", np.array([0.0, 1.0]), np.array([0.5, 0.5]), look={"color": "white", "linestyle": dashes})
    figure = draw(Sheet("", [[Panel(nothing, nothing, (line,), image=bright)]], 3.0))
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    left, bottom, right, top = figure.axes[0].get_window_extent().extents.astype(int)
    pixels = np.asarray(canvas.buffer_rgba())[::-1, :, :3].max(axis=-1)[bottom + 5 : top - 5, left + 5 : right - 5]
    assert np.all(pixels.min(axis=0) < 128)  # in every column
    assert np.all(pixels[0] > 128)
