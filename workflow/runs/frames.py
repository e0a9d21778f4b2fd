"""Frames that an engine computes, written as LAMMPS would."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from analysis.files.recording import Writer
from analysis.trajectory import Trajectory
from lammps_inputs import Problem
from workflow.runs.engines import Progress


def write_frames(
    dump: Path, problem: Problem, blocks: Iterable[Trajectory], progress: Progress | None = None
) -> dict[str, Any]:
    """Write frames as LAMMPS would, to the end or to Ctrl-C; how it ended.

    Examples:
        >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 5.0}).problem()
        >>> write_frames(tmp / "chains.dump.bin", problem, engine.blocks(problem))
        {'outcome': 'done', 'steps_done': 350}
    """
    step = 0
    with Writer(dump, problem) as writer:
        try:
            for block in blocks:
                for state in block.states():
                    writer.append(step, *state)
                    step += problem.steps_per_frame
                if progress is not None:
                    progress(step - problem.steps_per_frame, _front(block))
        except KeyboardInterrupt:
            return {"outcome": "interrupted", "steps_done": max(0, step - problem.steps_per_frame)}
    return {"outcome": "done", "steps_done": problem.steps}


def _front(block: Trajectory) -> int:
    moving = (abs(block.velocity[-1]) > 1e-3).any(axis=0).nonzero()[0]
    return int(block.beads[moving[-1]]) if len(moving) else 1
