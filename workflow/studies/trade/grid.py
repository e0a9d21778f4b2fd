"""What a user can choose for a scene: the settings of every engine, from coarse to fine."""

from dataclasses import replace

from lammps_inputs import Problem, physics
from lammps_inputs import scheme as schemes
from lammps_inputs.facts import Fact
from lammps_inputs.limits.timestep import stability_bound
from lammps_inputs.scheme import SchemeName
from lammps_inputs.window import HEADROOM, LEAST_WINDOW
from workflow.engines.lammps import mpi
from workflow.engines.reference.blanes_moan import BLANES_MOAN
from workflow.engines.reference.scheme import Scheme
from workflow.engines.reference.suzuki import SUZUKI4
from workflow.engines.reference.verlet import VERLET
from workflow.studies.trade.jobs import Job
from workflow.studies.trade.work_precision import Setting

COARSEST = 0.6
"""Longest step (of a composition: cycle) in the stability bound of velocity Verlet."""

FINEST = {"verlet": 1024, "suzuki4": 64, "blanes-moan": 64}
"""Steps, or cycles, in the coarsest one."""

MOST_RANKS = 4

USUAL = 0.06
"""Step of the reference at which windows are compared, at most."""

WIDEN, MOST_WIDTHS = 1.5, 6

Jobs = list[Setting[Job]]

LAMMPS = "LAMMPS "
REFERENCE = "reference "
RIGID = "rigid beads"
RANKS, WINDOW = "ranks", "window"


def settings(problem: Problem) -> Jobs:
    """Everything to be measured for a problem, which has the scene's own frames and time step."""
    system = problem.system
    found = lammps_by_step(problem, "verlet")
    if system.holds(Fact.REVERSIBLE):
        found += lammps_by_step(problem, "suzuki4")
    found += lammps_by_ranks(problem)
    for scheme in reference_schemes():
        found += reference_by_step(problem, scheme)
    found += lammps_by_window(problem) + reference_by_window(problem)
    if physics.gap(system) > 0.0 and physics.simply_coupled(system):
        found.append(_setting(RIGID, 1.0, "exact", Job("collisions", problem)))
    return found


def reference_schemes() -> tuple[Scheme, ...]:
    """All tables that there are."""
    return BLANES_MOAN, SUZUKI4, VERLET


def cycles(problem: Problem, finest: int, own: float | None = None) -> list[tuple[int, int]]:
    """(frames that one cycle spans, cycles in a frame), one of them 1: lengths halved from `COARSEST`.

    Args:
        problem: whose frames and stability bound count.
        finest: cycles in the coarsest one, at most.
        own: another length to take in.
    """
    longest = COARSEST * stability_bound(problem.system)
    frames = 1
    while 2 * frames * problem.every <= longest and problem.frames // (2 * frames) >= 10:
        frames *= 2
    found: list[tuple[int, int]] = []
    while frames > 1:
        found.append((frames, 1))
        frames //= 2
    parts = 1
    while problem.every / parts > longest:
        parts *= 2
    coarsest = problem.every / parts if not found else problem.every * found[0][0]
    while coarsest / (problem.every / parts) <= finest * (1.0 + 1e-9):
        found.append((1, parts))
        parts *= 2
    if own is not None and own <= longest:
        found.append((1, round(problem.every / own)))
    return sorted(set(found), key=lambda pair: pair[0] / pair[1], reverse=True)


def stepped(problem: Problem, frames: int, parts: int) -> Problem:
    """A problem whose steps are so many frames long, or so many parts of one; frames are left out where need be."""
    coarse = problem.coarser(frames)
    return replace(coarse, timestep=problem.every * frames / parts, steps_per_frame=parts)


def lammps_by_step(problem: Problem, scheme: SchemeName) -> Jobs:
    """LAMMPS by the length of a (mean) Verlet step, which is what a scene's ``timestep`` says."""
    stages = schemes.cycle(scheme)
    found: Jobs = []
    for frames, parts in cycles(problem, FINEST[scheme], problem.timestep if stages == 1 else None):
        own = replace(stepped(problem, frames, parts * stages), scheme=scheme)
        found.append(_setting(f"{LAMMPS}{scheme}", own.timestep, _step(own), Job("lammps", own)))
    return found


