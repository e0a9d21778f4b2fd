"""Modes, breathers and responses for scripts and notebooks."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, TypedDict, Unpack

from granchain import load
from granchain.parts import Between, checked, inputs
from workflow.plugins.derivatives import tangent
from workflow.plugins.modes import response_study
from workflow.plugins.modes.response_tables import ResponseResult
from workflow.plugins.modes.study import modes_of, requested, study
from workflow.plugins.modes.tables import ModesResult

_Energy = Annotated[float, Between(0.0, above=True)]
_Number = Annotated[int, Between(1)]


class ModesOptions(TypedDict, total=False):
    """What is computed beside the linear modes.

    Attributes:
        mode: numbers of the linear modes whose branches are followed.
        energy: largest energy, in the scene's units.
        at_energy: energies of further states, in the scene's units.
        points: largest number of states of a branch, or of responses.
        every_state: whether LAMMPS is started on every state.
        frequencies: of a driven, damped scene lowest and highest frequency of the drive, in cycles per unit time.
        bead: chain and bead whose largest speed is the amplitude of responses.
        sweep: frequencies of the sweep in LAMMPS.
    """

    mode: Sequence[_Number] | None
    energy: _Energy | None
    at_energy: Sequence[_Energy]
    points: Annotated[int, Between(2, 10_000)] | None
    every_state: bool
    frequencies: Sequence[_Energy] | None
    bead: Sequence[_Number] | None
    sweep: Annotated[int, Between(2, 1000)] | None


@checked
def modes(
    scene: inputs.AnyScene,
    directory: Path | str,
    *,
    linear: bool = False,
    lammps: bool = True,
    **options: Unpack[ModesOptions],
) -> ModesResult | ResponseResult:
    """Compute modes and breathers of a scene, or its responses to a drive, with their stability; resumes.

    Writes the same files as ``granchain modes``.

    Args:
        scene: see `granchain.load`; its kicks, end, time step and output do not matter.
        directory: new, or resumed.
        linear: whether only linear modes are computed.
        lammps: whether LAMMPS is started on states.
        **options: ``mode``, ``energy``, ``at_energy``, ``points``, ``every_state``; of a driven, damped scene
            ``frequencies``, ``bead`` and ``sweep``; by default those of the command.

    Returns:
        The modes and branches; with ``frequencies`` the responses.

    Raises:
        InputError: the scene has no such modes or responses, or the directory cannot be used.
        RunError: LAMMPS failed, or a process was killed.

    Examples:
        >>> scene = granchain.load("precompressed", {"beads": 8})
        >>> len(granchain.modes(scene, "linear", linear=True).modes())
        8
    """
    defaults = {"mode": None, "energy": None, "at_energy": (), "points": None, "every_state": False}
    of_responses = {"frequencies": None, "bead": None, "sweep": None}
    chosen = {**defaults, **of_responses, "linear": linear, "no_lammps": not lammps, **options}
    arguments = argparse.Namespace(**chosen)
    plain, source = load(scene).plain(), inputs.source_of(scene)
    problem = tangent.problem_of(plain, source)
    responses = response_study.requested(arguments, problem)
    if responses is not None:
        response_study.refuse_unusable(problem, source, responses)
        return response_study.study(plain, source, Path(directory), responses)
    request = requested(arguments, problem, modes_of(problem, source, linear_only=linear))
    return study(plain, source, Path(directory), request)
