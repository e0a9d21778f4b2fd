"""How many ranks are worth while, what a run will cost, and the options of a job that asks a cluster for them.

By a model of a step, with its assumptions written down: it takes a fixed time, a time for every bead of a rank, and
with more than one rank a time for the messages to the two neighbours (a rank owns whole rows, so it sends its outermost
rows only). Times and bytes a bead were measured on one core with 100 to a million beads; the time of messages is
assumed. Larger runs are extrapolated, taking for granted that

- memory and its bandwidth grow with the ranks (true for ranks on different nodes, less so for those of one);
- a network takes some microseconds a message, and the outermost rows of a rank are few beads beside its own;
- frames are written by one rank, at the speed of one file.
"""

import argparse
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.files.dump_layout import sizes
from lammps_inputs import InputError, Problem, physics
from lammps_inputs.numbers import size_text, time_text
from workflow.plugins.jobs import site
from workflow.plugins.jobs.schedulers import SCHEDULERS
from workflow.plugins.jobs.step_time import MESSAGES, bead_seconds, frame_seconds, step_seconds

MEMORY = 1000
"""Memory in bytes a bead of a single chain at the start, when it is largest; 600 to 700 for coupled chains."""

PROCESS = 40_000_000
"""Memory in bytes of a rank without beads."""

LONE_RESTART, COUPLED_RESTART = 144, 190
"""Size in bytes a bead of a restart, of a single chain and of coupled chains."""

REFERENCE_FORCE = 1e-9
"""Seconds of the reference integrator for the forces on a bead; measured: 0.7e-9 to 3e-9."""

EFFICIENCY = 0.9
"""Part of the time that a rank spends on its beads rather than on messages, below which more ranks are a waste."""

LEAST_ROWS = 20
"""Rows of a rank below which those that it shares with its neighbours are no longer few beside its own."""

RANKS_OF_A_NODE = 32
"""Number of ranks on a node where the site's file does not state its cores."""


@dataclass(frozen=True)
class Cost:
    """Estimated cost of a run.

    Attributes:
        ranks: MPI ranks.
        beads: number of beads of all chains, as far as they exist.
        step: time of a time step without frames, in s.
        seconds: time of the run with its frames, in s.
        memory: memory of all ranks together, in bytes.
        frame: size of a frame, in bytes.
        frames: size of all frames, in bytes.
        restart: size of a restart, in bytes.
    """

    ranks: int
    beads: int
    step: float
    seconds: float
    memory: float
    frame: float
    frames: float
    restart: float

    def sentence(self) -> str:
        """All costs in one line."""
        ranks = f"{self.ranks} rank{'s' * (self.ranks > 1)} of {math.ceil(self.beads / self.ranks)} beads"
        return (
            f"the run takes about {time_text(self.seconds)} ({time_text(self.step)} a step) on {ranks}, "
            f"{size_text(self.memory)} of memory, and on the disk {size_text(self.frames)} of frames "
            f"({size_text(self.frame)} each) and {size_text(self.restart)} a restart"
        )


def least_beads(problem: Problem) -> int:
    """Beads that a rank must have to be worth its messages."""
    return math.ceil(EFFICIENCY / (1.0 - EFFICIENCY) * MESSAGES / bead_seconds(problem))


def advised(problem: Problem, most_ranks: int) -> int:
    """Number of ranks that are worth while, at most ``most_ranks``."""
    beads = problem.chains * problem.rows
    return max(1, min(most_ranks, beads // least_beads(problem), problem.rows // LEAST_ROWS))


def cost(problem: Problem, ranks: int) -> Cost:
    """Cost of a run on a number of ranks, by the model."""
    beads = problem.chains * problem.rows
    frame, frames = sizes(problem)
    largest = math.ceil(problem.rows / ranks) * problem.chains
    fixed, bead = step_seconds(problem)
    step = fixed + bead * largest + MESSAGES * (ranks > 1)
    return Cost(
        ranks=ranks,
        beads=beads,
        step=step,
        seconds=step * problem.steps + frame_seconds(frames, problem.frames),
        memory=float(MEMORY * beads + PROCESS * ranks),
        frame=frame,
        frames=frames,
        restart=float((COUPLED_RESTART if physics.coupled(problem.system) else LONE_RESTART) * beads),
    )


def too_many(problem: Problem, ranks: int) -> str:
    """A line that says that one rank would be faster by the model; empty if it would not."""
    alone = cost(problem, 1)
    if alone.step >= cost(problem, ranks).step:
        return ""
    return f"one rank would be faster: about {time_text(alone.seconds)} with --nodes 1 --ranks-per-node 1"


# --- options of a job -------------------------------------------------------------------------------------------------


def add_job_arguments(parser: argparse.ArgumentParser) -> "argparse._ArgumentGroup":
    """Add what a job requests of a cluster; the group that the options are in."""
    group = parser.add_argument_group(
        "job on a cluster", f"defaults: --site FILE, else ${site.VARIABLE}, else ~/{site.DEFAULT_FILE}"
    )
    scripts = ", ".join(f"{name} ({scheduler.script})" for name, scheduler in SCHEDULERS.items())
    group.add_argument("--scheduler", metavar="NAME", choices=SCHEDULERS, help=f"write a job as well, for {scripts}")
    group.add_argument("--slurm", action="store_const", dest="scheduler", const="slurm", help="--scheduler slurm")
    group.add_argument("--job", action="store_true", help="write a job for the scheduler of the site (default slurm)")
    group.add_argument("--site", metavar="FILE", type=Path, help="YAML with a site's defaults for the options below")
    group.add_argument("--nodes", metavar="N", type=int, help="nodes (default 1)")
    group.add_argument("--ranks-per-node", metavar="N", type=int, help="MPI ranks of a node (default: by the beads)")
    group.add_argument("--time", metavar="HH:MM:SS", help="limit of one job; the next resumes (default 24:00:00)")
    group.add_argument("--max-jobs", metavar="N", type=int, help="jobs after which to stop (default 100)")
    group.add_argument("--partition", metavar="P", help="partition, or queue")
    group.add_argument("--account", metavar="A", help="account")
    group.add_argument("--module", metavar="M", dest="modules", action="append", help="module to load; may be repeated")
    group.add_argument("--lmp", metavar="PATH", help="the executable (default lmp)")
    group.add_argument("--launcher", metavar="COMMAND", help="what starts the ranks (default srun or mpirun)")
    return group


def job_options(arguments: argparse.Namespace) -> site.JobOptions | None:
    """Options of a job by the arguments of `add_job_arguments`, else by the site's file; None if no job is asked for.

    Raises:
        InputError: an option cannot be used, or is given without ``--scheduler``, ``--slurm`` or ``--job``.
    """
    names = (*site.JobOptions.model_fields, "site")
    requested: dict[str, Any] = {
        name: value for name, value in vars(arguments).items() if name in names and value is not None
    }
    if not (arguments.job or arguments.scheduler):
        if requested:
            name = next(iter(requested))
            option = site.OPTIONS.get(name, name.replace("_", "-"))
            raise InputError(f"--{option}: is for a job; add --slurm, --scheduler NAME or --job")
        return None
    requested.pop("site", None)
    return site.options(requested, site.find_site(arguments.site))


def with_ranks(options: site.JobOptions, problem: Problem) -> site.JobOptions:
    """Options of a job with the advised number of ranks where they name none."""
    if options.ranks_per_node is not None:
        return options
    cores = options.cores_per_node or RANKS_OF_A_NODE
    count = max(1, advised(problem, cores * options.nodes) // options.nodes)
    return options.model_copy(update={"ranks_per_node": count})
