"""Statistics over seeds: exact values, undefined seeds, published ensembles, a second field, and resumption."""

import csv
import json
import math

import numpy as np
import pytest

from lammps_inputs import strict_yaml
from workflow.cli import main
from workflow.studies.ensemble import study
from workflow.studies.ensemble.study import Question, statistics

pytestmark = pytest.mark.usefixtures("pool_here")

ROUNDING = 1e-14


def test_statistics_of_one_to_five_are_the_exact_ones_and_undefined_seeds_are_counted_apart():
    found = statistics([3.0, None, 1.0, 2.0, None, 5.0, 4.0], 0.1)
    assert (found.values, found.undefined, found.mean, found.q50) == (5, 2, 3.0, 3.0)
    assert found.standard_deviation == pytest.approx(math.sqrt(2.5), rel=ROUNDING)
    assert found.standard_error == pytest.approx(math.sqrt(0.5), rel=ROUNDING)
    assert found.interval_95 == pytest.approx(1.96 * math.sqrt(0.5), rel=ROUNDING)
    # linear between the ordered values: 1 + 4 q
    assert [found.q2_5, found.q16, found.q84, found.q97_5] == pytest.approx([1.1, 1.64, 4.36, 4.9], rel=ROUNDING)
    assert found.seeds_needed == math.ceil(1.96**2 * 2.5 / 0.3**2 * 7 / 5)


@pytest.mark.parametrize(
    ("values", "undefined"),
    [
        ([None, None], {"mean", "standard_error", "interval_95", "standard_deviation", "q50", "seeds_needed"}),
        ([2.0], {"standard_error", "interval_95", "standard_deviation", "seeds_needed"}),
        ([-1.0, 1.0], {"seeds_needed"}),
        ([0.1] * 3, set()),
    ],
)
def test_statistics_that_have_no_meaning_are_undefined(values, undefined):
    found = vars(statistics(values, 0.01))
    assert {name for name, value in found.items() if value is None and name not in ("q2_5", "q16", "q84", "q97_5")} == (
        undefined
    )
    if not undefined:
        assert (found["mean"], found["standard_deviation"]) == (0.1, 0.0)
        assert found["seeds_needed"] == 2  # one value has no interval


def test_the_figure_of_one_ensemble_shows_the_share_of_defined_values_below_each():
    seeds = [{"over": None, "seed": k, "mass": value} for k, value in enumerate([3.0, None, 1.0, 3.0, 5.0])]
    (axis,) = study._figure(study.Found(Question("test", {}, ("mass",), range(5)), {}, seeds, ""), "mass").axes
    (line,) = axis.get_lines()
    assert line.get_xydata().tolist() == [[1.0, 0.0], [3.0, 0.25], [3.0, 0.25], [5.0, 0.75]]
    assert axis.get_ylabel() == "share of defined values below"


CHAIN = {"name": "chain", "beads": 130, "disorder": {"mass": 0.2}, "kick": {"velocity": 1.0}, "duration": 150.0}
AT_100 = ["--quantity", "peak_velocity@100", "--quantity", "participation"]


def asked(tmp_path, *words, scene=CHAIN):
    """Exit code of the command, and the lines of both tables."""
    path = tmp_path / "chain.yaml"
    path.write_text(strict_yaml.dump(scene))
    code = main(["ensemble", str(path), *words, "-o", str(tmp_path / "found"), "--jobs", "1"])
    tables = [tmp_path / "found" / name for name in ("ensemble.csv", "seeds.csv")]
    return code, *(list(csv.DictReader(one.read_text().splitlines())) if one.is_file() else [] for one in tables)


# digits given with these numbers
HALF_SEVENTH, HALF_SIXTH = 0.5e-7, 0.5e-6


@pytest.mark.slow
def test_an_ensemble_of_200_chains_has_the_statistics_of_an_independent_integration(tmp_path):
    code, (peak, spread), seeds = asked(tmp_path, "--seeds", "0:199", *AT_100)
    assert (code, len(seeds), peak["values"], peak["undefined"]) == (0, 200, "200", "0")
    first = [float(row["peak_velocity@100"]) for row in seeds[:3]]
    assert first == pytest.approx([0.5755172, 0.5824558, 0.6120970], abs=HALF_SEVENTH)
    names = ("mean", "interval_95", "standard_deviation", "q2_5", "q97_5")
    given = [0.602358, 0.005721, 0.041282, 0.529943, 0.675352]
    assert [float(peak[name]) for name in names] == pytest.approx(given, abs=HALF_SIXTH)
    assert float(spread["mean"]) == pytest.approx(3.98430, abs=0.5e-5)
    assert peak["seeds_needed"] == "181"  # (1.96 * 0.041282 / 0.00602358)^2 = 180.4
    assert (tmp_path / "found" / "ensemble-peak_velocity-at-100.png").is_file()


SHORT = {**CHAIN, "beads": 24, "disorder": {"mass": 0.2, "stiffness": 0.1}, "duration": 18.0}


