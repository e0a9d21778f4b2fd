"""Chains on a foundation: laws, deck, LAMMPS and reference against an integrator of their own."""

import functools
import json

import numpy as np
import pytest
from independent import integrated
from plain_scene import BEADS, goes_on_bit_for_bit, scene
from stock_lammps import DEBIAN
from stock_lammps import run as run_stock
from wrong_runs import deck_run

from analysis.sharing.energy_flow import EnergyFlow
from lammps_inputs import InputError, file_names, find
from lammps_inputs.decks import deck
from lammps_inputs.slurm import job
from lammps_inputs.slurm.site import JobOptions
from workflow.engines.reference import engine
from workflow.runs.run import run
from workflow.verdicts.analyse import analyse
from workflow.verdicts.validate import validate

pytestmark = pytest.mark.usefixtures("lammps_here")

KINDS = {
    "linear": {"stiffness": 0.5},
    "cubic": {"stiffness": 0.3, "cubic": 0.7},
    "purely cubic": {"cubic": 0.5},
    "in some rows": {"stiffness": 0.4, "rows": [3, 9]},
    "by chain": {"stiffness": [0.5, 0.2]},
}


def on_foundation(foundation, **changes):
    return scene(foundation=foundation, **changes)


def springs(foundation, chains):
    """Linear and cubic stiffness [chain, bead] by hand."""
    first, last = foundation.get("rows", (1, BEADS))
    found = []
    for key in ("stiffness", "cubic"):
        values = np.zeros((chains, BEADS))
        values[:, first - 1 : last] = np.reshape(foundation.get(key, 0.0), (-1, 1))
        found.append(values)
    return found


@functools.cache
def exact(kind, chains):
    """Velocities by an integrator of their own."""
    return integrated(on_foundation(KINDS[kind], chains=chains).problem(), *springs(KINDS[kind], chains))


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "chains"), [("cubic", 1), ("in some rows", 3), *((kind, 2) for kind in KINDS)])
def test_the_reference_agrees_with_an_independent_integrator(chains, kind):
    found = engine.run(on_foundation(KINDS[kind], chains=chains).problem(), steps_per_frame=100).velocity
    assert np.abs(found - exact(kind, chains)).max() < 5e-8


@pytest.mark.parametrize("kind", KINDS)
def test_lammps_agrees_to_second_order_and_measures_its_own_error(tmp_path, kind):
    errors = []
    for step in (0.02, 0.01):
        found = run(on_foundation(KINDS[kind], timestep=step), tmp_path / f"{step}", check=step == 0.01)
        errors.append(np.abs(found.trajectory.velocity - exact(kind, 2)).max())
    assert found.check.velocity == pytest.approx(errors[-1], rel=0.1)
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.3)
    assert errors[1] < 2e-4


def test_the_energy_beats_between_two_chains_as_published_numbers_say():
    """k_f = 1, kappa = 0.1, V = 0.1: chain 2 has 0.995 of the energy at t = 34.5, and 0.013 at t = 69."""
    problem = find("beats-on-a-foundation").problem()
    flow = EnergyFlow(problem)
    for block in engine.blocks(problem):
        flow.add(block)
    found = flow.result()
    time = found.time * problem.scale.time
    assert np.interp([34.5, 69.0], time, found.share[:, 1]) == pytest.approx([0.995, 0.013], abs=5e-4)
    assert np.sum(found.share, axis=1) == pytest.approx(1.0, abs=1e-14)


@pytest.fixture(scope="module")
def directory(tmp_path_factory):
    return run(on_foundation(KINDS["linear"]), tmp_path_factory.mktemp("on") / "run", check=False).directory


def test_energy_is_kept_and_momentum_is_not_asked_for(directory):
    found = validate(directory)
    assert found.deviations["energy"].largest < 1e-4
    assert "momentum" not in found.deviations
    assert found.passed


