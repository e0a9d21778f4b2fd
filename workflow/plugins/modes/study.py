"""Linear modes, nonlinear normal modes and breathers of a scene, or its responses to a drive, with their stability.

A conservative scene has no damping, drive or push; its kicks do not matter, but for the velocity V. From its linear
modes, branches of periodic states are followed up to an energy; each state has its Floquet multipliers, and some are
checked by LAMMPS. A scene with damping and a sinusoidal drive has responses over a range of frequencies
(`workflow.plugins.modes.response_study`).

| file             | contents                                                                            |
|------------------|-------------------------------------------------------------------------------------|
| modes.csv        | the linear modes                                                                    |
| states.csv       | the periodic states along each branch                                               |
| bifurcations.csv | changes of stability                                                                |
| lammps.csv       | LAMMPS started on some of the states                                                |
| states.npz       | displacements at the start, periods and multipliers of the states of each branch    |
| decks            | decks for LAMMPS that start on these states                                         |
| frequency.png    | frequency over energy, with the stability                                           |
| shapes.png       | shapes of the linear modes and of the last states                                   |
| multipliers.png  | Floquet multipliers of the last states                                              |
| motion.png       | a period of the last states in space and time                                       |
| responses.csv    | of a driven scene: the responses along the curve                                    |
| sweep.csv        | of a driven scene: the sweep in LAMMPS, up and down                                 |
| response.png     | of a driven scene: amplitude over frequency                                         |
| cases.jsonl      | the cache of computed branches                                                      |
"""

import argparse
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from granchain import InputError
from granchain.parts import Problem, Study, computations, deck, library, options, physics, screen, write_text
from workflow.plugins.derivatives import tangent
from workflow.plugins.modes import lammps_check, response_study
from workflow.plugins.modes.drawing import FIGURES, figures
from workflow.plugins.modes.linear import (
    MOST_FREE,
    LinearModes,
    free_atoms,
    free_to_drift,
    linear_modes,
    refuse_not_conservative,
)
from workflow.plugins.modes.tables import (
    BifurcationLine,
    BranchOfMode,
    LammpsLine,
    LinearMode,
    ModesResult,
    StateLine,
)

MODES, STATES, BIFURCATIONS, LAMMPS = "modes.csv", "states.csv", "bifurcations.csv", "lammps.csv"
ARRAYS, DECKS = "states.npz", "decks"
STUDY = Study(
    "modes",
    f"{STATES} is the table",
    tables=(MODES, STATES, BIFURCATIONS, LAMMPS),
    figures=FIGURES,
    cache="cases.jsonl",
    others=(ARRAYS, DECKS),
)

POINTS = 60
"""Default largest number of states of a branch."""

BISECTIONS = 8
"""Halvings of the interval of a bifurcation: a few thousandths of a step along the branch."""

MOST_ATOMS = 3000
"""Atoms up to which linear modes are computed, with dense matrices."""

MOST_CHECKED = 12
"""States that LAMMPS is started on, at most."""

_ORDER = {"energy": 0, "branch": 1, "bifurcation": 2}
"""Which states are checked first."""


@dataclass(frozen=True)
class ModesRequest:
    """What is asked for, dimensionless.

    Attributes:
        modes: numbers of the linear modes whose branches are followed, from 0; none for linear modes alone.
        energy: largest energy, in units of m V^2.
        points: largest number of states of a branch.
        energies: of further states, in units of m V^2.
        lammps: number of states that LAMMPS is started on, at most; None for all.
    """

    modes: tuple[int, ...]
    energy: float
    points: int
    energies: tuple[float, ...]
    lammps: int | None


# --- carried out ------------------------------------------------------------------------------------------------------


