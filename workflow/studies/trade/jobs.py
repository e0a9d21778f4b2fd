"""What can be run at a setting: an engine's time loop with its frames on the disk, timed apart from its start.

Also what a Verlet step costs in LAMMPS by the number of beads, on its own and as a part of suzuki4's cycles.
"""

import math
import re
import shutil
import subprocess
import sysconfig
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import get_args

from analysis.files import recording
from analysis.trajectory import Trajectory
from lammps_inputs import Problem, file_names, physics
from lammps_inputs import scheme as schemes
from lammps_inputs.decks import deck
from lammps_inputs.scheme import SchemeName
from lammps_inputs.window import LOOK
from workflow.engines.lammps import mpi
from workflow.engines.reference import engine
from workflow.engines.reference.scheme import Scheme
from workflow.errors import RunError
from workflow.studies.trade.certified import write

TOOK = "took.txt"

MOST_SECONDS = 600.0
"""After which a LAMMPS run is given up."""

STOP_SECONDS = 5.0

Change = Callable[[str], str]


@dataclass(frozen=True)
class Job:
    """One run.

    Attributes:
        engine: a key of `ENGINES`.
        problem: with its own time step and frames; LAMMPS's scheme and window stand in it.
        scheme: of the reference.
        ranks: of LAMMPS.
        window: rows that the reference integrates; None for all.
    """

    engine: str
    problem: Problem
    scheme: Scheme | None = None
    ranks: int = 1
    window: int | None = None


@dataclass(frozen=True)
class Done:
    """What a run left.

    Attributes:
        dump: its frames.
        seconds: of the time loop, frames included.
        start: of everything before it: starting a program, reading a deck, loading compiled code.
        forces: evaluations of all forces.
    """

    problem: Problem
    dump: Path
    seconds: float
    start: float
    forces: float

    followed: int | None = None
    """Rows of the reference's window, beyond which what was recorded is of no use."""

    def blocks(self) -> Iterator[Trajectory]:
        """Its frames; with a window, the rows in it."""
        found = recording.blocks([self.dump], self.problem)
        return found if self.followed is None else _follow(found, self.followed)

    def costs(self) -> dict[str, float]:
        """By name."""
        return {"seconds": self.seconds, "start": self.start, "forces": self.forces}


def run(job: Job, directory: Path) -> Done:
    """Run a job with its files in a directory, over those of the one before.

    Raises:
        RunError: it failed.
    """
    return ENGINES[job.engine](job, directory)


# --- LAMMPS -----------------------------------------------------------------------------------------------------------


def executable() -> str | None:
    """Path of the ``lmp`` beside this Python, else on the PATH, else None."""
    beside = Path(sysconfig.get_path("scripts")) / "lmp"
    return str(beside) if beside.exists() else shutil.which("lmp")


def timed(text: str) -> str:
    """A deck that writes the seconds of its time loop, all that follows its first ``timestep``, into `TOOK`."""
    start = re.search(r"^timestep ", text, flags=re.MULTILINE)
    assert start is not None
    before, loop = text[: start.start()], text[start.start() :].rstrip()
    return (
        f"{before}variable begun timer\n{loop}\nvariable ended timer\n"
        f'variable took equal v_ended-v_begun\nprint "$(v_took:%.9g)" file {TOOK} screen no\n'
    )


def lammps(problem: Problem, directory: Path, *, ranks: int = 1, change: Change = str) -> tuple[float, float]:
    """Run a problem's stand-alone deck with the stock program; seconds of its time loop, and of all else.

    Args:
        problem: what to run.
        directory: for its files, over those of a run before.
        ranks: of MPI.
        change: what to do to the deck first.

    Raises:
        RunError: there is no program, or it failed.
    """
    program, launcher = executable(), mpi.launcher()
    if program is None or (ranks > 1 and launcher is None):
        raise RunError("no `lmp` (or `mpiexec`) beside Python or on the PATH")
    for name in (TOOK, file_names.DUMP):
        (directory / name).unlink(missing_ok=True)
    (directory / file_names.DATA).write_text(deck.render_data(problem))
    (directory / file_names.DECK).write_text(timed(change(deck.render_deck(problem))))
    command = [program, "-in", file_names.DECK, "-log", file_names.LOG, "-screen", "none", "-nocite"]
    if ranks > 1:
        command = [str(launcher), "-n", str(ranks), *command]
    started = time.perf_counter()
    code = _finished(command, directory)
    whole = time.perf_counter() - started
    try:
        seconds = float((directory / TOOK).read_text())
    except (OSError, ValueError):
        raise RunError(f"LAMMPS ended with exit code {code}. {_complaint(directory / file_names.LOG)}") from None
    return seconds, whole - seconds