def test_a_bead_that_the_pulse_misses_is_undefined_and_no_quantity_defined_is_exit_code_1(tmp_path, capsys):
    code, (late,), seeds = asked(tmp_path, "--seeds", "4:5", "--quantity", "arrival@24", "--json", scene=SHORT)
    assert (code, late["values"], late["undefined"], late["mean"]) == (1, "0", "2", "")
    assert [row["arrival@24"] for row in seeds] == ["", ""]
    assert not list((tmp_path / "found").glob("*.png"))
    (told,) = json.loads(capsys.readouterr().out)["statistics"]
    assert (told["undefined"], told["mean"]) == (2, None)


OPPOSED = [{"velocity": 1.0}, {"bead": 24, "velocity": -0.5}]


@pytest.mark.parametrize("kick", [SHORT["kick"], OPPOSED], ids=["one", "opposed"])
def test_quantities_of_a_seed_are_those_of_a_run_with_that_seed_in_the_scene(kick, tmp_path):
    scene = {**SHORT, "kick": kick}
    _, _, (seed,) = asked(tmp_path, "--seeds", "5:5", "--quantity", "peak_velocity@10", *AT_100[2:], scene=scene)
    own = tmp_path / "own.yaml"
    own.write_text(strict_yaml.dump({**scene, "disorder": {**scene["disorder"], "seed": 5}}))
    assert main(["run", str(own), "--engine", "reference", "-o", str(tmp_path / "run")]) == 0
    assert main(["analyze", str(tmp_path / "run"), "--no-figures"]) == 0
    waves = csv.DictReader((tmp_path / "run" / "waves.csv").read_text().splitlines())
    (peak,) = (float(row["peak_velocity"]) for row in waves if row["bead"] == "10")
    report = json.loads((tmp_path / "run" / "analysis.json").read_text())
    found = [float(seed[name]) for name in ("peak_velocity@10", "participation")]
    assert found == pytest.approx([peak, report["participation"]], rel=1e-12)


def test_random_ingredients_have_seeds_of_their_own_and_parts_that_are_not_random_have_none():
    def seeded(strength):
        scene = {**SHORT, "contact": {"strength": strength}}
        return Question("test", scene, ("mass",), range(7, 8)).scenes(None)[0]

    ramp, random = {"from": 1.0, "to": 2.0, "contacts": [5, 9]}, {"spread": 0.2}
    assert seeded(ramp)["disorder"]["seed"] == 7
    assert seeded(ramp)["contact"]["strength"] == ramp
    both = seeded(random)
    assert (both["disorder"]["seed"], both["contact"]["strength"]["seed"]) == (7, 7 + 2**48)


BY_MASS = ["--seeds", "0:3", "--quantity", "mass", "--over", "disorder.mass=0.1,0.2"]


def test_masses_of_an_ensemble_have_the_mean_and_deviation_of_the_random_numbers(tmp_path):
    code, rows, seeds = asked(tmp_path, *BY_MASS, scene=SHORT)
    assert (code, len(rows), len(seeds)) == (0, 2, 8)
    assert [row["over"] for row in rows] == ["0.1", "0.2"]
    shares = np.array([np.random.default_rng(seed).random(24) for seed in range(4)])
    for row, spread in zip(rows, (0.1, 0.2), strict=True):
        exact = np.sum(1.0 + spread * (2.0 * shares - 1.0), axis=1)
        assert float(row["mean"]) == pytest.approx(exact.mean(), rel=ROUNDING)
        assert float(row["standard_deviation"]) == pytest.approx(exact.std(ddof=1), rel=1e-12)


@pytest.mark.parametrize(
    ("words", "scene", "says"),
    [
        (["--seeds", "3"], SHORT, "--seeds: '' is no number; such as 0:199"),
        (["--seeds", "3:1"], SHORT, "--seeds: 3:1 given; whole numbers, the smaller one first, such as 0:199"),
        (["--seeds", "0:1", "--precision", "0"], SHORT, "--precision: 0 given; 1e-09 to 1"),
        (["--seeds", "0:1"], {**SHORT, "disorder": None}, "has no random ingredient; add one, such as"),
        (["--seeds", "0:1", "--over", "disorder.seed=1,2"], SHORT, "--over disorder.seed: is what --seeds varies"),
        (["--seeds", "0:1", "--over", "disorder={mass: 1}"], SHORT, "different values with commas between"),
        (["--seeds", "0:1", "--over", "disorder.mass=0.1,1e-1"], SHORT, "different values with commas between"),
        (["--seeds", "0:1", "--over", "disorder.mass=0.1,2"], SHORT, "disorder.mass = 2: disorder.mass: should be"),
        (["--seeds", "0:1", "--quantity", "speed@25"], SHORT, "speed@25: the chains have 24 beads"),
        (["--seeds", "0:1", "--quantity", "speed@x"], SHORT, "should end in the number of a bead, such as speed@100"),
        (["--seeds", "0:1", "--quantity", "speeed"], SHORT, "is no quantity of an ensemble (did you mean `speed`?)"),
    ],
)
def test_a_mistake_is_one_line_and_exit_code_2(words, scene, says, tmp_path, capsys):
    scene = {key: value for key, value in scene.items() if value is not None}
    assert asked(tmp_path, *words, scene=scene) == (2, [], [])
    (line,) = capsys.readouterr().err.splitlines()
    assert says in line
