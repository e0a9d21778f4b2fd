"""Run a scene: from its validated description to a run directory with everything in it."""

import hashlib
import importlib.metadata
import os
import platform
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from analysis.trajectory import Trajectory
from lammps_inputs import Scene, deck
from workflow.ending import with_duration
from workflow.engines.lammps import engine as lammps_engine
from workflow.errors import RunError
from workflow.run_directory import RunDirectory, prepare, write_text

Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Run:
    """A run that came to an end.

    Attributes:
        directory: everything that it left.
        outcome: "done", or "interrupted" with the frames until then.
    """

    directory: RunDirectory
    outcome: str

    @property
    def trajectory(self) -> Trajectory:
        """All frames; read from the disk when asked for."""
        return self.directory.trajectory


def run(
    scene: Scene,
    directory: Path | str,
    *,
    ranks: int = 1,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> Run:
    """Run a scene with LAMMPS in a new directory.

    Args:
        scene: what to compute.
        directory: new or empty, or an earlier run's with ``overwrite``.
        ranks: MPI ranks.
        overwrite: whether an earlier run's files may be replaced.
        progress: called after every segment with the steps done and the bead that the front has reached.

    Raises:
        InputError: the directory or the number of ranks cannot be used.
        RunError: the run failed; ``run.json`` says why.
    """
    path = Path(directory)
    scene = with_duration(scene)
    problem = scene.problem()
    lammps_engine.check_ranks(ranks, problem)
    files = deck.render(scene)
    prepare(path, overwrite=overwrite)
    for name, text in files.items():
        write_text(path / name, text)
    result = RunDirectory(path)
    started = time.perf_counter()
    result.update_record(
        outcome="running",
        engine="lammps",
        ranks=ranks,
        steps=problem.steps,
        deck_sha256=fingerprint(files),
        **provenance(),
    )
    try:
        end = lammps_engine.run(path, problem, ranks=ranks, progress=progress)
    except RunError as error:
        result.update_record(outcome="failed", reason=str(error), wall_seconds=time.perf_counter() - started)
        raise
    outcome = "done" if end.end == "done" else "interrupted"
    result.update_record(
        outcome=outcome,
        steps_done=end.steps,
        lammps=end.version,
        lammps_seconds=end.seconds,
        wall_seconds=time.perf_counter() - started,
    )
    return Run(result, outcome)


def fingerprint(files: dict[str, str]) -> str:
    """SHA-256 over the deck's files in the order of their names."""
    digest = hashlib.sha256()
    for name in sorted(files):
        digest.update(f"{name}\n{len(files[name].encode())}\n".encode() + files[name].encode())
    return digest.hexdigest()


def provenance() -> dict[str, Any]:
    """What is needed to tell where and with what something was computed."""
    names = ("granchain", "lammps", "numpy", "MDAnalysis", "matplotlib", "numba", "scipy", "pydantic")
    return {
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
        "command": sys.argv,
        "host": platform.node(),
        "machine": f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
        "python": platform.python_version(),
        "versions": {name: importlib.metadata.version(name) for name in names},
    }
