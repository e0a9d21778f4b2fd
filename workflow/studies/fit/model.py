"""Traces that a scene would show, from the reference, at times of a table."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from analysis.files.traces import Traces
from analysis.gauges.channels import beads_of, read_at
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import InputError, Problem, library
from lammps_inputs.units import REDUCED, SI
from workflow.engines.reference import engine
from workflow.engines.reference.schemes import VERLET
from workflow.verdicts.validate_table import check_channels

_LATER = 8
"""Frames beyond the last time, which the interpolation leans on."""

MOST_FRAMES = 2_000_000


class Model:
    """Traces of scenes that differ in some numbers.

    Frames and steps lie at the same times in all, so that small changes of the numbers make small ones of the traces.

    Args:
        scene: plain data of the scene to begin with.
        source: what to call it in messages.
        path: of the table.
        given: what was measured.

    Raises:
        InputError: the scene is none, or has no such channels.
    """

    def __init__(self, scene: dict[str, Any], source: str, path: Path, given: Traces) -> None:
        self.source, self.given = source, given
        start = self._problem(scene, 1.0)
        if start.window is not None:
            raise InputError(f"{source}: window: rows behind it have no traces; leave it out")
        if given.units and not start.scale.si:
            raise InputError(f"{path}: names units, but {source} has no material, so it is in reduced units")
        check_channels(path, given.channels, start)
        self.unit_time = start.scale.time
        self._si = start.scale.si
        self.every = start.every * start.scale.time
        self._steps = engine.default_steps_per_frame(start)
        if (given.time[-1] - given.time[0]) / self.every > MOST_FRAMES:
            raise InputError(
                f"{path}: lasts {(given.time[-1] - given.time[0]) / self.unit_time:.3g} T, too long to fit; cut it "
                "where the pulses have passed (and see that its times are in the scene's units)"
            )
        self.beads = beads_of(given.channels, start)

    def symbol(self, quantity: str) -> str:
        """Of the unit of a quantity."""
        return SI[quantity] if self._si else REDUCED

    @property
    def units(self) -> tuple[str, ...]:
        """Symbol of each channel's unit."""
        return tuple(self.symbol(channel.quantity) for channel in self.given.channels)

    def _problem(self, scene: dict[str, Any], duration: float) -> Problem:
        """Of a scene that is followed for a time of its own units."""
        kept = {key: value for key, value in scene.items() if key not in ("until_bead", "accuracy", "timestep")}
        return library.from_plain({**kept, "duration": duration, "output": {}}, self.source).problem()

    def run(self, scene: dict[str, Any], until: float) -> Trajectory:
        """The beads that matter, from the start until a time in the scene's units.

        Raises:
            InputError: it is no scene.
        """
        frames = max(0, math.ceil(until / self.every)) + _LATER
        problem = self._problem(scene, frames * self.every)
        steps = max(self._steps, engine.default_steps_per_frame(problem))
        every = self.every / problem.scale.time
        problem = replace(problem, timestep=every / steps, steps_per_frame=steps, frames=frames, recorded=self.beads)
        return engine.run(problem, steps_per_frame=steps)

    def numerical_error(self, scene: dict[str, Any], offset: float, traces: Floats) -> Floats:
        """[channel] root mean square of the difference of a run with the scene's time step and LAMMPS's scheme.

        Data that such a run made are as far from the traces without any noise.
        """
        kept = {key: value for key, value in scene.items() if key not in ("until_bead", "accuracy")}
        last = max(0.0, float(self.given.time[-1]) - offset) + _LATER * self.every
        problem = library.from_plain({**kept, "duration": last, "output": {}}, self.source).problem()
        run = engine.run(replace(problem, recorded=self.beads), scheme=VERLET, steps_per_frame=problem.steps_per_frame)
        difference = np.where(np.isfinite(self.given.values), self.traces(run, offset) - traces, np.nan)
        return np.asarray(np.sqrt(np.nanmean(difference**2, axis=0)))

    def traces(self, run: Trajectory, offset: float) -> Floats:
        """What the table would hold, [row, channel], where its times are later than the scene's by an offset."""
        return read_at(run, self.given.channels, self.given.time - offset)
