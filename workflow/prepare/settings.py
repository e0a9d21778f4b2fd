"""The duration and the time step of a scene, found and judged before anything is written or run."""

import math
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

from pydantic import ValidationError

from lammps_inputs import InputError, Problem, Scene, library, scheme
from lammps_inputs.limits.timestep import stability_bound
from lammps_inputs.numbers import memory
from workflow.engines.reference.certify import Certifier
from workflow.prepare import step_search
from workflow.prepare.duration import with_duration
from workflow.prepare.twin import UnreachableError

SURE = 1.0 / 3.0
"""Part of an accuracy to which the reference must be sure that tells whether a run keeps it."""

_MOST_DOUBLINGS = 4


@dataclass(frozen=True)
class Settings:
    """How the time step of a scene that asks for an accuracy was chosen, dimensionless.

    Attributes:
        accuracy: asked for: largest error of any recorded velocity, in units of V.
        timestep: chosen.
        steps_per_frame: the same.
        reference_timestep: of a reference that is surer than the accuracy.
        expected_error: what the error is expected to be, in units of V.
        measured_error: what was measured beforehand: the same, or a larger one from which it was carried over.
        measured: share of the run's time over which that was measured; 0 where a law told it.
        limited: whether a longer step would have done, but for ``output.every`` or the stability bound.
        seconds: what the choice cost.
    """

    accuracy: float
    timestep: float
    steps_per_frame: int
    reference_timestep: float
    expected_error: float
    measured_error: float
    measured: float
    limited: bool
    seconds: float

    def plain(self) -> dict[str, Any]:
        """For ``run.json``."""
        return asdict(self)

    def sentence(self, problem: Problem) -> str:
        """What was chosen and why, in one line."""
        step = f"{self.timestep * problem.scale.time:.3g}"
        unit = f" {problem.scale.symbol('time')}" if problem.scale.si else ""
        if self.measured == 0.0:
            how = "from a law, for the scene is too large to measure beforehand"
        elif self.expected_error == self.measured_error:
            how = f"it leaves {self.expected_error:.1e} V, measured beforehand in {self.seconds:.1f} s"
        else:
            part = "" if self.measured == 1.0 else f" over 1/{1.0 / self.measured:.0f} of the time and beads"
            how = (
                f"it should leave less than {self.expected_error:.1e} V, by {self.measured_error:.1e} V measured "
                f"beforehand with another step{part} in {self.seconds:.1f} s"
            )
            if self.measured < 1.0 and problem.window is None and (problem.coupled or problem.gap > 0.0):
                how += "; beads left far behind may be off by more, for in long runs they amplify any error"
        longer = "; frames or stability allow no longer one" if self.limited else ""
        return f"accuracy {self.accuracy:g}: timestep {step}{unit}; {how}{longer}"


_DECK_BYTES = 250
"""Of memory, a bead that exists, to write a deck; measured."""


def refuse_too_large(scene: Scene, source: str, bytes_a_bead: float, what: str = "the deck") -> None:
    """Refuse what this machine's memory does not hold, before it is tried.

    Raises:
        InputError: naming the number of beads and what they need.
    """
    rows = scene.beads if not isinstance(scene.window, int) else min(scene.window, scene.beads)
    needed = bytes_a_bead * scene.chains * rows
    if scene.window != "auto" and needed > memory():
        raise InputError(
            f"{source}: beads: {scene.chains} x {rows:,} beads need {needed / 1e9:.3g} GB of memory for {what}, and "
            f"this machine has {memory() / 1e9:.3g}; take fewer, or a `window`"
        )


def settle(scene: Scene, *, source: str = "", force: bool = False) -> tuple[Scene, Settings | None]:
    """The scene with duration, window and time step written out, and how the step was chosen for an accuracy.

    Args:
        scene: as the user gave it.
        source: what the user calls the scene, for messages.
        force: whether a time step above the stability bound may pass.

    Raises:
        InputError: the end is not reached, the time step is unstable, or no step keeps the accuracy.
    """
    refuse_too_large(scene, source, _DECK_BYTES)
    if not force:
        refuse_unstable(scene, source)
    scene = with_duration(scene)
    if scene.window == "auto":
        from workflow.prepare.window import with_window  # numba takes a third of a second to import

        scene = with_window(scene)
    if scene.accuracy is None:
        return scene, None
    return _with_timestep(scene, scene.accuracy, source)