def lammps_by_ranks(problem: Problem) -> Jobs:
    """LAMMPS at the scene's time step on one core and on several."""
    most = min(MOST_RANKS, mpi.cores(), problem.beads) if mpi.launcher() is not None else 1
    ranks = [2**power for power in range(most.bit_length()) if 2**power <= most]
    if len(ranks) < 2:
        return []
    return [
        _setting(f"{LAMMPS}{RANKS}", count, f"{count} rank{'s' * (count > 1)}", Job("lammps", problem, ranks=count))
        for count in ranks
    ]


def reference_by_step(problem: Problem, scheme: Scheme) -> Jobs:
    """The reference by the length of a step of its scheme."""
    found: Jobs = []
    for frames, parts in cycles(problem, FINEST[scheme.name]):
        own = stepped(problem, frames, parts)
        found.append(_setting(f"{REFERENCE}{scheme.name}", own.timestep, _step(own), Job("reference", own, scheme)))
    return found


def lammps_by_window(problem: Problem) -> Jobs:
    """LAMMPS at the scene's time step by the number of rows that exist; all of them last."""
    system = problem.system
    recorded = problem.recorded is None and physics.uniform(system)
    forward = all(velocity > 0.0 and bead <= LEAST_WINDOW - HEADROOM for _, bead, velocity in system.kicks)
    may = recorded and forward and system.holds(Fact.FRONT)
    jobs = [Job("lammps", replace(problem, window=rows)) for rows in widths(problem)] if may else []
    return _windows(LAMMPS, problem, jobs, Job("lammps", problem))


def reference_by_window(problem: Problem) -> Jobs:
    """The reference, at a step that leaves some 1e-6, by the number of rows that are integrated; all of them last."""
    pairs = cycles(problem, FINEST["blanes-moan"])
    fine = next((pair for pair in pairs if problem.every * pair[0] / pair[1] <= USUAL), pairs[-1])
    own = stepped(problem, *fine)
    hit = [bead for _, bead, _ in physics.excitations(problem.system)]
    recorded = problem.recorded is None and max(hit) - min(hit) <= LEAST_WINDOW // 2
    jobs = [Job("reference", own, BLANES_MOAN, window=rows) for rows in widths(problem)] if recorded else []
    return _windows(REFERENCE, problem, jobs, Job("reference", own, BLANES_MOAN))


def widths(problem: Problem) -> list[int]:
    """Numbers of rows to try, fewer than there are."""
    found: list[int] = []
    width = float(LEAST_WINDOW)
    while width < 0.9 * problem.beads and len(found) < MOST_WIDTHS:
        found.append(round(width))
        width *= WIDEN
    return found


def _windows(engine: str, problem: Problem, windowed: list[Job], whole: Job) -> Jobs:
    rows = [job.window or job.problem.window or problem.beads for job in windowed]
    return [
        _setting(f"{engine}{WINDOW}", count, f"{count} rows", job)
        for count, job in zip([*rows, problem.beads], [*windowed, whole], strict=True)
        if windowed
    ]


def _setting(curve: str, value: float, label: str, job: Job) -> Setting[Job]:
    """A setting whose effort is the forces of all beads."""
    problem = job.problem
    rows = job.window or problem.window or problem.beads
    stages = 1 if job.scheme is None else job.scheme.forces_per_step
    effort = problem.steps * stages * rows / problem.beads / min(job.ranks, 2)
    return Setting(curve, value, label, effort, job, job.engine)


def _step(problem: Problem) -> str:
    """The step in words, in units of T."""
    return f"step {problem.timestep:.4g}"


def has_order(curve: str) -> bool:
    """Whether the values of a curve are steps."""
    return curve != RIGID and not curve.endswith((RANKS, WINDOW))


def is_whole(curve: str) -> bool:
    """Whether all rows are computed, so that errors are those of all beads."""
    return not curve.endswith(WINDOW)
