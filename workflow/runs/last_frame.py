"""The last frame of a finished run as the initial state of another, as plain data of a scene.

A scene's file asks for it by ``initial: {run: DIRECTORY}``, through the entry point ``run`` of ``granchain.starts``.
"""

from pathlib import Path
from typing import Any

import numpy as np

from lammps_inputs import InputError, file_names, physics
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.initial import digest_of
from workflow.runs.run_directory import RunDirectory


def initial_state_of(path: Path) -> dict[str, Any]:
    """Keys ``run`` and ``table`` of an initial state: displacements and velocities in the units of the run's scene.

    Raises:
        InputError: the directory holds no finished run, its frames do not hold all beads, or its contacts yield.
    """
    if not (path / file_names.SCENE).exists():
        raise InputError(f"initial.run: {path} is no run directory; `granchain run SCENE -o {path}` makes one")
    directory = RunDirectory(path)
    if directory.account.outcome not in ("done", None):
        raise InputError(f"initial.run: {path} holds a run that is not finished; `granchain run --resume {path}`")
    problem = directory.problem
    if problem.rows.missing:
        raise InputError(f"initial.run: {path}: {problem.rows.missing}")
    if not problem.system.holds(Fact.FRAMES):
        raise InputError(f"initial.run: {path}: its contacts yield, and a scene does not take over their state")
    *_, last = directory.blocks()
    x, v = (values[-1] for values in last.atoms)
    x, v, scale = x * problem.scale.length, v * problem.scale.velocity, problem.scale
    lines, beads = np.unravel_index(physics.atom_ids(problem.system) - 1, x.shape)
    rows = [
        [line + 1, bead + 1, float(x[line, bead]), float(v[line, bead])]
        for line, bead in zip(lines.tolist(), beads.tolist(), strict=True)
        if x[line, bead] or v[line, bead]
    ]
    if not rows:
        raise InputError(f"initial.run: {path}: all beads are at rest in its last frame; leave `initial` out")
    size = {"chains": problem.chains, "beads": problem.beads, "time": float(last.time[-1] * scale.time)}
    return {"run": {"directory": path.name, **size, "sha256": digest_of(rows)}, "table": rows}
