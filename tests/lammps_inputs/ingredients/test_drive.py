"""Harmonic drives: units, moved bead, causes, a linear chain's cut-off; the motion is in `test_every_ingredient`."""

import math
from dataclasses import replace

import pytest
from ingredient_scenes import FORCED as PUSHED
from ingredient_scenes import MOVED, STEEL
from plain_scene import scene

from lammps_inputs import library
from lammps_inputs.facts import Fact
from workflow.engines.reference import engine
from workflow.runs.run import run
from workflow.verdicts.analyse import analyse
from workflow.verdicts.causes import causes

pytestmark = pytest.mark.usefixtures("lammps_here")


def driven(*drives, **changes):
    """By default one bead is moved and another pushed, so that all tests share one compiled kernel."""
    drive = list(drives or (MOVED, PUSHED))
    return scene(**{"kick": None, "drive": drive, "beads": 8, "output": {"every": 0.25}, **changes})


def test_v_of_a_driving_force_is_what_it_swings_a_free_bead_with():
    one = driven(
        {"force": 0.4, "frequency": 900.0}, chains=1, coupling=None, material=STEEL, duration=0.01, output=None
    )
    mass = 4.0 / 3.0 * math.pi * 4.76e-3**3 * 8000.0
    assert one.scale.velocity == pytest.approx(0.4 / (mass * 2.0 * math.pi * 900.0), rel=1e-14)


@pytest.mark.parametrize("phase", [0.0, -90.0, 30.0])
def test_a_phase_is_in_degrees_and_motion_begins_at_the_beads_place(phase):
    keys = {"name": "a", "beads": 4, "duration": 8.0, "drive": {"frequency": 0.25, "phase": phase}}
    moved, pushed = (
        library.from_plain({**keys, "drive": {**keys["drive"], how: 0.5}}, "a").problem()
        for how in ("displacement", "force")
    )
    angle = math.pi / 2.0 + phase * math.pi / 180.0  # after a quarter of a swing, at t = 1
    (motion,), (load,) = moved.system.motions, pushed.system.loads
    start = math.sin(phase * math.pi / 180.0)
    found = motion.displacement(1.0 / moved.scale.time) * moved.scale.length
    assert found == pytest.approx(0.5 * (math.sin(angle) - start))
    assert load.force(1.0 / pushed.scale.time) * pushed.scale.force == pytest.approx(0.5 * math.sin(angle))


@pytest.mark.slow
def test_a_bead_that_is_moved_is_where_it_should_be_to_rounding_and_the_verdict_does_not_apply(tmp_path):
    found = run(driven(timestep=0.0125), tmp_path / "run", check=False)
    trajectory = found.trajectory
    (motion,) = trajectory.problem.system.motions
    assert trajectory.displacement[:, 0, 0] == pytest.approx(motion.displacement(trajectory.time), abs=1e-12)
    assert trajectory.velocity[:, 0, 0] == pytest.approx(motion.velocity(trajectory.time), abs=1e-12)
    assert "does not apply" in analyse(found.directory, figures=False).survey.verdict.sentence
    assert not trajectory.problem.system.holds(Fact.PULSE)


@pytest.mark.slow
def test_impulse_of_a_force_alone_is_momentum(tmp_path):
    found = analyse(run(driven(PUSHED), tmp_path / "run", check=False).directory, figures=False)
    assert found.conservation.momentum_drift < 1e-12


@pytest.mark.slow
def test_above_the_cut_off_of_a_linear_chain_amplitude_falls_by_what_theory_says(tmp_path):
    """Rows of beads that never touch, tied by springs of 1: a linear chain across the chains, cut off at omega = 2."""
    omega = 2.2
    drive = {"displacement": 1.0 / omega, "frequency": omega / (2.0 * math.pi), "phase": -90.0}
    case = driven(drive, chains=30, beads=2, gap=10.0, coupling={"stiffness": 1.0}, duration=250.0, timestep=0.0125,
                  output={"every": 0.25, "spectra": {"beads": [1], "after": 125.0}})  # fmt: skip
    spectra = analyse(run(case, tmp_path / "run", check=False).directory, figures=False).findings["spectra"].spectra
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
        (({**MOVED, "frequency": 0.31}, PUSHED), "drive of bead 1 of chain 1 has a frequency of 0.31 instead of 0.3"),
        ((MOVED, {**PUSHED, "phase": 45.0}), "the drive has a phase of 45 instead of 30 degrees"),
        ((MOVED, {**PUSHED, "frequency": 0.22}), "the drive has a frequency of 0.22 instead of 0.2"),
        ((MOVED, {**PUSHED, "force": 0.44}), "the drive has a force of 0.44 instead of 0.4"),
    ],
    ids=["phase of motion", "frequency of motion", "phase", "frequency", "force"],
)
def test_what_is_wrong_with_a_drive_is_named(wrong, said):
    kicked = {"kick": {"chain": 2, "bead": 8, "velocity": -2.0}, "output": {"every": 0.1}}  # which makes V the same
    right, other = (engine.run(driven(*drives, **kicked).problem()) for drives in ((MOVED, PUSHED), wrong))
    (cause,) = causes(replace(other, problem=right.problem), right)
    assert cause.endswith(said)
    assert not any("drive" in cause for cause in causes(right, replace(other, problem=right.problem)))