def _finished(command: list[str], directory: Path) -> int:
    """Run a program to its end; its exit code. Whatever happens, it does not outlive this."""
    process = subprocess.Popen(
        command, cwd=directory, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        return process.wait(MOST_SECONDS)
    except BaseException as reason:
        process.terminate()  # which mpiexec hands on to its ranks
        try:
            process.wait(STOP_SECONDS)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        if isinstance(reason, subprocess.TimeoutExpired):
            raise RunError(f"LAMMPS was not done after {MOST_SECONDS:.0f} s") from None
        raise


def _complaint(log: Path) -> str:
    try:
        lines = log.read_text(errors="replace").splitlines()
    except OSError:
        return ""
    return next((line for line in lines if line.startswith("ERROR")), "")


def _lammps(job: Job, directory: Path) -> Done:
    seconds, start = lammps(job.problem, directory, ranks=job.ranks)
    return Done(job.problem, directory / file_names.DUMP, seconds, start, float(job.problem.steps))


# --- our own ----------------------------------------------------------------------------------------------------------


def _reference(job: Job, directory: Path) -> Done:
    assert job.scheme is not None
    problem, path = job.problem, directory / file_names.DUMP
    started = time.perf_counter()
    engine.load()
    loaded = time.perf_counter()
    try:
        blocks = engine.blocks(problem, scheme=job.scheme, steps_per_frame=problem.steps_per_frame, window=job.window)
        write(path, problem, blocks)
    except ValueError as error:
        raise RunError(str(error)) from None
    ended = time.perf_counter()
    forces = float(problem.steps * job.scheme.forces_per_step)
    return Done(problem, path, ended - loaded, loaded - started, forces, job.window)


def _follow(blocks: Iterator[Trajectory], window: int) -> Iterator[Trajectory]:
    """The rows of frames of all rows that a window has which follows the pulse."""
    for block in blocks:
        problem = replace(block.problem, window=window)
        size = max(1, int(LOOK / problem.every))
        for start in range(0, block.frames, size):
            piece = replace(block[start : start + size], problem=problem)
            front = max(window, piece.moving.stop)
            yield piece.on(front - window + 1, front)


def _collisions(job: Job, directory: Path) -> Done:
    # numba takes a third of a second to import
    started = time.perf_counter()
    from workflow.engines import collisions

    collisions.run(job.problem, max_events=0)
    loaded = time.perf_counter()
    write(directory / file_names.DUMP, job.problem, collisions.blocks(collisions.run(job.problem)))
    return Done(job.problem, directory / file_names.DUMP, time.perf_counter() - loaded, loaded - started, math.nan)


ENGINES: dict[str, Callable[[Job, Path], Done]] = {
    "lammps": _lammps,
    "reference": _reference,
    "collisions": _collisions,
}


# --- cost of a step by the number of beads ----------------------------------------------------------------------------

FACTORS = (1, 10, 100)
MOST_ATOMS = 50_000

BEAD_SECONDS = 2e-8
STEP_SECONDS = 5e-6
"""Of a step: guesses from which the number of steps that are timed follows."""

TIMED_SECONDS = 0.4
"""Of a timed run."""

LEAST_CYCLES = 40

ROUNDS = 2


@dataclass(frozen=True)
class Size:
    """Seconds that a Verlet step takes, by scheme, of so many atoms."""

    atoms: int
    seconds: dict[str, float]


def step_costs(problem: Problem, directory: Path) -> Sequence[Size]:
    """The scene's chains as they are and longer, without frames.

    Raises:
        RunError: LAMMPS failed.
    """
    found = []
    for factor in FACTORS:
        system = replace(problem.system, beads=problem.beads * factor)
        longer = replace(problem, system=system, recorded=None, window=None)
        atoms = longer.chains * longer.beads
        if factor == 1 or (atoms <= MOST_ATOMS and physics.uniform(problem.system)):
            found.append(Size(atoms, _step_seconds(longer, directory)))
    return found


def _step_seconds(problem: Problem, directory: Path) -> dict[str, float]:
    """By the difference of a long and a very short run, which the setup drops out of; the best of some rounds."""
    stages = schemes.cycle("suzuki4")
    guess = STEP_SECONDS + BEAD_SECONDS * problem.chains * problem.beads
    counts = (stages, stages * max(LEAST_CYCLES, int(TIMED_SECONDS / guess / stages)))
    best: dict[tuple[str, int], float] = {}
    for _ in range(ROUNDS):
        for name in get_args(SchemeName):
            for steps in counts:
                bare = replace(problem, scheme=name, steps_per_frame=steps, frames=1)
                took, _ = lammps(bare, directory)
                best[name, steps] = min(took, best.get((name, steps), took))
    few, many = counts
    # however noisy the machine, a setup never takes more than half of the long run
    return {
        name: max(best[name, many] - best[name, few], 0.5 * best[name, many]) / (many - few)
        for name in get_args(SchemeName)
    }
