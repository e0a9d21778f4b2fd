"""Linear modes and periodic states: closed forms, published numbers, symplectic maps, folds, LAMMPS, the command."""

import csv
import json
import math
from dataclasses import replace

import numpy as np
import pytest

from analysis import motion
from workflow.cli import main
from workflow.plugins.derivatives import tangent
from workflow.plugins.modes import branches, continuation, floquet, lammps_check, linear, shooting

pytestmark = pytest.mark.usefixtures("lammps_here")

CHAIN = {
    **{"name": "chain", "beads": 12, "kick": {"velocity": 1}, "duration": 10},
    **{"precompression": {"force": 1}, "walls": {"left": "bead", "right": "bead"}},
}
FOUR = {
    **{**CHAIN, "name": "four", "chains": 2, "beads": 2, "precompression": {"force": 0.2**1.5}},
    **{"foundation": {"stiffness": 1}, "coupling": {"stiffness": 0.05}},
}


def modes_of(scene):
    problem = tangent.problem_of(scene, "scene")
    return problem, linear.linear_modes(problem, "scene")


def last_state(scene, mode, energy, doublings=0):
    """Shooting for a mode, counted from 1, and the last state of its branch."""
    problem, modes = modes_of(scene)
    solver = branches.shooting_of(problem, modes, mode - 1, doublings)
    branch = shooting.follow(solver, mode - 1 - modes.zeros, energy, 60)
    assert not branch.why
    return solver, branch.states[-1]


# --- linear modes -----------------------------------------------------------------------------------------------------


def test_frequencies_of_a_loaded_chain_between_fixed_beads_are_those_of_springs():
    _, modes = modes_of(CHAIN)
    number = np.arange(1, 13)
    assert np.allclose(modes.frequency, 2.0 * math.sqrt(1.5) * np.sin(0.5 * np.pi * number / 13), rtol=1e-12)
    assert modes.frequency[[0, -1]] == pytest.approx([0.29525336, 2.43163020], abs=5e-9)
    shape = np.sin(np.pi * np.outer(number, number) / 13)
    assert np.allclose(np.abs(modes.shapes[:, 0]), np.abs(shape) * math.sqrt(2.0 / 13), atol=1e-10)
    # (sum e)^2 / sum e^2 of e = sin^2: (13 / 2)^2 / (3 / 8 * 13)
    assert linear.centre(modes.energies[0], modes.system) == pytest.approx((13.0 * 2.0 / 3.0, 6.5, 1.0))


def test_resonators_are_further_atoms_and_open_the_gap_of_an_infinite_chain():
    scene = CHAIN | {"beads": 60, "resonators": {"mass": 0.1, "stiffness": 1}, "precompression": {"force": 0.125}}
    _, modes = modes_of(scene)
    assert len(modes.frequency) == 120
    edges = sorted(modes.frequency)[59:61]  # published edges of the gap: 1.625146 and 3.316625
    assert edges[0] == pytest.approx(1.625146, rel=1e-3)
    assert edges[0] < 1.625146 < 3.316625 < edges[1]


@pytest.mark.slow
def test_a_chain_with_free_ends_drifts_and_its_periodic_states_do_not():
    scene = {key: value for key, value in CHAIN.items() if key != "walls"} | {"beads": 5}
    _, modes = modes_of(scene)
    assert modes.zeros == 1
    assert linear.free_to_drift(modes)
    solver, state = last_state(scene, 2, 0.1)
    assert state.residual < 1e-11
    assert abs(np.sum(solver.displacement(state.y))) < 1e-12
    assert floquet.multipliers(solver, state).values.shape == (6,)  # four vibrations, less one pair


@pytest.mark.slow
@pytest.mark.parametrize("beads", [3, 4, 7])
def test_a_bonded_ring_has_its_exact_spectrum(beads):
    contact = {"force": "k*s", "k": 0.7, "tension": "allowed"}
    ring = {"name": "ring", "beads": beads, "periodic": True, "contact": contact, "kick": {"velocity": 1.0}}
    _, modes = modes_of({**ring, "duration": 20.0})
    # lengths are in units in which the stiffness of the contacts is 1
    exact = sorted(2.0 * abs(math.sin(math.pi * j / beads)) for j in range(beads))
    np.testing.assert_allclose(modes.frequency, exact, rtol=0.0, atol=1e-7)  # of the mean the root of rounding


# --- periodic states --------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(("mode", "frequency"), [(1, 0.29942993), (12, 2.42683789)])
def test_nonlinear_modes_of_twelve_beads_have_the_published_frequencies(mode, frequency):
    solver, state = last_state(CHAIN, mode, 0.5)
    assert solver.energy(state.y) == pytest.approx(0.5, rel=1e-11)
    assert 2.0 * math.pi / state.period == pytest.approx(frequency, abs=6e-9)
    assert state.residual < 1e-11
    assert floquet.multipliers(solver, state).stable


