"""Responses of driven, damped scenes: closed forms, balances, folds, period doubling, LAMMPS's sweep, the command."""

import csv
import json
import math

import numpy as np
import pytest

from workflow.cli import main
from workflow.plugins.derivatives import tangent
from workflow.plugins.modes import driven, lammps_sweep, response, response_tables

pytestmark = pytest.mark.usefixtures("lammps_here")

DRIVEN = {
    **{"name": "driven", "beads": 2, "precompression": {"force": 1}, "walls": {"left": "bead", "right": "bead"}},
    **{"damping": {"beads": 0.1}, "drive": {"force": 0.3, "frequency": 0.3}, "duration": 100},
}
STIFFNESS = 1.5  # of a contact of force overlap^1.5 under a load of 1


def curve_of(scene, low, high, further=()):
    """Time unit, velocity unit and the curve between two frequencies, with responses of further ones."""
    scale = tangent.problem_of(scene, "scene").scale
    low, high, *further = (1.0 / (frequency * scale.time) for frequency in (low, high, *further))
    return scale, response.computed(scene, "scene", (low, high), 400, further, 10)


def response_of(scene, frequency):
    """Shooting, and the response near the linear one at a frequency of the scene."""
    problem = tangent.problem_of(scene, "scene")
    solver = response.DrivenShooting(problem, 512, 2.0 * math.pi * frequency * problem.scale.time, 1.0)
    corrected = solver.linear(1.0 / (frequency * problem.scale.time))
    assert corrected is not None
    return solver, corrected.state


# --- closed forms -----------------------------------------------------------------------------------------------------


def closed_form(scene, drive, omega):
    """Displacements at phase 0 of a chain of springs and dashpots between fixed beads, from its own matrices."""
    count = scene["beads"]
    chain = 2.0 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1)
    damping = scene["damping"]["beads"] * np.eye(count) + scene["damping"]["contact"] * chain
    dynamic = STIFFNESS * chain - omega**2 * np.eye(count) + 1j * omega * damping
    if "force" in drive:
        return np.linalg.solve(dynamic, drive["force"] * np.exp(1j * drive["angle"]) * np.eye(count)[0]).imag
    shaken = drive["displacement"] * np.exp(1j * drive["angle"])
    shift = -drive["displacement"] * math.sin(drive["angle"])
    others = np.linalg.solve(dynamic[1:, 1:], -dynamic[1:, 0] * shaken).imag
    return np.append(shaken.imag + shift, others + np.linalg.solve(chain[1:, 1:], -chain[1:, 0] * shift))


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "dashpots"), [("force", 0.1), ("displacement", 0.0)])
def test_small_responses_are_those_of_springs_and_dashpots_up_to_the_square_of_the_drive(kind, dashpots):
    deviations = []
    for size in (1e-3, 1e-4):
        drive = {kind: size, "frequency": 0.2, "phase": 50}
        scene = DRIVEN | {"beads": 4, "damping": {"beads": 0.05, "contact": dashpots}, "drive": drive}
        solver, state = response_of(scene, 0.2)
        x = solver.samples(state)[0][0, 0] * solver.problem.scale.length
        expected = closed_form(scene, drive | {"angle": math.radians(50)}, 0.4 * math.pi)
        deviations.append(np.linalg.norm(x - expected) / size)
    assert deviations[0] < 1e-2
    assert deviations[0] / deviations[1] == pytest.approx(10.0, rel=0.05)


def test_the_linear_response_of_a_problem_is_that_of_springs_and_dashpots():
    drive = {"force": 1e-3, "frequency": 0.2, "phase": 50}
    scene = DRIVEN | {"beads": 4, "damping": {"beads": 0.05, "contact": 0.1}, "drive": drive}
    problem = tangent.problem_of(scene, "scene")
    x = driven.linear_response(problem)[0][0] * problem.scale.length
    # overlaps at rest are rounded to what places in LAMMPS distinguish
    assert np.allclose(x, closed_form(scene, drive | {"angle": math.radians(50)}, 0.4 * math.pi), rtol=1e-6, atol=0.0)


