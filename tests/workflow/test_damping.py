"""Damped runs from end to end: reference, budget, interruption, ranks, validation with its cause."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from independent import integrated
from stock_lammps import scene

from analysis.conservation import Conservation
from analysis.tracking.peaks import PeakFinder
from analysis.trajectory import joined
from lammps_inputs import InputError, Scene
from lammps_inputs.ingredients.damping import Damping
from lammps_inputs.laws.dashpot import alpha
from workflow.engines.reference import engine
from workflow.engines.reference.verlet import VERLET
from workflow.prepare.instants import stride
from workflow.runs.run import Run, run
from workflow.verdicts.causes import causes

SLOW = pytest.mark.slow


def damped(**changes: Any) -> Scene:
    return scene(**{"beads": 12, "duration": 10.0, "damping": Damping(contact=0.1), **changes})


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return run(damped(), tmp_path_factory.mktemp("damped") / "run")


def test_the_twin_steps_as_lammps_does(done: Run) -> None:
    own = joined(done.directory.blocks())
    problem = done.directory.problem
    twin = engine.run(problem, scheme=VERLET, steps_per_frame=problem.steps_per_frame)
    np.testing.assert_allclose(twin.velocity, own.velocity, rtol=0.0, atol=1e-12)


def test_the_reference_knows_the_damped_run_to_its_certificate(done: Run) -> None:
    problem = done.directory.problem
    right = integrated(problem, loss=lambda _: 0.1, max_step=0.02, rtol=1e-10)
    assert done.check is not None
    sure = done.check.reference.velocity
    assert sure < 1e-6
    assert np.max(np.abs(engine.run(problem).velocity - right)) < sure
    assert done.check.velocity < 2e-4


def test_the_budget_of_lammps_closes_to_the_error_of_the_run(done: Run) -> None:
    seen = Conservation()
    for block in done.directory.blocks():
        seen.add(block)
    assert done.check is not None
    assert seen.energy_drift < 2.0 * done.check.velocity
    assert seen.momentum_drift < 1e-12
    assert seen.budget is not None
    account = seen.budget.result()
    assert account.lost["contact_damping"][-1] > 0.2
    assert np.all(np.diff(account.lost["contact_damping"]) >= 0.0)


def test_the_budget_of_drag_on_beads_closes_to_1e_9_in_the_reference() -> None:
    seen = Conservation()
    asked = damped(damping=Damping(beads=0.05), every=0.05)
    for block in engine.blocks(asked.problem(), steps_per_frame=20):
        seen.add(block)
    assert seen.energy_drift < 1e-9


@SLOW
@pytest.mark.parametrize(
    ("keys", "physics"),
    [
        ({"contact": 0.2, "tension": "cut"}, {"loss": lambda _: 0.2, "tension": False}),
        ({"contact": 0.3, "law": "viscoelastic"}, {"loss": lambda s: 0.3 * s**0.5}),
        ({"contact": 0.7, "law": "restitution"}, {"loss": lambda s: alpha(0.7) * 0.5**0.5 * s**0.25}),
    ],
)
def test_the_reference_knows_every_law(keys: dict[str, Any], physics: dict[str, Any]) -> None:
    problem = damped(damping=Damping(**keys), beads=6, every=0.5).problem()
    right = integrated(problem, **physics, max_step=0.02, rtol=1e-10)
    assert np.max(np.abs(engine.run(problem).velocity - right)) < 1e-5


LAWS = {
    "on-site": ({"beads": 0.01}, 0.2, -0.12244, 0.004),
    "linear": ({"contact": 0.002}, 0.2, -0.10586, 0.011),
    "linear, stronger": ({"contact": 0.01}, 0.2, -0.10586, 0.06),
    "viscoelastic": ({"contact": 0.01, "law": "viscoelastic"}, -0.2, 0.07577, 0.03),
}


@SLOW
@pytest.mark.parametrize("name", LAWS)
def test_weak_damping_slows_the_pulse_by_its_law(name: str, tmp_path: Path) -> None:
    """From the energy of the exact wave: amplitude to this power changes evenly from bead to bead."""
    keys, power, rate, within = LAWS[name]
    asked = scene(beads=130, duration=165.0, damping=Damping(**keys))
    found = run(asked, tmp_path / "run")
    finder = PeakFinder(first_only=True)
    for block in found.directory.blocks():
        finder.add(block)
    peaks = finder.result()
    beads = np.arange(40, 102)
    amplitude = np.array([peaks.velocity[peaks.bead == bead][0] for bead in beads])
    coefficient = next(value for value in keys.values() if isinstance(value, float))
    slope = np.polyfit(beads, amplitude**power, 1)[0]
    assert slope / (rate * coefficient) == pytest.approx(1.0, abs=within)
    assert found.check is not None
    if name == "on-site":
        assert amplitude[-1] == pytest.approx(0.33306, abs=5e-6 + found.check.amplitude)


def test_rigid_beads_refuse_damping(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="damping"):
        run(damped(gap=1.0), tmp_path / "run", engine="collisions")


@pytest.mark.parametrize(
    ("felt", "words"), [(0.0, "the contact damping is missing"), (0.12, "the contact damping is 1.2 times as strong")]
)
def test_wrong_damping_is_named_as_the_cause(felt: float, words: str) -> None:
    right, wrong = (engine.run(damped(damping=Damping(contact=g)).problem()) for g in (0.1, felt))
    found = causes(replace(wrong, problem=right.problem), right)
    assert len(found) == 1
    assert found[0].startswith(words)
    assert causes(right, right) == []


# --- overdamped -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("drag", [10.0, 1e3])
def test_steps_of_lammps_and_of_the_reference_follow_the_drag_on_beads(drag: float) -> None:
    problem = damped(damping=Damping(beads=drag), duration=1.0).problem()
    assert problem.timestep * drag <= 0.05
    assert problem.every / engine.default_steps_per_frame(problem) * drag <= 0.15  # within which Runge-Kutta is exact


def test_frames_are_compared_as_often_as_dashpots_stop_a_bead() -> None:
    """The error is largest in the first of them, where a kick is slowed down."""
    quick, slow = (damped(damping=Damping(contact=g), duration=50.0).problem() for g in (1.0, 0.01))
    assert quick.every > 0.25 / quick.drag
    assert stride(quick) == 1
    assert stride(slow) == 4
