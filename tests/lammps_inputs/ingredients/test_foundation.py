"""Chains on a foundation: a published beat, and the analysis; the motion is in `test_every_ingredient`."""

import json

import numpy as np
import pytest
from plain_scene import scene

from analysis.sharing.energies import EnergyFlow
from lammps_inputs import find
from workflow.engines.reference import engine
from workflow.runs.run import run
from workflow.verdicts.analyse import analyse

pytestmark = pytest.mark.usefixtures("lammps_here")


@pytest.mark.slow
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
    case = scene(foundation={"stiffness": 0.5}, timestep=0.01)
    return run(case, tmp_path_factory.mktemp("on") / "run", check=False).directory


@pytest.mark.slow
def test_analysis_says_where_the_energy_is_in_place_of_a_verdict(directory, draw_only):
    draw_only("energy")
    assert {path.stem for path in analyse(directory).figures} == {"energy", "response", "spacetime"}
    report = json.loads((directory.path / "analysis.json").read_text())
    assert report["equipartition"]["state"] == "does not apply"
    assert len(report["energy"]["share"]) == len(report["energy"]["time"]) == directory.problem.frames + 1
    assert report["energy"]["centre"][0] == [1.0, None]
