"""The time step of a scene that names none: found by a pilot run for an accuracy, and written into the scene."""

import math
import time

from pydantic import ValidationError

from lammps_inputs import InputError, Scene, library, scheme
from lammps_inputs.scene import DEFAULT_ACCURACY
from workflow.prepare import step_search, twin
from workflow.prepare.settings import Settings
from workflow.prepare.twin import UnreachableError


def with_timestep(scene: Scene, source: str = "") -> tuple[Scene, Settings]:
    """The scene with a time step that keeps its accuracy, or the default, and how it was chosen.

    Where no step keeps the default accuracy, the step is that of the rule.

    Args:
        scene: with its duration.
        source: what the user calls the scene, for messages.

    Raises:
        InputError: no step keeps the accuracy that the scene asks for.
    """
    asked, accuracy = scene.accuracy is not None, scene.accuracy or DEFAULT_ACCURACY
    problem = scene.model_copy(update={"timestep": None, "accuracy": None}).problem()
    where, unreached = f"{source}: accuracy" if source else "accuracy", ""
    twin.load(problem)
    started = time.perf_counter()
    try:
        found = step_search.search(problem, accuracy)
    except UnreachableError as error:
        if asked:
            raise InputError(
                f"{where}: {accuracy:g} is not reached with any time step, since {error}; "
                "take a larger one, or give a timestep"
            ) from None
        found, unreached = step_search.by_rule(problem, accuracy), str(error)
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
        asked=asked,
        unreached=unreached,
        reference=found.reference,
    )


def better_timestep(scene: Scene) -> str:
    """What to change in a scene whose time step left too large an error, in words."""
    better, settings = with_timestep(scene.model_copy(update={"timestep": None}))
    if settings.unreached:
        return f"no time step is known to leave less, since {settings.unreached}"
    if settings.measured < 1.0:
        return "leave `timestep` out, and a pilot run chooses a shorter one"
    return f"`timestep: {better.timestep:.12g}` leaves {settings.expected_error:.1e} V, measured by a pilot run"
