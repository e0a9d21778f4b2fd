"""Error against cost, measured from scripts and notebooks."""

from pathlib import Path
from typing import Annotated

from granchain import load
from granchain.parts import Between, checked, inputs
from workflow.plugins.trade.points import Findings
from workflow.plugins.trade.study import BUDGET, plain_problem, study


@checked
def trade(
    scene: inputs.AnyScene, directory: Path | str, *, budget: Annotated[float, Between(0.0, above=True)] = BUDGET
) -> Findings:
    """Measure error against cost of a scene on this machine: time steps, schemes, ranks, windows, frames.

    Writes the same files as ``granchain trade``.

    Args:
        scene: see `granchain.load`.
        directory: new, or that of an earlier study.
        budget: approximate duration, in s; settings that would take much of it are left out.

    Returns:
        What was measured; ``points`` are the settings with their errors and times.

    Raises:
        InputError: the scene has no end or an unstable time step, or the directory cannot be used.
        RunError: the reference failed.

    Examples:
        >>> scene = {"name": "short", "beads": 20, "kick": {"velocity": 1.0}, "duration": 20.0}
        >>> measured = granchain.trade(scene, "traded", budget=2)
        >>> measured.complete
        True
    """
    return study(plain_problem(load(scene)), Path(directory), budget=budget)
