"""A small sweep and the command that runs it, for the tests of sweeps."""

import sys
from pathlib import Path
from typing import Any

from lammps_inputs import strict_yaml
from workflow.cli import main

GRANCHAIN = str(Path(sys.executable).with_name("granchain"))

SMALL: dict[str, Any] = {
    "name": "small",
    "chains": 2,
    "beads": 12,
    "coupling": {"stiffness": 0.1},
    "kick": {"velocity": 1},
    "duration": 10,
}


def sweep_file(
    directory: Path, scene: Any = SMALL, combine: str = "product", engine: str = "lammps", **vary: Any
) -> Path:
    """A sweep file; ``__`` in a field stands for its dot."""
    path = directory / "sweep.yaml"
    fields = {name.replace("__", "."): values for name, values in vary.items()}
    path.write_text(strict_yaml.dump({"scene": scene, "vary": fields, "combine": combine, "engine": engine}))
    return path


def sweep(path: Path, directory: Path, *more: str) -> int:
    """Exit code of the command, in one process and without measured errors."""
    return main(["sweep", str(path), "-o", str(directory), "--jobs", "1", "--no-check", *more])
