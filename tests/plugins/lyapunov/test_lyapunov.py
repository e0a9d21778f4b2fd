"""Lyapunov exponents: exact ones, their symmetry, an independent program, and what the command says."""

import csv
import json
import math

import numpy as np
import pytest

from workflow.cli import main
from workflow.plugins.derivatives import tangent
from workflow.plugins.lyapunov import growth
from workflow.plugins.lyapunov.study import Exponent, GrowthOfRun, combined

CHAOTIC = {
    **{"name": "small", "beads": 12, "kick": {"bead": 4, "velocity": 1}, "precompression": {"force": 0.125}},
    **{"walls": {"left": "bead", "right": "bead"}, "duration": 100},
}
DRAG = 0.1


def exponents(scene, count, duration, refinement=1):
    value = growth.computed(scene, "scene", count, refinement, 0, duration)
    return growth.exponents_of(np.array(value["time"]), np.array(value["growth"]))


@pytest.mark.slow
def test_deviations_of_a_chain_with_drag_decay_at_half_of_its_coefficient():
    # near rest each mode is an oscillator with x'' + gamma x' + omega^2 x = 0, omega > gamma / 2
    scene = CHAOTIC | {"beads": 6, "damping": {"beads": DRAG}, "kick": {"velocity": 0.01}}
    values, errors = exponents(scene, 12, 1000)
    time = tangent.problem_of(scene, "scene").scale.time
    # an interval of 2 pi / omega adds the ratio of lengths along an ellipse, omega^2, at its ends only
    assert np.allclose(values / time, -0.5 * DRAG, rtol=0.0, atol=2e-3)
    assert np.all(errors < 2e-3)


@pytest.mark.slow
def test_exponents_of_a_conservative_chain_are_pairs_of_opposite_sign():
    values, errors = exponents(CHAOTIC, 24, 1500)
    both = np.hypot(errors, errors[::-1])
    assert np.all(np.abs(values + values[::-1]) < 4.0 * both)
    assert abs(np.sum(values)) < 1e-9  # volume in phase space is kept
    assert values[0] > 10.0 * errors[0]


def verlet_exponent(step, duration):
    """Largest exponent of the chaotic chain by velocity Verlet and its tangent map, in NumPy, and its uncertainty."""
    rest, x, v = 0.25, np.zeros(14), np.zeros(14)
    v[4] = 1.0
    dx, dv = np.zeros((2, 14))
    dx[1:-1] = np.random.default_rng(3).normal(size=12)

    def forces():
        overlap = np.maximum(rest + x[:-1] - x[1:], 0.0)
        push, slope = overlap**1.5, 1.5 * np.sqrt(overlap) * (dx[:-1] - dx[1:])
        a, da = np.zeros((2, 14))
        a[1:-1], da[1:-1] = push[:-1] - push[1:], slope[:-1] - slope[1:]
        return a, da

    a, da = forces()
    rates, per_block = [], round(duration / step / 20)
    for _ in range(20):
        total = 0.0
        for _ in range(per_block):
            v, dv = v + 0.5 * step * a, dv + 0.5 * step * da
            x, dx = x + step * v, dx + step * dv
            a, da = forces()
            v, dv = v + 0.5 * step * a, dv + 0.5 * step * da
            size = math.sqrt(np.sum(dx * dx) + np.sum(dv * dv))
            dx, dv, da, total = dx / size, dv / size, da / size, total + math.log(size)
        rates.append(total / (per_block * step))
    return np.mean(rates[2:]), np.std(rates[2:], ddof=1) / math.sqrt(18)


@pytest.mark.slow
def test_largest_exponent_is_that_of_an_independent_program():
    expected, uncertainty = verlet_exponent(0.02, 3000)
    for refinement in (1, 2):
        values, errors = exponents(CHAOTIC, 1, 6000, refinement)
        assert abs(values[0] - expected) < 3.5 * math.hypot(errors[0], uncertainty)


def test_runs_that_differ_have_no_common_exponent():
    time = np.linspace(1.0, 1000.0, 200)
    noise = np.random.default_rng(0).normal(size=200)
    runs = [
        GrowthOfRun(1, start, time, (rate * time + 0.1 * noise)[:, np.newaxis])
        for start, rate in enumerate((0.03, 0.05))
    ]
    assert combined(runs) == [Exponent(1, None, None, None)]
    alike = combined([runs[0], runs[0]])[0]
    assert alike.exponent == pytest.approx(0.03, abs=1e-3)


@pytest.mark.parametrize(("rate", "noise"), [(0.0, 1e-3), (0.004, 0.1), (0.012, 3.0), (-0.012, 3.0)])
def test_exponents_of_the_size_of_their_uncertainty_or_of_regular_motion_are_bounded(rate, noise):
    time = np.linspace(1.0, 1000.0, 200)
    walk = np.random.default_rng(0).normal(size=(4, 200)).cumsum(axis=1)
    starts = [(1, 0), (1, 1), (2, 0), (2, 1)]
    runs = [
        GrowthOfRun(*start, time, (rate * time + noise * steps)[:, np.newaxis])
        for start, steps in zip(starts, walk, strict=True)
    ]
    [exponent] = combined(runs)
    assert (exponent.exponent, exponent.uncertainty) == (None, None)
    assert exponent.bound >= max(10.0 / 1000.0, abs(rate))


@pytest.mark.slow
def test_table_text_and_data_say_that_regular_motion_has_no_exponent(tmp_path, capsys):
    scene, out = tmp_path / "scene.yaml", str(tmp_path / "out")
    scene.write_text(json.dumps(CHAOTIC | {"kick": {"bead": 4, "velocity": 1e-4}}))
    words = ["lyapunov", str(scene), "--exponents", "2", "--duration", "2000", "-o", out]
    assert main(words) == 0
    assert "no exponent can be distinguished from 0: the largest is below" in capsys.readouterr().out
    for name in ("exponents.csv", "runs.csv"):
        with (tmp_path / "out" / name).open() as file:
            lines = list(csv.DictReader(file))
        assert lines
        assert {line["exponent"] + line["uncertainty"] for line in lines} == {""}
    assert main([*words, "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert [line["exponent"] for line in answer["exponents"]] == [None, None]
    assert all(line["bound"] > 0.0 for line in answer["exponents"])


def test_command_writes_tables_and_says_for_how_long_a_run_can_be_predicted(tmp_path, capsys):
    scene = tmp_path / "scene.yaml"
    scene.write_text(json.dumps(CHAOTIC))
    assert main(["lyapunov", str(scene), "--duration", "1500", "-o", str(tmp_path / "out")]) == 0
    printed = capsys.readouterr().out
    with (tmp_path / "out/exponents.csv").open() as file:
        [line] = csv.DictReader(file)
    value = float(line["exponent"])
    assert f"the largest Lyapunov exponent is {value:.4g} +- " in printed
    assert f"reach the velocity V after {math.log(2.0**53) / value:.4g} +- " in printed
    assert main(["lyapunov", str(scene), "--duration", "1500", "-o", str(tmp_path / "out"), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["chaotic"] is True
    assert answer["exponents"][0]["exponent"] == value  # from the cache
