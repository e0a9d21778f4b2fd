"""Options of commands that write jobs."""

import argparse
from pathlib import Path
from typing import Any

from granchain import InputError
from workflow.plugins.jobs import site
from workflow.plugins.jobs.registry import SCHEDULERS
from workflow.plugins.jobs.site import JobOptions


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


def job_options(arguments: argparse.Namespace) -> JobOptions | None:
    """Options of a job by the arguments of `add_job_arguments`, else by the site's file; None if no job is asked for.

    Raises:
        InputError: an option cannot be used, or is given without ``--scheduler``, ``--slurm`` or ``--job``.
    """
    names = (*JobOptions.model_fields, "site")
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
