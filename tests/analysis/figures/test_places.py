"""Which bead, chain and time is where in a figure, in which unit: checked against states made by hand."""

import re

import numpy as np
import pytest
from stock_lammps import scene

from analysis.figures.engines import Curve, engines_figure
from analysis.figures.spacetime import BeadHistory, SpaceTime, spacetime_figure
from analysis.figures.style import shown_chains, title
from analysis.figures.waves import distance_figure, response_figure
from analysis.sharing.energies import EnergyShares
from analysis.sharing.equipartition import Sharing
from analysis.trajectory import Trajectory
from lammps_inputs import Kick, Material, library, physics

STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)

SI = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "m/s": 1.0, "mm/s": 1e-3}
"""What a unit on an axis is worth."""

SPEED = 3.0


def problem(si, **changes):
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


def unit_on(label, what, quantity):
    """What the numbers on an axis are to be multiplied with, in the scene's units."""
    (unit,) = re.findall(r"\(([^()]*)\)$", label)
    if not what.scale.si:
        assert unit == "reduced", (label, quantity)
        return 1.0
    assert unit in SI
    assert ("/" in unit) == (quantity == "velocity"), label
    return SI[unit]


def panel(figure, chain):
    """The image of a chain."""
    (axis,) = (axis for axis in figure.axes if axis.get_title() == f"chain {chain}")
    (image,) = axis.get_images()
    return axis, image


@pytest.mark.parametrize("si", [False, True])
@pytest.mark.parametrize(("chain", "bead", "frame"), [(1, 1, 2), (1, 7, 5), (2, 10, 8), (2, 2, 0)])
def test_a_bead_that_moves_is_seen_where_and_when_it_does(chain, bead, frame, si):
    what = problem(si)
    data = SpaceTime(what)
    data.add(moving(what, chain, bead, frame))
    figure = spacetime_figure(data)
    axis, image = panel(figure, chain)
    values = np.ma.filled(image.get_array(), 0.0)
    rows, columns = values.shape
    left, right, bottom, top = image.get_extent()
    (row,), (column,) = np.nonzero(values)
    assert left + (column + 0.5) * (right - left) / columns == pytest.approx(bead)
    assert axis.get_xlabel() == "bead"
    seen = (bottom + (row + 0.5) * (top - bottom) / rows) * unit_on(figure.axes[0].get_ylabel(), what, "time")
    assert seen == pytest.approx(frame * what.every * what.scale.time, abs=0.51 * what.every * what.scale.time)
    bar, scale = figure.axes[-1].get_ylabel().split("; ")
    assert scale == "colour: signed square root"
    assert values[row, column] * unit_on(bar, what, "velocity") == pytest.approx(0.5 * SPEED)
    assert not np.any(np.ma.filled(panel(figure, 3 - chain)[1].get_array(), 0.0))


@pytest.mark.parametrize("bead", [1, 5, 50])
def test_of_a_few_recorded_beads_each_is_seen_at_its_place(bead):
    what = problem(False, beads=50, recorded=(1, 5, 50))
    v = np.zeros((what.frames + 1, 2, 3))
    v[3, 0, (1, 5, 50).index(bead)] = 0.5
    data = SpaceTime(what)
    data.add(Trajectory(what, np.arange(what.frames + 1) * what.every, np.zeros_like(v), v))
    axis, image = panel(spacetime_figure(data), 1)
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
    what = problem(si)
    data = BeadHistory(what, (3, 8))
    data.add(moving(what, chain, bead, frame))
    whole, near = response_figure(data).axes  # of the other bead, which has not moved, there is none
    assert whole.get_title(loc="left") == f"(a) bead {bead}"
    velocities = unit_on(whole.get_ylabel(), what, "velocity")
    for axis, when in ((whole, frame * what.every * what.scale.time), (near, 0.0)):
        times = unit_on(axis.get_xlabel(), what, "time")
        for line in axis.get_lines():
            right = line.get_label() == f"chain {chain}"
            (peak,) = np.nonzero(line.get_ydata())
            assert len(peak) == right
            if right:
                assert line.get_ydata()[peak[0]] * velocities == pytest.approx(0.5 * SPEED)
                assert line.get_xdata()[peak[0]] * times == pytest.approx(when)


def test_the_response_is_that_of_the_bead_it_names_also_where_a_window_has_moved_on():
    what = problem(False, beads=100, window=64)
    data = BeadHistory(what, (20, 40, 95))
    for first, frame in ((1, 0), (30, 1)):
        v = np.tile(np.arange(first, first + 64) / 100.0, (1, 2, 1))
        data.add(Trajectory(what, np.array([frame * what.every]), np.zeros_like(v), v, first=first))
    np.testing.assert_array_equal(data.velocity, np.tile([[[0.2, 0.4, 0.0]], [[np.nan, 0.4, 0.0]]], (1, 2, 1)))


def shared(what):
    """Two chains at beads 2 to 5, all different."""
    bead = np.arange(2, 6)
    amplitude = 0.4 + 0.01 * np.arange(8.0).reshape(4, 2)
    return Sharing(0, bead, np.stack([1.2 * bead, 1.2 * bead + 0.25], axis=1), amplitude, physics.energy(what.system))


