"""Compute a run again from its ``run.json`` alone, and tell whether it comes to the same, bit for bit."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np

from analysis.trajectory import Floats
from lammps_inputs import InputError, Scene, library
from workflow.engines.lammps import mpi
from workflow.runs.engines import Progress, engine_called
from workflow.runs.files import RECORD, parts
from workflow.runs.provenance import provenance
from workflow.runs.record import read_record
from workflow.runs.results import SAMPLES, results, states
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory


@dataclass(frozen=True)
class Original:
    """What a run's record tells.

    Attributes:
        scene: with every default written out.
        record: the whole of ``run.json``.
        directory: where its frames still are, or None.
    """

    scene: Scene
    record: dict[str, Any]
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
    """What came of computing a run again.

    Attributes:
        same: whether all frames are bit for bit the same.
        distance: how far they are apart; None if they are the same.
        changed: what is another version or number than it was: name -> then, now.
        results: of the new run, as `results.results`.
    """

    same: bool
    distance: Distance | None
    changed: dict[str, tuple[str, str]]
    results: dict[str, Any]


def original(given: Path) -> Original:
    """The run of a ``run.json``, or of the directory that holds it.

    Raises:
        InputError: there is none, it is not finished or not whole, or its scene is none.
    """
    path = given / RECORD if given.is_dir() else given
    if not path.is_file():
        raise InputError(f"{path}: no such file" + ("; the directory holds no run" if given.is_dir() else ""))
    record = read_record(path)
    if record.get("outcome") != "done":
        raise InputError(
            f"{path}: its run is {record.get('outcome', 'none')!r}, not 'done'; finish it with run --resume"
        )
    _refuse_incomplete(path, record)
    scene = library.from_plain(record["scene"], f"{path}: scene")
    if scene.duration is None:
        raise InputError(f"{path}: scene: has no duration")
    beside = path.parent
    kept = path.name == RECORD and bool(parts(beside)) and (beside / "scene.yaml").is_file()
    return Original(scene, record, RunDirectory(beside) if kept else None)


def _refuse_incomplete(path: Path, record: dict[str, Any]) -> None:
    kinds: dict[str, type] = {"scene": dict, "engine": str, "ranks": int, "results": dict, "versions": dict}
    for key, kind in kinds.items():
        if not isinstance(record.get(key), kind):
            raise InputError(f"{path}: holds no {key!r}; it cannot be run again from this file")
    engine_called(record["engine"], f"{path}: engine")
    try:
        str(record["results"]["sha256"]), _states(record["results"])
    except (KeyError, TypeError, ValueError):
        raise InputError(f"{path}: results: not the fingerprint and samples of a run") from None


def rerun(first: Original, directory: Path, *, progress: Progress | None = None) -> Rerun:
    """Compute a run again in a new directory, on as many ranks as then or as there are cores, and compare.

    Raises:
        InputError: the directory cannot be used, or the frames of the first run are not those it was recorded with.
        RunError: the run fails.
    """
    record = first.record
    if first.directory is not None and results(first.directory)["sha256"] != record["results"]["sha256"]:
        raise InputError(
            f"{first.directory.path}: its frames or scene are not those that its {RECORD} tells of; "
            f"give a copy of {RECORD} alone to compare with that"
        )
    again = run(
        first.scene,
        directory,
        engine=record["engine"],
        ranks=max(1, min(record["ranks"], mpi.cores())),
        force=bool(record.get("force", False)),
        check=False,
        progress=progress,
    )
    found: dict[str, Any] = again.directory.record["results"]
    same = found["sha256"] == record["results"]["sha256"]
    distance = None
    if not same:
        distance = _of_samples(record["results"], found)
        if first.directory is not None:
            distance = _of_frames(first.directory, again.directory)
    return Rerun(same, distance, _changed(record, again.directory.record), found)


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


def _of_samples(one: dict[str, Any], other: dict[str, Any]) -> Distance:
    """From the last states of some beads, where the frames are not at hand."""
    left, right = _states(one), _states(other)
    if left.keys() != right.keys():
        return Distance(np.inf, np.inf, None)
    apart = np.array([np.abs(np.subtract(left[place], right[place])) for place in left]).max(axis=0)
    return Distance(velocity=float(apart[0]), displacement=float(apart[1]), since=None)


def _states(found: dict[str, Any]) -> dict[tuple[int, int], tuple[float, float]]:
    """(chain, bead) -> last velocity and displacement."""
    kept = found["samples"][:SAMPLES]
    return {(int(s["chain"]), int(s["bead"])): (float(s["velocity"]), float(s["displacement"])) for s in kept}


def _changed(then: dict[str, Any], now: dict[str, Any]) -> dict[str, tuple[str, str]]:
    """What may be the cause."""
    current = provenance()
    pairs = {name: (then["versions"].get(name), version) for name, version in current["versions"].items()}
    pairs["Python"] = (then.get("python"), current["python"])
    pairs["machine"] = (then.get("machine"), current["machine"])
    pairs["ranks"] = (then["ranks"], now["ranks"])
    if then.get("files_sha256") != now["files_sha256"]:
        pairs["deck"] = (str(then.get("files_sha256"))[:12], now["files_sha256"][:12])
    return {name: (str(old), str(new)) for name, (old, new) in pairs.items() if old != new}