def modes_of(problem: Problem, source: str, *, linear_only: bool) -> LinearModes:
    """Linear modes of a scene's problem, after refusing what has none, or no periodic states near them.

    Raises:
        InputError: see `refuse_not_conservative` and `linear_modes`; or there are too many atoms, or modes of frequency
            0 other than those of chains that drift.
    """
    refuse_not_conservative(problem, source)
    atoms = int(np.count_nonzero(free_atoms(problem.system)))
    if atoms > MOST_ATOMS:
        raise InputError(f"{source}: {atoms} atoms; at most {MOST_ATOMS} for modes, which take dense matrices")
    modes = linear_modes(problem, source)
    if linear_only:
        return modes
    if atoms > MOST_FREE:
        raise InputError(
            f"{source}: {atoms} atoms; at most {MOST_FREE} for periodic states; `--linear` gives the linear modes alone"
        )
    if modes.zeros and not free_to_drift(modes):
        raise InputError(
            f"{source}: {modes.zeros} of {len(modes.frequency)} linear modes have the frequency 0, as contacts without "
            "load have no stiffness at rest; load all of them, such as by `precompression: {force: 0.1}`, or ask for "
            "`--linear`"
        )
    return modes


def study(scene: dict[str, Any], source: str, directory: Path, request: ModesRequest) -> ModesResult:
    """Compute modes and branches on all cores; branches of an earlier start are not computed again.

    Args:
        scene: plain data of the scene.
        source: its name in messages.
        directory: made if need be.
        request: what is asked for.

    Raises:
        InputError: the scene has no such modes, or the directory cannot be used.
        RunError: LAMMPS failed, and all but its table is written; or a process was killed.
    """
    problem = tangent.problem_of(scene, source)
    linear = modes_of(problem, source, linear_only=not request.modes)
    with STUDY.evaluating(directory) as values:
        computed = values([_branch_case(scene, source, linear, mode, request) for mode in request.modes])
        branches = [BranchOfMode(mode, data) for mode, data in zip(request.modes, computed, strict=True)]
        chosen = [] if deck.refusal(problem.system) else _checked(branches, request.lammps)
        result = ModesResult(problem, linear, branches, [])
        _write(directory, result, chosen)  # before LAMMPS, which may fail
        cases = [_check_case(scene, source, branch, number) for branch, number in chosen]
        lines = [
            _lammps_line(branch, number, value) for (branch, number), value in zip(chosen, values(cases), strict=True)
        ]
        if lines:
            STUDY.write(directory, {LAMMPS: (LammpsLine, lines)}, scale=problem.scale)
    return replace(result, checks=lines)


def _write(directory: Path, result: ModesResult, chosen: Sequence[tuple[BranchOfMode, int]]) -> None:
    """Write tables, arrays and figures, and decks that start on chosen states, given by their numbers."""
    tables: dict[str, Any] = {MODES: (LinearMode, result.modes())}
    if result.branches:
        tables[STATES] = (StateLine, result.states())
        tables[BIFURCATIONS] = (BifurcationLine, result.bifurcations())
    STUDY.remove_all_but(directory, (*tables, ARRAYS, DECKS))  # of an earlier start
    STUDY.write(directory, {**tables, ARRAYS: _arrays(result)}, figures(result), result.problem.scale)
    for branch, number in chosen:
        name = f"mode-{branch.mode + 1}-state-{number}"
        _write_deck(result.problem, directory / DECKS / name, branch.states[number - 1])


def _branch_case(
    scene: dict[str, Any], source: str, linear: LinearModes, mode: int, request: ModesRequest
) -> computations.Computation:
    arguments = {
        "plain": scene,
        "source": source,
        "mode": mode,
        "energy": request.energy,
        "points": request.points,
        "energies": list(request.energies),
        "bisections": BISECTIONS,
    }
    return computations.case(
        "workflow.plugins.modes.branches:computed", arguments, cost=1.0 / float(linear.frequency[mode])
    )


def _check_case(scene: dict[str, Any], source: str, branch: BranchOfMode, number: int) -> computations.Computation:
    state = branch.states[number - 1]
    arguments = {
        "plain": scene,
        "source": source,
        "mode": branch.mode,
        "state": state,
        "steps": branch.data["steps"],
    }
    return computations.case("workflow.plugins.modes.lammps_check:computed", arguments, cost=state["period"])


