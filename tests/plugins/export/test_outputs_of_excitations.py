"""Each output with each excitation: what a scene accepts is run by each engine, analysed, shown and exported."""

import itertools
from pathlib import Path
from typing import Any

import pytest
from plug_ins import needs

from lammps_inputs import InputError, Scene
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
EXCITATIONS: dict[str, dict[str, Any]] = {
    "kick": {"kick": {"velocity": 1.0}},
    "kick, column": {"kick": {"velocity": 0.1}, "gravity": 0.02, "walls": {"right": "bead"}},
    "kick back": {"kick": {"bead": 12, "velocity": -1.0}},
    "striker": {"striker": {"mass": 2.0, "velocity": 1.0}},
    "push": {"push": PUSH},
    "two pushes, loaded": {"push": [PUSH, {"bead": 12, "table": [[0, 0], [1, -0.1], [2, 0]]}], **LOAD},
    "two drives, loaded": {"drive": [MOVED, FORCED], **LOAD},
    "kick and drive": {"kick": {"bead": 3, "velocity": 0.5}, "drive": MOVED},
}
OUTPUTS: dict[str, dict[str, Any]] = {
    "all": {},
    "recorded": {"output": {"beads": [2, 3, 4, 11]}},
    "spectra of one recorded": {"output": {"beads": [6], "spectra": {"beads": [6]}}},
    "forces of recorded": {"output": {"beads": [4, 5, 6], "forces": {"contacts": [5], "sensors": [5]}}},
    "forces on walls": {"output": {"forces": {"wall": True}}, **WALLS},
    "everything": {"output": {"forces": {"wall": True, "contacts": [3], "sensors": [5]}, **LATE}, **WALLS},
    "window": {"beads": 100, "window": 64, "duration": 60},
    "resonators": {"resonators": {"mass": 0.3, "stiffness": 0.2, "rows": [3, 6]}, "output": LATE},
    "several chains": {"chains": 3, "coupling": {"stiffness": 0.1}, "output": LATE},
}
CASES = [
    (*pair, engine)
    for pair in itertools.product(EXCITATIONS, OUTPUTS)
    if pair[1] == "everything" or pair[0] == "kick"  # a case takes 5 s
    for engine in {"everything": ("reference", "lammps"), "window": ("lammps",)}.get(pair[1], ("reference",))
]
"""Outputs with a kick, and each excitation with everything that may be recorded, by both engines."""


def case_of(excitation: str, output: str) -> Scene:
    keys = {**EXCITATIONS[excitation], **OUTPUTS[output]}
    plain = {"name": "case", "beads": 12, "duration": 20.0, "timestep": 0.01, **keys}
    return from_plain({**plain, "output": {"every": 0.1, **keys.get("output", {})}}, "case")


@pytest.mark.slow
@needs("pages")
@pytest.mark.parametrize(("excitation", "output", "engine"), CASES)
def test_what_a_scene_accepts_is_run_analysed_shown_and_exported(
    excitation: str, output: str, engine: str, tmp_path: Path
) -> None:
    directory = tmp_path / "run"
    done = run_prepared(prepare_run(case_of(excitation, output), directory, engine=engine), check=False)
    assert done.outcome == "done"
    for command in ("analyze", "view"):
        assert main([command, str(directory)]) == 0, command
    assert main(["export", str(directory), "--to", "csv,netcdf,ovito,vmd"]) == 0


def test_a_window_does_not_go_with_drives() -> None:
    with pytest.raises(InputError, match=r"^case: .*; leave"):
        case_of("two drives, loaded", "window")
