"""Compare two runs of one scene: bitwise, and quantity by quantity, with what they were computed with.

Plug-ins take this module to compare two runs: `compare_runs` gives the `Validation`, `compared_pairs` the frames that
were compared, `scene_changes` the fields in which two scenes differ.

Examples:
    >>> validate_run.scene_changes(granchain.load("two-chains"), granchain.load("two-chains-strong"))
    {'coupling.stiffness': ('0.1', '0.5')}
"""

import hashlib
import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from analysis.compare.common_times import (
    near_the_front,
    of_recorded,
    on_common_rows,
    paired,
    paired_parts,
    simultaneous,
)
from analysis.compare.difference import Deviation, Difference, DifferenceMeter
from analysis.files.binary_dump import CutDumpWarning
from analysis.sharing.chain_differences import ChainDifference, ChainMeter
from analysis.trajectory import Trajectory
from lammps_inputs import InputError, Problem, Scene
from lammps_inputs.facts import Fact
from workflow.engines.reference import engine as reference
from workflow.engines.reference.step_halving import compared_rows
from workflow.runs.engines import engine_called
from workflow.runs.exchange import accountant
from workflow.runs.files import RECORD
from workflow.runs.run_directory import RunDirectory, add_frames, states
from workflow.verdicts.validate import (
    HALF_WINDOW,
    RunDifference,
    Validation,
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
    "adopted",
)
"""Keys of a scene that say how it is computed, for how long, and what is recorded, but not what the beads do."""

MOST_FRAMES = 1000
"""Frames of a run from one instant that both runs recorded to the next, at most."""

_AT_AN_INSTANT = ("velocity", "displacement", "amplitude", "arrival")
"""Quantities without a tolerance, unless one is given, where one of two runs has rigid beads."""

_RIGID_BEADS = (
    "one run has rigid beads: velocities at an instant have no tolerance, impulses and shares of the energy have"
)

_NO_IMPULSE = "no bead received an impulse in both runs; a longer duration, or neighbouring recorded beads, are needed"

Runs = tuple[RunDirectory, RunDirectory]

Pairs = Iterator[tuple[Trajectory, Trajectory]]


def validate_run(
    directory: RunDirectory, other: RunDirectory, tolerances: dict[str, float] | None = None
) -> Validation:
    """Compare a run with another one of the same scene, at the beads and times that both recorded.

    Writes what `validate` writes. Energy and momentum are those of the first run. Where one of the two has rigid beads,
    impulses and the energy of each chain are compared, too (`analysis.sharing.chain_differences`).

    Args:
        directory: the run.
        other: the run that it is compared with.
        tolerances: quantity -> largest difference let pass, in place of the one in `TOLERANCES`, dimensionless.

    Raises:
        InputError: the runs are of different scenes, or recorded no bead or no time in common.
    """
    refuse_another_scene(directory.scene, str(directory.path), other)
    result, difference = compare_runs((directory, other), tolerances)
    write(directory.path, result, error_figure(result, difference, other.path.name))
    return result


def compare_runs(runs: Runs, tolerances: dict[str, float] | None = None) -> tuple[Validation, Difference]:
    """Comparison of two runs, which may be of different scenes; writes nothing.

    Args:
        runs: the run, and that it is compared with.
        tolerances: quantity -> largest difference let pass, in place of the one in `TOLERANCES`, dimensionless.

    Returns:
        The comparison, and the differences that it is made of.

    Raises:
        InputError: they have other numbers of chains or beads, other units, or no bead or time in common.
    """
    refuse_other_beads(runs)
    directory, other = runs
    rigid = [run for run in runs if not run.problem.system.holds(Fact.OVERLAPS)]
    models_differ = len(rigid) == 1
    unlimited = dict.fromkeys(_AT_AN_INSTANT, math.inf) if models_differ else {}
    limits = limits_of(directory.problem, {**unlimited, **(tolerances or {})})
    frames, fingerprints = held_by_both(runs), Fingerprints()
    meter, chain_meter = DifferenceMeter(limits), ChainMeter(frames.problem, rigid_first=rigid == [directory])
    counted = accountant(directory, frames.problem).counted
    pieces: list[Any] = []
    of_chains: list[Any] = []
    for pair in paired_parts(fingerprints.taken(frames.pairs(runs, counted), all_rows=frames.same_width)):
        pieces.append(meter.of_parts(*pair))
        if models_differ:
            of_chains.append(chain_meter.of_parts(*pair))
    difference = meter.result(pieces)
    deviations = difference.deviations
    chains: tuple[ChainDifference, ...] = ()
    if models_differ:
        engine = engine_called(rigid[0].engine)
        impulses = engine.impulses(rigid[0].path, frames.problem, until=difference.last_time)
        assert impulses is not None  # frames without overlaps are of engines that give them
        together, chains = chain_meter.result(of_chains, impulses, limits["impulse"])
        deviations = {**deviations, **together}
    result = Validation(
        problem=frames.problem,
        against=str(other.path),
        deviations=deviations,
        tolerances=limits,
        remarks=tuple(_remarks(runs, frames.problem, deviations, models_differ=models_differ)),
        frames=difference.frames,
        compared=difference.frames,
        runs=RunDifference(
            identical=fingerprints.identical,
            sha256=fingerprints.sha256,
            since=None if fingerprints.identical else fingerprints.since,
            changes=changes(directory, other),
            chains=chains,
        ),
    )
    return result, difference


