"""Dispersion of small waves in loaded chains: the textbook's formulas, and what runs of LAMMPS show."""

import csv
import io
import math

import numpy as np
import pytest
from figure_table import assert_shown, at_both_widths
from small_problems import written_down
from stock_lammps import scene

from analysis import quantity
from analysis.figures.drawing import draw
from analysis.shape.exact_wave import nesterenko
from analysis.shape.long_waves import LoadedSpeed, sound_speed, speed_over_sound
from analysis.shape.unit_cell import UnitCell, cell_of
from analysis.trajectory import Trajectory
from lammps_inputs import Kick, Material, library
from lammps_inputs.units import make_scale
from workflow.plugins.sound.dispersion import DispersionMeter, Map, measured_branches
from workflow.plugins.sound.figure import dispersion_sheet
from workflow.runs.run import run

pytestmark = pytest.mark.usefixtures("lammps_here")

DIMER = {"kinds": {"heavy": {"mass": 1.0}, "light": {"mass": 0.5}}, "pattern": ["heavy", "light"]}


def loaded(**changes):
    plain = {"name": "test", "beads": 64, "kick": {"velocity": 1.0}, "duration": 200.0}
    return library.from_plain({**plain, "precompression": {"force": 1.0}, **changes}, "test")


def test_equal_beads_have_the_branch_of_the_textbook():
    system = loaded().system
    q = np.linspace(0.0, math.pi, 9)
    k = 1.5 * system.along[0].law.rest ** 0.5
    exact = 2.0 * math.sqrt(k) * np.sin(q / 2.0)
    np.testing.assert_allclose(cell_of(system).branches(q)[:, 0], exact, rtol=1e-9, atol=1e-7)


@pytest.mark.parametrize(
    ("changes", "edges"),
    [
        (DIMER, [[0.0, 3.0], [6.0, 9.0]]),  # of masses 1 and 1/2, contacts 3/2
        ({"chains": 2, "coupling": {"stiffness": 0.1}}, [[0.0, 6.0], [0.2, 6.2]]),
        ({"chains": 3, "coupling": {"stiffness": 0.1, "topology": "ring"}}, [[0.0, 6.0], [0.3, 6.3], [0.3, 6.3]]),
        ({"foundation": {"stiffness": 0.5}}, [[0.5, 6.5]]),
        # (3 - w)(3 - w / 2) and, of opposite motion, (7 - w)(7 - w / 2) are 9 cos(q)**2; they are equal at w = 20 / 3
        (DIMER | {"chains": 2, "coupling": {"stiffness": 2.0}}, [[0, 3], [5, 20 / 3], [20 / 3, 9], [14, 16]]),
    ],
    ids=["alternating beads", "two chains", "ring", "foundation", "crossing branches"],
)
def test_bands_have_the_edges_of_the_textbook(changes, edges):
    bands = cell_of(loaded(**changes).system).bands()
    np.testing.assert_allclose(bands**2, edges, rtol=1e-9, atol=1e-9)
    if len(edges) == 4:
        assert bands[1, 1] == bands[2, 0]  # without a gap


def test_a_branch_is_measured_where_a_parabola_through_the_logarithm_of_its_power_is_highest():
    frequency = 0.25 * np.arange(20)
    power = np.exp(-((frequency - 2.57) ** 2))[np.newaxis, np.newaxis]
    assert measured_branches(frequency, power, np.array([[2.6]])).item() == pytest.approx(2.57, abs=1e-12)


def linear(scene):
    """The frames of a scene of one chain of equal beads of exponent 2 with resonators, kicked weakly: by its modes."""
    problem, beads = scene.problem(), scene.beads
    contact = 2.0 * math.sqrt(scene.precompression.force)
    spring, inner = scene.resonators[0].stiffness, scene.resonators[0].mass
    difference = np.diff(np.eye(beads), axis=0)
    stiffness = np.kron([[1.0, -1.0], [-1.0, 1.0]], spring * np.eye(beads))
    stiffness[:beads, :beads] += contact * difference.T @ difference
    root = np.sqrt(np.repeat([1.0, inner], beads))
    squares, shapes = np.linalg.eigh(stiffness / np.outer(root, root))
    time = np.arange(problem.frames + 1) * problem.every
    swing = np.cos(np.outer(time * problem.scale.time, np.sqrt(np.maximum(squares, 0.0))))
    velocity = (swing * shapes[scene.kick[0].bead - 1]) @ shapes.T / root
    atoms = velocity[:, :beads].reshape(-1, 1, beads), velocity[:, beads:].reshape(-1, 1, 1, beads)
    return Trajectory(
        problem, time, 0.0 * atoms[0], atoms[0], further_lines=np.concatenate([0.0 * atoms[1], atoms[1]], axis=1)
    )


def test_a_weak_branch_is_not_given_the_power_of_a_strong_one():
    plain = {"name": "weak", "beads": 14, "contact": {"exponent": 2}, "precompression": {"force": 0.13}}
    plain |= {"resonators": {"mass": 0.92, "stiffness": 0.13}, "kick": {"velocity": 0.01, "bead": 7}}
    scene = library.from_plain({**plain, "duration": 116, "output": {"every": 0.46}}, "weak")
    found = DispersionMeter(scene.problem()).read([linear(scene)])
    assert np.all(found.measured_bands()[:, 1] < found.cell.bands()[:, 1] + found.bin)
    assert np.isfinite(found.measured).mean() > 0.8
    assert np.nanmax(np.abs(found.measured - found.exact) / found.uncertainty()) < 1.0


