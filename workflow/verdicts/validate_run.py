"""Compare two runs of one scene: bitwise, and quantity by quantity, with what they were computed with."""

import warnings
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from analysis.against.common_times import near_the_front, of_recorded, on_common_rows, simultaneous
from analysis.against.difference import Deviation, Difference
from analysis.files.binary_dump import CutDumpWarning
from analysis.trajectory import Trajectory
from lammps_inputs import InputError, Problem, Scene
from workflow.runs.check import accountant
from workflow.runs.engines import ENGINES
from workflow.runs.files import RECORD
from workflow.runs.run_directory import Fingerprint, RunDirectory, states
from workflow.verdicts.validate import (
    HALF_WINDOW,
    RunDifference,
    Validation,
    compared,
    error_figure,
    limits_of,
    write,
)

NOT_PHYSICS = (
    "name",
    "description",
    "duration",
    "until_bead",
    "timestep",
    "accuracy",
    "scheme",
    "window",
    "limits",
    "output",
)
"""Keys of a scene that say how it is computed, for how long, and what is recorded, but not what the beads do."""

MOST_FRAMES = 1000
"""Frames of a run from one instant that both runs recorded to the next, at most."""

_TOGETHER = ("velocity", "displacement", "energy", "momentum")
"""Quantities that are read from snapshots as well as from frames; snapshots are too far apart for waves."""


def validate_run(
    directory: RunDirectory, other: RunDirectory, tolerances: dict[str, float] | None = None
) -> Validation:
    """Compare a run with another one of the same scene, at the beads and times that both recorded.

    Writes what `validate` writes. Energy and momentum are those of the first run.

    Args:
        directory: the run.
        other: the run that it is compared with.
        tolerances: quantity -> largest difference let pass, in place of the one in `TOLERANCES`, dimensionless.

    Raises:
        InputError: the runs are of different scenes, or recorded no bead or no time in common.
    """
    refuse_another_scene(directory.scene, str(directory.path), other)
    limits = limits_of(directory.problem, tolerances)
    fingerprints = Fingerprints()
    problem, difference = _difference((directory, other), limits, fingerprints)
    deviations = difference.deviations()
    if directory.problem.frames_per_snapshot and other.problem.frames_per_snapshot:
        _, of_snapshots = _difference((directory, other), limits, fingerprints, snapshots=True)
        if of_snapshots.frames:
            deviations |= _larger(deviations, of_snapshots.deviations())
    result = Validation(
        problem=problem,
        against=str(other.path),
        deviations=deviations,
        tolerances=limits,
        remarks=(
            *(f"{run.path}: {run.failure}" for run in (directory, other) if run.failure),
            *([] if problem.window is None else [HALF_WINDOW]),
            *(
                f"{run.path}: has no {RECORD} that names versions, so that these are not compared"
                for run in (directory, other)
                if not run.account.versions
            ),
        ),
        frames=difference.frames,
        compared=difference.frames,
        runs=RunDifference(
            identical=fingerprints.identical,
            sha256=fingerprints.sha256,
            since=None if fingerprints.identical else fingerprints.since,
            changes=changes(directory, other),
        ),
    )
    write(directory.path, result, error_figure(result, difference, other.path.name))
    return result


# --- of one scene -----------------------------------------------------------------------------------------------------


def refuse_another_scene(scene: Scene, source: str, other: RunDirectory) -> None:
    """Refuse a run whose scene differs from a scene in more than the keys of `NOT_PHYSICS`.

    Args:
        scene: of a run that is, or will be, compared with the other one.
        source: what that run, or its scene, is called.
        other: the other run.

    Raises:
        InputError: names the first field that differs, with both values.
    """
    fields, other_fields = (dict(_fields(each.plain())) for each in (scene, other.scene))
    for name in dict.fromkeys((*fields, *other_fields)):
        value, other_value = (each.get(name, "not given") for each in (fields, other_fields))
        if value != other_value and name.partition(".")[0] not in NOT_PHYSICS:
            raise InputError(
                f"{other.path}: is a run of another scene: {name} is {other_value} there, and {value} in {source}"
            )


