"""Pushes and drives: units, tables, moved beads, causes; the motion is in `test_every_ingredient`."""

import math
from dataclasses import replace

import numpy as np
import pytest
import yaml
from ingredient_scenes import FORCED as PUSHED
from ingredient_scenes import MOVED, STEEL
from plain_scene import one_chain, scene
from wrong_runs import causes

from analysis.conservation import ConservationMeter
from lammps_inputs import file_names, library, physics
from lammps_inputs.ingredients.on_bead import MOST_POINTS
from lammps_inputs.scene import DEFAULT_ACCURACY
from workflow.engines.reference import engine
from workflow.runs.run import run
from workflow.verdicts.analysis_files import analyse

pytestmark = pytest.mark.usefixtures("lammps_here")


def forced(**keys):
    """A chain whose bead 1 is not kicked."""
    return one_chain(**{"kick": None, "output": None, "duration": 10.0, **keys})


def pushed(peak=1.0, duration=2.0, **keys):
    return forced(push={"peak": peak, "duration": duration, "shape": "half-sine"}, **keys)


def test_without_a_kick_v_is_what_the_push_gives_a_free_bead():
    one = pushed()
    assert one.scale.velocity == pytest.approx(4.0 / math.pi, rel=1e-15)
    assert physics.excitations(one.system) == ((1, 1, pytest.approx(1.0, rel=1e-15)),)
    assert physics.energy(one.system) == pytest.approx(0.5, rel=1e-15)


def test_in_si_the_numbers_are_newtons_and_seconds():
    one = forced(push={"peak": 100.0, "duration": 1e-4, "shape": "half-sine"}, duration=1e-3, material=STEEL)
    impulse = 2.0 * 100.0 * 1e-4 / math.pi
    assert one.scale.velocity == pytest.approx(impulse / one.scale.mass, rel=1e-15)
    (load,) = one.problem().system.loads
    assert load.law.peak * one.scale.force == pytest.approx(100.0, rel=1e-14)


@pytest.mark.parametrize(
    ("line", "table", "velocity", "written"),
    [
        ("push: {", "time,force\n0,0\n1.5; 2\n3,0\n\n", 3.0, {"table": [[0.0, 0.0], [1.5, 2.0], [3.0, 0.0]]}),
        ("drive: {", "time; velocity\n0; 0\n1; 2\n", 2.0, {"quantity": "velocity", "table": [[0.0, 0.0], [1.0, 2.0]]}),
    ],
    ids=["push", "drive"],
)
def test_a_table_from_beside_the_scene_is_written_into_it_with_what_its_first_line_says(
    line, table, velocity, written, tmp_path
):
    (tmp_path / "t.csv").write_text(table)
    (tmp_path / "a.yaml").write_text(f"name: a\nbeads: 20\nduration: 10\n{line}table: t.csv}}\n")
    one = library.find(str(tmp_path / "a.yaml"))
    assert written.items() <= one.plain()[line.partition(":")[0]].items()
    assert one.scale.velocity == pytest.approx(velocity, rel=1e-15)
    assert library.from_plain(yaml.safe_load(yaml.safe_dump(one.plain())), "x") == one


@pytest.mark.slow
def test_steps_of_short_pushes_keep_the_default_accuracy(tmp_path):
    case = pushed(duration=0.1)
    assert case.problem().system.loads[0].end < case.problem().every
    assert run(case, tmp_path / "run").check.velocity <= DEFAULT_ACCURACY


# --- drives -----------------------------------------------------------------------------------------------------------


def driven(*drives, **changes):
    """By default one bead is moved and another pushed, so that all tests share one compiled kernel."""
    drive = list(drives or (MOVED, PUSHED))
    return scene(**{"kick": None, "drive": drive, "beads": 8, "output": {"every": 0.25}, **changes})


def test_v_of_a_driving_force_is_what_it_swings_a_free_bead_with():
    one = forced(drive={"force": 0.4, "frequency": 900.0}, material=STEEL, duration=0.01)
    mass = 4.0 / 3.0 * math.pi * 4.76e-3**3 * 8000.0
    assert one.scale.velocity == pytest.approx(0.4 / (mass * 2.0 * math.pi * 900.0), rel=1e-14)


@pytest.mark.parametrize("phase", [0.0, -90.0, 30.0])
def test_a_phase_is_in_degrees_and_motion_begins_at_the_beads_place(phase):
    moved, pushed = (
        forced(drive={"frequency": 0.25, "phase": phase, how: 0.5}).problem() for how in ("displacement", "force")
    )
    angle = math.pi / 2.0 + phase * math.pi / 180.0  # after a quarter of a swing, at t = 1
    (motion,), (load,) = moved.system.motions, pushed.system.loads
    start = math.sin(phase * math.pi / 180.0)
    found = motion.displacement(1.0 / moved.scale.time) * moved.scale.length
    assert found == pytest.approx(0.5 * (math.sin(angle) - start))
    assert load.force(1.0 / pushed.scale.time) * pushed.scale.force == pytest.approx(0.5 * math.sin(angle))