# --- balances ---------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_work_of_the_drive_is_dissipated_in_a_period_after_which_the_state_returns():
    solver, state = response_of(DRIVEN | {"drive": {"force": 0.1, "frequency": 0.3}}, 0.33)
    scale = solver.problem.scale
    v = solver.samples(state)[1][:, 0] * scale.velocity
    phase = 2.0 * math.pi * np.arange(response.SAMPLES) / response.SAMPLES
    work, dissipated = np.mean(0.1 * np.sin(phase) * v[:, 0]), np.mean(np.sum(0.1 * v**2, axis=1))
    assert np.max(np.abs(v)) > 0.3  # far from linear: sound has velocities below 0.1
    assert work == pytest.approx(dissipated, rel=1e-8)
    assert state.residual < 1e-12
    assert np.linalg.norm(solver.mapped(state.y, state.period) - state.y) < 1e-12 * np.linalg.norm(state.y)


@pytest.mark.slow
def test_the_product_of_the_multipliers_is_the_decay_of_volumes_in_phase_space():
    scene = DRIVEN | {"beads": 3, "damping": {"beads": 0.05, "contact": 0.1}, "drive": {"force": 0.1, "frequency": 0.3}}
    solver, state = response_of(scene, 0.25)
    product = np.prod(solver.multipliers(state).values)
    # three beads with drag, each between two dashpots
    assert product == pytest.approx(math.exp(-3 * (0.05 + 2 * 0.1) / 0.25), rel=1e-9)


# --- bifurcations -----------------------------------------------------------------------------------------------------


FOLDS = (0.32127039, 0.31593792)
"""Frequencies of the folds of `DRIVEN`, upper and lower, with 512 steps a period; responses appear and vanish there."""

SWEPT = np.linspace(0.314, 0.324, 4).tolist()


@pytest.fixture(scope="module")
def bent():
    """Scale and curve of `DRIVEN` with responses near the folds and of the frequencies of the sweep."""
    further = [fold + side for fold in FOLDS for side in (1e-5, -1e-5)]
    return curve_of(DRIVEN, SWEPT[0], SWEPT[-1], [*further, *SWEPT])


@pytest.mark.slow
def test_between_two_folds_there_are_three_responses_of_which_the_middle_one_is_unstable(bent):
    scale, curve = bent
    upper, lower = curve["bifurcations"]
    assert [upper["kind"], lower["kind"]] == ["fold", "fold"]
    assert [upper["outside"], lower["outside"]] == [[0, 1], [1, 0]]
    for fold, change, side in zip(FOLDS, (upper, lower), (1e-5, -1e-5), strict=True):
        assert change["uncertainty"] / scale.time < response.DIGITS
        assert change["frequency"] / scale.time == pytest.approx(fold, abs=2.0 * change["uncertainty"] / scale.time)
        assert stable_at(bent, fold + side) == [True]
        assert stable_at(bent, fold - side) == [True, False, True]
    assert max(state["residual"] for state in curve["states"]) < 1e-9


def stable_at(bent, frequency):
    """Whether the responses of a frequency are stable, in order along the curve."""
    scale, curve = bent
    return [state["stable"] for state in curve["states"] if abs(state["period"] * frequency * scale.time - 1.0) < 1e-12]


@pytest.mark.slow
def test_period_doubling_is_around_twice_the_frequency_of_a_mode():
    scene = DRIVEN | {"damping": {"beads": 0.02}}
    scale, curve = curve_of(scene, 0.36, 0.42)
    first, second = curve["bifurcations"]
    assert [first["kind"], second["kind"]] == ["-1", "-1"]
    mode = math.sqrt(STIFFNESS) / (2.0 * math.pi)  # both beads alike, between two walls
    assert first["frequency"] / scale.time < 2.0 * mode < second["frequency"] / scale.time


