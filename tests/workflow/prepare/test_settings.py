"""A scene without a time step gets one that keeps its accuracy, or the default; a step that is unstable is refused."""

import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from small_problems import problem as small_problem

from analysis.compare.common_times import on_common_rows
from lammps_inputs import InputError, Kick, Output, Scene, find
from lammps_inputs.ingredients.coupling import Coupling
from lammps_inputs.limits.rates import stability_bound, timestep_for
from lammps_inputs.scene import DEFAULT_ACCURACY
from lammps_inputs.scheme import cycle
from lammps_inputs.units import make_scale
from workflow.engines.reference import engine
from workflow.engines.reference.step_halving import accurate_reference
from workflow.errors import RunError
from workflow.prepare import pilot
from workflow.prepare.pilot import stride
from workflow.prepare.settings import settle
from workflow.prepare.step_choice import ChosenStep
from workflow.runs.check import check
from workflow.runs.run import prepare_run, run, run_prepared
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.analysis_files import analyse

pytestmark = pytest.mark.usefixtures("lammps_here")

SUZUKI = {"window of 64": 1e-3, "kappa = 10": 1e-6}


def scene(kappa=0.1, **changes):
    fields = {"name": "a", "chains": 2, "beads": 40, "kick": (Kick(velocity=1.0),), "duration": 60.0, **changes}
    return Scene(**fields, coupling=Coupling(stiffness=kappa) if kappa else None)


BACK = (Kick(bead=20, velocity=-1.0),)
HEAD_ON = (Kick(velocity=1.0), Kick(bead=40, velocity=-1.0))
SMALL = {
    "one chain": scene(kappa=0.0, chains=1),
    "five chains": scene(chains=5),
    "kappa = 10": scene(kappa=10.0, beads=20, duration=30.0),
    "kappa = 0.001": scene(kappa=1e-3),
    "head-on": scene(kick=HEAD_ON),
    "kicked back": scene(kick=BACK),
    "gapped": scene(gap=2.874, beads=20, duration=120.0),
    "gapped, kappa = 1": scene(kappa=1.0, gap=0.909, duration=120.0),
    "one bead recorded": scene(output=Output(beads=(30,))),
    "two beads": scene(kappa=0.0, chains=1, beads=2, duration=5.0),
    "window of 64": scene(beads=300, duration=150.0, window=64),
}
GRID = {**{name: find(name) for name in ("two-chains", "three-chains", "two-chains-steel")}, **SMALL}


def asking(scene, accuracy, **changes):
    """The scene with an accuracy in place of a time step."""
    return scene.model_copy(update={"timestep": None, "accuracy": accuracy, **changes})


def error(problem, accuracy):
    """Largest error of any velocity of LAMMPS, by its twin at every frame, against a reference sure to a fifth."""
    runs = (
        engine.blocks(
            problem,
            scheme=pilot.TABLES[problem.scheme],
            steps_per_frame=problem.steps_per_frame // cycle(problem.scheme),
        ),
        accurate_reference(problem, accuracy / 5.0).blocks(),
    )
    pairs = (on_common_rows(own, right) for own, right in zip(*runs, strict=True))
    return max(float(np.abs(own.velocity - right.velocity).max()) for own, right in pairs)