def _remarks(runs: Runs, problem: Problem, deviations: dict[str, Deviation], *, models_differ: bool) -> Iterator[str]:
    for run in runs:
        if run.failure:
            yield f"{run.path}: {run.failure}"
    if problem.rows.follow:
        yield HALF_WINDOW
    if models_differ:
        yield _RIGID_BEADS
        if math.isnan(deviations["impulse"].largest):
            yield _NO_IMPULSE
    for run in runs:
        if not run.account.versions:
            yield f"{run.path}: has no {RECORD} that names versions, so that these are not compared"


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
    for name, (value, other_value) in scene_changes(scene, other.scene).items():
        raise InputError(
            f"{other.path}: is a run of another scene: {name} is {other_value} there, and {value} in {source}"
        )


def scene_changes(scene: Scene, other: Scene) -> dict[str, tuple[str, str]]:
    """Fields that differ between two scenes, but for the keys of `NOT_PHYSICS`.

    Args:
        scene: the scene.
        other: the scene that it is compared with.

    Returns:
        Dotted path -> (value, other value), in words.
    """
    fields, other_fields = (dict(_fields(each.plain())) for each in (scene, other))
    values = {
        name: (fields.get(name, "not given"), other_fields.get(name, "not given"))
        for name in dict.fromkeys((*fields, *other_fields))
        if name.partition(".")[0] not in NOT_PHYSICS
    }
    return {name: (str(first), str(second)) for name, (first, second) in values.items() if first != second}


def refuse_other_beads(runs: Runs) -> None:
    """Refuse two runs whose beads do not correspond, or whose units V, T and L differ.

    Raises:
        InputError: names what differs, with both values.
    """
    first, second = (run.problem for run in runs)
    for name in ("chains", "beads"):
        numbers = getattr(first, name), getattr(second, name)
        if numbers[0] != numbers[1]:
            raise InputError(
                f"{runs[1].path}: cannot be compared: it has {numbers[1]} {name}, and {runs[0].path} has {numbers[0]}"
            )
    for name, symbol in (("velocity", "V"), ("length", "L"), ("mass", "m")):
        sizes = [getattr(problem.scale, name) for problem in (first, second)]
        if first.scale.si != second.scale.si or not math.isclose(*sizes, rel_tol=1e-9):
            units = [problem.scale.written(1.0, name) for problem in (first, second)]
            raise InputError(
                f"{runs[1].path}: cannot be compared: its unit {symbol} is {units[1]}, and that of {runs[0].path} "
                f"{units[0]}; kicks and materials must agree"
            )


