"""Damped runs from end to end: reference, budget, interruption, ranks, validation with its cause."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from stock_lammps import scene
from wrong_runs import causes, without_uncertainties

from analysis.conservation import ConservationMeter
from analysis.tracking.peaks import PeakMeter
from analysis.trajectory import joined
from lammps_inputs import Kick, laws
from lammps_inputs.limits import rates
from lammps_inputs.scene import DEFAULT_ACCURACY
from workflow.engines.reference import engine
from workflow.engines.reference.energy_exchange import Accountant
from workflow.prepare.pilot import stride
from workflow.runs.check import closing
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.analysis_files import analyse
from workflow.verdicts.validate import TOLERANCES, validate


def damped(**changes):
    return scene(**{"beads": 12, "duration": 10.0, "damping": {"contact": 0.1}, **changes})


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    return run(damped(), tmp_path_factory.mktemp("damped") / "run")


def budget(blocks, keeper=None):
    """What is missing at most, and where the energy is."""
    first, *others = blocks if keeper is None else keeper.counted(blocks)
    seen = ConservationMeter(first.problem).read([first, *others])
    return seen.energy_drift, seen.budget


@pytest.mark.slow
def test_the_budget_of_lammps_closes_to_the_error_of_the_run_and_is_told_and_validated(done):
    """However far apart its frames are."""
    problem = done.directory.problem
    for coarse in (1, 20):
        keeper = Accountant(problem.coarser(coarse))
        missing, account = budget(done.directory.blocks(coarse), keeper)
        assert missing < 2.0 * done.check.velocity
        assert keeper.uncertainty < 0.1 * done.check.velocity
        assert account.dissipated["contact_damping"][-1] > 0.2
        assert np.all(np.diff(account.dissipated["contact_damping"]) >= 0.0)
    found = analyse(done.directory, figures=False)
    told = json.loads((done.directory.path / "analysis.json").read_text())["budget"]
    assert told["closed"] == pytest.approx(max(map(abs, told["missing"])) / 0.5)
    assert told["between_frames"] < 1e-6
    assert told["stated"] == done.check.velocity
    assert found.conservation.momentum_drift < 1e-12
    validated = validate(done.directory)
    assert validated.passed
    assert 0.0 < validated.deviations["energy"].largest < 2.0 * done.check.velocity


@pytest.mark.slow
def test_contacts_that_stick_and_part_take_steps_of_their_own_for_that():
    kicks = (Kick(bead=10, velocity=1.0), Kick(bead=11, velocity=-0.4904698767034886))
    scene = damped(damping={"contact": 0.785972041541755, "tension": "cut"}, kick=kicks, every=0.05)
    *_, uncertainty = (halving.run() for halving in closing(scene.problem()))
    assert uncertainty.energy < 1e-9


@pytest.mark.slow
def test_peaks_of_a_damped_run_with_an_error_of_first_order_are_let_pass(tmp_path):
    found = validate(run(damped(damping={"contact": 0.5}, timestep=1e-3), tmp_path / "run", check=False).directory)
    assert found.deviations["amplitude"].largest > TOLERANCES["amplitude"]
    assert found.passed


@pytest.mark.slow
def test_what_a_time_step_leaves_of_overdamped_beads_is_not_taken_for_their_masses(tmp_path):
    sticky = damped(damping={"contact": 20.0, "law": "viscoelastic"}, beads=10, duration=12.0, timestep=2e-3)
    found = validate(run(sticky, tmp_path / "run", check=False).directory)
    assert found.exceeded("velocity")
    (cause,) = found.causes
    assert cause.startswith("the time step of 0.002 is too long")


@pytest.mark.slow
def test_a_run_with_other_dashpots_fails_by_its_budget_too(done, tmp_path):
    step = done.directory.scene.timestep
    other = run(damped(damping={"contact": 0.11}, timestep=step), tmp_path / "run").directory.path
    (other / "scene.yaml").write_text((done.directory.path / "scene.yaml").read_text())
    (other / "log.lammps").unlink()  # it states the other dashpots
    found = validate(RunDirectory(other))
    assert found.exceeded("energy")
    assert without_uncertainties(found.causes) == ["the contact damping is 1.1 times as strong as the scene says"]


@pytest.mark.slow
def test_frames_that_are_followed_by_the_reference_have_the_ledger_of_its_own_run():
    problem = damped(every=0.5).problem()
    own = engine.run(problem)
    keeper = Accountant(problem)
    again = joined(keeper.counted([replace(own, exchange=None)]))
    assert 0.0 < keeper.uncertainty < 1e-6
    # where beads at rest are reached within a step, the run has them from the next part of it on
    np.testing.assert_allclose(again.exchange, own.exchange, rtol=0.0, atol=1e-10)


LAWS = {
    "on-site": ({"beads": 0.01}, 0.2, -0.12244, 0.004),
    "linear": ({"contact": 0.002}, 0.2, -0.10586, 0.011),
    "viscoelastic": ({"contact": 0.01, "law": "viscoelastic"}, -0.2, 0.07577, 0.03),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", LAWS)
def test_weak_damping_slows_the_pulse_by_its_law(name):
    """From the energy of the exact wave: amplitude to this power changes evenly from bead to bead."""
    keys, power, rate, within = LAWS[name]
    asked = scene(beads=130, duration=165.0, damping=keys)
    peaks = PeakMeter(first_only=True).read(engine.blocks(asked.problem()))
    beads = np.arange(40, 102)
    amplitude = np.array([peaks.velocity[peaks.bead == bead][0] for bead in beads])
    coefficient = next(value for value in keys.values() if isinstance(value, float))
    slope = np.polyfit(beads, amplitude**power, 1)[0]
    assert slope / (rate * coefficient) == pytest.approx(1.0, abs=within)
    if name == "on-site":
        assert amplitude[-1] == pytest.approx(0.33306, abs=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("felt", "words"),
    [
        ({"contact": 0.0}, "the contact damping is missing"),
        ({"contact": 0.1, "law": "viscoelastic"}, "the contact damping does not follow the law of the scene"),
    ],
    ids=str,
)
def test_wrong_damping_is_named_as_the_cause_and_only_where_it_is(felt, words):
    right, other = (engine.run(damped(damping=keys).problem()) for keys in ({"contact": 0.1}, felt))
    wrong = replace(other, problem=right.problem)
    (found,) = causes(wrong, right)
    assert found.startswith(words)
    assert causes(right, right) == []
    assert not any("damping" in cause for cause in causes(right, wrong))


@pytest.mark.slow
def test_a_small_standing_wave_under_load_decays_at_its_exact_complex_frequency(tmp_path):
    """x ~ exp(s t) cos(q (n - 1/2)): m s^2 + 2 (1 - cos q) (g s + k) = 0, so its rate is g (1 - cos q) / m."""
    beads, mode, g = 12, 4, 0.2
    q = np.pi * mode / beads
    shape = np.cos(q * (np.arange(beads) + 0.5))
    shape /= shape.max()  # of the fastest bead, which is V
    asked = damped(
        precompression={"force": 1e4},  # so large that strains of the wave are 1e-3 of the overlap
        kick=tuple(Kick(bead=bead + 1, velocity=value) for bead, value in enumerate(shape) if abs(value) > 1e-9),
        damping={"contact": g},
        duration=6.0,
        every=0.05,
    )
    k = float(laws.stiffness(asked.system.along[0].law, 0.0))
    s = complex(np.roots([1.0, 2.0 * (1.0 - np.cos(q)) * g, 2.0 * (1.0 - np.cos(q)) * k])[0])
    rate, omega = -s.real, abs(s.imag)
    assert rate == pytest.approx(g * (1.0 - np.cos(q)), rel=1e-12)
    done = run(asked, tmp_path / "run")
    for found, doubt in ((joined(done.directory.blocks()), done.check.velocity), (engine.run(asked.problem()), 0.0)):
        swing = found.velocity[:, 0] @ shape / (shape @ shape)
        fall = np.exp(-rate * found.time)
        exact = fall * (np.cos(omega * found.time) - rate / omega * np.sin(omega * found.time))
        assert np.abs(swing - exact).max() < doubt + 2e-6
    assert fall[-1] < 0.6


# --- walls ------------------------------------------------------------------------------------------------------------


@pytest.fixture
def column(tmp_path):
    case = damped(
        beads=6,
        walls={"right": {"stiffness": 5.0}},
        contact={"exponent": 2.0},
        gravity={"acceleration": 0.05},
        damping={"contact": 0.1, "law": "viscoelastic"},
        timestep=0.005,
        output={"forces": {"wall": True}},
    )
    return run(case, tmp_path / "run")


@pytest.mark.slow
def test_the_budget_tells_what_walls_take_and_closes_and_their_gauge_reads_their_dashpot(column):
    problem = column.directory.problem
    missing, account = budget(engine.blocks(problem, steps_per_frame=40))
    assert missing < 1e-9
    assert account.dissipated["right_wall_damping"][-1] > 5e-3
    assert np.all(np.diff(account.dissipated["right_wall_damping"]) >= -1e-15)
    missing, seen = budget(column.directory.blocks(20), Accountant(problem.coarser(20)))
    assert missing < 2.0 * column.check.velocity
    for name, lost in account.dissipated.items():
        assert seen.dissipated[name][-1] == pytest.approx(lost[-1], abs=2.0 * column.check.velocity)
    # all that the wall gives, above what it bears, is what the momentum has changed by
    analyse(column.directory, figures=False)
    (wall,) = json.loads((column.directory.path / "analysis.json").read_text())["forces"]
    momentum = float(joined(column.directory.blocks()).velocity[-1].sum())
    assert wall["static"] == pytest.approx(0.3, rel=1e-9)
    assert wall["impulse"] == pytest.approx(1.0 - momentum, abs=6.0 * column.check.velocity)


# --- overdamped -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("drag", [10.0, 1e3])
def test_steps_of_lammps_and_of_the_reference_follow_the_drag_on_beads(drag):
    problem = damped(damping={"beads": drag}, duration=1.0).problem()
    assert (problem.timestep * drag) ** 2 / (12.0 * math.e) <= DEFAULT_ACCURACY  # of an exponential of second order
    assert problem.every / engine.default_steps_per_frame(problem) * drag <= 0.15  # within which Runge-Kutta is exact


def test_frames_are_compared_as_often_as_dashpots_stop_a_bead():
    """The error is largest in the first of them, where a kick is slowed down."""
    quick, slow = (damped(damping={"contact": g}, duration=50.0).problem() for g in (1.0, 0.01))
    assert quick.every > 0.25 / rates.drag(quick.system)
    assert stride(quick) == 1
    assert stride(slow) == 4