# --- accuracy ---------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "accuracy", "scheme"),
    [
        *((name, (1e-3, 1e-5)[number % 2], "verlet") for number, name in enumerate([*GRID][::2])),
        ("two-chains", 1e-6, "verlet"),
        *((name, accuracy, "suzuki4") for name, accuracy in SUZUKI.items()),
    ],
)
def test_the_error_ends_below_what_was_asked_with_at_most_five_times_the_steps_that_would_just_do(
    name, accuracy, scheme
):
    settled, settings = settle(asking(GRID[name], accuracy, scheme=scheme))
    problem = settled.problem()
    found = error(problem, accuracy)
    assert problem.steps_per_frame % cycle(scheme) == 0
    assert found <= accuracy
    order = 2.0 if scheme == "verlet" else 2.5  # from 4 down to that
    assert (accuracy / found) ** (1.0 / order) <= 5.0 or settings.limited


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "work"), [({"chains": 1, "kappa": 0.0}, 0.0), ({"kappa": 1e-3}, 3e6), ({"kick": HEAD_ON}, 3e6)]
)
def test_so_it_does_where_less_than_the_run_can_be_measured(changes, work):
    problem, accuracy = scene(**{"beads": 120, "duration": 192.0, **changes}).problem(), 1e-4
    found = pilot.search(problem, accuracy, most_work=work)
    steps = math.ceil(problem.every / found.timestep)
    assert (found.measured, found.measured_error) != (1.0, found.expected_error)
    made = error(replace(problem, steps_per_frame=steps, timestep=problem.every / steps), accuracy)
    assert accuracy / 25.0 <= made <= accuracy


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "scheme"),
    [("one-chain", "suzuki4"), ("two-chains", "verlet"), ("kappa = 10", "suzuki4"), ("head-on", "verlet")],
)
def test_the_rule_alone_errs_on_the_safe_side_by_a_factor_of_five_in_the_step_at_most(name, scheme):
    problem, accuracy = replace((GRID.get(name) or find(name)).problem(), scheme=scheme), 1e-5
    step = timestep_for(accuracy, problem.duration, problem.system, scheme)
    cycles = math.ceil(problem.every / (step * cycle(scheme)))
    steps = cycles * cycle(scheme)
    found = error(replace(problem, timestep=problem.every / steps, steps_per_frame=steps), accuracy)
    assert found <= accuracy
    assert (accuracy / found) ** (1.0 / pilot.TABLES[scheme].order) <= 5.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "accuracy", "scheme"),
    [("two-chains", 1e-4, None), ("gapped", 1e-3, None), ("five chains", 1e-5, "suzuki4")],
)
def test_a_run_of_lammps_ends_with_the_error_that_was_measured_beforehand(tmp_path, name, accuracy, scheme):
    result = run(asking(GRID[name], accuracy, scheme=scheme), tmp_path / "run")
    expected = result.directory.job.settings.expected_error
    assert result.check.velocity <= accuracy
    assert result.check.reference.velocity <= accuracy / 3.0
    assert result.check.velocity == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("accuracy", [1e-3, 1e-7])
def test_a_run_of_the_reference_is_certified_to_what_was_asked(tmp_path, accuracy):
    result = run(asking(SMALL["five chains"], accuracy), tmp_path / "run", engine="reference")
    assert result.directory.job.uncertainty.velocity <= accuracy


@pytest.mark.slow
def test_a_scene_that_names_neither_step_nor_accuracy_gets_the_default_accuracy():
    """A bead that leaves the free end takes the largest error: 7.9e-4 of V at a step of 0.01."""
    settled, settings = settle(scene(kappa=0.0, chains=1, beads=250, duration=320.0))
    assert (settings.accuracy, settings.asked) == (DEFAULT_ACCURACY, False)
    assert error(settled.problem(), DEFAULT_ACCURACY) <= DEFAULT_ACCURACY
    assert "0.0002 V (default accuracy): error" in settings.sentence(settled.problem())


def test_where_no_step_keeps_the_default_accuracy_the_rule_gives_one():
    far = scene(kappa=0.0, chains=1, beads=2, gap=4e8, duration=1e5, output=Output(every=1e3))
    settled, settings = settle(far)
    assert settled.timestep == pytest.approx(far.resolved().timestep)
    assert "rounding" in settings.sentence(settled.problem())


@pytest.mark.slow
@pytest.mark.parametrize("changes", [{"output": Output(every=0.02)}, {"window": 64, "beads": 300}])
def test_a_check_with_the_reference_of_the_pilot_run_finds_what_a_new_one_does(tmp_path, changes):
    ready = prepare_run(scene(**{"duration": 150.0, **changes}), tmp_path / "run")
    settings, done = ready.step, run_prepared(ready)
    assert settings.reference.is_of(done.directory.problem.coarser(stride(done.directory.problem, pilot.CADENCE)))
    again = check(done.directory, replace(settings, reference=None))
    for name in ("velocity", "arrival", "amplitude"):
        assert getattr(done.check, name) == pytest.approx(getattr(again, name), rel=1e-6)
    assert done.check.reference.velocity == pytest.approx(again.reference.velocity, rel=1e-6)


@pytest.mark.parametrize("scheme", ["verlet", "suzuki4"])
@pytest.mark.parametrize("step", [1e-3, 0.0136, 0.07, 0.3])
def test_without_a_cadence_frames_are_as_many_whole_steps_apart_as_fit_into_a_tenth_of_t(step, scheme):
    problem = scene(timestep=step, scheme=scheme).problem()
    steps = cycle(scheme)
    assert problem.timestep == pytest.approx(step, rel=1e-9)
    assert problem.steps_per_frame % steps == 0
    assert problem.every <= max(0.1, steps * step) * (1.0 + 1e-9)
    assert problem.every + steps * step > 0.1
    resolved = scene(timestep=step, scheme=scheme).resolved()
    assert resolved.resolved() == resolved


