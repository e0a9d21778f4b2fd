"""Outputs and excitations: what a scene accepts is run by each engine, analysed, shown and exported."""

from pathlib import Path
from typing import Any

import pytest
from plug_ins import needs

from lammps_inputs import Scene
from lammps_inputs.library import from_plain
from workflow.cli import main
from workflow.runs.run import prepare_run, run_prepared

for package in ("gsd", "h5netcdf"):
    pytest.importorskip(package, reason=f"{package} is not installed (granchain[export])")
pytestmark = pytest.mark.usefixtures("lammps_here")

PUSH = {"peak": 0.5, "duration": 3.0, "shape": "half-sine"}
MOVED = {"displacement": 0.2, "frequency": 0.1, "phase": -90}
FORCED = {"bead": 12, "force": 0.2, "frequency": 0.15}
LOAD = {"precompression": {"force": 0.1}}
WALLS = {"walls": {"left": "bead", "right": "bead"}}
LATE = {"spectra": {"beads": [2, 11], "after": 0}}
EVERYTHING = {"output": {"forces": {"wall": True, "contacts": [3], "sensors": [5]}, **LATE}, **WALLS}
CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "kick, window": ("lammps", {"kick": {"velocity": 1.0}, "beads": 100, "window": 64, "duration": 60}),
    "kick back, resonators, spectra of one recorded bead": (
        "reference",
        {
            "kick": {"bead": 12, "velocity": -1.0},
            "resonators": {"mass": 0.3, "stiffness": 0.2, "rows": [3, 6]},
            "output": {"beads": [6], "spectra": {"beads": [6]}},
        },
    ),
    "two pushes, loaded chains, everything": (
        "lammps",
        {
            "push": [PUSH, {"bead": 12, "table": [[0, 0], [1, -0.1], [2, 0]]}],
            **LOAD,
            **EVERYTHING,
            "chains": 3,
            "coupling": {"stiffness": 0.1},
        },
    ),
    "kick and two drives, loaded, everything": (
        "lammps",
        {"kick": {"bead": 3, "velocity": 0.5}, "drive": [MOVED, FORCED], **LOAD, **EVERYTHING},
    ),
}
"""Engine and keys: kicks, pushes and drives, each kind of output, each engine."""


def case_of(keys: dict[str, Any]) -> Scene:
    plain = {"name": "case", "beads": 12, "duration": 20.0, "timestep": 0.01, **keys}
    return from_plain({**plain, "output": {"every": 0.1, **keys.get("output", {})}}, "case")


@pytest.mark.slow
@needs("pages")
@pytest.mark.parametrize("name", CASES)
def test_what_a_scene_accepts_is_run_analysed_shown_and_exported(name: str, tmp_path: Path) -> None:
    directory = tmp_path / "run"
    engine, keys = CASES[name]
    done = run_prepared(prepare_run(case_of(keys), directory, engine=engine), check=False)
    assert done.outcome == "done"
    for command in ("analyze", "view"):
        assert main([command, str(directory)]) == 0, command
    assert main(["export", str(directory), "--to", "csv,netcdf,ovito,vmd"]) == 0
