"""Laws and ingredients of one's own go all the way from YAML without touching the product.

They may add atoms that no table shows, and contacts whose force depends on the past.
"""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from processes import HANGS
from scipy.integrate import solve_ivp

pytestmark = pytest.mark.slow

TESTS = Path(__file__).parent

OWN = '''
"""Springs of the fifth power, a mass inside each bead, contacts with a state."""

from typing import Annotated

import numpy as np
from pydantic import Field

from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.base import FurtherAtoms, Ingredient, Positive
from lammps_inputs.laws import Law, Parameter, Pure, dimensionless, formula
from lammps_inputs.laws.plastic import LargestOverlap
from lammps_inputs.laws.spring import Linear
from lammps_inputs.links import Links
from lammps_inputs.units import Dimension


class Quintic(Law):
    """``q s**5``."""

    quintic: Annotated[Parameter, Dimension("stiffness", length=-4)]

    @staticmethod
    def force(s, quintic):
        return quintic * (s * s * s * s * s)

    @staticmethod
    def energy(s, quintic):
        return quintic / 6.0 * s**6

    @staticmethod
    def stiffness(s, quintic):
        return 5.0 * quintic * s**4

    @staticmethod
    def max_strain(energy, quintic):
        return (6.0 * energy / quintic) ** (1.0 / 6.0)

    ground = formula.ground("quintic*s^5")
    across = formula.across("quintic/6*q^3")


class Tie(Ingredient):
    quintic: Annotated[float, Field(gt=0)]

    def links(self, scene):
        law = dimensionless(Quintic(self.quintic), scene.scale)
        return (Links.across("tie", law, edges=tuple((chain, chain + 1) for chain in range(scene.chains - 1))),)


class Bed(Ingredient):
    takes_away = frozenset({Fact.MOMENTUM, Fact.PULSE})

    quintic: Annotated[float, Field(gt=0)]

    def links(self, scene):
        return (Links.ground("bed", dimensionless(Quintic(self.quintic), scene.scale)),)


class Masses(Ingredient):
    """A mass inside each bead, on a linear spring."""

    takes_away = frozenset({Fact.PULSE, Fact.SONIC_VACUUM})

    mass: Positive
    stiffness: Positive

    def further_atoms(self, scene):
        edges = tuple((chain, scene.chains + chain) for chain in range(scene.chains))
        link = Links.across("masses", Linear(self.stiffness / scene.scale.stiffness), edges=edges)
        return FurtherAtoms(np.full((scene.chains, scene.beads), self.mass / scene.scale.mass), (link,))

    def lacks(self, scene):
        return self.takes_away


class Worn(Law):
    """``s**1.5`` at first; what was pressed to d falls to nothing at ``share * d``."""

    strength: Pure
    share: Pure
    largest: LargestOverlap = 0.0

    @staticmethod
    def force(s, strength, share, largest):
        left = (s - share * largest) / (1.0 - share)
        return strength * np.maximum(s if s >= largest else left, 0.0) ** 1.5

    @staticmethod
    def energy(s, strength, share, largest):
        return 0.4 * strength * np.maximum(s, 0.0) ** 2.5

    @staticmethod
    def stiffness(s, strength, share, largest):
        return 1.5 * strength / (1.0 - share) * np.sqrt(np.maximum(s, 0.0))

    @staticmethod
    def max_strain(energy, strength, share, largest):
        return (2.5 * energy / strength) ** 0.4

    @staticmethod
    def next_state(s, strength, share, largest):
        return max(s, largest)

    @staticmethod
    def permanent(strength, share, largest):
        return share * largest

    @staticmethod
    def dissipated(strength, share, largest):
        return 0.4 * share * strength * largest**2.5


class Wear(Ingredient):
    takes_away = frozenset({Fact.PULSE, Fact.SONIC_VACUUM})

    share: Positive

    def contact_law(self, strength):
        return Worn(strength, self.share)

    def lacks(self, scene):
        return self.takes_away


INGREDIENTS = {"bed": Bed, "masses": Masses, "tie": Tie, "wear": Wear}
'''