def test_a_branch_without_power_is_undefined():
    problem = loaded(chains=2, coupling={"stiffness": 0.5}, duration=50.0).problem()
    bead = np.arange(1, 65)
    alike = written_down(problem, lambda t: (0.0 * t, np.cos(0.8 * bead - 0.95 * t)))
    low, high = DispersionMeter(problem).read([alike]).measured_bands()
    assert np.all(np.isfinite(low))
    assert np.all(np.isnan(high))


def test_the_map_does_not_depend_on_where_blocks_end():
    problem = loaded(duration=50.0).problem()
    bead = np.arange(1, 65)
    whole = written_down(problem, lambda t: (0.0 * t, np.cos(0.8 * bead - 1.25 * t)))
    parts = whole[:3], whole[3:100], whole[100:333], whole[333:]
    found = [DispersionMeter(problem).read(blocks) for blocks in ([whole], parts)]
    assert found[0].frequency[-1] < 0.5 * math.pi / problem.every  # not every frame is taken
    np.testing.assert_array_equal(found[0].power, found[1].power)


@pytest.mark.parametrize("pattern", ["heavy light", "heavy light light", "heavy heavy light light light"])
def test_long_waves_run_at_the_speed_of_sound_of_a_cell_anywhere_in_it(pattern):
    system = loaded(kinds=DIMER["kinds"], pattern=pattern.split()).system
    q = 1e-3
    exact = cell_of(system).branches(np.array([q]))[0, 0] / q
    np.testing.assert_allclose(sound_speed(system), exact, rtol=1e-6)


def test_a_run_of_lammps_shows_the_edges_of_the_bands_to_a_bin(tmp_path):
    case = loaded(**DIMER, kick={"velocity": 1.0}, precompression={"force": 300.0}, duration=50.0, timestep=0.01)
    frames = run(case, tmp_path / "run", check=False).directory.blocks()
    result = DispersionMeter(case.problem()).read(frames)
    difference = np.abs(result.measured_bands() - result.cell.bands())
    assert difference[0, 1] < result.bin
    assert np.all(difference[1] < result.bin)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_wave_towards_higher_bead_numbers_has_a_positive_wavenumber(way):
    problem = loaded(duration=50.0).problem()
    turn = 2.0 * math.pi * 8 / 64, 1.25  # wavenumber and frequency
    bead = np.arange(1, 65)
    wave = written_down(problem, lambda t: (0.0 * t, np.cos(way * turn[0] * bead - turn[1] * t)))
    result = DispersionMeter(problem).read([wave])
    row, column = np.unravel_index(np.argmax(result.power), result.power.shape)
    assert result.wavenumber[column] == pytest.approx(way * turn[0])
    assert result.frequency[row] == pytest.approx(turn[1], abs=result.bin)


def test_the_table_has_a_line_for_each_branch_in_the_units_of_the_scene():
    cell = UnitCell(np.array([[1.0, 2.0]]), np.ones((1, 2)), np.zeros((2, 1, 1)))
    exact, measured = np.array([[0.5, 3.0]]), np.array([[np.nan, 2.9]])
    found = Map(1, np.zeros(1), np.zeros(2), np.zeros((2, 1)), cell, np.array([0.25]), exact, measured)
    scale = make_scale(2.0, 3.0, 0.1, si=True)
    head, first, second = csv.reader(io.StringIO(quantity.to_csv(quantity.table(found.branches(), scale))))
    assert head == ["wavenumber", "branch", "frequency (rad/s)", "measured (rad/s)", "uncertainty (rad/s)"]
    assert (first[:2], first[3:]) == (["0.25", "1"], ["", ""])
    assert second[:2] == ["0.25", "2"]
    assert [float(first[2]), *map(float, second[2:4])] == pytest.approx([w / scale.time for w in (0.5, 3.0, 2.9)])


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"precompression": None}, "no static load"),
        ({"precompression": None, "gravity": 0.1, "walls": {"right": "flat"}}, "do not repeat"),
        ({"beads": 4}, "three unit cells"),
        ({"output": {"beads": [1, 2, 3]}}, "velocities of all beads"),
        ({"output": {"every": 2.0}}, "frames are farther apart"),
    ],
)
def test_where_there_is_no_map_it_says_why(changes, said):
    run = written_down(loaded(**changes).problem(), lambda t: (0.0 * t, 0.0 * t))
    assert said in DispersionMeter(run.problem).read([run])


def test_the_long_wave_theory_has_its_limits_right():
    assert speed_over_sound(5.0, 1.0) == pytest.approx(1.0, rel=1e-12)
    for exponent in (1.25, 1.5, 2.0, 3.0):
        assert speed_over_sound(1.0 + 1e-4, exponent) == pytest.approx(1.0, abs=1e-4)
        system = loaded(precompression={"force": 1e-9}, contact={"exponent": exponent}).system
        speed = LoadedSpeed(system).at(1, np.array([30]), np.array([1.0]))
        assert speed[0] == pytest.approx(nesterenko(exponent).speed, rel=0.02)


STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)


def drawn():
    """Chain 7 of 12: power at q = pi / 2 and the frequency 2, and a branch of omega = 3 |sin(q / 2)|."""
    problem = scene(chains=12, beads=10, kick=(Kick(chain=6, velocity=0.01),), material=STEEL).problem()
    cell = UnitCell(np.array([[1.0]]), np.array([[2.25]]), np.zeros((1, 1, 1)))
    power, nothing = np.zeros((8, 8)), np.zeros((1, 1))
    power[4, 6] = 1.0
    wavenumber = np.arange(-4, 4) * math.pi / 4.0
    found = Map(7, wavenumber, 0.5 * np.arange(8), power, cell, nothing[0], nothing, nothing)
    return draw(dispersion_sheet(problem, found))


@at_both_widths
def test_the_dispersion_figure_has_power_and_branches_where_its_axes_say(width, golden):
    assert_shown("dispersion-si", drawn, width, golden)
