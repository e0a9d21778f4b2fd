"""Options of a Slurm job on the command line, shared by the commands that write one."""

import argparse
from pathlib import Path
from typing import Any

from lammps_inputs import InputError, Problem, file_names
from lammps_inputs.slurm import site
from workflow.cluster import ranks


def add_job_arguments(parser: argparse.ArgumentParser) -> "argparse._ArgumentGroup":
    """What a job asks of a cluster; the group that they are in."""
    group = parser.add_argument_group(
        "Slurm", f"defaults: --site FILE, else ${site.VARIABLE}, else ~/{site.DEFAULT_FILE}"
    )
    group.add_argument("--slurm", action="store_true", help=f"write {file_names.JOB} as well")
    group.add_argument("--site", metavar="FILE", type=Path, help="YAML with a site's defaults for the options below")
    group.add_argument("--nodes", metavar="N", type=int, help="nodes (default 1)")
    group.add_argument("--ranks-per-node", metavar="N", type=int, help="MPI ranks of a node (default: by the beads)")
    group.add_argument("--time", metavar="HH:MM:SS", help="limit of one job; the next resumes (default 24:00:00)")
    group.add_argument("--max-jobs", metavar="N", type=int, help="jobs after which to stop (default 100)")
    group.add_argument("--partition", metavar="P", help="partition")
    group.add_argument("--account", metavar="A", help="account")
    group.add_argument("--module", metavar="M", dest="modules", action="append", help="module to load; may be repeated")
    group.add_argument("--lmp", metavar="PATH", help="the executable (default lmp)")
    group.add_argument("--launcher", metavar="COMMAND", help="what starts the ranks (default srun)")
    return group


def job_options(arguments: argparse.Namespace) -> site.JobOptions | None:
    """What the arguments of `add_job_arguments` ask for, over the site's defaults; None without ``--slurm``.

    Raises:
        InputError: an option cannot be used, or is given without ``--slurm``.
    """
    known = (*site.JobOptions.model_fields, "site")
    given: dict[str, Any] = {
        name: value for name, value in vars(arguments).items() if name in known and value is not None
    }
    if not arguments.slurm:
        if given:
            name = next(iter(given))
            raise InputError(f"--{site.OPTIONS.get(name, name.replace('_', '-'))}: is for a job; add --slurm")
        return None
    given.pop("site", None)
    return site.options(given, site.find_site(arguments.site))


def with_ranks(options: site.JobOptions, problem: Problem) -> site.JobOptions:
    """The same options with a number of ranks advised where none was asked for."""
    if options.ranks_per_node is not None:
        return options
    most = options.cores_per_node or ranks.RANKS_OF_A_NODE
    count = max(1, ranks.advised(problem, most * options.nodes) // options.nodes)
    return options.model_copy(update={"ranks_per_node": count})
