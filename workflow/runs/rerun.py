"""Compute a run again from its ``run.json`` alone, and compare it bitwise."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path

import numpy as np

from analysis.trajectory import Floats
from lammps_inputs import InputError, Scene, library
from workflow.engines.lammps import mpi
from workflow.runs.engines import LAMMPS, Progress
from workflow.runs.files import RECORD, parts
from workflow.runs.job import Job, Results, load
from workflow.runs.run import run
from workflow.runs.run_directory import SAMPLES, RunDirectory, results, states


@dataclass(frozen=True)
class Original:
    """Contents of a run's ``run.json``.

    Attributes:
        scene: with every default written out.
        job: all that it holds.
        results: what the run came to.
        directory: where its frames still are, or None.
    """

    scene: Scene
    job: Job
    results: Results
    directory: RunDirectory | None


@dataclass(frozen=True)
class Distance:
    """How far two runs are apart, dimensionless.

    Attributes:
        velocity: largest difference of a velocity.
        displacement: largest difference of a displacement.
        since: time of the first frame in which they differ; None where only the ends could be compared.
    """

    velocity: float
    displacement: float
    since: float | None


@dataclass(frozen=True)
class Rerun:
    """Result of computing a run again.

    Attributes:
        distance: how far they are apart; None if all frames are bit for bit the same.
        changed: what is another version or number than it was: name -> then, now.
        results: of the new run.
    """

    distance: Distance | None
    changed: dict[str, tuple[str, str]]
    results: Results


def original(given: Path) -> Original:
    """The run of a ``run.json``, or of the directory that holds it.

    Raises:
        InputError: there is none, it is not finished or not whole, or its scene is none.
    """
    path = given / RECORD if given.is_dir() else given
    if not path.is_file():
        raise InputError(f"{path}: no such file" + ("; the directory holds no run" if given.is_dir() else ""))
    job = load(path)
    if job.outcome != "done":
        raise InputError(f"{path}: its run is {job.outcome or 'none'!r}, not 'done'; finish it with run --resume")
    for key in ("scene", "engine", "ranks", "results", "versions"):
        if not getattr(job, key):
            raise InputError(f"{path}: holds no {key!r}; it cannot be run again from this file")
    assert job.scene is not None
    assert job.results is not None
    scene = library.from_plain(job.scene, f"{path}: scene")
    if scene.duration is None:
        raise InputError(f"{path}: scene: has no duration")
    beside = path.parent
    kept = path.name == RECORD and bool(parts(beside)) and (beside / "scene.yaml").is_file()
    return Original(scene, job, job.results, RunDirectory(beside) if kept else None)


def rerun(first: Original, directory: Path, *, progress: Progress | None = None) -> Rerun:
    """Compute a run again in a new directory, on as many ranks as then or as there are cores, and compare.

    Raises:
        InputError: the directory cannot be used, or the frames of the first run are not those it was recorded with.
        RunError: the run fails.
    """
    if first.directory is not None and results(first.directory)["sha256"] != first.results.sha256:
        raise InputError(
            f"{first.directory.path}: its frames or scene are not those that its {RECORD} describes; "
            f"give a copy of {RECORD} alone to compare with that"
        )
    again = run(
        first.scene,
        directory,
        engine=first.job.engine or LAMMPS.name,
        ranks=max(1, min(first.job.ranks or 1, mpi.cores())),
        force=first.job.force,
        check=False,
        progress=progress,
    )
    job = again.directory.job
    found = job.results
    assert found is not None
    distance = None
    if found.sha256 != first.results.sha256:
        kept = first.directory
        distance = _of_samples(first.results, found) if kept is None else _of_frames(kept, again.directory)
    return Rerun(distance, _changed(first.job, job), found)


def _frames(directory: RunDirectory) -> Iterator[tuple[float, Floats]]:
    """Time and state of frame after frame."""
    for block in directory.blocks():
        yield from zip(block.time.tolist(), states(block), strict=True)


def _of_frames(one: RunDirectory, other: RunDirectory) -> Distance:
    largest, since = np.zeros(2), None
    for left, right in zip_longest(_frames(one), _frames(other)):
        if left is None or right is None or left[1].shape != right[1].shape:
            raise InputError(f"{one.path}: has other frames than its scene gives")
        apart = np.abs(left[1] - right[1]).max(axis=(1, 2))
        if since is None and apart.any():
            since = left[0]
        largest = np.maximum(largest, apart)
    return Distance(velocity=float(largest[1]), displacement=float(largest[0]), since=since)


def _of_samples(one: Results, other: Results) -> Distance:
    """From the last states of some beads, where the frames are not available."""
    left, right = _states(one), _states(other)
    if left.keys() != right.keys():
        return Distance(np.inf, np.inf, None)
    apart = np.array([np.abs(np.subtract(left[place], right[place])) for place in left]).max(axis=0)
    return Distance(velocity=float(apart[0]), displacement=float(apart[1]), since=None)


def _states(found: Results) -> dict[tuple[int, int], tuple[float, float]]:
    """(chain, bead) -> last velocity and displacement."""
    return {(one.chain, one.bead): (one.velocity, one.displacement) for one in found.samples[:SAMPLES]}


def _changed(then: Job, now: Job) -> dict[str, tuple[str, str]]:
    """What may be the cause."""
    pairs: dict[str, tuple[str | None, str | None]] = {
        name: (then.versions.get(name), version) for name, version in now.versions.items()
    }
    pairs["Python"] = (then.python, now.python)
    pairs["machine"] = (then.machine, now.machine)
    pairs["ranks"] = (str(then.ranks), str(now.ranks))
    if then.files_sha256 != now.files_sha256:
        pairs["deck"] = (str(then.files_sha256)[:12], str(now.files_sha256)[:12])
    return {name: (str(old), str(new)) for name, (old, new) in pairs.items() if old != new}
