"""What each engine found in a scene (impulses, velocities, shares), and what rigid beads keep and lose, in words."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analysis import motion
from analysis.files import events
from analysis.sharing.impulses import ImpulseMeter, Impulses, from_events, relative_difference
from analysis.tracking.peaks import PeakFinder
from analysis.trajectory import Floats, Trajectory
from workflow.errors import RunError
from workflow.runs.engines import ENGINES, RIGID
from workflow.runs.files import EVENTS
from workflow.runs.run_directory import RunDirectory

# --- numbers ----------------------------------------------------------------------------------------------------------


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
    problem, job = directory.problem, directory.job
    rigid = not ENGINES[directory.engine].deforms
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
        directory.engine,
        impulses,
        peak,
        time,
        velocity,
        momentum,
        energy,
        job.engine_seconds,
        job.wall_seconds,
    )


def partition(state: Trajectory) -> tuple[Floats, Floats]:
    """Shares of one frame: of the momentum by chain, and of the energy by chain and, last, in the springs."""
    problem, x, v = state.problem, state.displacement[-1], state.velocity[-1]
    system = problem.system
    of_chain = np.sum(motion.kinetic_energy(system, v), axis=-1) + np.sum(motion.contact_energy(system, x), axis=-1)
    whole = float(motion.energy(system, x, v))
    momentum = np.sum(v * system.mass, axis=1)
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


# --- words ------------------------------------------------------------------------------------------------------------

KEPT = 0.1
"""Relative difference up to which the cheap model is said to keep a quantity."""


def unevenness(impulses: Impulses, last: int) -> float:
    """How unequal the chains are on the last quarter of the way: median of (largest - smallest) / mean, or NaN."""
    rows = (impulses.bead <= last) & (impulses.bead > 0.75 * last)
    values = relative_difference(impulses.first[:, rows])
    return float(np.nanmedian(values)) if np.isfinite(values).any() else math.nan


def kept_to(one: Impulses, other: Impulses, last: int) -> int:
    """Last bead up to which every first impulse agrees within `KEPT` of the row's largest; 1 if not even bead 2."""
    rows = other.bead <= last
    scale = other.first[:, rows].max(axis=0)
    agree = np.all(np.abs(one.first[:, rows] - other.first[:, rows]) <= KEPT * scale, axis=0)
    return last if agree.all() else int(other.bead[int(np.argmin(agree))]) - 1


def arrival(impulses: Impulses, bead: int) -> float:
    """When a row was first struck, the earliest of its chains, in units of T; NaN if it never was."""
    times = impulses.time[:, impulses.row(bead)]
    return float(np.nanmin(times)) if np.isfinite(times).any() else math.nan


def answer(results: Sequence[Result], last: int) -> tuple[str, ...]:
    """What the numbers say, in sentences."""
    by_name = {result.engine: result for result in results}
    sentences = []
    if {"lammps", "reference"} <= set(by_name):
        one, other = by_name["lammps"], by_name["reference"]
        rows = one.impulses.bead <= last
        impulse = np.abs(one.impulses.first - other.impulses.first)[:, rows].max(initial=0.0)
        late = np.abs(one.impulses.time - other.impulses.time)[:, rows]
        moved = float(np.nanmax(late)) if np.isfinite(late).any() else 0.0
        sentences.append(
            f"LAMMPS and the reference agree on first impulses to {impulse:.1e} m V, on their times to {moved:.1e} T."
        )
    hertz = by_name.get("reference") or by_name.get("lammps")
    if RIGID.name in by_name and hertz is not None:
        sentences += _rigid_against(by_name[RIGID.name], hertz, last)
    return tuple(sentences)


def _rigid_against(rigid: Result, hertz: Result, last: int) -> list[str]:
    if last < 2:
        return ["No row received an impulse in both models, so nothing can be compared; give a longer duration."]
    kept, lost = [], []
    one, other = rigid.impulses, hertz.impulses
    until = kept_to(one, other, last)
    if until >= 2:
        kept.append(f"the first impulses of beads 2 to {until}")
    if until < last:
        lost.append(f"those from bead {until + 1} on" if until >= 2 else "the first impulses, from bead 2 on")
    row = other.row(last)
    for name, a, b in (
        (f"the arrival at bead {last}", arrival(one, last), arrival(other, last)),
        (f"the momentum passed to bead {last}", one.whole[:, row].sum(), other.whole[:, row].sum()),
    ):
        difference = (a - b) / b
        (kept if abs(difference) <= KEPT else lost).append(f"{name} ({100.0 * difference:+.3g} %)")
    farthest = int(other.bead[np.flatnonzero(other.whole.any(axis=0))[-1]])
    reached = int(one.bead[np.flatnonzero(one.whole.any(axis=0))[-1]])
    if reached < farthest - 5:
        lost.append(
            f"the pulse itself, which has not passed bead {reached} when it is at bead {farthest} in Hertz beads"
        )
    sentences = []
    if kept:
        sentences.append(f"Rigid beads keep, within {100.0 * KEPT:.0f} %: {'; '.join(kept)}.")
    if lost:
        sentences.append(f"{'They' if kept else 'Rigid beads'} lose: {'; '.join(lost)}.")
    if len(one.first) > 1:
        a, b = unevenness(one, last), unevenness(other, last)
        if math.isfinite(a) and math.isfinite(b):
            verdict = "the same" if abs(a - b) <= KEPT else "not the same"
            sentences.append(
                f"Sharing is {verdict}: on the last quarter of the way to bead {last} the chains' impulses differ by "
                f"{_percent(a)} of their mean in rigid beads, by {_percent(b)} in Hertz beads."
            )
    ratio = hertz.seconds / rigid.seconds if rigid.seconds > 0.0 else math.inf
    sentences.append(
        f"Rigid beads took {rigid.seconds:.2g} s, {hertz.engine} {hertz.seconds:.2g} s: {ratio:.3g} times as long."
    )
    return sentences


def _percent(share: float) -> str:
    return f"{100.0 * share:.3g} %" if share >= 1e-4 else "less than 0.01 %"
