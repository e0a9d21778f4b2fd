"""Designs: what a file may say, that the search finds the best, goes on where it was stopped, and LAMMPS agrees."""

import csv
import json
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import granchain
from lammps_inputs import library, strict_yaml
from workflow.cli import main
from workflow.plugins.design import file
from workflow.plugins.design.file import Variable
from workflow.plugins.design.result import DesignResult, Sensitivity, sensitivity
from workflow.plugins.design.search import DesignRecord, computed, search, worth
from workflow.quantities.evaluate import of_scene
from workflow.runs.run import run
from workflow.sweep.collect import collect
from workflow.workers.computations import StoredResults, values
from workflow.workers.pool import Pool

pytestmark = pytest.mark.usefixtures("lammps_here", "pool_here")

SCENE = {
    **{"name": "small", "chains": 2, "beads": 12, "coupling": {"stiffness": 0.1}, "walls": {"right": "rigid"}},
    **{"kick": {"velocity": 1}, "duration": 30},
}
SMALL = {
    "scene": SCENE,
    "vary": {"coupling.stiffness": [0.02, 0.1, 0.5, 2.0], "beads": {"from": 8, "to": 14}},
    "minimize": "wall_force",
    "where": {"mass": {"from": 20}},
    "also": ["delay"],
    "beside": {**SCENE, "chains": 1, "beads": 24, "duration": 50},
    "manufacture": {"members": 8},
    "verify": 1,
}


def computing(design, cache=None):
    """Computes designs in this process."""
    return partial(computed, design, evaluated=partial(values, cache=cache, pool=Pool(1)))


def written(directory, **changes):
    path = directory / "design.yaml"
    path.write_text(strict_yaml.dump(json.loads(json.dumps({**SMALL, **changes}))))  # no part is there twice
    return path


@pytest.fixture(scope="module")
def found(tmp_path_factory, request):
    """The small design, carried out by the command in this process."""
    for here in ("lammps_here", "pool_here"):
        request.getfixturevalue(here)
    directory = tmp_path_factory.mktemp("design")
    assert main(["design", str(written(directory)), "-o", str(directory / "d"), "--jobs", "1"]) == 0
    return directory / "d"


@pytest.mark.slow
def test_where_designs_can_be_counted_all_are_computed_and_the_best_is_verified_varied_and_reported(found):
    rows = list(csv.DictReader((found / "designs.csv").read_text().splitlines()))
    assert len(rows) == 4 * 7
    fitting = [float(row["wall_force"]) for row in rows if row["fits"] == "yes"]
    assert fitting == sorted(fitting)
    assert all((int(row["beads"]) >= 10) == (row["fits"] == "yes") for row in rows)
    report = json.loads((found / "design.json").read_text())
    best, verified = report["quantities"]["wall_force"], report["verified"][0]
    assert verified["error_velocity"] < 5e-4
    for name in ("wall_force", "delay"):
        assert verified["lammps"][name] == pytest.approx(verified["reference"][name], rel=1e-3)
    members = report["manufacture"]["members"]
    assert len(members) == 8
    assert all(0.0 < abs(value / best - 1.0) < 0.1 for value in members)
    page = (found / "index.html").read_text()
    assert page.count("<img") == 5
    assert 'src="http' not in page
    again = granchain.design(SMALL, str(found), jobs=1)
    assert again.best.quantities["wall_force"] == best


EVOLUTION = {"evaluations": 20, "population": 8}


@pytest.mark.slow
def test_evolution_finds_what_no_exhaustive_search_betters(found, tmp_path):
    """With fewer designs than there are; those that it asks for are kept from the exhaustive search."""
    design = file.load(written(tmp_path, search=EVOLUTION))
    with StoredResults(found / "evaluations.jsonl") as cache:
        best = min(worth(design, record) for record in search(design, computing(design, cache)))
        everything = file.load(written(tmp_path))
        assert best == min(worth(everything, record) for record in search(everything, computing(everything, cache)))


