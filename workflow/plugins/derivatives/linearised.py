"""Problem of a scene whose equations of motion are linearised, whatever the scene's end, time step and output."""

from typing import Any

from lammps_inputs import InputError, Problem, Scene, library
from workflow.plugins.derivatives import tangent

_LEFT_OUT = ("window", "timestep", "accuracy", "scheme", "output")


def problem_of(plain: dict[str, Any], source: str) -> Problem:
    """The problem of a scene, whatever its end, time step and output.

    Args:
        plain: the scene.
        source: its name in messages.

    Raises:
        InputError: it is no scene, or one that cannot be linearised.
    """
    scene: Scene = library.from_plain({key: value for key, value in plain.items() if key not in _LEFT_OUT}, source)
    problem = scene.model_copy(update={"duration": scene.scale.time}).resolved().problem()
    try:
        tangent.refuse_without_slope(problem.system)
    except InputError as error:
        raise InputError(f"{source}: {error}") from None
    return problem
