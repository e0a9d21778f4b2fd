"""A law and an ingredient of one's own go all the way from YAML without touching the product."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from processes import HANGS

pytestmark = pytest.mark.slow

TESTS = Path(__file__).parent

OWN = '''
"""A spring to the ground whose force is the fifth power of the displacement."""

from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.base import Ingredient
from lammps_inputs.laws import Parameter, Pure, dimensionless, formula
from lammps_inputs.links import Across, Ground
from lammps_inputs.units import Dimension


class Quintic(NamedTuple):
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
        return (Across("tie", law, edges=tuple((chain, chain + 1) for chain in range(scene.chains - 1))),)


class Bed(Ingredient):
    takes_away = frozenset({Fact.MOMENTUM, Fact.PULSE})

    quintic: Annotated[float, Field(gt=0)]

    def links(self, scene):
        return (Ground("bed", dimensionless(Quintic(self.quintic), scene.scale)),)


class Stiffening(NamedTuple):
    """``A s**1.5 (1 + b s)``."""

    strength: Pure
    b: Annotated[Parameter, Dimension(length=-1)]

    @staticmethod
    def force(s, strength, b):
        closed = np.maximum(s, 0.0)
        return strength * closed**1.5 * (1.0 + b * closed)

    @staticmethod
    def energy(s, strength, b):
        closed = np.maximum(s, 0.0)
        return strength * (0.4 * closed**2.5 + b / 3.5 * closed**3.5)

    @staticmethod
    def stiffness(s, strength, b):
        closed = np.maximum(s, 0.0)
        return strength * (1.5 * closed**0.5 + 2.5 * b * closed**1.5)

    @staticmethod
    def max_strain(energy, strength, b):
        return (2.5 * energy / np.where(strength > 0.0, strength, np.inf)) ** 0.4

    along = formula.along("strength*(0.4*s^2.5+b/3.5*s^3.5)")


class Stiffer(Ingredient):
    b: Annotated[float, Field(gt=0)]

    def contact_law(self, strength):
        return Stiffening(strength, self.b)


INGREDIENTS = {"bed": Bed, "stiffer": Stiffer, "tie": Tie}
'''

SCENE = """
name: bed
chains: 2
beads: 8
coupling: {stiffness: 0.2}
bed: {quintic: 1.5}
kick: {velocity: 1.0}
duration: 40
output: {every: 0.1}
"""

CONTACT = """
name: stiffer
beads: 8
stiffer: {b: 0.5}
damping: {contact: 0.2}
kick: {velocity: 4.0}
duration: 10
timestep: 0.001
output: {every: 0.1}
"""

HELD = """
name: held
beads: 8
stiffer: {b: 0.5}
walls: {right: bead}
gap: 0.3
kick: {velocity: 4.0}
duration: 12
output: {every: 0.1}
"""

TIED = """
name: tied
chains: 3
beads: 8
tie: {quintic: 1.5}
kick: {velocity: 1.0}
duration: 40
"""

PROGRAM = """
import json
from pathlib import Path
import numpy as np
import lammps_here as here
from lammps_inputs import find
from lammps_inputs.limits import rates
from workflow.engines.reference import engine
from workflow.runs.resume import resume
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.validate import validate