@pytest.mark.slow
def test_two_tones_move_a_bead_on_a_linear_spring_as_their_exact_response():
    """Chain 1 moves with two tones; the bead of chain 2 hangs on it by a spring and never touches another."""
    tones, w0 = ((0.3, 0.7), (0.2, 1.9)), 1.3
    drives = [{"displacement": size, "frequency": w / (2.0 * math.pi), "phase": -90.0} for size, w in tones]
    case = driven(*drives, beads=2, gap=10.0, coupling={"stiffness": w0**2}, duration=20.0, output={"every": 0.5})
    found = engine.run(case.problem(), steps_per_frame=40)
    t = found.time * case.scale.time
    # m x'' = k (X (1 - cos w t) - x) from rest, for each tone
    exact = sum(size * (1.0 - (w0**2 * np.cos(w * t) - w**2 * np.cos(w0 * t)) / (w0**2 - w**2)) for size, w in tones)
    np.testing.assert_allclose(found.displacement[:, 1, 0] * case.scale.length, exact, rtol=0.0, atol=1e-7)
    given = sum(size * (1.0 - np.cos(w * t)) for size, w in tones)
    np.testing.assert_allclose(found.displacement[:, 0, 0] * case.scale.length, given, rtol=0.0, atol=1e-12)
    assert ConservationMeter(found.problem).read([found]).energy_drift < 1e-8


@pytest.mark.slow
def test_behind_the_front_of_a_piston_beads_move_with_its_velocity_and_at_the_front_with_almost_twice_that(tmp_path):
    """A bead that elastic beads of velocity 2 V hit one after the other, seen from the piston, has 2 V at most."""
    found = run(forced(beads=120, drive={"velocity": 0.02}, duration=250.0), tmp_path / "run")
    velocity = found.trajectory.velocity[:, 0]
    assert np.all(velocity[:, 0] == 1.0)
    peaks = velocity.max(axis=0)
    passed = np.flatnonzero(velocity[-1] > 0.1)[-1] - 2
    peaks = peaks[1 : passed - 2]
    assert np.max(np.maximum.accumulate(peaks) - peaks) < 1e-2  # at frames, which miss the maximum by as much
    assert 1.985 < peaks[-1] + 5e-3 < 2.005
    late = found.trajectory.time > found.trajectory.time[-1] - 60.0
    assert np.mean(velocity[late][:, 2:20]) == pytest.approx(1.0, abs=5e-3)
    assert found.check.velocity < 2e-4


@pytest.mark.slow
def test_a_record_of_100_000_velocities_of_a_sine_moves_the_beads_as_the_sine_in_both_engines(tmp_path):
    omega, duration = 0.7, 20.0
    time = np.linspace(0.0, duration, MOST_POINTS)
    record = {"quantity": "velocity", "table": np.stack([time, 0.3 * np.cos(omega * time)], axis=1).tolist()}
    sine = {"displacement": 0.3 / omega, "frequency": omega / (2.0 * math.pi)}
    recorded, harmonic = (
        run(forced(drive=drive, beads=8, duration=duration, timestep=0.01, output={"every": 0.5}), tmp_path / name)
        for name, drive in (("record", record), ("sine", sine))
    )
    apart = np.max(np.abs(recorded.trajectory.velocity - harmonic.trajectory.velocity))
    assert apart < 1e-6  # (omega h)^2 / 8 = 2.5e-9 at the driven bead
    assert recorded.check.velocity == pytest.approx(harmonic.check.velocity, rel=1e-3)
    assert (tmp_path / "record" / file_names.TABLES).is_file()


@pytest.mark.slow
def test_above_the_cut_off_of_a_linear_chain_amplitude_falls_by_what_theory_says(tmp_path):
    """Rows of beads that never touch, tied by springs of 1: a linear chain across the chains, cut off at omega = 2."""
    omega = 2.2
    drive = {"displacement": 1.0 / omega, "frequency": omega / (2.0 * math.pi), "phase": -90.0}
    case = driven(drive, chains=30, beads=2, gap=10.0, coupling={"stiffness": 1.0}, duration=250.0, timestep=0.0125,
                  output={"every": 0.25, "spectra": {"beads": [1], "after": 125.0}})  # fmt: skip
    spectra = analyse(run(case, tmp_path / "run", check=False).directory, figures=False).measurements["spectra"].spectra
    amplitude = spectra.at_drive[0, :, 0]
    assert amplitude[0] == pytest.approx(1.0, abs=1e-4)
    fall = math.exp(-2.0 * math.acosh(0.5 * omega))
    assert fall == pytest.approx(0.412, abs=5e-4)
    assert amplitude[1:4] / amplitude[:3] == pytest.approx(fall, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (({**MOVED, "phase": -50.0}, PUSHED), "drive of bead 1 of chain 1 has a phase of -50 instead of -60 degrees"),
        ((MOVED, {**PUSHED, "phase": 45.0}), "drive on bead 4 of chain 2 has a phase of 45 instead of 30 degrees"),
        ((MOVED, {**PUSHED, "frequency": 0.22}), "frequency of the drive on bead 4 of chain 2 is 1.1 times that of"),
    ],
    ids=["phase of motion", "phase", "frequency"],
)
def test_what_is_wrong_with_a_drive_is_named(wrong, said):
    kicked = {"kick": {"chain": 2, "bead": 8, "velocity": -2.0}, "output": {"every": 0.1}}  # which makes V the same
    right, other = (engine.run(driven(*drives, **kicked).problem()) for drives in ((MOVED, PUSHED), wrong))
    (cause,) = causes(replace(other, problem=right.problem), right)
    assert cause.removeprefix("the ").startswith(said)
    assert not any("drive" in cause for cause in causes(right, replace(other, problem=right.problem)))
