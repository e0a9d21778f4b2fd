"""How many ranks are worth while for a deck, and what its run costs on them, by `workflow.cost_model`."""

import math

from granchain.parts import Problem, cost_model, numbers, physics
from workflow.plugins.jobs.site import JobOptions

PROCESS = 40_000_000
"""Memory in bytes of a rank without beads."""

LONE_RESTART, COUPLED_RESTART = 144, 190
"""Size in bytes a bead of a restart, of a single chain and of coupled chains."""

EFFICIENCY = 0.9
"""Part of the time that a rank spends on its beads rather than on messages, below which more ranks are a waste."""

LEAST_ROWS = 20
"""Rows of a rank below which those that it shares with its neighbours are no longer few beside its own."""

RANKS_OF_A_NODE = 32
"""Number of ranks on a node where the site's file does not state its cores."""


def memory(problem: Problem, ranks: int) -> float:
    """Memory of all ranks together, in bytes."""
    return float(cost_model.MEMORY * problem.chains * problem.rows.existing + PROCESS * ranks)


def restart(problem: Problem) -> float:
    """Size of a restart, in bytes."""
    bead = COUPLED_RESTART if physics.coupled(problem.system) else LONE_RESTART
    return float(bead * problem.chains * problem.rows.existing)


def sentence(problem: Problem, ranks: int) -> str:
    """All costs of a run on a number of ranks in one line."""
    costs = cost_model.cost(problem, ranks)
    beads = math.ceil(problem.chains * problem.rows.existing / ranks)
    time, step = numbers.time_text(costs.seconds), numbers.time_text(costs.step)
    sizes = map(numbers.size_text, (memory(problem, ranks), costs.frames, costs.frame, restart(problem)))
    in_memory, frames, frame, in_restart = sizes
    return (
        f"the run takes about {time} ({step} a step) on {ranks} rank{'s' * (ranks > 1)} of {beads} beads, {in_memory} "
        f"of memory, and on the disk {frames} of frames ({frame} each) and {in_restart} a restart"
    )


def least_beads(problem: Problem) -> int:
    """Beads that a rank must have to be worth its messages."""
    return math.ceil(EFFICIENCY / (1.0 - EFFICIENCY) * cost_model.MESSAGES / cost_model.bead_seconds(problem))


def advised(problem: Problem, most_ranks: int) -> int:
    """Number of ranks that are worth while, at most ``most_ranks``."""
    beads = problem.chains * problem.rows.existing
    return max(1, min(most_ranks, beads // least_beads(problem), problem.rows.existing // LEAST_ROWS))


def too_many(problem: Problem, ranks: int) -> str:
    """A line that says that one rank would be faster by the model; empty if it would not."""
    alone = cost_model.cost(problem, 1)
    if alone.step >= cost_model.cost(problem, ranks).step:
        return ""
    return f"one rank would be faster: about {numbers.time_text(alone.seconds)} with --nodes 1 --ranks-per-node 1"


def with_ranks(options: JobOptions, problem: Problem) -> JobOptions:
    """Options of a job with the advised number of ranks where they name none."""
    if options.ranks_per_node is not None:
        return options
    cores = options.cores_per_node or RANKS_OF_A_NODE
    count = max(1, advised(problem, cores * options.nodes) // options.nodes)
    return options.model_copy(update={"ranks_per_node": count})
