"""A scene of rigid beads: the same run directory as of any engine, and a list of its collisions."""

import math

import numpy as np
import pytest
from stock_lammps import scene

from analysis.quantity import declared
from analysis.trajectory import joined
from lammps_inputs import find, strict_yaml
from workflow.cli import main
from workflow.plugins.rigid import engine as collisions
from workflow.plugins.rigid import events
from workflow.plugins.rigid.events import from_events
from workflow.plugins.rigid.rounding import by_rounding
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.analysis_files import analyse
from workflow.verdicts.analysis_lines import lines


def gapped(**changes):
    return scene(**{"chains": 2, "beads": 12, "kappa": 0.5, "gap": 1.0, "duration": 40.0, **changes})


@pytest.fixture(scope="module")
def directory(tmp_path_factory):
    path = tmp_path_factory.mktemp("collisions") / "run"
    assert run(gapped(), path, engine="collisions").outcome == "done"
    return RunDirectory(path)


def test_a_run_leaves_the_collisions_and_the_motion_of_the_engine(directory):
    files = {path.name for path in directory.path.iterdir()}
    assert files == {"scene.yaml", "chains.dump.bin", "events.csv", "run.json"}
    exact = collisions.run(directory.problem)
    table = events.from_csv(directory.path / "events.csv", directory.problem.scale)
    assert directory.job.collisions == len(table) == len(exact) > 20
    np.testing.assert_array_equal(table.rounding, by_rounding(exact).collisions)
    for name in set(declared(events.Collisions)) - {"rounding"}:
        np.testing.assert_array_equal(getattr(table, name), getattr(exact, name))  # all scales are 1 here
    frames, motion = directory.trajectory, joined(collisions.blocks(exact))
    np.testing.assert_array_equal(frames.velocity, motion.velocity)
    # the file holds positions, rounded at 12 * 5 or below
    np.testing.assert_allclose(frames.displacement, motion.displacement, rtol=0, atol=np.spacing(64.0))


@pytest.mark.slow
def test_chains_of_rigid_beads_are_compared_by_the_impulses_of_their_collisions(tmp_path, capsys):
    scene = find("two-chains-gapped").model_copy(update={"beads": 60, "duration": 300.0})
    run(scene, tmp_path / "run", engine="collisions")
    directory = RunDirectory(tmp_path / "run")
    expected = from_events(directory.problem, events.from_csv(tmp_path / "run" / "events.csv", directory.problem.scale))
    shared = analyse(directory, figures=False).survey.shared
    np.testing.assert_allclose(shared.amplitude, expected.first[:, shared.bead - 2].T, rtol=0, atol=1e-12)
    # both chains reach the same velocity in flight, whichever was struck
    assert shared.mismatch[-1] > 1.0
    assert main(["analyze", str(tmp_path / "run"), "--no-figures"]) == 0
    assert "beating: impulses of first contacts differ by up to" in capsys.readouterr().out


@pytest.mark.slow
def test_the_command_says_how_many_collisions_there_were_and_overwriting_removes_them(tmp_path, capsys):
    path, directory = tmp_path / "scene.yaml", tmp_path / "run"
    path.write_text(strict_yaml.dump(gapped().plain()))
    words = ["run", str(path), "-o", str(directory)]
    assert main([*words, "--engine", "collisions"]) == 0
    lines = (directory / "events.csv").read_text().splitlines()
    assert f"\n{len(lines) - 1} collisions" in capsys.readouterr().out
    assert main([*words, "--engine", "reference", "--overwrite"]) == 0
    assert not (directory / "events.csv").exists()


def test_collisions_that_follow_rounding_are_marked_and_named_by_run_and_analyze(tmp_path, capsys):
    """At theta = pi two beads touch without speed as the pulse passes on: row 4 is the first that rounding reaches."""
    path = tmp_path / "scene.yaml"
    path.write_text(strict_yaml.dump(gapped(gap=math.pi, duration=120.0).plain()))
    assert main(["run", str(path), "-o", str(tmp_path / "run"), "--engine", "collisions"]) == 0
    directory = RunDirectory(tmp_path / "run")
    table = events.from_csv(directory.path / "events.csv", directory.problem.scale)
    first = directory.job.rounding.collision
    assert table.rounding[first - 1 :].all()
    assert f"warning: from collision {first} on (row {table.row[first - 1]})" in capsys.readouterr().out
    analysis = analyse(directory, figures=False)
    assert any(str(line).startswith(f"warning: from collision {first} on (row 4, t = ") for line in lines(analysis))
    values = analysis.measurements["rounding"].values
    assert (values.collision, values.row) == (first, 4)
    late = analysis.survey.waves.time >= values.time
    assert late.any()
    assert not late.all()
    assert np.array_equal(np.isnan(analysis.survey.waves.peak_velocity_error), late)
