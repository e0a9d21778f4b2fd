"""Chains on a foundation: laws, deck, LAMMPS and reference against an integrator of their own."""

import json

import numpy as np
import pytest
from plain_scene import scene
from wrong_runs import deck_run

from analysis.sharing.energies import EnergyFlow
from lammps_inputs import InputError, file_names, find
from lammps_inputs.decks import deck
from workflow.engines.reference import engine
from workflow.runs.run import run
from workflow.verdicts.analyse import analyse
from workflow.verdicts.validate import validate

pytestmark = pytest.mark.usefixtures("lammps_here")


def on_foundation(foundation, **changes):
    return scene(foundation=foundation, **changes)


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
    case = on_foundation({"stiffness": 0.5}, timestep=0.01)
    return run(case, tmp_path_factory.mktemp("on") / "run", check=False).directory


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