def _checked(branches: Sequence[BranchOfMode], limit: int | None) -> list[tuple[BranchOfMode, int]]:
    """States that LAMMPS is started on, with their numbers.

    Args:
        branches: of which all states, or those of given energies, ends of branches, and those behind bifurcations.
        limit: largest number of these; None for all states.
    """
    numbered = [
        (_ORDER[state["role"]], place, number)
        for place, branch in enumerate(branches)
        for number, state in enumerate(branch.states, 1)
        if limit is None or state["role"] != "branch" or number == len(branch.states)
    ]
    return [(branches[place], number) for _, place, number in sorted(sorted(numbered)[:limit], key=lambda x: x[1:])]


def _lammps_line(branch: BranchOfMode, number: int, value: dict[str, Any]) -> LammpsLine:
    coarse, fine = value["growth"] or (None, None)
    error = None if fine is None or coarse is None else max(abs(fine - coarse), value["fitted"][1])
    return LammpsLine(
        mode=branch.mode + 1,
        state=number,
        energy=branch.states[number - 1]["energy"],
        steps=value["steps"],
        velocity=value["velocity"][0],
        velocity_finer=value["velocity"][1],
        order=math.log2(value["velocity"][0] / value["velocity"][1]),
        distance=value["distance"][0],
        periods=value["periods"],
        later=value["later"],
        growth=None if error is None else fine,
        uncertainty=error,
        predicted=None if error is None else value["predicted"],
    )


def _write_deck(problem: Problem, directory: Path, state: dict[str, Any]) -> None:
    """Write the deck of a run of LAMMPS on a state."""
    directory.mkdir(parents=True, exist_ok=True)
    x, period = np.array(state["x"]), float(state["period"])
    steps = lammps_check.steps_per_period(problem, period)
    run = lammps_check.lammps_problem(problem, state["energy"], period, steps, lammps_check.PERIODS)
    for name, text in lammps_check.deck_files(run, x, np.zeros_like(x)).items():
        write_text(directory / name, text)


def _arrays(result: ModesResult) -> bytes:
    """Contents of a file of arrays: of each branch displacements [state, line, bead], periods and multipliers."""
    scale, arrays = result.problem.scale, {}
    for branch in result.branches:
        name, states = f"mode_{branch.mode + 1}", branch.states
        arrays[f"{name}_displacement"] = scale.measured(np.array([state["x"] for state in states]), "length")
        arrays[f"{name}_period"] = scale.measured(np.array([state["period"] for state in states]), "time")
        pairs = np.array([state["multipliers"] for state in states]).reshape(len(states), -1, 2)
        arrays[f"{name}_multipliers"] = pairs[..., 0] + 1j * pairs[..., 1]
    arrays["shapes"] = result.linear.shapes
    content = io.BytesIO()
    np.savez(content, **arrays)
    return content.getvalue()


# --- command ----------------------------------------------------------------------------------------------------------

