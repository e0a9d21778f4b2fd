"""How large a run will be, in steps, frames, bytes and time, and whether that is more than its limits.

By the model of `workflow.cost_model`, whose times were measured on one machine: LAMMPS took 0.7 to 2 times as long.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

from analysis.files.dump_layout import sizes
from lammps_inputs import InputError, Problem, Scene, physics, plugins
from lammps_inputs.limits import rates
from lammps_inputs.numbers import size_text, time_text
from lammps_inputs.output import Limits
from lammps_inputs.window import LEAST_WINDOW
from workflow.runs.engines import Engine

MOST = Limits(gigabytes=20.0, hours=24.0)
"""Limits where neither the scene nor the machine names any."""


LARGE_BYTES, LARGE_SECONDS = 1e9, 10.0
"""Size (bytes) and time (s) above which a run prints them before it begins."""

_UNITS = {"gigabytes": "GB of frames", "hours": "h"}


@dataclass(frozen=True)
class Size:
    """Size of a run.

    Attributes:
        steps: steps of LAMMPS; None for other engines, which choose their own.
        frames: number of frames, that at the start included.
        bytes: size of all frames, in bytes.
        seconds: estimated time, in s; None where there is no estimate.
        rough: whether the steps are those of a rule, as before a pilot run.
        at_least: whether the run may have more frames, as its duration or window is not known yet.
    """

    steps: int | None
    frames: int
    bytes: float
    seconds: float | None
    rough: bool = False
    at_least: bool = False

    @property
    def large(self) -> bool:
        """Whether it takes long enough, or enough of the disk, to be said before it begins."""
        return self.bytes > LARGE_BYTES or (self.seconds or 0.0) > LARGE_SECONDS

    def sentence(self) -> str:
        """Steps, frames, their size and time in one phrase."""
        number = "" if self.steps is None else f"about {self.steps:.2g}" if self.rough else f"{self.steps:,}"
        steps = f"{number} steps and " if number else ""
        time = "" if self.seconds is None else f" in an estimated time of {time_text(self.seconds)}"
        return f"{'at least ' * self.at_least}{steps}{self.frames:,} frames ({size_text(self.bytes)}){time}"


def size_of(problem: Problem, engine: Engine, ranks: int = 1) -> Size:
    """Size of the run of a problem."""
    return Size(
        steps=problem.steps if engine.own_step else None,
        frames=problem.frames + 1,
        bytes=sizes(problem)[1],
        seconds=engine.seconds(problem, ranks),
    )


def too_large(scene: Scene, size: Size) -> str:
    """One line on how a run exceeds its limits and how they are raised; empty where it does not.

    Args:
        scene: with its limits.
        size: of its run.

    Raises:
        InputError: a file with limits of this machine cannot be used.
    """
    scene_limits = scene.limits or Limits()
    needs = {"gigabytes": size.bytes / 1e9, "hours": (size.seconds or 0.0) / 3600.0}
    limits = {key: getattr(scene_limits, key) or getattr(MOST, key) for key in needs}
    if all(needs[key] <= limits[key] for key in needs):
        return ""
    machine: dict[str, Limits] = dict(limits_of() for limits_of in plugins.loaded("limits").values())
    sources = (scene_limits, *machine.values(), MOST)
    limits = {key: next(filter(None, (getattr(source, key) for source in sources))) for key in needs}
    above = {key: value for key, value in needs.items() if value > limits[key]}
    if not above:
        return ""
    beyond = " and ".join(f"{limits[key]:g} {_UNITS[key]}" for key in above)
    needed = ", ".join(f"{key}: {_rounded_up(value)}" for key, value in above.items())
    units = f"; {scene.in_units_of_time}" if scene.in_units_of_time else ""
    return (
        f"{size.sentence()}: more than the limit of {beyond}{units}; shorten the "
        "duration, record less (output.every, output.beads), or raise the limit with "
        f"`limits: {{{needed}}}` in {' or in '.join(['the scene', *machine])}"
    )


def refuse_too_long(scene: Scene, source: str, engine: Engine, ranks: int = 1, problem: Problem | None = None) -> None:
    """Refuse a run that is larger than its limits, before anything is written.

    Args:
        scene: with its duration, window and time step.
        source: what the user calls the scene.
        engine: what computes.
        ranks: of LAMMPS.
        problem: the scene's.

    Raises:
        InputError: it is.
    """
    above = too_large(scene, size_of(scene.problem() if problem is None else problem, engine, ranks))
    if above:
        raise InputError(f"{source}: duration: {above}")


def refuse_beforehand(scene: Scene, source: str, engine: Engine, ranks: int = 1) -> None:
    """Refuse a scene that exceeds its limits as it was given, with the fewest frames that it can have."""
    open_step = scene.accuracy is not None or (engine.own_step and scene.timestep is None)
    if not sought(scene) and not open_step:
        return refuse_too_long(scene, source, engine, ranks)
    above = too_large(scene, replace(size_beforehand(scene, least_problem(scene), engine), seconds=None))
    if above:
        key = "duration" if scene.until_bead is None else "until_bead"
        raise InputError(f"{source}: {key}: {above}")
    return None


def sought(scene: Scene) -> bool:
    """Whether the duration or the window of a scene is found by trials."""
    return scene.until_bead is not None or scene.window == "auto"


def size_beforehand(scene: Scene, problem: Problem, engine: Engine) -> Size:
    """Size of the run before anything is tried: that of the scene's `least_problem`."""
    size = replace(size_of(problem, engine), rough=engine.own_step and scene.timestep is None)
    return replace(size, steps=None, seconds=None, at_least=True) if sought(scene) else size


def least_problem(scene: Scene) -> Problem:
    """A problem with no more frames and rows than the scene has once its duration and window are found."""
    changes: dict[str, Any] = {"accuracy": None}
    if scene.until_bead is not None:
        system = scene.system
        distance = min(abs(scene.until_bead - bead) for _, bead, _ in physics.excitations(system))
        changes |= {"until_bead": None, "duration": max(1, distance) / rates.front_speed(system) * scene.scale.time}
    if scene.window == "auto":
        changes["window"] = LEAST_WINDOW
    return scene.model_copy(update=changes).problem()


def _rounded_up(value: float) -> str:
    """A number rounded up to two digits."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return f"{float(f'{math.ceil(value / unit) * unit:.2g}'):.15g}"