def _fields(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted path and value of every field of a scene's plain data; entries of lists are numbered from 1."""
    if isinstance(value, dict):
        for key, entry in value.items():
            yield from _fields(entry, f"{path}.{key}" if path else key)
    elif isinstance(value, list):
        for number, entry in enumerate(value, 1):
            yield from _fields(entry, f"{path}[{number}]")
    else:
        yield path, value


# --- frames -----------------------------------------------------------------------------------------------------------


class Fingerprints:
    """Fingerprints of the frames of two runs, which are taken as these are read.

    Attributes:
        since: time of the first frame in which the two differ; None if none does.
    """

    def __init__(self) -> None:
        self.since: float | None = None
        self._digests = hashlib.sha256(), hashlib.sha256()

    def taken(self, pairs: Pairs, *, all_rows: bool) -> Pairs:
        """Consecutive frames of both runs, at the same times, at the rows that are compared.

        Args:
            pairs: frames of both with all their rows.
            all_rows: whether the fingerprints are of all rows that both hold; else they are of those compared.
        """
        for blocks in pairs:
            compared = where_both_hold(*blocks)
            first, second = on_common_rows(*blocks) if all_rows else compared
            for digest, block in zip(self._digests, (first, second), strict=True):
                add_frames(digest, block)
            differs = np.any(states(first) != states(second), axis=(1, 2, 3))
            if self.since is None and differs.any():
                self.since = float(first.time[np.argmax(differs)])
            yield compared

    @property
    def sha256(self) -> tuple[str, str]:
        """Fingerprints of all frames so far, of the first run and of the second."""
        first, second = (digest.hexdigest() for digest in self._digests)
        return first, second

    @property
    def identical(self) -> bool:
        """Whether all frames so far are bitwise the same."""
        return len(set(self.sha256)) == 1


@dataclass(frozen=True)
class RecordedByBoth:
    """What two runs both recorded.

    Attributes:
        problem: of the beads and times that both recorded.
        strides: every which frame of each run is at such a time.
        same_width: whether both hold the same number of rows.
    """

    problem: Problem
    strides: tuple[int, int]
    same_width: bool

    def pairs(self, runs: Runs, counted: Callable[[Iterator[Trajectory]], Iterator[Trajectory]] = iter) -> Pairs:
        """Blocks of the two at these beads and times; of a window all rows of each.

        Args:
            runs: the two runs.
            counted: gives frames of the first one their exchange.
        """
        first, second = (self._blocks(run, stride) for run, stride in zip(runs, self.strides, strict=True))
        return simultaneous(counted(first), second)

    def _blocks(self, run: RunDirectory, stride: int) -> Iterator[Trajectory]:
        """The frames of one of the runs at these beads and times; a file that ends within a frame is no warning."""
        problem = replace(self.problem, system=run.problem.system)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", CutDumpWarning)
            for block in run.blocks(stride):
                yield of_recorded(block, problem)


def where_both_hold(first: Trajectory, second: Trajectory) -> tuple[Trajectory, Trajectory]:
    """Frames of two runs at the rows that are compared: of windows those near the front that both hold."""
    return on_common_rows(near_the_front(first), near_the_front(second))


def held_by_both(runs: Runs) -> RecordedByBoth:
    """The beads and times that two runs recorded.

    Raises:
        InputError: there is no such bead, or no such time after the start.
    """
    first, second = (run.problem for run in runs)
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
    rows = first.rows.shared(second.rows)
    if rows.count == 0:
        raise InputError(f"{runs[1].path}: recorded none of the beads that {runs[0].path} recorded")
    problem = replace(first.coarser(strides[0]), frames=frames, rows=rows)
    return RecordedByBoth(problem, strides, same_width=first.rows.width == second.rows.width)


def compared_pairs(runs: tuple[RunDirectory, ...], comparison: Validation) -> Pairs:
    """Blocks of a run, and of what it was compared with, at the beads and times that were compared.

    Args:
        runs: the run, and the other one where it was not compared with the reference.
        comparison: their comparison.

    Returns:
        Pairs of frames at the same times.
    """
    directory, *others = runs
    for other in others:
        return (where_both_hold(*pair) for pair in held_by_both((directory, other)).pairs((directory, other)))
    steps = None if comparison.uncertainty is None else comparison.uncertainty.steps_per_frame
    problem = directory.problem
    exact = reference.blocks(problem, steps_per_frame=steps, rows=compared_rows(problem))
    return paired(directory.blocks_so_far(), exact)


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
    stepped = engine_called(run.engine).own_step
    return {
        "engine": run.engine,
        "time step": problem.scale.written(problem.timestep, "time") if stepped else "",
        "scheme": problem.scheme if stepped else "",
        "window": f"{problem.rows.width} rows" if problem.rows.follow else "all rows",
        "ranks": str(job.ranks or ""),
        **job.versions,
        "Python": job.python or "",
        "machine": job.machine or "",
        "input files": (job.files_sha256 or "")[:12],
    }
