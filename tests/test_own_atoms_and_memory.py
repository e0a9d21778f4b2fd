"""Ingredients of one's own may add atoms that no table shows, and contacts whose force depends on the past."""

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
from typing import NamedTuple

import numpy as np

from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.base import Ingredient, Inner, Positive
from lammps_inputs.laws import Pure
from lammps_inputs.laws.spring import Linear
from lammps_inputs.links import Across


class Masses(Ingredient):
    """A mass inside each bead, on a linear spring."""

    takes_away = frozenset({Fact.PULSE, Fact.SONIC_VACUUM})

    mass: Positive
    stiffness: Positive

    def inner(self, scene):
        edges = tuple((chain, scene.chains + chain) for chain in range(scene.chains))
        link = Across("masses", Linear(self.stiffness / scene.scale.stiffness), edges=edges)
        return Inner(np.full((scene.chains, scene.beads), self.mass / scene.scale.mass), (link,))

    def lacks(self, scene):
        return self.takes_away


class Worn(NamedTuple):
    """``s**1.5`` at first; what was pressed to d falls to nothing at ``share * d``."""

    strength: Pure
    share: Pure
    memory: Pure = 0.0

    @staticmethod
    def force(s, strength, share, memory):
        left = (s - share * memory) / (1.0 - share)
        return strength * np.maximum(s if s >= memory else left, 0.0) ** 1.5

    @staticmethod
    def energy(s, strength, share, memory):
        return 0.4 * strength * np.maximum(s, 0.0) ** 2.5

    @staticmethod
    def stiffness(s, strength, share, memory):
        return 1.5 * strength / (1.0 - share) * np.sqrt(np.maximum(s, 0.0))

    @staticmethod
    def max_strain(energy, strength, share, memory):
        return (2.5 * energy / strength) ** 0.4

    @staticmethod
    def remember(s, strength, share, memory):
        return max(s, memory)


class Wear(Ingredient):
    takes_away = frozenset({Fact.PULSE, Fact.SONIC_VACUUM})

    share: Positive

    def contact_law(self, strength):
        return Worn(strength, self.share)

    def lacks(self, scene):
        return self.takes_away


INGREDIENTS = {"masses": Masses, "wear": Wear}
'''

CHAIN = {"name": "chain", "kick": {"velocity": 1.0}, "output": {"every": 0.1}}
RESONANT = {**CHAIN, "beads": 30, "masses": {"mass": 0.1, "stiffness": 1.0}, "duration": 40}
COUPLED = {**RESONANT, "beads": 12, "chains": 2, "coupling": {"stiffness": 0.2}, "duration": 15, "timestep": 0.005}

PROGRAM = """
import json, sys
from dataclasses import replace
from pathlib import Path
import numpy as np
import lammps_here as here
from analysis.tracking.peaks import find_peaks
from lammps_inputs import InputError, library
from workflow.engines.reference import engine
from workflow.runs.resume import resume
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.analyse import analyse

{program}
"""

INNER = """
resonant, coupled = (library.from_plain(plain, "a") for plain in json.loads(sys.argv[1]))
found = run(resonant, "resonant")
peaks = find_peaks([engine.run(found.directory.problem)])
whole = run(coupled, "whole")
run(coupled, "cut", check=False, lammps=here.interrupted_after(1000))
resume("cut", check=False)
some = coupled.model_copy(update={"output": coupled.output.model_copy(update={"beads": (3, 5)})})
part = run(some, "some", check=False).trajectory.velocity
analyse(whole.directory, figures=False)
print(json.dumps({
    "peak": float(peaks.velocity[peaks.bead == 20][0]),
    "error": found.check.velocity,
    "coupled error": whole.check.velocity,
    "shape": whole.trajectory.velocity.shape,
    "resumed": bool(np.array_equal(RunDirectory(Path("cut")).trajectory.velocity, whole.trajectory.velocity)),
    "some beads": bool(np.array_equal(part, whole.trajectory.velocity[:, :, [2, 4]])),
}))
"""

MEMORY = """
scene = library.from_plain(json.loads(sys.argv[1]), "a")
problem = scene.problem()
try:
    run(scene, "lammps")
    refused = ""
except InputError as error:
    refused = str(error)
done = run(scene, "reference", engine="reference")
state = engine.make_state(problem, None)
print(json.dumps({
    "refused": refused,
    "velocity": done.trajectory.velocity[-1, 0].tolist(),
    "fine": engine.run(problem, steps_per_frame=400).velocity[-1, 0].tolist(),
    "memories": [engine.make_state(replace(problem, system=system), None).memory.size
                 for system in (problem.system, library.find("two-chains").system)],
}))
"""


def found(path, program, argument):
    (path / "own.py").write_text(OWN)
    paths = [str(path), str(TESTS / "support"), str(TESTS.parent)]
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM.replace("{program}", program), json.dumps(argument)],
        cwd=path,
        env={**os.environ, "GRANCHAIN_INGREDIENTS": "own", "PYTHONPATH": os.pathsep.join(paths)},
        capture_output=True,
        text=True,
        timeout=HANGS,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return json.loads(done.stdout.splitlines()[-1])


def test_a_mass_inside_each_bead_acts_alike_in_lammps_and_the_reference_and_stands_in_no_table(tmp_path):
    """The peak is that of an independent program (mass-in-mass chain, m2 = 0.1, k2 = 1)."""
    seen = found(tmp_path, INNER, [RESONANT, COUPLED])
    assert seen["peak"] == pytest.approx(0.588365, abs=2e-6)
    assert seen["error"] < 2e-4  # the accuracy that its time step is chosen for
    assert seen["coupled error"] < 5e-4
    assert seen["shape"] == [151, 2, 12]
    assert seen["resumed"]
    assert seen["some beads"]


def test_a_contact_that_remembers_its_largest_overlap_gives_two_beads_their_restitution(tmp_path):
    """Of the energy 0.4 d**2.5 at the largest overlap d, the share is lost: e**2 = 1 - share."""
    two = {**CHAIN, "beads": 2, "wear": {"share": 0.19}, "duration": 8, "timestep": 0.01}
    seen = found(tmp_path, MEMORY, two)
    assert "LAMMPS has no such force; use the reference engine" in seen["refused"]
    # the largest overlap is found within the step
    assert seen["velocity"] == pytest.approx([0.05, 0.95], abs=1e-5)
    assert seen["fine"] == pytest.approx([0.05, 0.95], abs=1e-8)
    assert seen["memories"] == [3, 0]
