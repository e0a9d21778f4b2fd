"""Runs by the reference integrator, to an accuracy or until the energy budget is closed."""

import math
import time
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from analysis.conservation import FrameAccountant
from analysis.trajectory import Trajectory
from lammps_inputs import Problem, file_names
from workflow import cost_model
from workflow.runs.engines import Engine, Work
from workflow.runs.frames import write_frames
from workflow.runs.job import Job


class ReferenceEngine(Engine):
    """The reference integrator, which chooses its own steps."""

    name = "reference"
    title = "the reference integrator"

    def seconds(self, problem: Problem, ranks: int) -> float | None:  # noqa: ARG002  it runs on one core
        """Estimated time of a run, by the number of forces."""
        from workflow.engines.reference import engine
        from workflow.prepare import pilot

        return cost_model.REFERENCE_FORCE * pilot.work(problem, 0, engine.default_steps_per_frame(problem))

    def compute(self, work: Work) -> dict[str, Any]:
        """Compute to the accuracy if one is asked for; else, where energy is exchanged, until its budget is closed."""
        from workflow.runs.check import closing, references_of

        problem, settings, started = work.problem, work.settings, time.perf_counter()
        for halving in closing(problem) if settings is None else references_of(problem, settings):
            ending = write_frames(work.path / file_names.DUMP, problem, halving.blocks(), work.progress)
            if ending["outcome"] != "done":
                return ending
            uncertainty = halving.uncertainty
            if settings is not None and uncertainty.velocity <= settings.accuracy:
                break
        seconds = time.perf_counter() - started
        return {**ending, "engine_seconds": seconds, "uncertainty": asdict(uncertainty)}

    def blocks(
        self, problem: Problem, *, rows: int | None = None, most_frames: int | None = None
    ) -> Iterator[Trajectory]:
        """Frames with the reference's default steps."""
        from workflow.engines.reference import engine

        return engine.blocks(problem, rows=rows, most_frames=most_frames)

    def accountant(self, frames: Problem, run: Problem | None = None, job: Job | None = None) -> FrameAccountant:
        """Accountant of frames of a run, with the steps that the run itself took if it is the reference's."""
        from workflow.engines.reference import energy_exchange, engine, step_halving

        uncertainty = None if job is None else job.uncertainty  # only the reference's runs have one
        if uncertainty is None:
            return energy_exchange.Accountant(frames)
        most_steps = 2**step_halving.MOST_HALVINGS * engine.default_steps_per_frame(frames)
        steps = uncertainty.steps_per_frame * round(frames.every / (run or frames).every)
        return energy_exchange.Accountant(frames, min(steps, most_steps))

    def sentence(self, job: Job) -> str:
        """Time and uncertainty."""
        errors = self.errors(job)
        assert errors is not None
        return (
            f"the reference integrator computed the run in {job.engine_seconds:.2f} s; its uncertainty is "
            f"{errors[0]:.1e} V in velocities and {errors[1]:.1e} T in arrivals"
        )

    def errors(self, job: Job) -> tuple[float, float] | None:
        """Uncertainty by step halving; None where the record holds none."""
        if job.uncertainty is None:
            return None
        bounds = job.uncertainty.velocity, job.uncertainty.arrival
        velocity, arrival = (math.nan if bound is None else bound for bound in bounds)
        return velocity, arrival


REFERENCE = ReferenceEngine()
