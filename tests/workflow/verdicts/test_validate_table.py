"""A run against a user's own trajectory, or traces: columns, grids, other times and units; refusals of bad tables."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import wrong_runs
from refusals import refusal
from small_problems import problem, written_down
from stock_lammps import run as run_stock
from stock_lammps import scene

import granchain
from lammps_inputs import Kick, Material, library
from workflow.cli import main
from workflow.engines.reference import engine
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts import validate_table as tables
from workflow.verdicts.validate import AGAINST, validate
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


def csv(path, table, form="%.17g", between=",", names=("time", "chain", "bead", "displacement", "velocity")):
    np.savetxt(
        path, np.column_stack([table[name] for name in names]), form, between, header=between.join(names), comments=""
    )
    return path


SI = (UNIT.time, UNIT.length, UNIT.velocity)


@pytest.mark.parametrize("between", [",", " "])
def test_a_table_at_other_times_passes(between, runs, exact, tmp_path):
    found = validate_table(runs["reduced"], csv(tmp_path / "own.csv", columns(exact[1]), between=between))
    assert found.passed
    assert list(found.deviations) == ["displacement", "velocity", "amplitude", "arrival"]
    assert found.compared == exact[1].frames
    assert 0.0 < found.interpolation[1] < 1e-4
    assert found.remarks == ()


def test_units_do_not_change_what_is_found(runs, exact, tmp_path, capsys):
    plain, si = (csv(tmp_path / f"{units[0]}.csv", columns(exact[1], units)) for units in ((1.0, 1.0, 1.0), SI))
    found = validate_table(runs["reduced"], plain).deviations
    for again in (
        validate_table(runs["SI"], si),
        validate_table(runs["SI"], plain, dimensionless=True),
    ):
        for quantity, deviation in found.items():
            assert again.deviations[quantity].largest == pytest.approx(deviation.largest, abs=1e-11)
    assert main(["validate", str(runs["SI"].path), "--against", str(plain), "--units", "dimensionless"]) == 0
    assert "against" in capsys.readouterr().out


@pytest.mark.slow
def test_an_npz_says_the_same_as_text(runs, exact, tmp_path):
    fine = exact[1]
    text = validate_table(runs["reduced"], csv(tmp_path / "own.csv", columns(fine)))
    for content in (
        columns(fine),
        {"time": fine.time, "displacement": fine.displacement, "velocity": fine.velocity},
    ):
        np.savez(tmp_path / "own.npz", **content)
        assert validate_table(runs["reduced"], tmp_path / "own.npz").deviations == text.deviations


def test_the_error_against_a_table_is_the_runs_own_within_interpolation(runs, exact, tmp_path):
    at_frames = validate_table(runs["reduced"], csv(tmp_path / "a.csv", columns(exact[0])))
    between = validate_table(runs["reduced"], csv(tmp_path / "b.csv", columns(exact[1])))
    assert at_frames.interpolation is None
    error = np.max(np.abs(runs["reduced"].trajectory.velocity - exact[0].velocity))
    assert at_frames.deviations["velocity"].largest == pytest.approx(error, rel=1e-9)
    # the largest error lies between frames as likely as at one: 0.1 apart it changes by less than (2 pi 0.05 / 3.5)^2
    assert between.deviations["velocity"].largest == pytest.approx(error, rel=0.01, abs=between.interpolation[1])


@pytest.mark.parametrize("name", ["displacement", "velocity"])
def test_one_quantity_alone_is_compared_alone(name, runs, exact, tmp_path):
    path = csv(tmp_path / "own.csv", columns(exact[1]), names=("bead", "time", name, "chain"))
    found = validate_table(runs["reduced"], path)
    assert found.passed
    assert list(found.deviations) == [name]


def test_some_beads_of_one_chain_are_compared_alone(runs, exact, tmp_path):
    table = columns(exact[1], beads=[3, 17], chains=[2])
    table["velocity"] = table["velocity"] + np.where(table["bead"] == 17, 0.01, 0.0)
    found = validate_table(runs["reduced"], csv(tmp_path / "own.csv", table))
    assert not found.passed
    where = found.deviations["velocity"].where
    assert (where.chain, where.bead) == (2, 17)
    assert found.deviations["velocity"].largest == pytest.approx(0.01, abs=2e-4)


def test_a_table_with_holes_is_compared_where_it_has_rows(runs, exact, tmp_path):
    table = columns(exact[1])
    kept = np.random.default_rng(1).uniform(size=len(table["time"])) < 0.7
    found = validate_table(runs["reduced"], csv(tmp_path / "own.csv", {k: v[kept] for k, v in table.items()}))
    assert found.passed
    assert list(found.deviations) == ["displacement", "velocity"]


@pytest.mark.parametrize("frames", [slice(0, 1), slice(50, 51), slice(5, 7)])
def test_a_single_instant_or_two_are_compared(frames, runs, exact, tmp_path):
    found = validate_table(runs["reduced"], csv(tmp_path / "own.csv", columns(exact[1][frames])))
    assert found.passed


def test_times_of_six_digits_are_let_pass(runs, exact, tmp_path):
    table = columns(exact[0], SI)
    table["time"] = wrong_runs.six_digits(table["time"])
    path = csv(tmp_path / "own.csv", table)
    found = validate_table(runs["SI"], path)
    # a time that is off by 5e-6 of itself, at most 25, at an acceleration below 1
    assert found.deviations["velocity"].largest < 5e-4
    assert "arrival" in found.deviations


# --- wrong ones -------------------------------------------------------------------------------------------------------


def test_a_table_printed_with_g_is_remarked_and_counts_by_its_effect(runs, exact, tmp_path, capsys):
    path = csv(tmp_path / "own.csv", columns(exact[1]), form="%g")
    assert main(["validate", str(runs["reduced"].path), "--against", str(path)]) == 0
    out = capsys.readouterr().out.splitlines()
    assert f"note: velocities in {path} have only 6 digits" in out
    assert f"note: displacements in {path} have only 6 digits" in out


def test_a_table_from_positions_printed_with_g_is_caught_and_named(runs, exact, tmp_path):
    fine = exact[1]
    rest = fine.beads * fine.problem.layout.spacing
    far = np.vectorize(lambda value: float(f"{value:.4g}"))(fine.displacement + rest) - rest
    np.savez(tmp_path / "own.npz", time=fine.time, displacement=far, velocity=fine.velocity)
    found = validate_table(runs["reduced"], tmp_path / "own.npz")
    assert found.exceeded("displacement")
    assert any("displacements in" in cause and "decimals" in cause for cause in found.causes)


def test_a_table_of_another_coupling_is_caught_and_named(runs, tmp_path):
    other = engine.run(scene(chains=2, beads=25, kappa=0.101, duration=25.0).problem(), steps_per_frame=16)
    found = validate_table(runs["reduced"], csv(tmp_path / "own.csv", columns(other)))
    assert not found.passed
    assert any("own.csv: the coupling is 1.01 (± " in cause for cause in found.causes)


def test_a_table_in_other_units_is_asked_about(runs, exact, tmp_path):
    found = validate_table(runs["reduced"], csv(tmp_path / "own.csv", columns(exact[1], (1e-5, 1e-5, 1.0))))
    assert not found.passed
    assert any("is it in other units?" in remark for remark in found.remarks)


def test_a_table_beyond_an_interrupted_run_says_so(runs, exact, tmp_path, capsys):
    part = wrong_runs.rewritten(
        runs["reduced"], tmp_path / "part", lambda run: (run.displacement[:100], run.velocity[:100])
    )
    path = csv(tmp_path / "own.csv", columns(exact[1]))
    assert refusal(["validate", part.path, "--against", path], capsys).endswith("; the run is incomplete")
    early = csv(tmp_path / "early.csv", columns(exact[1][:100]))
    assert main(["validate", str(part.path), "--against", str(early)]) == 1
    assert "the run is incomplete: 100 of 251 frames" in capsys.readouterr().out.splitlines()
    report = json.loads((part.path / f"{AGAINST}.json").read_text())
    assert not any(quantity["exceeded"] for quantity in report["quantities"].values())


def test_a_run_of_three_frames_is_too_short_to_interpolate(tmp_path, capsys):
    short = run(scene(beads=4, duration=0.2), tmp_path / "run", check=False).directory
    (tmp_path / "own.csv").write_text("time,chain,bead,velocity\n0.05,1,1,1\n")
    assert "3 frames are too few" in refusal(["validate", short.path, "--against", tmp_path / "own.csv"], capsys)


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


# --- times of a table -------------------------------------------------------------------------------------------------

OWN = written_down(problem(), lambda t: (0.0 * t, 0.0 * t))  # 101 frames 0.1 apart


def at(*times):
    return replace(OWN[: len(times)], time=np.array(times))


@pytest.mark.parametrize(
    ("times", "frames"),
    [((0.0, 0.3, 10.0), True), ((0.0, 0.3 + 1e-11), True), ((0.0, 0.3001), False), ((10.1,), False)],
)
def test_times_are_those_of_frames_to_rounding(times, frames):
    assert tables.are_frames(at(*times), OWN) is frames


@pytest.mark.parametrize(("last", "said"), [(0.11, False), (0.09, True)])
def test_a_table_that_ends_within_a_hundredth_of_the_run_is_asked_about(last, said):
    found = list(tables.remarks(Path("t.csv"), at(0.0, last), OWN))
    assert found == (["t.csv ends at 0.009 of the run: is it in other units? (see --units)"] if said else [])


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


def written(directory, names, factor=1.0, shift=0.0):
    """A table of the run's own forces, changed, under other names."""
    own = np.genfromtxt(directory / "forces.csv", delimiter=",", names=True)
    columns = [own["time"] + shift, *(factor * own[name] for name in names.values())]
    path = directory.parent / "given.csv"
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=",".join(("time", *names)), comments="")
    return path