scene = find("bed.yaml")
problem = scene.problem()
whole = run(scene, "whole")
run(scene, "cut", check=False, lammps=here.interrupted_after(500))
resumed = resume("cut", check=False)
again = RunDirectory(Path("cut")).trajectory.velocity
reference = engine.run(problem)
damped = run(find("contact.yaml"), "damped")
tied = run(find("tied.yaml"), "tied")
held = engine.run(find("held.yaml").problem())
print(json.dumps({
    "error": whole.check.velocity,
    "sure": whole.check.reference.velocity,
    "same": bool(np.array_equal(again, whole.trajectory.velocity)),
    "from_step": RunDirectory(Path("cut")).job.resumed[0].from_step,
    "difference": float(np.abs(whole.trajectory.velocity - reference.velocity).max()),
    "quantities": sorted(validate(whole.directory).deviations),
    "bound": rates.stability_bound(problem.system),
    "ground": float(problem.system.ground[0].energy(reference.displacement).max()),
    "damped": damped.check.velocity,
    "own_contacts": (damped.trajectory.velocity[-1] * 4.0).tolist(),
    "velocity": reference.velocity[-1].tolist(),
    "held": [(held.displacement[-1, 0] * held.problem.scale.length).tolist(), (held.velocity[-1, 0] * 4.0).tolist()],
    "tied": tied.check.velocity,
    "passed_on": float(np.abs(tied.trajectory.velocity[:, 2]).max()),
}))
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    path = tmp_path_factory.mktemp("own")
    (path / "bed.py").write_text(OWN)
    (path / "bed.yaml").write_text(SCENE)
    (path / "contact.yaml").write_text(CONTACT)
    (path / "tied.yaml").write_text(TIED)
    (path / "held.yaml").write_text(HELD)
    paths = [str(path), str(TESTS / "support"), str(TESTS.parent)]
    own = {"GRANCHAIN_INGREDIENTS": "bed", "PYTHONPATH": os.pathsep.join(paths)}
    command = [sys.executable, "-c", PROGRAM]
    done = subprocess.run(
        command, cwd=path, env={**os.environ, **own}, capture_output=True, text=True, timeout=HANGS, check=False
    )
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
    """omega**2 <= 6 sqrt(largest overlap) + 0.2 * 2 + 5 q s**4 at the largest s: q s**6 / 6 = 1 / 2."""
    largest = (6.0 * 0.5 / 1.5) ** (1.0 / 6.0)
    omega = (6.0 * 1.25**0.2 + 0.4 + 7.5 * largest**4) ** 0.5
    assert found[1]["bound"] == pytest.approx(2.0 / omega, rel=1e-12)