SCENES: dict[str, dict[str, Any]] = {
    "bed": {
        "chains": 3,
        "coupling": {"stiffness": 0.2},
        "tie": {"quintic": 1.5},
        "bed": {"quintic": 1.5},
        "duration": 40,
    },
    "inner": {"beads": 30, "masses": {"mass": 0.1, "stiffness": 1.0}, "duration": 40},
    "worn": {"beads": 2, "wear": {"share": 0.19}, "duration": 8, "timestep": 0.01},
}


def text(name: str, **changes: Any) -> str:
    """A scene file: one chain of eight beads for 10 T unless it says otherwise."""
    plain = {"beads": 8, "kick": {"velocity": 1.0}, "duration": 10, "output": {"every": 0.1}}
    return json.dumps({"name": name, **plain, **SCENES[name], **changes})


PROGRAM = """
import json
from pathlib import Path
import numpy as np
import lammps_here as here
from analysis.tracking.peaks import find_peaks
from lammps_inputs import InputError, find
from lammps_inputs.facts import Fact
from lammps_inputs.limits import rates
from workflow.engines.reference import engine
from workflow.runs.resume import resume
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts import validate

validate.error_figure, validate.write_figure = (lambda *_: None), (lambda *_: ())  # take longer than the validation
scene = find("bed.yaml")
problem = scene.problem()
whole = run(scene, "whole")
run(scene, "cut", check=False, lammps=here.interrupted_after(500))
resume("cut", check=False, lammps=here.run)
again = RunDirectory(Path("cut")).trajectory.velocity
reference = engine.run(problem)
inner = run(find("inner.yaml"), "inner", lammps=here.run)
peaks = find_peaks([engine.run(inner.directory.problem)])
worn = find("worn.yaml").problem()
try:
    run(find("worn.yaml"), "worn")
except InputError as error:
    refused = str(error)
print(json.dumps({
    "error": whole.check.velocity,
    "sure": whole.check.reference.velocity,
    "same": bool(np.array_equal(again, whole.trajectory.velocity)),
    "from_step": RunDirectory(Path("cut")).job.resumed[0].from_step,
    "difference": float(np.abs(whole.trajectory.velocity - reference.velocity).max()),
    "quantities": sorted(validate.validate(whole.directory).deviations),
    "bounds": [rates.stability_bound(find(f"{name}.yaml").system) for name in ("untied", "bed")],
    "ground": float(problem.system.ground[0].energy(reference.displacement).max()),
    "velocity": reference.velocity[-1].tolist(),
    "inner": inner.check.velocity,
    "shape": inner.trajectory.velocity.shape,
    "peak": float(peaks.velocity[peaks.bead == 20][0]),
    "refused": refused,
    "rebound": [engine.run(worn, steps_per_frame=steps).velocity[-1, 0].tolist() for steps in (10, 400)],
    "momentum": worn.system.holds(Fact.MOMENTUM),
    "states": [engine.make_state(each, None).compiled.contacts.size for each in (worn, find("two-chains").problem())],
}))
"""


def python(place, *words, **environment):
    """How a process of Python beside the scenes ended; no path but that of the packages unless another is given."""
    return subprocess.run(
        [sys.executable, *words],
        cwd=place,
        env={**os.environ, "PYTHONPATH": str(TESTS.parent), **environment},
        capture_output=True,
        text=True,
        timeout=HANGS,
        check=False,
    )


def granchain(place, *words, **environment):
    """How a command ended."""
    return python(place, "-m", "workflow.cli", *words, **environment)


def own(*places):
    """Environment in which the own ingredients are found."""
    return {"GRANCHAIN_INGREDIENTS": "own", "PYTHONPATH": os.pathsep.join(map(str, (*places, TESTS.parent)))}


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    path = tmp_path_factory.mktemp("own")
    (path / "own.py").write_text(OWN)
    for name in SCENES:
        (path / f"{name}.yaml").write_text(text(name))
    (path / "untied.yaml").write_text(text("bed", chains=2, tie=None))
    # the module is on a relative path, where the processes of LAMMPS find it, too
    done = python(path, "-c", PROGRAM, **own(".", TESTS / "support"))
    assert done.returncode == 0, done.stderr[-3000:]
    return path, json.loads(done.stdout.splitlines()[-1])


