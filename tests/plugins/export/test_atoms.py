"""OVITO and VMD: one file each with beads at their radii, chains side by side, springs as bonds and velocities."""

import os
import re
import subprocess

import numpy as np
import pytest
from processes import HANGS

import granchain

OVITO_PYTHON = os.environ.get("OVITO_PYTHON")

READ = """
import sys
import numpy as np
from ovito.io import import_file

file = import_file(sys.argv[1])
frame = file.compute(int(sys.argv[2]))
particles = frame.particles
np.savez(
    sys.argv[3],
    frames=file.num_frames, time=frame.attributes["Time"], x=particles["Position"], v=particles["Velocity"],
    radius=particles["Radius"], bonds=particles.bonds.topology, bead=particles["Bead"],
    types=[kind.name for kind in particles["Particle Type"].types], type=particles["Particle Type"],
)
"""

SPRINGS = [[row, row + 12] for row in range(2, 9)]
"""DrawnAtoms, from 0, that the springs in rows 3 to 9 of two chains of 12 beads tie."""


def expected(run, frame):
    """Positions and velocities along the chains of all atoms, and the distance of the chains."""
    problem, frames = run.directory.problem, run.trajectory
    x = problem.layout.places + frames.displacement[frame]
    return x.ravel(), frames.velocity[frame].ravel(), problem.layout.apart((0, 1))


def test_beads_have_their_relative_radii_and_resonators_are_small(run_of, tmp_path):
    hoomd = pytest.importorskip("gsd.hoomd", reason="gsd is not installed (granchain[export])")
    for name in ("tapered-chain", "resonators"):
        run = run_of(name)
        [path] = granchain.export(run, "ovito", tmp_path / f"{name}.gsd", every=500)
        with hoomd.open(str(path), "r") as file:
            diameter, bonds = file[0].particles.diameter, file[0].bonds.group
        layout = run.directory.problem.layout
        assert np.max(diameter) == layout.diameter
        if name == "tapered-chain":
            relative = diameter / diameter[0]
            np.testing.assert_allclose(relative**3, run.directory.problem.system.mass[0], rtol=1e-6)
    assert np.min(diameter) == layout.diameter_of_others
    universe = granchain.universe(run)
    assert len(diameter) == len(universe.atoms)
    assert sorted(bonds.tolist()) == sorted(universe.bonds.indices.tolist())


@pytest.mark.skipif(OVITO_PYTHON is None, reason="OVITO_PYTHON names no Python that has OVITO")
def test_ovito_maps_every_property_of_the_file_itself(run_of, tmp_path):
    run = run_of("coupled")
    [path] = granchain.export(run, "ovito", tmp_path)
    subprocess.run([OVITO_PYTHON, "-c", READ, path, "50", tmp_path / "seen.npz"], check=True, timeout=HANGS)
    seen = np.load(tmp_path / "seen.npz")
    x, v, apart = expected(run, 50)
    assert seen["frames"] == run.trajectory.frames
    assert seen["time"] == pytest.approx(run.trajectory.time[50])
    np.testing.assert_allclose(seen["x"][:, 0] - seen["x"][0, 0], x - x[0], atol=1e-6 * x.max())
    np.testing.assert_allclose(seen["x"][12:, 1] - seen["x"][:12, 1], apart)
    np.testing.assert_allclose(seen["v"][:, 0], v, atol=1e-7)
    assert np.all(seen["radius"] == run.directory.problem.layout.diameter / 2.0)
    assert seen["bonds"].tolist() == SPRINGS
    assert seen["bead"].tolist() == [*range(1, 13)] * 2
    assert seen["types"][seen["type"]].tolist() == ["chain 1"] * 12 + ["chain 2"] * 12


STUBS = """
# the commands of VMD that the script calls, which print what they are given
proc mol {args} { puts "mol $args"; if {[lindex $args 0] eq "new"} { return 0 } }
proc animate {args} { puts "animate $args" }
proc display {args} { puts "display $args" }
proc color {args} { puts "color $args" }
proc atomselect {molecule text} { puts "select $molecule $text"; return selection }
proc selection {args} { puts "selection $args" }
"""


def test_the_script_for_vmd_makes_atoms_bonds_frames_and_representations(run_of, executable, tmp_path):
    tclsh = executable("tclsh")
    run = run_of("coupled")
    [path] = granchain.export(run, "vmd", tmp_path)
    (tmp_path / "stubs.tcl").write_text(STUBS + f'source {path}\nputs "time $time_of_frame(50)"\n')
    words = [tclsh, tmp_path / "stubs.tcl"]
    calls = subprocess.run(words, capture_output=True, text=True, check=True, timeout=HANGS).stdout.splitlines()
    lists = {}
    frame = None
    for call in calls:
        kind, *parts = call.split(maxsplit=3)
        if kind == "selection" and parts[0] == "frame":
            frame = int(parts[1])
        elif kind == "selection" and parts[0] == "set":
            lists[frame, parts[1]] = parts[2].strip("{}").split()
    x, v, apart = expected(run, 50)
    assert max(frame for frame, _ in lists if frame is not None) == run.trajectory.frames - 1
    np.testing.assert_allclose(np.array(lists[50, "x"], float), x, rtol=1e-6)
    np.testing.assert_allclose(np.array(lists[50, "user"], float), v, atol=1e-7)
    np.testing.assert_allclose(np.array(lists[None, "y"], float), np.repeat([0.0, apart], 12))
    assert set(lists[None, "radius"]) == {f"{run.directory.problem.layout.diameter / 2.0:g}"}
    assert lists[None, "segname"] == ["C1"] * 12 + ["C2"] * 12
    assert calls.count("animate dup 0") == run.trajectory.frames
    bonds = next(call for call in calls if call.startswith("selection setbonds "))
    ends = re.findall(r"\{([0-9 ]*)\}", bonds.removeprefix("selection setbonds "))
    neighbours = {atom: int(others) for atom, others in enumerate(ends) if others}
    assert neighbours == {**dict(SPRINGS), **{second: first for first, second in SPRINGS}}
    assert {"mol representation VDW 1.0 16", "mol color User", "mol colupdate 0 0 on"} <= set(calls)
    assert "mol scaleminmax 0 0 -1 1" in calls
    assert "time 5" in calls
    # VMD reads line by line
    code = f"set file [open {path}]; while {{[gets $file line] >= 0}} {{if {{![info complete $line]}} {{puts $line}}}}"
    (tmp_path / "lines.tcl").write_text(code)
    assert subprocess.run([tclsh, tmp_path / "lines.tcl"], capture_output=True, check=True, timeout=HANGS).stdout == b""