def test_forces_csv_reads_back_as_the_run_that_it_is_of(directory):
    assert main(["validate", str(directory), "--against", str(directory / "forces.csv")]) == 0
    found = json.loads((directory / "validation-against.json").read_text())
    assert len(found["quantities"]) == 6
    assert all(entry["largest"] < 1e-12 for entry in found["quantities"].values())


def test_a_trace_that_is_off_is_named_with_place_and_time(directory, capsys):
    path = written(directory, {"force_sensor_8_chain_2": "sensor_8_chain_2"}, factor=1.05)
    assert main(["validate", str(directory), "--against", str(path)]) == 1
    found = json.loads((directory / "validation-against.json").read_text())["quantities"]["force_sensor_8_chain_2"]
    own = np.genfromtxt(directory / "forces.csv", delimiter=",", names=True)["sensor_8_chain_2"]
    assert found["largest"] == pytest.approx(0.05 * own.max(), rel=1e-6)
    assert found["where"]["chain"] == 2
    assert "a tolerance is first exceeded by the force_sensor_8_chain_2 of bead 8" in capsys.readouterr().out


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


def test_a_comparison_with_a_file_leaves_the_report_of_the_reference_as_it_is(runs, exact, tmp_path):
    directory = RunDirectory(shutil.copytree(runs["reduced"].path, tmp_path / "run"))
    validate(directory)
    before = (directory.path / "validation.json").read_bytes()
    table = columns(exact[0][::10])
    found = validate_table(directory, csv(tmp_path / "own.csv", table | {"velocity": table["velocity"] + 0.1}))
    assert not found.passed
    assert (directory.path / "validation.json").read_bytes() == before
    assert json.loads((directory.path / "validation-against.json").read_text())["passed"] is False