@pytest.mark.slow
def test_a_state_with_opening_contacts_is_unstable_with_the_published_multiplier():
    solver, state = last_state(FOUR, 3, 0.1, doublings=2)
    values = floquet.multipliers(solver, state)
    assert 2.0 * math.pi / state.period == pytest.approx(1.687457, abs=6e-7)
    assert values.largest == pytest.approx(1.16753, abs=1e-5)
    assert not values.stable
    assert values.outside() == (1, 0, 0)


@pytest.mark.slow
def test_the_monodromy_matrix_is_symplectic_and_that_of_a_full_period():
    solver, state = last_state(FOUR, 3, 0.02)
    matrix, asymmetry = floquet.monodromy(solver, state)
    count = len(state.y)
    turn = np.block([[np.zeros((count, count)), np.eye(count)], [-np.eye(count), np.zeros((count, count))]])
    assert asymmetry < 1e-13
    assert np.max(np.abs(matrix.T @ turn @ matrix - turn)) < 1e-12


@pytest.mark.slow
def test_multipliers_near_rest_are_those_of_the_linear_modes():
    problem, modes = modes_of(FOUR)
    solver = branches.shooting_of(problem, modes, 0)
    state = shooting.first_state(solver, 0, 1e-10).state
    angles = np.sort(np.angle(floquet.multipliers(solver, state).values))
    expected = 2.0 * np.pi * modes.frequency[1:] / modes.frequency[0]
    wrapped = (np.concatenate([expected, -expected]) + np.pi) % (2.0 * np.pi) - np.pi
    assert np.allclose(angles, np.sort(wrapped), atol=1e-5)


@pytest.mark.slow
def test_newton_converges_quadratically():
    problem, modes = modes_of(CHAIN)
    first = shooting.first_state(branches.shooting_of(problem, modes, 11), 11, 1e-3)
    assert first.iterations <= 3
    assert first.state.residual < 1e-12


@pytest.mark.slow
def test_a_branch_changes_stability_where_its_multipliers_pass_one():
    value = branches.computed(FOUR, "scene", 2, 0.06, 60, [0.03, 1e-7], 8)
    [change] = value["bifurcations"]
    low, high = change["energies"]
    assert (change["kind"], change["outside"]) == ("+1", [0, 1])
    assert 0.0 < high - low < 1e-4
    for energy, stable in ((low * 0.999, True), (high * 1.01, False)):
        solver, state = last_state(FOUR, 3, energy)
        assert floquet.multipliers(solver, state).stable == stable
    given = [state["energy"] for state in value["states"] if state["role"] == "energy"]
    assert given == pytest.approx([1e-7, 0.03], rel=1e-11)


@pytest.mark.slow
def test_continuation_passes_folds_in_energy_and_in_frequency():
    problem, modes = modes_of(CHAIN | {"beads": 6})
    solver = branches.shooting_of(problem, modes, 0)
    branch = shooting.follow(solver, 0, 8.0, 100)
    assert not branch.why
    energy = np.array([solver.energy(state.y) for state in branch.states])
    frequency = np.array([2.0 * np.pi / state.period for state in branch.states])
    for values in (energy, frequency):
        assert np.any(np.diff(values) > 0.0)
        assert np.any(np.diff(values) < 0.0)
    assert max(state.residual for state in branch.states) < continuation.ROUNDED
    # three states of one energy, between the folds near 5.36 and 5.21
    value = branches.computed(CHAIN | {"beads": 6}, "scene", 0, 8.0, 100, [5.3], 0)
    given = [state for state in value["states"] if state["role"] == "energy"]
    assert [state["energy"] for state in given] == pytest.approx([5.3] * 3, rel=1e-10)
    assert len({round(state["period"], 6) for state in given}) == 3
    assert [change["kind"] for change in value["bifurcations"]].count("fold") >= 1


# --- LAMMPS -----------------------------------------------------------------------------------------------------------