@pytest.mark.parametrize("si", [False, True])
def test_the_distance_figure_has_each_chain_at_its_beads_in_its_units(si):
    what = problem(si)
    amplitude, _, lag = distance_figure(what, shared(what), EnergyShares(what, shared(what))).axes
    assert amplitude.get_ylabel() == r"peak velocity $v_\mathrm{max} / V$"
    for chain in (1, 2):
        (line,) = (line for line in amplitude.get_lines() if line.get_label() == f"chain {chain}")
        assert line.get_xdata().tolist() == [2.0, 3.0, 4.0, 5.0]
        assert line.get_ydata() == pytest.approx(shared(what).amplitude[:, chain - 1])
    (late,) = (line for line in lag.get_lines() if line.get_label() == "chain 2")
    seconds = late.get_ydata() * unit_on(lag.get_ylabel(), what, "time")
    assert seconds == pytest.approx(0.25 * what.scale.time)
    assert "behind chain 1" in lag.get_ylabel()


@pytest.mark.parametrize("si", [False, True])
def test_the_engines_figure_has_each_bead_and_engine_where_it_says(si):
    what = problem(si, gap=0.5 * problem(si).scale.length)
    time, velocity = np.array([0.0, 1.0, 2.0]), np.zeros((3, 2, 2))
    velocity[1, 1, 1] = 0.5  # chain 2, the second of the rows shown
    curve = Curve("rigid", time, velocity, np.array([2, 3]), np.array([[0.7, 0.6], [0.2, 0.1]]))
    first, *rows = engines_figure(what, (4, 9), [curve]).axes
    assert [axis.get_title(loc="left") for axis in (first, *rows)] == ["(a) rigid", "(b) bead 4", "(c) bead 9"]
    assert first.get_ylabel() == "first impulse $I / (m V)$"
    assert [line.get_ydata().tolist() for line in first.get_lines()] == [[0.7, 0.6], [0.2, 0.1]]
    assert not np.any([line.get_ydata() for line in rows[0].get_lines()])
    moved = rows[1].get_lines()[1]
    assert moved.get_ydata() * unit_on(rows[1].get_ylabel(), what, "velocity") == pytest.approx([0.0, 0.5 * SPEED, 0.0])
    assert moved.get_xdata() * unit_on(rows[1].get_xlabel(), what, "time") == pytest.approx(time * what.scale.time)


def test_a_line_marks_the_bead_from_which_on_the_chains_agree():
    amplitude = np.full((80, 2), 0.3)
    amplitude[:60, 0] *= 1.0 + 0.05 * np.cos(np.arange(60))
    what = problem(False, beads=100)
    agreeing = Sharing(0, np.arange(2, 82), np.zeros((80, 2)), amplitude, physics.energy(what.system))
    axis = distance_figure(what, agreeing, EnergyShares(what, agreeing)).axes[0]
    (mark,) = (line for line in axis.get_lines() if not line.get_label().startswith("chain"))
    assert set(mark.get_xdata()) == {agreeing.agrees_from(0.01)}
    assert axis.get_title(loc="right") == f"within 1% from bead {agreeing.agrees_from(0.01)} on"


@pytest.mark.parametrize(("direction", "label"), [(1, "bead"), (-1, "bead, counted from bead 10")])
def test_beads_are_counted_from_the_end_that_was_hit(direction, label):
    what = problem(False)
    figure = distance_figure(what, shared(what), EnergyShares(what, shared(what)), direction)
    assert figure.axes[2].get_xlabel() == label


def test_the_title_tells_name_chains_coupling_and_gap():
    what = problem(False, kappa=0.25 * SPEED**0.4, gap=0.5 * SPEED**0.8)
    data = SpaceTime(what)
    data.add(moving(what, 1, 1, 0))
    # kappa at V = 1, the gap as in the scene
    gap = f"{0.5 * SPEED**0.8:.4g}"
    assert spacetime_figure(data).get_suptitle() == f"test: $N$ = 2, $\\kappa = k T^2 / m$ = 0.25, gap {gap}"


def coupled(chains, beads=20, **coupling):
    plain = {"name": "test", "chains": chains, "beads": beads, "kick": {"velocity": 1.0}, "duration": 5.0}
    return library.from_plain({**plain, "coupling": coupling}, "test").problem()


@pytest.mark.parametrize(
    ("coupling", "words"),
    [
        ({"stiffness": 0.1, "rows": [5, 20]}, "= 0.1 in rows 5 to 20"),
        ({"stiffness": {"from": 0.1, "to": 0.2, "rows": [1, 20]}}, "= 0.1 to 0.2"),
        ({"stiffness": 0.1, "topology": "ring"}, "= 0.1, ring"),
        ({"cubic": 0.1}, "= 0 and cubic"),
    ],
)
def test_the_title_tells_where_springs_are_and_of_which_kind(coupling, words):
    assert title(coupled(3, **coupling)) == f"test: $N$ = 3, $\\kappa$ {words}"


def test_lattices_have_a_panel_for_each_chain_and_lines_for_those_far_from_each_other():
    lattice = coupled(16, stiffness=0.1, topology={"lattice": [4, 4]})
    assert shown_chains(lattice, panels=True) == list(range(16))
    corners = {0, 3, 12, 15}
    assert len(shown_chains(lattice)) == 9
    assert corners <= set(shown_chains(lattice))


def test_where_few_beads_move_the_picture_shows_those():
    what = problem(False, beads=40)
    data = SpaceTime(what)
    data.add(moving(what, 1, 6, 2))
    assert spacetime_figure(data).axes[0].get_xlim() == (5.5, 6.5)