def better_timestep(scene: Scene, accuracy: float) -> str:
    """What to put into a scene whose run was off by more than an accuracy, in words; measured, or said not to be."""
    try:
        better, settings = _with_timestep(scene, accuracy, "")
    except InputError as error:
        return str(error)
    if settings.measured < 1.0:
        return f"`accuracy: {accuracy:g}` in place of `timestep` finds a shorter one"
    return f"`timestep: {better.timestep:.12g}` leaves {settings.expected_error:.1e} V, measured on a twin of the run"


def with_settings(scene: Scene) -> Scene:
    """The same scene with its duration and, where it asks for an accuracy, its time step written out.

    Raises:
        InputError: as `settle`.
    """
    return settle(scene, force=True)[0]


def refuse_unstable(scene: Scene, source: str = "") -> None:
    """Say so before LAMMPS runs with a time step at which it blows up.

    Raises:
        InputError: the scene names a time step above the stability bound.
    """
    if scene.timestep is None:
        return
    scale = scene.scale
    problem = scene.model_copy(update={"until_bead": None, "duration": scale.time, "window": None}).problem()
    bound = stability_bound(problem, problem.scheme)
    if problem.timestep > bound * (1.0 + 1e-9):
        unit = f" {scale.symbol('time')}" if scale.si else ""
        raise InputError(
            f"{f'{source}: ' if source else ''}timestep: {scene.timestep:g}{unit} is unstable, above the bound of "
            f"{bound * scale.time:.3g}{unit}; take a tenth of that, or `accuracy: 1e-4` instead; "
            "--force of run and deck allows it, for study"
        )


def certifiers(problem: Problem, settings: Settings | None) -> Iterator[Certifier]:
    """References of a problem, of which the last counts; each is asked how sure it is when its blocks were taken.

    Without an accuracy the usual one; else with ever more steps, until it is sure enough or gets hardly surer.
    """
    if settings is None:
        yield Certifier(problem)
        return
    steps = 2 * math.ceil(0.5 * problem.every / settings.reference_timestep * (1.0 - 1e-9))
    before = math.inf
    for _ in range(_MOST_DOUBLINGS):
        certifier = Certifier(problem, steps_per_frame=steps)
        yield certifier
        sure = certifier.certificate.velocity
        if sure <= SURE * settings.accuracy or sure > 0.5 * before:
            return
        before, steps = sure, 2 * steps


def _with_timestep(scene: Scene, accuracy: float, source: str) -> tuple[Scene, Settings]:
    started = time.perf_counter()
    problem = scene.model_copy(update={"accuracy": None}).problem()
    where = f"{source}: accuracy" if source else "accuracy"
    try:
        found = step_search.search(problem, accuracy)
    except UnreachableError as error:
        raise InputError(
            f"{where}: {accuracy:g} is not reached with any time step, since {error}; ask for less, or give a timestep"
        ) from None
    cycle = scheme.cycle(problem.scheme)
    steps = cycle * math.ceil(problem.every / (cycle * found.timestep) * (1.0 - 1e-9))
    every = problem.every * scene.scale.time if scene.output.every is None else scene.output.every
    fields = {name: getattr(scene, name) for name in Scene.model_fields}
    try:
        settled = Scene.model_validate({**fields, "accuracy": None, "timestep": every / steps})
    except ValidationError as error:
        wrong = library.describe(error, Scene)
        raise InputError(f"{where}: {accuracy:g} needs a time step of {every / steps:.3g}; {wrong}") from None
    return settled, Settings(
        accuracy=accuracy,
        timestep=problem.every / steps,
        steps_per_frame=steps,
        reference_timestep=found.reference_timestep,
        expected_error=found.error,
        measured_error=found.measured_error,
        measured=found.measured,
        limited=found.limited,
        seconds=time.perf_counter() - started,
    )
