"""What a user can choose for a scene: the settings of every engine, from coarse to fine, and how each is run and timed.

Times are of an engine's time loop with its frames on the disk, apart from its start.
"""

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from analysis.files import recording
from analysis.trajectory import Trajectory
from lammps_inputs import Problem, file_names, physics
from lammps_inputs import scheme as schemes
from lammps_inputs.decks import deck
from lammps_inputs.facts import Fact
from lammps_inputs.limits.rates import stability_bound
from lammps_inputs.scheme import SchemeName
from lammps_inputs.window import HEADROOM, LEAST_WINDOW, LOOK
from workflow.engines.lammps import engine as lammps
from workflow.engines.lammps import mpi
from workflow.engines.reference import engine as reference
from workflow.engines.reference.schemes import BLANES_MOAN, SUZUKI4, VERLET, Scheme
from workflow.errors import RunError
from workflow.studies.trade.truth import write
from workflow.studies.trade.work_precision import Setting

# --- runs -------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Job:
    """One run.

    Attributes:
        engine: its name.
        problem: with its own time step and frames; LAMMPS's scheme and window stand in it.
        scheme: of the reference.
        ranks: of LAMMPS.
        window: rows that the reference integrates; None for all.
    """

    engine: str
    problem: Problem
    scheme: Scheme = BLANES_MOAN
    ranks: int = 1
    window: int | None = None

    @property
    def forces(self) -> float:
        """Evaluations of all forces; NaN where there are none."""
        stages = {"lammps": 1, "reference": self.scheme.forces_per_step}
        return float(self.problem.steps * stages.get(self.engine, math.nan))

    @property
    def rows(self) -> int:
        """Rows that exist or are integrated."""
        return self.window or self.problem.window or self.problem.beads


@dataclass(frozen=True)
class Done:
    """A job that was run: its frames, and its costs by name in seconds (``forces`` is a number of evaluations)."""

    job: Job
    dump: Path
    costs: dict[str, float]

    def blocks(self) -> Iterator[Trajectory]:
        """Its frames; of the reference with a window, the rows in it."""
        found = recording.blocks([self.dump], self.job.problem)
        return found if self.job.window is None else _follow(found, self.job.window)


def run(job: Job, directory: Path) -> Done:
    """Run a job with its files in a directory, over those of the one before.

    Raises:
        RunError: it failed.
    """
    started = time.perf_counter()
    (directory / file_names.DUMP).unlink(missing_ok=True)
    seconds = _ENGINES[job.engine](job, directory)
    start = time.perf_counter() - started - seconds
    return Done(job, directory / file_names.DUMP, {"seconds": seconds, "start": start, "forces": job.forces})


def _lammps(job: Job, directory: Path) -> float:
    (directory / file_names.DATA).write_text(deck.render_data(job.problem))
    (directory / file_names.DECK).write_text(deck.render_deck(job.problem))
    end = lammps.run(directory, ranks=job.ranks, problem=job.problem)
    if end.end != "done":
        raise KeyboardInterrupt
    return end.seconds


def _reference(job: Job, directory: Path) -> float:
    problem = job.problem
    reference.load()
    started = time.perf_counter()
    try:
        blocks = reference.blocks(
            problem, scheme=job.scheme, steps_per_frame=problem.steps_per_frame, window=job.window
        )
        write(directory / file_names.DUMP, problem, blocks)
    except ValueError as error:
        raise RunError(str(error)) from None
    return time.perf_counter() - started


def _collisions(job: Job, directory: Path) -> float:
    from workflow.engines import collisions  # numba takes a third of a second to import

    collisions.run(job.problem, max_events=0)
    started = time.perf_counter()
    write(directory / file_names.DUMP, job.problem, collisions.blocks(collisions.run(job.problem)))
    return time.perf_counter() - started


_ENGINES: dict[str, Callable[[Job, Path], float]] = {
    "lammps": _lammps,
    "reference": _reference,
    "collisions": _collisions,
}


def _follow(blocks: Iterator[Trajectory], window: int) -> Iterator[Trajectory]:
    """The rows of frames of all rows that a window has which follows the pulse."""
    for block in blocks:
        problem = replace(block.problem, window=window)
        size = max(1, int(LOOK / problem.every))
        for start in range(0, block.frames, size):
            piece = replace(block[start : start + size], problem=problem)
            front = max(window, piece.moving.stop)
            yield piece.on(front - window + 1, front)


# --- settings ---------------------------------------------------------------------------------------------------------

COARSEST = 0.6
"""Longest step (of a composition: cycle) in the stability bound of velocity Verlet."""

FINEST = {"verlet": 1024, "suzuki4": 64, "blanes-moan": 64}
"""Steps, or cycles, in the coarsest one."""

MOST_RANKS = 4

USUAL = 0.06
"""Step of the reference at which windows are compared, at most; it leaves some 1e-6."""

WIDEN, MOST_WIDTHS = 1.5, 6

LAMMPS, REFERENCE, RIGID = "LAMMPS ", "reference ", "rigid beads"
RANKS, WINDOW = "ranks", "window"


