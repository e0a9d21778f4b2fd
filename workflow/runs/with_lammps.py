"""Runs by LAMMPS: the deck, the number of ranks, and how a run ended."""

import functools
import math
from pathlib import Path
from typing import Any

from lammps_inputs import Problem, Scene, file_names
from lammps_inputs.decks import deck, parameters, scene_files
from lammps_inputs.system import System
from workflow import cost_model
from workflow.engines.lammps import engine
from workflow.runs.engines import Engine, Work
from workflow.runs.files import LAMMPS_FILES
from workflow.runs.job import Job


class LammpsEngine(Engine):
    """LAMMPS, through its Python module."""

    name = "lammps"
    title = "LAMMPS"
    own_step = True
    inputs = (file_names.SCENE, file_names.DECK, file_names.DATA)
    files = LAMMPS_FILES
    bytes_a_bead = cost_model.MEMORY

    def refusal(self, scene: Scene) -> str:
        """What LAMMPS cannot compute."""
        return deck.refusal(scene.system)

    def refused_ranks(self, ranks: int, system: System) -> str:
        """More ranks than cores or rows, or no MPI."""
        return engine.refused_ranks(ranks, system.beads)

    def begins_with(self, scene: Scene, problem: Problem | None = None) -> dict[str, str]:
        """The scene and its deck."""
        return scene_files.render(scene, problem)

    def seconds(self, problem: Problem, ranks: int) -> float | None:
        """Estimated time of a run, by the model of a step."""
        return cost_model.cost(problem, ranks).seconds

    def compute(self, work: Work) -> dict[str, Any]:
        """Run the deck in the directory."""
        start = work.lammps or engine.run_deck
        if work.restart_every is not None:
            start = functools.partial(start, restart_every=work.restart_every)
        end = start(
            work.path,
            problem=work.problem,
            ranks=work.ranks,
            progress=work.progress,
            part=work.part,
            lock=work.lock,
        )
        return {
            "outcome": "done" if end.end == "done" else "interrupted",
            "steps_done": end.steps,
            "lammps": end.version,
            "engine_seconds": end.seconds + work.seconds,
        }

    def sentence(self, job: Job) -> str:
        """Version, steps, time and ranks, and where the run was resumed."""
        ranks = f"{job.ranks} rank{'' if job.ranks == 1 else 's'}"
        if job.resumed:
            steps = ", ".join(str(again.from_step) for again in job.resumed)
            return (
                f"LAMMPS {job.lammps} computed {job.steps} steps in {job.wall_seconds:.2f} s on {ranks}, "
                f"resumed from step {steps}"
            )
        return f"LAMMPS {job.lammps} computed {job.steps} steps in {job.engine_seconds:.2f} s on {ranks}"

    def errors(self, job: Job) -> tuple[float, float] | None:
        """Errors against the reference; None where the run was not checked."""
        if job.check is None:
            return None
        velocity, arrival = (math.nan if error is None else error for error in (job.check.amplitude, job.check.arrival))
        return velocity, arrival

    def other_parameters(self, path: Path, problem: Problem) -> list[str]:
        """Parameters of the deck whose values in the log differ from the scene's; none where there is no log."""
        try:
            log = (path / file_names.LOG).read_text(encoding="utf-8", errors="replace")
        except OSError:
            return []
        return parameters.differences(log, problem)


LAMMPS = LammpsEngine()
