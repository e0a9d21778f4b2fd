"""A run against a user's own trajectory, or traces: some columns, other times and units."""

import json

import numpy as np
import pytest
import wrong_runs
from stock_lammps import run as run_stock
from stock_lammps import scene

import granchain
from lammps_inputs import Kick, Material, library
from workflow.cli import main
from workflow.engines.reference import engine
from workflow.runs.run import run
from workflow.verdicts.validate_table import validate_table

pytestmark = pytest.mark.usefixtures("lammps_here")

STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)
UNIT = scene(material=STEEL, kick=(Kick(velocity=3.0),)).scale
SCENES = {
    "reduced": scene(chains=2, beads=25, kappa=0.1, duration=25.0),
    "SI": scene(
        chains=2,
        beads=25,
        material=STEEL,
        kick=(Kick(velocity=3.0),),
        kappa=0.1 * UNIT.stiffness,
        duration=25.0 * UNIT.time,
    ),
}


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Units -> the same run through LAMMPS."""
    root = tmp_path_factory.mktemp("table")
    return {name: run(wanted, root / name, check=False).directory for name, wanted in SCENES.items()}


@pytest.fixture(scope="module")
def exact(runs):
    """The reference at the frames, and at instants 0.0602 apart."""
    problem = runs["reduced"].problem
    return engine.run(problem.coarser(1), steps_per_frame=16), engine.run(
        scene(chains=2, beads=25, kappa=0.1, duration=24.9, every=0.0602).problem(), steps_per_frame=4
    )


def columns(trajectory, units=(1.0, 1.0, 1.0), beads=None, chains=None):
    """A table of a trajectory, long."""
    number = np.arange(1, trajectory.problem.chains + 1)
    time, chain, bead = np.meshgrid(trajectory.time * units[0], number, trajectory.beads, indexing="ij")
    values = {
        "time": time,
        "chain": chain,
        "bead": bead,
        "displacement": trajectory.displacement * units[1],
        "velocity": trajectory.velocity * units[2],
    }
    kept = np.isin(bead, beads or bead) & np.isin(chain, chains or chain)
    return {name: value[kept] for name, value in values.items()}


def csv(path, table, names=("time", "chain", "bead", "displacement", "velocity")):
    np.savetxt(
        path, np.column_stack([table[name] for name in names]), "%.17g", ",", header=",".join(names), comments=""
    )
    return path


SI = (UNIT.time, UNIT.length, UNIT.velocity)


@pytest.mark.slow
def test_the_error_against_a_table_is_the_runs_own_within_interpolation_in_any_units(runs, exact, tmp_path):
    at_frames = validate_table(runs["reduced"], csv(tmp_path / "a.csv", columns(exact[0])))
    plain, si = (csv(tmp_path / f"{unit[0]}.csv", columns(exact[1], unit)) for unit in ((1.0, 1.0, 1.0), SI))
    between = validate_table(runs["reduced"], plain)
    assert between.passed
    assert (list(between.deviations), between.remarks) == (["displacement", "velocity", "amplitude", "arrival"], ())
    assert between.compared == exact[1].frames
    assert at_frames.interpolation is None
    assert 0.0 < between.interpolation[1] < 1e-4
    error = np.max(np.abs(runs["reduced"].trajectory.velocity - exact[0].velocity))
    assert at_frames.deviations["velocity"].largest == pytest.approx(error, rel=1e-9)
    # the largest error lies between frames as likely as at one: 0.1 apart it changes by less than (2 pi 0.05 / 3.5)^2
    assert between.deviations["velocity"].largest == pytest.approx(error, rel=0.01, abs=between.interpolation[1])
    for again in (validate_table(runs["SI"], si), validate_table(runs["SI"], plain, dimensionless=True)):
        for quantity, deviation in between.deviations.items():
            assert again.deviations[quantity].largest == pytest.approx(deviation.largest, abs=1e-11)


def test_a_table_with_holes_of_one_quantity_is_compared_where_it_has_rows(runs, exact, tmp_path):
    table = columns(exact[1], beads=[3, 17], chains=[2])
    table["velocity"] = table["velocity"] + np.where(table["bead"] == 17, 0.01, 0.0)
    kept = np.random.default_rng(1).uniform(size=len(table["time"])) < 0.7
    path = csv(
        tmp_path / "own.csv", {k: v[kept] for k, v in table.items()}, names=("bead", "time", "velocity", "chain")
    )
    deviations = validate_table(runs["reduced"], path).deviations
    assert list(deviations) == ["velocity"]
    assert (deviations["velocity"].where.chain, deviations["velocity"].where.bead) == (2, 17)
    assert deviations["velocity"].largest == pytest.approx(0.01, abs=2e-4)


@pytest.mark.slow
def test_times_of_six_digits_are_let_pass(runs, exact, tmp_path):
    table = columns(exact[0], SI)
    table["time"] = wrong_runs.six_digits(table["time"])
    path = csv(tmp_path / "own.csv", table)
    found = validate_table(runs["SI"], path)
    # a time that is off by 5e-6 of itself, at most 25, at an acceleration below 1
    assert found.deviations["velocity"].largest < 5e-4
    assert "arrival" in found.deviations


# --- wrong ones -------------------------------------------------------------------------------------------------------


def test_a_table_from_positions_printed_with_g_is_caught_and_named(runs, exact, tmp_path):
    fine = exact[1]
    rest = fine.beads * fine.problem.layout.spacing
    far = np.vectorize(lambda value: float(f"{value:.4g}"))(fine.displacement + rest) - rest
    np.savez(tmp_path / "own.npz", time=fine.time, displacement=far, velocity=fine.velocity)
    found = validate_table(runs["reduced"], tmp_path / "own.npz")
    assert found.exceeded("displacement")
    assert any("displacements in" in cause and "decimals" in cause for cause in found.causes)


def test_a_text_dump_of_the_deck_by_stock_lammps_is_the_run(tmp_path):
    given = scene(chains=2, beads=12, kappa=0.1, duration=6.0)
    ran = run(given, tmp_path / "run", check=False)
    lines = "dump mine all custom 10 mine.lammpstrj id x vx\ndump_modify mine format float %.17g"
    run_stock(given, tmp_path / "stock", before_run=lines)
    found = validate_table(ran.directory, tmp_path / "stock" / "mine.lammpstrj", dimensionless=True)
    assert found.passed
    assert found.compared == 61
    assert found.deviations["velocity"].largest < 1e-10  # times differ in their last bit
    assert found.deviations["displacement"].largest < 1e-12


# --- traces -----------------------------------------------------------------------------------------------------------

TRACED = {
    "name": "traced",
    "chains": 2,
    "beads": 12,
    "coupling": {"stiffness": 0.1},
    "walls": {"right": "rigid"},
    "kick": {"velocity": 1},
    "duration": 25,
    "output": {"forces": {"wall": True, "contacts": [5], "sensors": [8]}},
}


@pytest.fixture(scope="module")
def directory(tmp_path_factory, request):
    request.getfixturevalue("lammps_here")
    path = tmp_path_factory.mktemp("traced") / "r"
    run(library.from_plain(TRACED, "scene"), path, check=False)
    assert main(["analyze", str(path), "--no-figures"]) == 0
    return path


@pytest.mark.slow
def test_forces_csv_reads_back_as_the_run_that_it_is_of(directory):
    assert main(["validate", str(directory), "--against", str(directory / "forces.csv")]) == 0
    found = json.loads((directory / "validation-against.json").read_text())
    assert len(found["quantities"]) == 6
    assert all(entry["largest"] < 1e-12 for entry in found["quantities"].values())


SCOPE = ("--columns", "time=TIME,sensor_8_chain_2=#3", "--gain", "CH2=-40", "--baseline", "sensor_8_chain_2=0.3")


def scope(directory):
    """A scope's file of a force of the run, 2 units of time late, by a sensor of -40 units of force per volt."""
    own = np.genfromtxt(directory / "forces.csv", delimiter=",", names=True)
    signal = 0.3 - own["sensor_8_chain_2"] / 40.0
    rows = [f"{t + 2.0!r};7;{volt!r}\r\n" for t, volt in zip(own["time"].tolist(), signal.tolist(), strict=True)]
    path = directory.parent / "scope.csv"
    path.write_text(f"Model;S-4\r\n\r\nTIME;CH1;CH2\r\n-;V;V\r\n{''.join(rows)}")
    return path


def test_a_scopes_file_of_a_run_is_the_run_and_is_not_with_another_gain(directory, capsys):
    words = ["validate", str(directory), "--against", str(scope(directory)), "--offset", "2"]
    assert main([*words, *SCOPE]) == 0
    found = json.loads((directory / "validation-against.json").read_text())["quantities"]
    assert found["force_sensor_8_chain_2"]["largest"] < 1e-12
    assert main([*words, *SCOPE, "--gain", "CH2=-44"]) == 1
    described = granchain.trace_file(
        scope(directory), {"time": "TIME", "sensor_8_chain_2": "CH2"}, gain={"CH2": -40.0}, baseline={"CH2": 0.3}
    )
    assert granchain.validate(directory, against=described, offset=2.0).passed
    capsys.readouterr()
