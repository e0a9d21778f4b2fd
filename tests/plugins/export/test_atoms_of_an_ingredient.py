"""An ingredient that adds one atom at one bead of one chain: how it is named from the deck to exports and the page."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from plug_ins import needs
from processes import HANGS

xarray = pytest.importorskip("xarray", reason="xarray is not installed (granchain[export])")
hoomd = pytest.importorskip("gsd.hoomd", reason="gsd is not installed (granchain[export])")
pytest.importorskip("h5netcdf", reason="h5netcdf is not installed (granchain[export])")
pytest.importorskip("h5py", reason="h5py is not installed (granchain[export])")

ROOT = Path(__file__).resolve().parents[3]

OWN = '''
"""A pendulum at one bead."""

from typing import Annotated

import numpy as np
from pydantic import Field

from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.base import Count, FurtherAtoms, Ingredient, Positive, in_rows
from lammps_inputs.laws.dashpot import Dashpot
from lammps_inputs.laws.spring import Linear
from lammps_inputs.links import Links


class Pendulum(Ingredient):
    takes_away = frozenset({Fact.SONIC_VACUUM, Fact.ENERGY, Fact.REVERSIBLE, Fact.SECOND_ORDER})

    chain: Count
    bead: Count
    mass: Positive
    stiffness: Positive
    damping: Positive

    def further_atoms(self, setting):
        mass, spring, dashpot = (
            in_rows(value, (self.bead, self.bead), (1, setting.beads))
            for value in (self.mass, self.stiffness, self.damping)
        )
        edges = ((self.chain - 1, setting.chains),)
        tie = Links.across("pendulum", Linear(spring), edges)
        damper = Links.across("friction", Dashpot(dashpot), edges)
        return FurtherAtoms(mass, (tie,), (damper,), ("pendulum", "pendulums"), (self.chain - 1,))

    def lacks(self, setting):
        return self.takes_away


INGREDIENTS = {"pendulum": Pendulum}
'''

SCENE = {
    **{"name": "hung", "chains": 3, "beads": 10, "duration": 12, "timestep": 0.005, "coupling": {"stiffness": 0.1}},
    "pendulum": {"chain": 2, "bead": 4, "mass": 0.05, "stiffness": 0.5, "damping": 0.02},
    "kick": {"chain": 2, "velocity": 1},
}

FORMATS = ("netcdf", "ovito", "vmd")


@pytest.fixture(scope="module")
def hung(tmp_path_factory):
    """Directory with a run of LAMMPS, its analysis, validation, exports and page; text of each command."""
    place = tmp_path_factory.mktemp("hung")
    (place / "own_pendulum.py").write_text(OWN)
    (place / "hung.yaml").write_text(json.dumps(SCENE))
    environment = {"GRANCHAIN_INGREDIENTS": "own_pendulum", "PYTHONPATH": os.pathsep.join((".", str(ROOT)))}
    texts = {}
    for words in (
        ("run", "hung.yaml", "-o", "run"),
        ("analyze", "run", "--json"),
        ("validate", "run"),
        ("export", "run", "--to", ",".join(FORMATS), "-o", "out"),
        ("view", "run", "--no-open"),
    ):
        command = [sys.executable, "-m", "workflow.cli", *words]
        options = {"cwd": place, "env": {**os.environ, **environment}, "timeout": HANGS}
        done = subprocess.run(command, capture_output=True, text=True, check=False, **options)
        assert done.returncode == 0, (words, done.stderr[-2000:])
        texts[words[0]] = done.stdout
    return place, texts


@pytest.mark.slow
@needs("pages")
def test_an_atom_at_one_bead_of_one_chain_is_run_and_named_from_the_deck_to_the_page(hung):
    place, texts = hung
    where = json.loads((place / "run" / "run.json").read_text())["check"]["where"]
    assert where == {"chain": 2, "bead": 4, "time": where["time"], "noun": "pendulum", "resonator": 1}
    assert "pendulum 1 at bead 4 of chain 2" in texts["validate"]
    analysis = json.loads(texts["analyze"])
    assert max(analysis["budget"]["other_atoms"]["pendulums"]) > 1e-4
    assert analysis["budget"]["closed"] < 1e-3
    assert "set segname {C1 C1" in (place / "out" / "frames.vmd").read_text()
    assert "P4}" in (place / "out" / "frames.vmd").read_text()
    page = (place / "run" / "view.html").read_text()
    assert "small circles: pendulums" in page
    assert not any("resonator" in text.lower() for text in (texts["run"], texts["validate"], texts["export"], page))

    with hoomd.open(str(place / "out" / "frames.gsd"), "r") as file:
        particles = file[-1].particles
    assert particles.types == ["chain 1", "chain 2", "chain 3", "pendulums 1"]
    assert particles.typeid.tolist() == [0] * 10 + [1] * 10 + [2] * 10 + [3]
    with xarray.open_dataset(place / "out" / "frames.nc", engine="h5netcdf") as dataset:
        moving = np.isfinite(dataset.pendulum_velocity).all(dim="time")
        assert np.argwhere(moving.values).tolist() == [[0, 3]]
