"""Harmonic drives: LAMMPS and reference against an integrator of their own, work, resume, a linear chain's cut-off."""

import math
import re
from dataclasses import replace

import lammps_here as here
import numpy as np
import pytest
from independent import integrated
from kill_many import frames
from plain_scene import goes_on_bit_for_bit
from wrong_runs import deck_run

from analysis.mirror import mirrored_problem
from lammps_inputs import InputError, Scene, file_names, library
from lammps_inputs.decks.continuation import render_continuation
from lammps_inputs.facts import Fact
from workflow.engines.reference import certify, engine
from workflow.runs.run import run
from workflow.sweep.fields import all_fields
from workflow.verdicts.analyse import analyse
from workflow.verdicts.causes import causes
from workflow.verdicts.validate import validate

pytestmark = pytest.mark.usefixtures("lammps_here")

MOVED = {"displacement": 0.5, "frequency": 0.3, "phase": -60.0}
PUSHED = {"chain": 2, "bead": 4, "force": 0.4, "frequency": 0.2, "phase": 30.0}


def driven(*drives, **changes):
    """By default one bead is moved and another pushed, so that all tests share one compiled kernel."""
    plain = {
        "name": "test",
        "chains": 2,
        "beads": 8,
        "coupling": {"stiffness": 0.1},
        "drive": list(drives or (MOVED, PUSHED)),
        "duration": 20.0,
        "output": {"every": 0.25},
    }
    return library.from_plain({key: value for key, value in {**plain, **changes}.items() if value is not None}, "test")