def test_lammps_closes_contacts_that_start_open_by_more_than_half_a_diameter_with_order_2():
    problem, _ = modes_of({key: value for key, value in CHAIN.items() if key != "walls"} | {"beads": 4})
    x, time = np.array([[-2.25, -2.25, 2.25, 2.25]]), 8.0
    energy = float(motion.energy(problem.system, x, np.zeros_like(x)))
    flow = tangent.make_flow(problem, 0, time / 4000)
    flow.state.x[1:-1], flow.state.v[:] = x.T, 0.0
    flow.advance(0, 4000)
    error = []
    for steps in (800, 1600):
        run = lammps_check.lammps_problem(problem, energy, time, steps, 1)
        run = replace(run, steps_per_frame=steps // 40, frames=40)
        assert x[0, 2] - x[0, 1] > run.layout.diameter / 2.0  # LAMMPS's skin about the places at rest
        displacement, _ = lammps_check.run(run, x, np.zeros_like(x))
        error.append(np.max(np.abs(displacement[-1] - flow.state.x[1:-1].T)))
        places = run.layout.places + displacement
        assert np.min(places[..., 2:] - places[..., :-2]) > run.layout.diameter  # second neighbours never touch
        assert np.max(motion.overlaps(problem.system, displacement)) > 1.5  # it closes, beyond its overlap 1 at rest
    assert math.log2(error[0] / error[1]) == pytest.approx(2.0, abs=0.1)
    assert error[0] < 1e-4


@pytest.mark.slow
def test_lammps_returns_to_a_state_with_order_2_and_leaves_it_at_the_multipliers_rate():
    value = branches.computed(FOUR, "scene", 2, 0.1, 60, [], 0)
    check = lammps_check.computed(FOUR, "scene", 2, value["states"][-1], value["steps"])
    assert check["steps"] == 800
    assert check["velocity"] == pytest.approx([6.2e-6, 1.5e-6], rel=0.07)  # published with two digits
    assert math.log2(check["velocity"][0] / check["velocity"][1]) == pytest.approx(2.0, abs=0.01)
    assert check["growth"][1] == pytest.approx(check["predicted"], rel=1e-4)  # multipliers are right to some 1e-5


@pytest.mark.slow
def test_lammps_stays_on_a_stable_state_for_a_hundred_periods():
    value = branches.computed(CHAIN, "scene", 11, 0.5, 60, [], 0)
    state = value["states"][-1]
    check = lammps_check.computed(CHAIN, "scene", 11, state, value["steps"])
    assert check["periods"] == 100
    # the period of LAMMPS differs by the order 2: a phase of 100 * 2 pi (2 pi / 800)^2 / 24, whose square moves x
    phase = 100 * 2.0 * math.pi * (2.0 * math.pi / 800) ** 2 / 24
    assert check["later"] < phase**2 * np.linalg.norm(state["x"])


@pytest.mark.slow
def test_decks_of_states_with_foundations_and_resonators_start_on_them():
    scene = FOUR | {"resonators": {"mass": 0.3, "stiffness": 0.5}}
    value = branches.computed(scene, "scene", 0, 0.02, 60, [], 0)
    check = lammps_check.computed(scene, "scene", 0, value["states"][-1], value["steps"])
    assert math.log2(check["velocity"][0] / check["velocity"][1]) == pytest.approx(2.0, abs=0.05)


# --- the command ------------------------------------------------------------------------------------------------------


@pytest.mark.usefixtures("drawn")
def test_the_command_writes_tables_arrays_and_figures(tmp_path, capsys):
    path, out = tmp_path / "scene.yaml", tmp_path / "out"
    path.write_text(json.dumps(FOUR))
    words = ["modes", str(path), "--mode", "3", "--energy", "0.05", "--points", "40", "--no-lammps", "-o", str(out)]
    assert main([*words, "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    with (out / "states.csv").open() as file:
        lines = list(csv.DictReader(file))
    assert [float(line["energy"]) for line in lines] == [state["energy"] for state in answer["states"]]
    assert (lines[0]["stable"], lines[-1]["stable"]) == ("yes", "no")
    with np.load(out / "states.npz") as arrays:
        assert arrays["mode_3_displacement"].shape == (len(lines), 2, 2)
        assert arrays["mode_3_multipliers"].shape == (len(lines), 6)
    assert {"frequency.png", "shapes.png", "multipliers.png", "motion.png"} <= {file.name for file in out.iterdir()}
    assert main(words) == 0  # from the cache
    assert "states of this branch are stable" in capsys.readouterr().out


def test_linear_modes_alone_are_those_of_touching_chains_across_and_write_no_empty_table(tmp_path, capsys):
    path, out = tmp_path / "scene.yaml", tmp_path / "out"
    scene = {key: value for key, value in FOUR.items() if key not in ("precompression", "foundation")}
    path.write_text(json.dumps(scene))
    assert main(["modes", str(path), "--linear", "-o", str(out), "--json"]) == 0
    frequencies = [mode["frequency"] for mode in json.loads(capsys.readouterr().out)["modes"]]
    assert frequencies == pytest.approx([0.0, 0.0, math.sqrt(0.1), math.sqrt(0.1)])
    assert {file.name for file in out.iterdir()} == {"modes.csv", "states.npz", "cases.jsonl", "run.json"}