def test_lammps_agrees_with_the_reference_to_the_usual_error(found):
    assert found[1]["error"] < 5e-4
    assert found[1]["difference"] == pytest.approx(found[1]["error"], abs=found[1]["sure"] + 1e-9)


def test_its_energy_is_in_the_budget_which_closes_and_momentum_is_not_asked_for(found):
    assert found[1]["ground"] > 0.01
    assert "energy" in found[1]["quantities"]
    assert "momentum" not in found[1]["quantities"]


def test_it_shortens_the_stability_bound(found):
    """omega**2 <= 6 sqrt(largest overlap) + 0.2 * 2 + 5 q s**4 at the largest s: q s**6 / 6 = 1 / 2; less with ties."""
    largest = (6.0 * 0.5 / 1.5) ** (1.0 / 6.0)
    omega = (6.0 * 1.25**0.2 + 0.4 + 7.5 * largest**4) ** 0.5
    untied, tied = found[1]["bounds"]
    assert untied == pytest.approx(2.0 / omega, rel=1e-12)
    assert tied < untied


def test_an_interrupted_run_goes_on_bit_for_bit(found):
    assert found[1]["from_step"] > 0
    assert found[1]["same"]


def test_the_reference_agrees_with_an_independent_integrator(found):
    """Chains that are coupled and tied, each to the next."""

    def rate(_, state):
        x = state[:24].reshape(3, 8)
        push = np.maximum(x[:, :-1] - x[:, 1:], 0.0) ** 1.5
        pull = 0.2 * np.diff(x, axis=0) + 1.5 * np.diff(x, axis=0) ** 5
        force = -1.5 * x**5
        force[:, 1:] += push
        force[:, :-1] -= push
        force[:-1] += pull
        force[1:] -= pull
        return np.concatenate([state[24:], force.reshape(-1)])

    start = np.zeros(48)
    start[24] = 1.0
    exact = solve_ivp(rate, (0.0, 40.0), start, method="DOP853", rtol=1e-12, atol=1e-14).y[24:, -1].reshape(3, 8)
    assert np.abs(exact[2]).max() > 0.1
    np.testing.assert_allclose(found[1]["velocity"], exact, atol=2e-5)


def test_a_mass_inside_each_bead_acts_alike_in_lammps_and_the_reference_and_stands_in_no_table(found):
    """The peak is that of an independent program (mass-in-mass chain, m2 = 0.1, k2 = 1)."""
    assert found[1]["peak"] == pytest.approx(0.588365, abs=2e-6)
    assert found[1]["inner"] < 2e-4  # the accuracy that its time step is chosen for
    assert found[1]["shape"] == [401, 1, 30]


def test_a_contact_whose_state_is_its_largest_overlap_gives_two_beads_their_restitution_and_all_their_momentum(found):
    """Of the energy 0.4 d**2.5 at the largest overlap d, the share is lost: e**2 = 1 - share."""
    assert "LAMMPS has no such force; use the reference engine" in found[1]["refused"]
    coarse, fine = found[1]["rebound"]
    assert coarse == pytest.approx([0.05, 0.95], abs=1e-5)  # the largest overlap is found within the step
    assert fine == pytest.approx([0.05, 0.95], abs=1e-8)
    assert found[1]["states"] == [3, 0]
    assert found[1]["momentum"]
    for velocities in found[1]["rebound"]:
        assert sum(velocities) == pytest.approx(1.0, abs=1e-14)


def test_a_run_without_its_module_names_the_module(found):
    place, _ = found
    assert granchain(place, "run", "bed.yaml", "-o", "away", "--engine", "reference", **own(".")).returncode == 0
    for command in ("analyze", "view", "validate"):
        done = granchain(place, command, "away")
        assert done.returncode == 2
        assert "bed: unknown key" in done.stderr
        assert done.stderr.endswith("the scene needs GRANCHAIN_INGREDIENTS=own\n")