def settings(problem: Problem) -> list[Setting]:
    """Everything to be measured for a problem, which has the scene's own frames and time step."""
    system = problem.system
    found = by_step(problem, LAMMPS, VERLET)
    if system.holds(Fact.REVERSIBLE):
        found += by_step(problem, LAMMPS, SUZUKI4)
    found += by_ranks(problem)
    for scheme in (BLANES_MOAN, SUZUKI4, VERLET):
        found += by_step(problem, REFERENCE, scheme)
    found += by_window(problem)
    if physics.gap(system) > 0.0 and physics.simply_coupled(system):
        found.append(_setting(RIGID, 1.0, "exact", Job("collisions", problem)))
    return found


def by_step(problem: Problem, curve: str, scheme: Scheme) -> list[Setting]:
    """An engine by the length of a step; of LAMMPS that of a (mean) Verlet step, which a scene's ``timestep`` says."""
    if curve == REFERENCE:
        jobs = [Job("reference", own, scheme) for own in stepped(problem, FINEST[scheme.name])]
    else:
        name: SchemeName = "suzuki4" if scheme is SUZUKI4 else "verlet"
        several = stepped(problem, FINEST[name], schemes.cycle(name), problem.timestep)
        jobs = [Job("lammps", replace(own, scheme=name)) for own in several]
    steps = [job.problem.timestep for job in jobs]
    return [_setting(curve + scheme.name, step, f"step {step:.4g}", job) for step, job in zip(steps, jobs, strict=True)]


def stepped(problem: Problem, finest: int, stages: int = 1, own: float | None = None) -> list[Problem]:
    """The problem with cycles of ever fewer frames, or parts of one, their lengths halved from `COARSEST`.

    Args:
        problem: whose frames and stability bound count; frames are left out where a cycle spans several.
        finest: cycles in the coarsest one, at most.
        stages: steps of a cycle.
        own: another length to include, where a cycle is a step.
    """
    longest = COARSEST * stability_bound(problem.system)
    frames = parts = 1
    while 2 * frames * problem.every <= longest and problem.frames // (2 * frames) >= 10:
        frames *= 2
    while problem.every / parts > longest:
        parts *= 2
    coarsest = frames / parts
    found = {(frames // 2**k, 1) for k in range(1, frames.bit_length())} | {(frames, parts)}
    while parts * coarsest <= finest * (1.0 + 1e-9):
        found.add((1, parts))
        parts *= 2
    if own is not None and stages == 1 and own <= longest:
        found.add((1, round(problem.every / own)))
    return [
        replace(
            problem.coarser(frames), timestep=problem.every * frames / (parts * stages), steps_per_frame=parts * stages
        )
        for frames, parts in sorted(found, key=lambda pair: pair[0] / pair[1], reverse=True)
    ]


def by_ranks(problem: Problem) -> list[Setting]:
    """LAMMPS at the scene's time step on one core and on several."""
    most = min(MOST_RANKS, mpi.cores(), problem.beads) if mpi.launcher() is not None else 1
    counts = [2**power for power in range(most.bit_length()) if most > 1]
    return [
        _setting(LAMMPS + RANKS, count, f"{count} rank{'s' * (count > 1)}", Job("lammps", problem, ranks=count))
        for count in counts
    ]


def by_window(problem: Problem) -> list[Setting]:
    """LAMMPS at the scene's time step by the number of rows that exist, and the reference by those that it integrates.

    All rows come last, and nothing where a scene can have no window or is too short for one.
    """
    system = problem.system
    widths = [
        round(LEAST_WINDOW * WIDEN**k) for k in range(MOST_WIDTHS) if LEAST_WINDOW * WIDEN**k < 0.9 * problem.beads
    ]
    if problem.recorded is not None or not widths:
        return []
    several = stepped(problem, FINEST["blanes-moan"])
    fine = next((own for own in several if own.timestep <= USUAL), several[-1])
    forward = all(velocity > 0.0 and bead <= LEAST_WINDOW - HEADROOM for _, bead, velocity in system.kicks)
    kicked = [bead for _, bead, _ in physics.excitations(system)]
    found = []
    if physics.uniform(system) and forward and system.holds(Fact.FRONT):
        narrow = [Job("lammps", replace(problem, window=rows)) for rows in widths]
        found += [(LAMMPS + WINDOW, job) for job in (*narrow, Job("lammps", problem))]
    if max(kicked) - min(kicked) <= LEAST_WINDOW // 2:
        found += [(REFERENCE + WINDOW, Job("reference", fine, window=rows)) for rows in (*widths, None)]
    return [_setting(curve, job.rows, f"{job.rows} rows", job) for curve, job in found]


def _setting(curve: str, value: float, label: str, job: Job) -> Setting:
    """A setting whose effort is the forces of all beads."""
    forces = job.problem.steps if math.isnan(job.forces) else job.forces
    return Setting(curve, value, label, forces * job.rows / job.problem.beads / min(job.ranks, 2), job, job.engine)


def has_order(curve: str) -> bool:
    """Whether the values of a curve are steps."""
    return curve != RIGID and not curve.endswith((RANKS, WINDOW))


def is_whole(curve: str) -> bool:
    """Whether all rows are computed, so that errors are those of all beads."""
    return not curve.endswith(WINDOW)
