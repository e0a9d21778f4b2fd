"""The time step of a scene that asks for an accuracy: searched for, and put into the scene."""

import math
import time

from pydantic import ValidationError

from lammps_inputs import InputError, Scene, library, scheme
from workflow.prepare import step_search
from workflow.prepare.settings import Settings
from workflow.prepare.twin import UnreachableError


def with_timestep(scene: Scene, accuracy: float, source: str = "") -> tuple[Scene, Settings]:
    """The scene with a time step that keeps an accuracy, and how it was chosen.

    Args:
        scene: with its duration.
        accuracy: largest error of any recorded velocity, in units of V.
        source: what the user calls the scene, for messages.

    Raises:
        InputError: no step keeps it.
    """
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


def better_timestep(scene: Scene, accuracy: float) -> str:
    """What to put into a scene whose run was off by more than an accuracy, in words; measured, or said not to be."""
    try:
        better, settings = with_timestep(scene, accuracy)
    except InputError as error:
        return str(error)
    if settings.measured < 1.0:
        return f"`accuracy: {accuracy:g}` in place of `timestep` finds a shorter one"
    return f"`timestep: {better.timestep:.12g}` leaves {settings.expected_error:.1e} V, measured on a twin of the run"
