"""Lyapunov exponents for scripts and notebooks."""

from pathlib import Path
from typing import Annotated

from granchain import load
from granchain.parts import Between, checked, inputs
from workflow.plugins.derivatives import tangent
from workflow.plugins.lyapunov.study import LyapunovResult, duration_of, study


@checked
def lyapunov(
    scene: inputs.AnyScene,
    directory: Path | str,
    *,
    exponents: Annotated[int, Between(1, 10_000)] = 1,
    duration: Annotated[float, Between(0.0, above=True)] | None = None,
) -> LyapunovResult:
    """Compute Lyapunov exponents of a scene, on all cores; resumes an interrupted call.

    Writes the same files as ``granchain lyapunov``.

    Args:
        scene: see `granchain.load`; its own end, time step and output do not matter.
        directory: new, or resumed.
        exponents: number of exponents, the largest first.
        duration: duration of each run, in the scene's units; 10,000 T by default.

    Returns:
        The exponents with their uncertainties, and for how long a run can be predicted (``predictable``).

    Raises:
        InputError: the scene cannot be linearised, the duration is too short, or the directory cannot be used.
        RunError: a process was killed.

    Examples:
        >>> scene = granchain.load("two-chains", {"beads": 6, "precompression": {"force": 1.0}})
        >>> regular = granchain.lyapunov(scene, "exponents", duration=1000)
        >>> regular.chaotic
        False
    """
    plain, source = load(scene).plain(), inputs.source_of(scene)
    until = duration_of(tangent.problem_of(plain, source), exponents, duration)
    return study(plain, source, Path(directory), exponents, until)