# --- LAMMPS -----------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_lammps_jumps_at_the_folds_and_else_follows_the_curve_within_the_error_of_its_scheme(bent):
    problem, (scale, curve) = tangent.problem_of(DRIVEN, "scene"), bent
    periods = [1.0 / (frequency * scale.time) for frequency in SWEPT]
    energy = max(state["energy"] for state in curve["states"])
    sweep = lammps_sweep.computed(DRIVEN, "scene", periods, energy, driven.slowest_decay(problem, "scene"))
    found = response_tables.ResponseResult(problem, (1, 1), curve, sweep)
    spacing = (SWEPT[1] - SWEPT[0]) * scale.time
    jumps = {(jump.direction, jump.branch): jump for jump in found.jumps()}
    folds = {change.after: change.frequency for change in found.bifurcations()}
    assert set(jumps) == {("up", "lower"), ("down", "upper")}
    for jump, fold in ((jumps["up", "lower"], folds[1]), (jumps["down", "upper"], folds[0])):
        assert jump.fold == fold
        assert min(jump.before, jump.after) < fold < max(jump.before, jump.after)
        assert abs(jump.after - jump.before) == pytest.approx(spacing)
    amplitude, frequency = found.amplitudes(found.data["states"]), [line.frequency for line in found.responses()]
    compared = 0
    for step, raw in zip(found.steps(), found.sweep, strict=True):
        if step.change > 1e-5:
            continue  # transients of a jump, or of the start, are slower
        number = step.response - 1
        near = slice(max(0, number - 1), number + 2)
        slope = np.max(np.abs(np.gradient(np.log(amplitude[near]), np.log(frequency[near]))))
        shift = (2.0 * math.pi / raw["steps"]) ** 2 / 24.0  # of the frequencies of velocity Verlet
        assert abs(step.deviation) < 2.0 * shift * slope + math.exp(-lammps_sweep.DECAYED)
        compared += 1
    assert compared >= 5


@pytest.mark.slow
def test_lammps_moves_a_bead_of_prescribed_motion_on_from_step_to_step():
    shaken = {"displacement": 0.02, "frequency": 0.2, "phase": 30}
    scene = DRIVEN | {"beads": 3, "damping": {"beads": 0.3}, "drive": shaken}
    solver, state = response_of(scene, 0.18)
    x, v = solver.samples(state)
    steps = lammps_sweep.computed(scene, "scene", [state.period], 1.0, driven.slowest_decay(solver.problem, "scene"))
    assert [step["direction"] for step in steps] == ["up", "down"]
    for step in steps:
        assert np.allclose(step["speed"], response.largest(v), rtol=1e-3)
        # bead 1 has the speed of its motion
        speed = step["speed"][0][0] * solver.problem.scale.velocity
        assert speed == pytest.approx(0.02 * 2.0 * math.pi * 0.18, rel=1e-5)
    assert steps[1]["change"] < steps[0]["change"]
    assert abs(x[0, 0, 0]) < 1e-12  # the motion is displaced by its start, so that it begins at rest's place


# --- the command ------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.usefixtures("drawn")
def test_the_command_writes_the_curve_in_units_of_the_scene(tmp_path, capsys):
    path, out = tmp_path / "scene.yaml", tmp_path / "out"
    material = {"radius": 4.76e-3, "density": 8000, "youngs_modulus": 193e9, "poisson_ratio": 0.3}
    steel = {"material": material, "precompression": {"force": 20}, "damping": {"beads": 5}}
    steel |= {"drive": {"force": 0.5, "frequency": 3000}}
    path.write_text(json.dumps(DRIVEN | steel | {"duration": 1e-3}))
    words = ["modes", str(path), "--frequencies", "3000,9000", "--no-lammps", "--bead", "1,2", "-o", str(out)]
    words += ["--points", "8"]
    assert main([*words, "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    with (out / "responses.csv").open() as file:
        lines = list(csv.DictReader(file))
    assert [float(line["frequency (Hz)"]) for line in lines] == [line["frequency"] for line in answer["responses"]]
    assert len(lines) == 8
    assert answer["responses"][0]["frequency"] == pytest.approx(3000.0)
    assert answer["sweep"] == []
    assert {"bifurcations.csv", "sweep.csv", "response.png"} <= {file.name for file in out.iterdir()}
    assert main(words) == 0  # from the cache
    printed = capsys.readouterr().out
    assert "amplitudes are largest speeds of bead 2 of chain 1" in printed
    assert "Hz: it has 8 states, as many as `--points` allows" in printed