def test_limits_come_before_the_objective_and_what_is_no_scene_is_worse_than_any_other(tmp_path):
    design = file.load(written(tmp_path))
    designs = [{"coupling.stiffness": 0.1, "beads": beads} for beads in (8, 12, 6)]
    light, heavy, lighter, refused = computing(design)([*designs, {"coupling.rows": [10, 14]}])
    assert light.quantities == {"mass": 16.0}  # which rules it out before anything runs
    assert "coupling.rows: 10 to 14 given" in refused.refused
    assert worth(design, heavy) < worth(design, light) < worth(design, lighter) < worth(design, refused) == np.inf
    limit = file.Limit.model_validate({"from": 2, "to": 4})
    assert [limit.violation(value) for value in (1.0, 2.0, 3.0, 4.0, 6.0)] == [0.5, 0.0, 0.0, 0.0, 0.5]
    assert limit.violation(None) > 0.0  # what is not known keeps no limit


@pytest.mark.parametrize(("wanted", "better"), [("minimize", 0), ("maximize", 1)])
def test_what_is_wanted_is_small_or_large(wanted, better, tmp_path):
    path = tmp_path / "design.yaml"
    plain = {"scene": SCENE, "vary": {"coupling.stiffness": {"from": 0.1, "to": 1}}, wanted: "delay"}
    path.write_text(strict_yaml.dump(plain))
    records = [DesignRecord({}, {"delay": delay}, "", 0.0) for delay in (10.0, 11.0)]
    assert min(records, key=lambda one: worth(file.load(path), one)) is records[better]


@pytest.mark.slow
@pytest.mark.parametrize("wanted", [{"maximize": "delay"}, {"minimize": "wall_force"}], ids=str)
def test_a_design_whose_pulse_does_not_reach_the_far_end_does_not_count(wanted, tmp_path):
    """Of one chain to t = 20; the pulse passes bead 16 at 18.6."""
    scene = {**SCENE, "chains": 1, "coupling": None, "duration": 20}
    plain = {"scene": {k: v for k, v in scene.items() if v is not None}, "vary": {"beads": {"from": 10, "to": 30}}}
    (tmp_path / "design.yaml").write_text(strict_yaml.dump({**plain, **wanted}))
    design = file.load(tmp_path / "design.yaml")
    records = search(design, computing(design))
    late = [r for r in records if r.values["beads"] > 16]
    assert all(r.quantities[design.objective] is None and worth(design, r) == np.inf for r in late)
    assert min(records, key=lambda one: worth(design, one)).values["beads"] <= 16
    assert DesignResult(design, records, [], None, Sensitivity(0.0, 0, (), 0, "", 0, {}), 0.0).undefined == len(late)


@pytest.mark.slow
def test_a_design_that_ends_at_a_bead_waits_for_what_is_wanted_at_the_wall():
    plain = {"name": "a", "beads": 30, "walls": {"right": {"stiffness": 0.1}}, "kick": {"velocity": 1.0}}
    names = ("wall_force", "delay", "transmitted_energy")
    found = of_scene({**plain, "until_bead": 10}, names, "scene")
    assert found == pytest.approx(of_scene({**plain, "duration": 90.0}, names, "scene"), rel=1e-6)


def test_manufacture_is_off_to_both_sides_by_the_spread_at_most(tmp_path):
    numbers = {"coupling.stiffness": {"from": 0.1, "to": 1}}
    design = file.load(written(tmp_path, vary=numbers, manufacture={"members": 50, "spread": 0.1}))
    asked = []

    def linear(designs):
        asked.extend(designs)
        return [DesignRecord(values, {"wall_force": values["coupling.stiffness"]}, "", 0.0) for values in designs]

    found = sensitivity(design, linear, {"coupling.stiffness": 0.5})
    assert len(found.members) == 50
    assert 0.45 <= min(found.members) < 0.47
    assert 0.53 < max(found.members) <= 0.55
    assert (found.asked, found.refused, found.undefined, found.broken) == (50, 0, 0, {})
    beads = [(one["disorder.radius"], one["disorder.stiffness"], one["disorder.seed"]) for one in asked[:50]]
    assert beads == [(0.1, 0.1, member) for member in range(1, 51)]


def failing(designs):
    """Every third design is no scene, every other third has no objective, and all are too light."""
    kinds = [("no scene", {}), ("", {"wall_force": None, "mass": 3.0}), ("", {"wall_force": 1.5, "mass": 3.0})]
    return [DesignRecord(values, kinds[k % 3][1], kinds[k % 3][0], 0.0) for k, values in enumerate(designs)]


