"""Statistics of a sweep over seeds: groups, undefined cases, tables, figures, and a published ensemble."""

import csv
import json

import numpy as np
import pytest
from figure_table import table as table_of
from sweeps import sweep, sweep_file

import granchain
from analysis.statistics import statistics
from lammps_inputs import InputError, library
from workflow.cli import main
from workflow.quantities.columns import QUANTITIES
from workflow.quantities.evaluate import mass_of, of_scene
from workflow.sweep import statistics as grouping
from workflow.sweep.collect import SweepTable

pytestmark = pytest.mark.usefixtures("pool_here")

ROUNDING = 1e-14

CHAIN = {"name": "chain", "beads": 130, "disorder": {"mass": 0.2}, "kick": {"velocity": 1.0}, "duration": 150.0}
SHORT = {**CHAIN, "beads": 24, "disorder": {"mass": 0.2, "stiffness": 0.1}, "duration": 18.0}


def table(fields, cases):
    """Table of cases, each the values of the fields, an outcome and a speed."""
    blank = dict.fromkeys(QUANTITIES)
    rows = [
        {**blank, "case": str(number), **dict(zip(fields, values, strict=True)), "outcome": outcome, "speed": speed}
        for number, (*values, outcome, speed) in enumerate(cases)
    ]
    return SweepTable(list(fields), rows, False)


CASES = [(0.1, 0, "done", 1.0), (0.1, 1, "done", 3.0), (0.1, 2, "failed", 9.0)]
SEEDED = table(["disorder.mass", "disorder.seed"], [*CASES, (0.2, 0, "done", None), (0.2, 1, "done", 5.0)])


def test_groups_are_those_of_the_fields_that_are_no_seeds_and_cases_without_a_value_are_counted():
    assert grouping.default_fields(SEEDED) == ("disorder.mass",)
    first, second = grouping.grouped(SEEDED, "speed", ["disorder.mass"])
    assert (first.fields, second.fields) == ({"disorder.mass": 0.1}, {"disorder.mass": 0.2})
    assert (first.statistics.values, first.statistics.undefined, first.statistics.mean) == (2, 1, 2.0)
    assert (second.statistics.values, second.statistics.undefined, second.plain()["standard_error"]) == (1, 1, None)
    (everything,) = grouping.grouped(SEEDED, "speed", [])
    assert (everything.statistics.values, everything.statistics.undefined) == (3, 2)
    assert grouping.default_fields(table(["gap"], [(0.1, "done", 1.0)])) == ()


def test_figures_show_means_with_standard_errors_or_a_histogram_with_mean_and_median(golden):
    cases = [(mass, seed, "done", None if mass == 0.4 else mass * seed) for mass in (0.1, 0.2, 0.4) for seed in (1, 3)]
    seeded = table(["disorder.mass", "disorder.seed"], cases)
    one = table(["disorder.seed"], [(seed, "done", value) for seed, value in enumerate([1.0, 1.0, 3.0, 7.0])])
    for name, found, fields in (("groups", seeded, ["disorder.mass"]), ("histogram", one, [])):
        golden(name, table_of(grouping.drawn(found, grouping.grouped(found, "speed", fields))))


@pytest.mark.parametrize(
    ("fields", "values", "says"),
    [
        (["gap", "beads", "chains"], [(0.1, 4, 2), (0.2, 4, 2)], "at most two fields"),
        (["pattern"], [(["a"],), (["a", "b"],)], "pattern: is not a number in every case"),
        (["gap", "beads"], [(0.1, beads) for beads in range(9)], "beads has 9 values; a figure has at most 8 lines"),
    ],
)
def test_groups_that_cannot_be_drawn_are_refused_with_the_reason(fields, values, says):
    undrawable = table(fields, [(*place, "done", 1.0) for place in values])
    groups = grouping.grouped(undrawable, "speed", fields)
    assert len(groups) == len(values)
    with pytest.raises(InputError, match=says):
        grouping.drawn(undrawable, groups)


def test_the_command_and_the_function_have_statistics_of_quantities_also_at_a_bead(tmp_path, capsys):
    """Of a sweep of a short disordered chain over two spreads and three seeds."""
    seeds, vary = tmp_path / "s", {"disorder__seed": {"from": 4, "to": 6}, "disorder__mass": [0.1, 0.2]}
    assert sweep(sweep_file(tmp_path, SHORT, engine="reference", **vary), seeds) == 0
    capsys.readouterr()
    assert main(["collect", str(seeds), "--statistics", "peak_velocity@10,participation", "--json"]) == 0
    first, *others = json.loads(capsys.readouterr().out)
    assert len(others) == 3
    peaks = []
    for seed in (4, 5, 6):
        table = (seeds / f"disorder.mass=0.1,disorder.seed={seed}" / "waves.csv").read_text().splitlines()
        peaks += [float(row["peak_velocity"]) for row in csv.DictReader(table) if row["bead"] == "10"]
    assert first["values"] == 3
    assert first["mean"] == pytest.approx(np.mean(peaks), rel=ROUNDING)
    rows = list(csv.DictReader((seeds / "statistics.csv").read_text().splitlines()))
    assert [(row["quantity"], row["disorder.mass"], row["values"]) for row in rows] == [
        (name, mass, "3") for name in ("peak_velocity@10", "participation") for mass in ("0.1", "0.2")
    ]
    groups = granchain.statistics(granchain.collect(seeds, ["peak_velocity@10"]), "peak_velocity@10")
    assert [group.statistics.mean for group in groups] == [float(row["mean"]) for row in rows[:2]]


def test_masses_of_disordered_chains_have_the_mean_and_deviation_of_the_random_numbers():
    shares = np.array([np.random.default_rng(seed).random(24) for seed in range(4)])
    for spread in (0.1, 0.2):
        scenes = [{**SHORT, "disorder": {"mass": spread, "seed": seed}} for seed in range(4)]
        found = statistics(np.array([mass_of(library.from_plain(scene, "test")) for scene in scenes]))
        exact = np.sum(1.0 + spread * (2.0 * shares - 1.0), axis=1)
        assert found.mean == pytest.approx(exact.mean(), rel=ROUNDING)
        assert found.standard_deviation == pytest.approx(exact.std(ddof=1), rel=1e-12)


# digits given with these numbers
HALF_SEVENTH, HALF_SIXTH = 0.5e-7, 0.5e-6


@pytest.mark.slow
def test_200_disordered_chains_have_the_statistics_of_an_independent_integration():
    names = ("peak_velocity@100", "participation")
    scenes = [{**CHAIN, "disorder": {"mass": 0.2, "seed": seed}} for seed in range(200)]
    peaks, spread = np.array([list(of_scene(scene, names, "test").values()) for scene in scenes]).T
    assert peaks[:3] == pytest.approx([0.5755172, 0.5824558, 0.6120970], abs=HALF_SEVENTH)
    found = statistics(peaks)
    assert (found.values, found.undefined) == (200, 0)
    assert found.mean == pytest.approx(0.602358, abs=HALF_SIXTH)
    assert 1.96 * found.standard_error == pytest.approx(0.005721, abs=HALF_SIXTH)
    assert found.standard_deviation == pytest.approx(0.041282, abs=HALF_SIXTH)
    assert np.quantile(peaks, [0.025, 0.975]) == pytest.approx([0.529943, 0.675352], abs=HALF_SIXTH)
    assert statistics(spread).mean == pytest.approx(3.98430, abs=0.5e-5)
