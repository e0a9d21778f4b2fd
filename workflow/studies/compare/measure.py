"""What one engine found in a scene: impulses, velocities, shares."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analysis import motion
from analysis.files import events
from analysis.sharing.impulses import ImpulseMeter, Impulses, from_events
from analysis.tracking.peaks import PeakFinder
from analysis.trajectory import Floats, Trajectory
from workflow.errors import RunError
from workflow.runs.engines import ENGINES
from workflow.runs.files import EVENTS
from workflow.runs.run_directory import RunDirectory


@dataclass(frozen=True)
class Result:
    """What one engine found, dimensionless.

    Attributes:
        impulses: of the contacts of every row.
        peak: largest velocity of each shown row, [chain, shown row].
        time, velocity: of the shown rows, [frame] and [frame, chain, shown row].
        momentum: share of each chain at the end, [chain]. Contacts pass momentum on within a chain, so this swings by
            the modes of one row whatever the contacts: a check of a run, not a result.
        energy: share of each chain's motion and contacts at the end, then of the springs, [chain + 1].
        seconds: wall time of the computation alone.
        wall: wall time with files.
    """

    engine: str
    impulses: Impulses
    peak: Floats
    time: Floats
    velocity: Floats
    momentum: Floats
    energy: Floats
    seconds: float
    wall: float


def measure(directory: RunDirectory, rows: Sequence[int]) -> Result:
    """What the finished run in a directory found, in one pass over its frames."""
    problem, record = directory.problem, directory.record
    rigid = not ENGINES[record["engine"]].deforms
    meter, finder = ImpulseMeter(problem), PeakFinder()
    place = [int(np.flatnonzero(problem.recorded_beads == row)[0]) for row in rows]
    times, velocities, last = [], [], None
    for block in directory.blocks():
        times.append(block.time)
        velocities.append(block.velocity[:, :, place].copy())
        if not rigid:
            meter.add(block)
            finder.add(block)
        last = block[-1:]
    if last is None:
        raise RunError(f"{directory.path}: holds no frames")
    time, velocity = np.concatenate(times), np.concatenate(velocities)
    peak = velocity.max(axis=0)
    if rigid:
        table = events.from_csv(directory.path / EVENTS, problem.scale)
        impulses = from_events(problem, table)
        for k, row in enumerate(rows):
            struck = table.row + 1 == row
            np.maximum.at(peak[:, k], table.chain[struck] - 1, table.striker[struck])
    else:
        impulses, found = meter.result(), finder.result()
        for k, row in enumerate(rows):
            at = found.bead == row
            np.maximum.at(peak[:, k], found.chain[at] - 1, found.velocity[at])
    momentum, energy = partition(last)
    return Result(
        record["engine"],
        impulses,
        peak,
        time,
        velocity,
        momentum,
        energy,
        float(record["engine_seconds"]),
        float(record["wall_seconds"]),
    )


def partition(state: Trajectory) -> tuple[Floats, Floats]:
    """Shares of one frame: of the momentum by chain, and of the energy by chain and, last, in the springs."""
    problem, x, v = state.problem, state.displacement[-1], state.velocity[-1]
    of_chain = np.sum(motion.kinetic_energy(problem, v), axis=-1) + np.sum(motion.contact_energy(problem, x), axis=-1)
    whole = float(motion.energy(problem, x, v))
    momentum = np.sum(v * problem.mass, axis=1)
    total = float(momentum.sum())
    share = momentum / total if total != 0.0 else np.full(problem.chains, math.nan)
    return share, np.append(of_chain, whole - of_chain.sum()) / whole


def last_row(results: Sequence[Result]) -> int:
    """Last bead, before the last five, that got an impulse in every engine."""
    passed = np.all([np.any(result.impulses.whole > 0.0, axis=0) for result in results], axis=0)
    if len(passed) > 10:
        passed[-5:] = False  # the free end
    reached = len(passed) if passed.all() else int(np.argmin(passed))
    return int(results[0].impulses.bead[reached - 1]) if reached else 1