ANSWERS = (
    "the linear modes, the periodic states with their stability, and LAMMPS's deviations from them; or the responses, "
    "changes of stability and LAMMPS's sweep"
)
DRAWS = True
EXAMPLES = (
    "modes precompressed -o modes --linear",
    "modes chain.yaml --mode 1,12 --energy 0.5 --at-energy 0.1,0.2 -o modes",
    "modes driven.yaml --frequencies 0.3,0.35 -o curve",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("scene", metavar="SCENE", help="the scene; its kicks, end, time step and output do not matter")
    parser.add_argument(
        "--mode",
        metavar="N,...",
        type=options.listed(int),
        help="numbers of the linear modes whose branches are followed (default the lowest and the highest)",
    )
    parser.add_argument(
        "--energy",
        metavar="E",
        type=options.within(float, 1e-300, 1e300),
        help="largest energy, in the scene's units (default that of its kicks)",
    )
    parser.add_argument(
        "--points",
        metavar="N",
        type=options.within(int, 2, 10_000),
        help=f"largest number of states of a branch (default {POINTS}; of responses {response_study.POINTS})",
    )
    parser.add_argument(
        "--at-energy", metavar="E,...", type=options.listed(float), default=(), help="further states, of these energies"
    )
    parser.add_argument("--linear", action="store_true", help="linear modes alone")
    lammps = parser.add_mutually_exclusive_group()
    lammps.add_argument("--no-lammps", action="store_true", help="do not start LAMMPS")
    lammps.add_argument(
        "--every-state",
        action="store_true",
        help=f"start LAMMPS on every state, not on {MOST_CHECKED} at most",
    )
    response_study.add_arguments(parser)
    options.add_output(parser)


def requested(arguments: argparse.Namespace, problem: Problem, linear: LinearModes) -> ModesRequest:
    """What the arguments ask for.

    Raises:
        InputError: there is no such mode, or another has its frequency, or an energy is above the largest.
    """
    scale, count, points = problem.scale, len(linear.frequency), arguments.points or POINTS
    energy = physics.energy(problem.system) if arguments.energy is None else arguments.energy / scale.energy
    energies = tuple(value / scale.energy for value in arguments.at_energy)
    for value, number in zip(energies, arguments.at_energy, strict=True):
        if not 0.0 < value <= energy * (1.0 + 1e-12):
            largest = scale.written(energy, "energy", ".6g")
            raise InputError(f"--at-energy: {number:g} given; above 0, and at most the largest energy, {largest}")
    alone = [mode for mode in range(count) if linear.alone(mode)]
    limit = 0 if arguments.no_lammps else None if arguments.every_state else MOST_CHECKED
    if arguments.linear:
        return ModesRequest((), energy, points, (), 0)
    if arguments.mode is None:
        if not alone:
            raise InputError("--mode: each linear mode shares its frequency with another; none can be followed alone")
        return ModesRequest(tuple(dict.fromkeys((alone[0], alone[-1]))), energy, points, energies, limit)
    for number in arguments.mode:
        if not 1 <= number <= count:
            raise InputError(f"--mode: {number} given; the scene has modes 1 to {count}")
        if number - 1 not in alone:
            reason = "has the frequency 0" if number <= linear.zeros else "has the frequency of another mode"
            raise InputError(f"--mode: {number} given; it {reason}, so that no branch of it alone can be followed")
    modes = tuple(dict.fromkeys(number - 1 for number in arguments.mode))
    return ModesRequest(modes, energy, points, energies, limit)


def execute(arguments: argparse.Namespace) -> screen.CommandResult:
    """Print the branches; exit code 1 where a mode has none, 130 when interrupted, with all computed branches kept."""
    name = arguments.scene
    scene = library.find(name)
    plain_scene = scene.plain()
    problem = tangent.problem_of(plain_scene, name)
    request_of_responses = response_study.requested(arguments, problem)
    if request_of_responses is not None:
        return response_study.execute(arguments, scene, request_of_responses)
    linear = modes_of(problem, name, linear_only=arguments.linear)
    request = requested(arguments, problem, linear)
    screen.print_heading(scene.name, scene.units)
    try:
        computed = study(plain_scene, name, arguments.output, request)
    except KeyboardInterrupt:
        return options.interrupted()
    _print(computed, request)
    figures = STUDY.figure_files if any(branch.states for branch in computed.branches) else ()
    names = [name for name in (*STUDY.tables, ARRAYS, DECKS) if (arguments.output / name).exists()]
    screen.print_files(arguments.output, (*names, *figures))
    return screen.CommandResult(0 if all(branch.states for branch in computed.branches) else 1, computed.plain())


def _print(computed: ModesResult, request: ModesRequest) -> None:
    """Print tables of the modes that were followed, given energies, bifurcations and LAMMPS's runs, and sentences."""
    scale, numbers = computed.problem.scale, {mode + 1 for mode in request.modes}
    shown = [line for line in computed.modes() if not numbers or line.mode in numbers]
    STUDY.print_records("linear modes", LinearMode, shown, scale)
    lines = computed.states()
    last = {branch.mode + 1: len(branch.states) for branch in computed.branches}
    ends = [line for line in lines if line.role == "energy" or line.state in (1, last[line.mode])]
    for title, kind, records in (
        ("periodic states: first, of given energies, and last", StateLine, ends),
        ("changes of stability", BifurcationLine, computed.bifurcations()),
        ("LAMMPS", LammpsLine, computed.checks),
    ):
        STUDY.print_records(title, kind, records, scale)
    for sentence in computed.sentences():
        print(sentence)
    if request.lammps != 0 and (why := deck.refusal(computed.problem.system)):
        print(f"LAMMPS is not started: {why}")