def test_a_wall_beside_own_contacts_has_their_law(found):
    """In the scene's units: the last bead and a wall as far apart as beads, with the force s**1.5 (1 + 0.5 s)."""
    import numpy as np
    from scipy.integrate import solve_ivp

    def rate(_, state):
        s = np.maximum(state[:8] - np.append(state[1:8], 0.0) - 0.3, 0.0)
        push = s**1.5 * (1.0 + 0.5 * s)
        return np.concatenate([state[8:], np.append(0.0, push[:-1]) - push])

    start = np.zeros(16)
    start[8] = 4.0
    exact = solve_ivp(rate, (0.0, 12.0), start, method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
    assert exact[8:].min() < -1.0  # reflected
    np.testing.assert_allclose(np.ravel(found[1]["held"]), exact, atol=1e-4)


@pytest.mark.parametrize("kind", ["rigid", "{stiffness: 2}"])
def test_a_wall_that_is_known_for_powers_of_the_overlap_only_is_refused_beside_own_contacts(found, kind):
    (found[0] / "face.yaml").write_text(HELD.replace("right: bead", f"right: {kind}"))
    done = granchain("show", "face.yaml", cwd=found[0], GRANCHAIN_INGREDIENTS="bed", PYTHONPATH=own_path(found[0]))
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "walls.right: is known for contacts whose force is a power of the overlap; take bead" in done.stderr


def test_springs_across_from_a_formula_agree_with_the_reference(found):
    assert found[1]["tied"] < 5e-4
    assert found[1]["passed_on"] > 0.1


@pytest.mark.parametrize(("damping", "key"), [("law: restitution", "law"), ("tension: cut", "tension")])
def test_dashpots_that_need_a_power_of_the_overlap_are_refused_beside_own_contacts(found, damping, key):
    (found[0] / "refused.yaml").write_text(CONTACT.replace("contact: 0.2", f"contact: 0.2, {damping}"))
    done = granchain("show", "refused.yaml", cwd=found[0], GRANCHAIN_INGREDIENTS="bed", PYTHONPATH=own_path(found[0]))
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert f"damping.{key}: " in done.stderr
    assert "a power of the overlap" in done.stderr


def test_an_interrupted_run_goes_on_bit_for_bit(found):
    assert found[1]["from_step"] > 0
    assert found[1]["same"]


def test_the_deck_and_its_continuation_have_its_lines(found):
    for name in ("whole/in.chains", "cut/in.continue"):
        assert "fix bed all addforce v_bed 0.0 0.0" in (found[0] / name).read_text()


def test_the_reference_agrees_with_an_independent_integrator(found):
    import numpy as np
    from scipy.integrate import solve_ivp

    def rate(_, state):
        x = state[:16].reshape(2, 8)
        push = np.maximum(x[:, :-1] - x[:, 1:], 0.0) ** 1.5
        force = -1.5 * x**5 - 0.2 * (x - x[::-1])
        force[:, 1:] += push
        force[:, :-1] -= push
        return np.concatenate([state[16:], force.reshape(-1)])

    start = np.zeros(32)
    start[16] = 1.0
    exact = solve_ivp(rate, (0.0, 40.0), start, method="DOP853", rtol=1e-12, atol=1e-14).y[16:, -1].reshape(2, 8)
    np.testing.assert_allclose(found[1]["velocity"], exact, atol=2e-5)


def test_own_contacts_are_scaled_and_damped_like_built_in_ones(found):
    """In the scene's units, at V = 4: a force s**1.5 (1 + 0.5 s) and a dashpot 0.2 s' while beads touch."""
    import numpy as np

    def acceleration(x, v):
        s = np.maximum(x[:-1] - x[1:], 0.0)
        push = s**1.5 * (1.0 + 0.5 * s) + 0.2 * (s > 0.0) * (v[:-1] - v[1:])
        return np.append(0.0, push) - np.append(push, 0.0)

    step, x, v = 5e-4, np.zeros(8), np.zeros(8)
    v[0] = 4.0
    for _ in range(20_000):  # the midpoint rule
        half = v + 0.5 * step * acceleration(x, v)
        x, v = x + step * half, v + step * acceleration(x + 0.5 * step * v, half)
    assert found[1]["damped"] < 5e-4
    np.testing.assert_allclose(found[1]["own_contacts"][0], v, atol=4.0 * found[1]["damped"] + 1e-5)


def own_path(place):
    """Python's path with the module of own ingredients."""
    return os.pathsep.join([str(place), str(TESTS.parent)])


def granchain(*words, cwd, **environment):
    """How a command ended, beside the scene; no path but that of the package unless another is given."""
    return subprocess.run(
        [sys.executable, "-m", "workflow.cli", *words],
        cwd=cwd,
        env={**os.environ, "PYTHONPATH": str(TESTS.parent), **environment},
        capture_output=True,
        text=True,
        timeout=HANGS,
        check=False,
    )


def test_without_the_module_the_key_is_unknown(found):
    done = granchain("show", "bed.yaml", cwd=found[0])
    assert done.returncode == 2
    assert "bed: unknown key" in done.stderr


def test_a_module_that_is_not_there_is_one_line(found):
    done = granchain("show", "bed.yaml", cwd=found[0], GRANCHAIN_INGREDIENTS="nonsense")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert done.stderr.startswith("granchain: GRANCHAIN_INGREDIENTS: 'nonsense'")


def test_lammps_finds_the_module_on_a_relative_path(found):
    path = own_path(".")
    words = ("run", "bed.yaml", "-o", "relative", "--no-check")
    done = granchain(*words, cwd=found[0], GRANCHAIN_INGREDIENTS="bed", PYTHONPATH=path)
    assert (done.returncode, done.stderr) == (0, "")