def test_members_of_the_ensemble_that_fail_or_do_not_keep_a_limit_are_counted_and_few_have_no_statistics(tmp_path):
    numbers = {"coupling.stiffness": {"from": 0.1, "to": 1}}
    design = file.load(written(tmp_path, vary=numbers, manufacture={"members": 30}))
    small = sensitivity(design, failing, {"coupling.stiffness": 1.0})
    best = DesignRecord({"coupling.stiffness": 1.0}, {"wall_force": 1.0, "mass": 20.0}, "", 0.0)
    found = DesignResult(design, [best], [], None, small, 0.0)
    assert found.warnings == [
        "the best is at a bound of the search (coupling.stiffness: to 1); a better design may lie beyond it",
        "20 of 30 members of the tolerance ensemble do not keep the limit of mass",
        "10 of 30 members of the tolerance ensemble are no valid scene; the first: no scene",
        "10 of 30 members of the tolerance ensemble have no wall_force",
    ]
    assert "wall_force of 10 of 30 members: 1.5, 1.5" in found.tolerance
    assert "mean" not in found.tolerance
    assert "mean" in DesignResult(design, [best], [], None, replace(small, asked=20), 0.0).tolerance
    assert found.plain()["manufacture"]["refused"] == found.plain()["manufacture"]["undefined"] == 10


def test_where_nothing_fits_the_reason_is_said(tmp_path, capsys):
    path = written(tmp_path, where={"mass": {"from": 1000}})
    assert main(["design", str(path), "-o", str(tmp_path / "d"), "--jobs", "1"]) == 2
    assert "none of 28 designs keeps the limits" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("variable", "coordinates", "value"),
    [
        (Variable("a", low=0.01, high=1.0, log=True), [np.log(0.1)], 0.1),
        (Variable("a", low=2.0, high=8.0, integer=True), [3.0], 3),
        (Variable("a", choices=("x", None)), [1.0], None),
        (Variable("a", choices=("x", "y"), places=3), [1.0, 0.0, 1.0], ["y", "x", "y"]),
        (Variable("a", low=1.0, high=9.0, integer=True, places=2), [7.0, 2.0], [2, 7]),
    ],
)
def test_coordinates_stand_for_values(variable, coordinates, value):
    assert variable.value(coordinates) == value


DIMER = {"kinds": {"a": {}, "b": {"mass": 0.6}}, "pattern": ["a", "b"]}
YIELDING = {"contact": {"yield": {"overlap": 0.2}}}


@pytest.mark.parametrize(
    ("changes", "names"),
    [(DIMER, ("residual_energy", "peak_velocity@20")), (YIELDING, ("permanent", "dissipated"))],
    ids=["cells", "yielding"],
)
def test_quantities_that_only_some_runs_have_are_those_of_an_analysis(changes, names, tmp_path):
    plain = {"name": "scene", "beads": 30, "kick": {"velocity": 1}, "duration": 40, **changes}
    values = of_scene(plain, names, "scene")
    run(library.from_plain(plain, "scene"), tmp_path / "r", engine="reference")
    assert main(["analyze", str(tmp_path / "r"), "--no-figures"]) == 0
    row = collect(tmp_path, [name for name in names if "@" in name]).rows[0]
    # read between frames at times of other rounding
    assert values == pytest.approx({name: row[name] for name in names}, rel=1e-9)
    assert None not in values.values()


BETWEEN = {
    "scene": {**SCENE, "beads": 24},
    "vary": {"coupling.stiffness": {"from": 0.05, "to": 0.3}, "walls.right": ["rigid", "bead"]},
    "minimize": "peak_velocity@15",
    "search": {"evaluations": 20, "population": 8},
    "manufacture": {"members": 8},
    "verify": 1,
}


@pytest.mark.slow
def test_steps_along_derivatives_end_where_the_objective_is_stationary(tmp_path, capsys):
    path = tmp_path / "design.yaml"
    path.write_text(strict_yaml.dump(json.loads(json.dumps(BETWEEN))))
    assert main(["design", str(path), "-o", str(tmp_path / "d"), "--jobs", "1", "--gradient"]) == 0
    assert "derivatives at the best design" in capsys.readouterr().out
    report = json.loads((tmp_path / "d" / "design.json").read_text())
    [line] = report["derivatives"]
    assert (line["quantity"], line["field"]) == ("peak_velocity@15", "coupling.stiffness")
    assert abs(line["relative"]) < 1e-4
    assert report["asked"] <= 21
    assert 0.05 < report["best"]["coupling.stiffness"] < 0.3