def test_the_sentence_says_how_the_step_was_chosen(golden):
    found = ChosenStep(1e-4, 0.0125, 8, 0.1, 2e-5, 2e-5, 1.0, limited=False, seconds=0.5)
    kinds = (
        {},
        {"measured_error": 8e-5, "measured": 0.25, "limited": True},
        {"rule_timestep": 0.0125 / 0.21},
        {"rule_timestep": 0.2},
        {"measured": 0.0},
        {"measured": 0.0, "unreached": "errors grow"},
    )
    units = (make_scale(1.0, 1.0, 1.0, si=False), make_scale(2.0, 2.0, 1e5, si=True))
    said = [replace(found, **kind).sentence(small_problem(scale=scale)) for kind in kinds for scale in units]
    golden("steps", "\n".join(said))


@pytest.mark.slow
def test_rounding_leaves_no_more_than_is_reckoned_with(tmp_path):
    """Bead 1000 is near 4000 in LAMMPS."""
    far = tuple(range(960, 1001))
    kick = (Kick(bead=960, velocity=1.0),)
    fine = scene(beads=1000, kick=kick, duration=10.0, timestep=1e-3, output=Output(beads=far))
    made = run(fine, tmp_path / "run", check=False)
    own, problem = made.trajectory, made.directory.problem
    right = engine.run(problem, scheme=pilot.TABLES["verlet"], steps_per_frame=problem.steps_per_frame)
    floor = pilot.rounding(problem, problem.timestep)
    assert 0.01 * floor < np.abs(own.velocity - right.velocity).max() < floor


# found in the run itself, and by how much faster errors grow than in a shorter one
@pytest.mark.slow
@pytest.mark.parametrize("work", [1.5e9, 4e8])
def test_chaos_behind_the_front_is_refused(work):
    """Two chains, kappa = 0.01: in t = 816, beads behind the front collide too often."""
    whole = scene(kappa=0.01, beads=480, duration=816.0).problem()
    with pytest.raises(pilot.UnreachableError, match="behind the front collide again and again"):
        pilot.search(whole, 1e-4, most_work=work)


@pytest.mark.slow
def test_the_error_in_a_window_is_measured_where_the_pulse_is():
    whole, window = (scene(beads=200, duration=180.0, window=rows).problem() for rows in (None, 64))
    found = [pilot.measure(problem, 1e-4, 1e9) for problem in (whole, window)]
    # the largest error of the whole chains is at the pulse, too, at another of the instants that are compared
    assert found[1].expected_error * found[0].timestep ** 2 == pytest.approx(
        found[0].expected_error * found[1].timestep ** 2, rel=0.05
    )


@pytest.mark.slow
def test_near_the_front_there_is_none():
    near = scene(kappa=0.01, chains=2, beads=480, duration=816.0, window=96)
    assert pilot.search(near.problem(), 1e-3, most_work=1e9).measured == 1.0


# --- stability --------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_step_up_to_the_bound_passes_and_one_beyond_it_runs_by_force_until_its_energy_is_wrong(tmp_path):
    def beyond(factor):
        step = factor * stability_bound(SMALL["one chain"].problem().system)
        return SMALL["one chain"].model_copy(update={"timestep": step, "output": Output(every=step)})

    settle(beyond(1.0))
    with pytest.raises(InputError, match="unstable"):
        settle(beyond(1.01))
    with pytest.raises(RunError, match="energy"):
        run(beyond(1.2), tmp_path / "run", force=True, check=False)
    analyse(RunDirectory(tmp_path / "run"), figures=False)
    assert (tmp_path / "run" / "analysis.json").is_file()


@pytest.mark.slow
def test_a_scene_that_memory_does_not_hold_is_refused_in_one_line(tmp_path):
    (tmp_path / "large.yaml").write_text(
        "{name: large, chains: 20, beads: 100000000, coupling: {stiffness: 0.1}, kick: {velocity: 1}, duration: 1,\n"
        "initial: [{bead: 1, displacement: 0.6}]}"  # 32 GB of displacements and velocities
    )
    command = f"ulimit -v 8000000; {sys.executable} -m workflow run large.yaml -o run"
    done = subprocess.run(["bash", "-c", command], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith("granchain: large.yaml: beads: more than this machine's memory holds")
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "run").exists()