def exact(problem):
    """By DOP853, from the formulas of the scene."""
    (motion,), (load,) = problem.system.motions, problem.system.loads
    top, omega, phase = motion.amplitude * motion.omega**2, motion.omega, motion.phase
    return integrated(
        problem,
        moved={(0, 0): lambda t: -top * math.sin(omega * t + phase)},
        pushed={(1, 3): lambda t: load.law.peak * math.sin(load.law.omega * t + load.law.phase)},
    )


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """At two time steps."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("workflow.engines.lammps.engine.run", here.run)
        folder = tmp_path_factory.mktemp("runs")
        return {step: run(driven(timestep=step), folder / f"{step}") for step in (0.0125, 0.00625)}


def test_numbers_are_those_of_the_scene():
    problem = driven().problem()
    (motion,), (load,) = problem.system.motions, problem.system.loads
    unit = problem.scale
    assert unit.velocity == pytest.approx(0.5 * 2.0 * math.pi * 0.3, rel=1e-14)
    assert motion.amplitude * unit.length == pytest.approx(0.5, rel=1e-14)
    assert motion.speed == pytest.approx(1.0, rel=1e-14)
    assert load.law.peak * unit.force == pytest.approx(0.4, rel=1e-14)
    assert load.law.omega / unit.time == pytest.approx(2.0 * math.pi * 0.2, rel=1e-14)
    assert motion.displacement(0.0) == 0.0


def test_v_of_a_driving_force_is_what_it_swings_a_free_bead_with():
    steel = {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3}
    one = driven(
        {"force": 0.4, "frequency": 900.0}, chains=1, coupling=None, material=steel, duration=0.01, output=None
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
def test_the_reference_is_as_near_to_an_independent_integrator_as_it_says_and_closes_the_budget():
    problem = driven(output={"every": 0.05}).problem()
    certifier = certify.certified(problem, 1e-6)
    found = np.concatenate([block.velocity for block in certifier.blocks()])
    assert np.abs(found - exact(problem)).max() < certifier.certificate.velocity
    assert certifier.certificate.energy < 1e-6


@pytest.mark.slow
def test_lammps_agrees_to_second_order_and_measures_its_own_error(runs):
    errors = []
    for found in runs.values():
        errors.append(np.abs(found.trajectory.velocity - exact(found.trajectory.problem)).max())
        assert found.check.velocity == pytest.approx(errors[-1], rel=0.1)
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.4)


@pytest.mark.slow
def test_a_bead_that_is_moved_is_where_it_should_be_to_rounding(runs):
    for found in runs.values():
        trajectory = found.trajectory
        (motion,) = trajectory.problem.system.motions
        assert trajectory.displacement[:, 0, 0] == pytest.approx(motion.displacement(trajectory.time), abs=1e-12)
        assert trajectory.velocity[:, 0, 0] == pytest.approx(motion.velocity(trajectory.time), abs=1e-12)


@pytest.mark.slow
def test_the_work_of_drives_closes_the_budget_and_the_verdict_does_not_apply(runs):
    found = analyse(runs[0.00625].directory, figures=False)
    assert found.conservation.energy_drift < 1e-4
    assert math.isnan(found.conservation.momentum_drift)
    assert "does not apply" in found.survey.verdict.sentence
    assert not found.problem.system.holds(Fact.PULSE)


@pytest.mark.slow
def test_impulse_of_a_force_alone_is_momentum(tmp_path):
    found = analyse(run(driven(PUSHED), tmp_path / "run", check=False).directory, figures=False)
    assert found.conservation.momentum_drift < 1e-12


@pytest.mark.slow
def test_a_run_that_was_interrupted_goes_on_bit_for_bit(tmp_path):
    goes_on_bit_for_bit(driven(duration=40.0), tmp_path, after=1000)


@pytest.mark.slow
def test_two_ranks_compute_the_same_bits(tmp_path):
    for ranks in (1, 2):
        run(driven(duration=3.0), tmp_path / f"{ranks}", ranks=ranks, check=False)
    np.testing.assert_array_equal(frames(tmp_path / "1"), frames(tmp_path / "2"))


def test_the_continuation_moves_beads_once_time_is_that_of_the_step():
    text = render_continuation(driven().problem())
    assert text.index("reset_timestep ${before}") < text.index("fix drive1 drive1 move") < text.index("run 0 post no")


@pytest.mark.slow
def test_a_driven_chain_of_unlike_beads_with_damping_is_computed_alike_and_closes_its_budget(tmp_path):
    kinds = {"kinds": {"heavy": {"mass": 2.0}, "plain": {"mass": 1.0}}, "pattern": ["heavy", "plain"]}
    case = driven(
        **kinds, damping={"beads": 0.2}, foundation={"stiffness": 0.3}, output={"every": 0.05}, timestep=0.005
    )
    problem, found = case.problem(), run(case, tmp_path / "run")
    (moved,), (load,) = problem.system.motions, problem.system.loads
    right = integrated(
        problem,
        ground=problem.system.ground[0].law.stiffness(0.0, *problem.system.ground[0].law),
        mass=problem.system.mass,
        drag=problem.system.dampers[0].law.coefficient,
        moved={(0, 0): lambda t: float(moved.acceleration(t))},
        pushed={(1, 3): lambda t: float(load.force(t))},
    )
    certifier = certify.certified(problem, 1e-6)
    reference = np.concatenate([block.velocity for block in certifier.blocks()])
    assert np.abs(reference - right).max() < certifier.certificate.velocity
    assert certifier.certificate.energy < 1e-5
    assert np.abs(found.trajectory.velocity - right).max() == pytest.approx(found.check.velocity, rel=0.1)
    assert found.check.velocity < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("keys", "static", "wall"),
    [
        ({"precompression": {"force": 0.3}}, np.full(9, 0.3), 0.0),
        ({"gravity": 0.02, "walls": {"right": "flat"}}, 0.02 * np.arange(9), math.sqrt(2.0)),
    ],
    ids=["precompression", "gravity"],
)
def test_a_driven_chain_under_load_is_computed_alike(tmp_path, keys, static, wall):
    case = driven(MOVED, **keys, coupling=None, duration=12.0, timestep=0.005)
    problem, found = case.problem(), run(case, tmp_path / "run")
    (moved,) = problem.system.motions
    right = integrated(
        problem,
        static=static / problem.scale.force,
        walls=(0.0, wall),
        moved={(0, 0): lambda t: float(moved.acceleration(t))},
    )
    assert np.abs(engine.run(problem).velocity - right).max() < 1e-6
    assert np.abs(found.trajectory.velocity - right).max() == pytest.approx(found.check.velocity, rel=0.1)
    assert found.check.velocity < 1e-3


def test_the_mirror_image_twice_is_the_problem_itself():
    problem = driven().problem()
    assert mirrored_problem(mirrored_problem(problem)) == problem
    assert mirrored_problem(problem) != problem


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
def test_validate_names_a_drive_that_is_not_the_scenes(tmp_path):
    def changed(path):
        text, found = re.subn(r"(drive1amplitude index) (\S+)", lambda m: f"{m[1]} {1.1 * float(m[2])!r}",
                              (path / file_names.DECK).read_text())  # fmt: skip
        assert found == 1
        (path / file_names.DECK).write_text(text)

    found = validate(deck_run(driven(), tmp_path / "run", changed)).causes
    assert found == ("the drive of bead 1 of chain 1 has a displacement of 0.55 instead of 0.5",)


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


@pytest.mark.parametrize(
    ("drives", "changes", "said"),
    [
        ([{"frequency": 1.0}], {}, "displacement: give either displacement or force (neither is given)"),
        ([{**MOVED, "force": 1.0}], {}, "displacement: give either displacement or force (both are given)"),
        ([{**MOVED, "bead": 9}], {}, "drive.bead: 9 is outside the array (beads 1 to 8)"),
        ([{**MOVED, "chain": 3}], {}, "drive.chain: 3 is outside the array (chains 1 to 2)"),
        ([{**MOVED, "frequency": 0.0}], {}, "drive.frequency: should be greater than 0"),
        ([MOVED], {"window": 64}, "drive: a window would take"),
        ([PUSHED], {"output": {"peaks": True, "beads": [1]}}, "output.peaks: finds the pulse that leads"),
        ([MOVED], {"scheme": "suzuki4"}, "drive: suzuki4 steps back"),
        ([MOVED], {"kick": {"velocity": 1.0}}, "drive.displacement: says how the bead moves"),
        ([MOVED, {**PUSHED, "chain": 1, "bead": 1}], {}, "drive.displacement: bead 1 of chain 1 is moved or pushed"),
        ([PUSHED], {"output": {"spectra": {"beads": [9]}}}, "output.spectra.beads: 9 is outside the array"),
        ([PUSHED], {"output": {"spectra": {"beads": [2]}, "beads": [1]}}, "output.spectra.beads: 2 not recorded"),
    ],
    ids=lambda value: re.sub(r"\W+", "-", str(value))[:30],
)
def test_what_cannot_be_is_refused_in_one_line(drives, changes, said):
    with pytest.raises(InputError) as error:
        driven(*drives, **changes)
    assert said in str(error.value)
    assert len(str(error.value).splitlines()) == 1


def test_a_sweep_may_vary_the_frequency():
    assert "drive.frequency" in all_fields(Scene)