def _fields(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted path and value of every field of a scene's plain data; entries of lists are numbered from 1."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _fields(inner, f"{path}.{key}" if path else key)
    elif isinstance(value, list):
        for number, inner in enumerate(value, 1):
            yield from _fields(inner, f"{path}[{number}]")
    else:
        yield path, value


# --- frames -----------------------------------------------------------------------------------------------------------


class Fingerprints:
    """Fingerprints of the frames of two runs that are given block by block.

    Attributes:
        since: time of the first frame in which the two differ; None if none does.
    """

    def __init__(self) -> None:
        self.since: float | None = None
        self._first, self._second = Fingerprint(), Fingerprint()

    def add(self, first: Trajectory, second: Trajectory) -> None:
        """Take the next frames of both, at the same times and of the same beads."""
        self._first.add(first)
        self._second.add(second)
        differs = np.any(states(first) != states(second), axis=(1, 2, 3))
        if differs.any():
            time = float(first.time[np.argmax(differs)])
            self.since = time if self.since is None else min(time, self.since)

    @property
    def sha256(self) -> tuple[str, str]:
        """Fingerprints of all frames so far, of the first run and of the second."""
        return self._first.sha256(), self._second.sha256()

    @property
    def identical(self) -> bool:
        """Whether all frames so far are bitwise the same."""
        return len(set(self.sha256)) == 1


Runs = tuple[RunDirectory, RunDirectory]


def _difference(
    runs: Runs, limits: dict[str, float], fingerprints: Fingerprints, *, snapshots: bool = False
) -> tuple[Problem, Difference]:
    """What both runs recorded, and how far apart their frames, or their snapshots, are there."""
    first, second = (run.problem.snapshots() if snapshots else run.problem for run in runs)
    problem, strides = _recorded_by_both(first, second, runs)
    same_window = first.window == second.window
    streams = (
        (of_recorded(block, problem) for block in _blocks(run, stride, snapshots=snapshots))
        for run, stride in zip(runs, strides, strict=True)
    )

    def pairs() -> Iterator[tuple[Trajectory, Trajectory]]:
        for blocks in simultaneous(*streams):
            near_front, other_near_front = on_common_rows(*map(near_the_front, blocks))
            fingerprints.add(*(on_common_rows(*blocks) if same_window else (near_front, other_near_front)))
            yield near_front, other_near_front

    difference = Difference(limits, accountant(runs[0], problem).of)
    compared(difference, pairs())
    return problem, difference


def _blocks(run: RunDirectory, stride: int, *, snapshots: bool) -> Iterator[Trajectory]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CutDumpWarning)  # the number of frames is reported
        yield from run.snapshots(stride) if snapshots else run.blocks(stride)


def _recorded_by_both(first: Problem, second: Problem, runs: Runs) -> tuple[Problem, tuple[int, int]]:
    """The problem of the beads and times that two recorded, and every which frame of each is at such a time.

    Raises:
        InputError: there is no such bead, or no such time after the start.
    """
    ratio = first.every / second.every
    fraction = Fraction(ratio).limit_denominator(MOST_FRAMES)
    strides = fraction.denominator, fraction.numerator
    commensurate = abs(fraction - ratio) <= 1e-9 * ratio
    frames = min(first.frames // strides[0], second.frames // strides[1]) if commensurate else 0
    if frames < 1:
        apart = [problem.scale.written(problem.every, "time") for problem in (first, second)]
        raise InputError(
            f"{runs[1].path}: its frames are {apart[1]} apart, and those of {runs[0].path} {apart[0]}: "
            "only their starts are at one time"
        )
    beads = np.intersect1d(first.recorded_beads, second.recorded_beads)
    if len(beads) == 0:
        raise InputError(f"{runs[1].path}: recorded none of the beads that {runs[0].path} recorded")
    problem = replace(
        first.coarser(strides[0]),
        frames=frames,
        recorded=None if len(beads) == first.beads else tuple(beads.tolist()),
        window=min((each.window for each in (first, second) if each.window is not None), default=None),
        peaks=False,
        frames_per_snapshot=None,
    )
    return problem, strides


def _larger(frames: dict[str, Deviation], snapshots: dict[str, Deviation]) -> dict[str, Deviation]:
    """The larger deviation in frames or snapshots of each of the quantities `_TOGETHER`."""
    larger = {}
    for name in _TOGETHER:
        deviations = [each[name] for each in (frames, snapshots) if name in each]
        if deviations:
            larger[name] = max(deviations, key=lambda deviation: np.nan_to_num(deviation.largest, nan=np.inf))
    return larger


# --- what they were computed with -------------------------------------------------------------------------------------


def changes(directory: RunDirectory, other: RunDirectory) -> dict[str, tuple[str, str]]:
    """Settings, versions, machine and input files that differ between two runs: name -> (of the run, of the other one).

    What one of the two has no record of is left out.
    """
    first, second = (_computed_with(run) for run in (directory, other))
    return {
        name: (value, second[name])
        for name, value in first.items()
        if value and second.get(name) and value != second[name]
    }


def _computed_with(run: RunDirectory) -> dict[str, str]:
    """Settings, versions, machine and checksum of the input files of a run by name; empty where nothing says."""
    problem, job = run.problem, run.account
    stepped = ENGINES[run.engine].own_step
    return {
        "engine": run.engine,
        "time step": problem.scale.written(problem.timestep, "time") if stepped else "",
        "scheme": problem.scheme if stepped else "",
        "window": f"{problem.window} rows" if problem.window else "all rows",
        "ranks": str(job.ranks or ""),
        **job.versions,
        "Python": job.python or "",
        "machine": job.machine or "",
        "input files": (job.files_sha256 or "")[:12],
    }