@pytest.mark.slow
def test_analysis_says_where_the_energy_is_in_place_of_a_verdict(directory, draw_only):
    draw_only("energy")
    assert {path.stem for path in analyse(directory).figures} == {"energy", "response", "spacetime"}
    report = json.loads((directory.path / "analysis.json").read_text())
    assert report["equipartition"]["state"] == "does not apply"
    assert len(report["energy"]["share"]) == len(report["energy"]["time"]) == directory.problem.frames + 1
    assert report["energy"]["centre"][0] == [1.0, None]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (("fix foundation all spring/self ${foundation} x", ""), "the foundation is missing"),
        (("foundation index 0.5", "foundation index 0.55"), "the foundation is 1.1 times as strong as the scene says"),
    ],
    ids=["missing", "wrong"],
)
def test_validate_names_a_foundation_that_is_not_the_scenes(tmp_path, edit, said):
    def changed(path):
        text = (path / file_names.DECK).read_text()
        assert text.count(edit[0]) == 1
        (path / file_names.DECK).write_text(text.replace(*edit))

    case = on_foundation({"stiffness": 0.5}, output={"every": 0.1})
    assert said in validate(deck_run(case, tmp_path / "run", changed)).causes


@pytest.mark.slow
@pytest.mark.parametrize("foundation", [{"stiffness": 0.5}, {"stiffness": [0.5, 0.2], "cubic": 0.1}], ids=str)
def test_a_run_that_was_interrupted_goes_on_bit_for_bit(tmp_path, foundation):
    goes_on_bit_for_bit(on_foundation(foundation, duration=100.0), tmp_path)


@pytest.mark.skipif(not DEBIAN.exists(), reason="needs Debian's LAMMPS")
def test_the_2021_release_computes_the_same_bits(tmp_path):
    case = on_foundation({"stiffness": [0.5, 0.2], "cubic": 0.3})
    new, old = run_stock(case, tmp_path / "new"), run_stock(case, tmp_path / "old", executable=DEBIAN)
    np.testing.assert_array_equal(new.vx, old.vx)


@pytest.mark.slow
def test_two_ranks_compute_the_same_bits(tmp_path):
    case = on_foundation({"stiffness": [0.5, 0.2], "cubic": 0.3}, beads=40, timestep=0.05)
    one, two = (run_stock(case, tmp_path / str(ranks), ranks=ranks) for ranks in (1, 2))
    np.testing.assert_array_equal(one.vx, two.vx)


def test_a_slurm_job_has_the_same_fixes():
    problem = on_foundation({"stiffness": 0.5}).problem()
    texts = job.render_job(JobOptions(), problem)
    assert "fix foundation all spring/self ${foundation} x" in texts[file_names.JOB_INPUT] + texts["in.continue"]


@pytest.mark.parametrize("foundation", [None, {"stiffness": 0.0}], ids=["absent", "of no stiffness"])
def test_no_foundation_leaves_no_trace(foundation):
    problem = on_foundation(foundation).problem()
    assert "foundation" not in deck.render_deck(problem)
    assert not problem.system.ground
    assert not problem.system.lacks


def test_in_si_units_stiffnesses_are_made_dimensionless():
    steel = {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3}
    plain = on_foundation(None, material=steel, coupling=None, duration=1e-4, output={"every": 1e-6})
    scale = plain.scale
    foundation = {"stiffness": 0.5 * scale.stiffness, "cubic": 0.25 * scale.stiffness / scale.length**2}
    changes = {"material": steel, "coupling": None, "duration": 1e-4, "output": {"every": 1e-6}}
    (link,) = on_foundation(foundation, **changes).problem().system.ground
    assert tuple(link.law) == pytest.approx((0.5, 0.25), rel=1e-14)


@pytest.mark.parametrize(
    ("foundation", "changes", "said"),
    [
        ({"stiffness": -1.0}, {}, "foundation.stiffness"),
        ({"stiffness": [1.0, 2.0, 3.0]}, {}, "foundation.stiffness: 3 numbers for 2 chains; one, or one for each"),
        ({"stiffness": 1.0, "rows": [5, 13]}, {}, "foundation.rows: 5 to 13 given"),
        ({"stiffness": 1.0, "rows": [5, 4]}, {}, "foundation.rows: 5 to 4 given"),
        ({"stifness": 1.0}, {}, "foundation.stifness: unknown key (did you mean `stiffness`?)"),
        ({"stiffness": 1e13}, {}, "so stiff that the beads do not move"),
        ({"stiffness": 1.0}, {"beads": 100, "window": 64, "output": {"every": 0.5}}, "leave the window out"),
    ],
    ids=str,
)
def test_a_mistake_is_one_line_that_names_the_key(foundation, changes, said):
    with pytest.raises(InputError, match="foundation") as error:
        on_foundation(foundation, **changes)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_rigid_beads_on_a_foundation_are_refused(tmp_path):
    with pytest.raises(InputError, match="collisions"):
        run(on_foundation({"stiffness": 1.0}, gap=1.0), tmp_path / "run", engine="collisions")
