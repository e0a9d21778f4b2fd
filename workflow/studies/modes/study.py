"""Linear modes of a scene, nonlinear normal modes and breathers, with their stability.

The scene is conservative: no damping, drive or push; its kicks do not matter, but for the velocity V. From its linear
modes, branches of periodic states are followed up to an energy; each state has its Floquet multipliers, and some are
checked by LAMMPS.

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
| cases.jsonl      | the cache of computed branches                                                      |
"""

import argparse
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis.loaded_pulse import bands
from analysis.quantity import declare, plain, result
from analysis.trajectory import Floats
from lammps_inputs import InputError, Problem, library, physics
from lammps_inputs.decks import deck
from lammps_inputs.units import Label
from workflow.formats import figure_files
from workflow.runs.files import write_bytes, write_text
from workflow.screen import CommandResult, print_files, print_heading
from workflow.studies.modes import lammps_check
from workflow.studies.modes.linear import (
    LinearModes,
    centre,
    free_atoms,
    free_to_drift,
    linear_modes,
    refuse_not_conservative,
)
from workflow.study_kit import options
from workflow.study_kit.directory import Study, print_records, to_csv
from workflow.study_kit.linearised import problem_of
from workflow.workers.evaluate import Computation, case

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from analysis.figures.periodic_states import BranchCurve

MODES, STATES, BIFURCATIONS, LAMMPS = "modes.csv", "states.csv", "bifurcations.csv", "lammps.csv"
ARRAYS, DECKS = "states.npz", "decks"
FIGURES = ("frequency", "shapes", "multipliers", "motion")
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

MOST_FREE, MOST_ATOMS = 600, 3000
"""Atoms up to which periodic states, and linear modes, are computed: with dense matrices."""

MOST_CHECKED = 12
"""States that LAMMPS is started on, at most."""

MOST_BRANCHES = 4
"""Branches that figures show, the first ones."""

_ORDER = {"energy": 0, "branch": 1, "bifurcation": 2}
"""Which states are checked first."""

_ROUNDING = 1e-13
"""Relative uncertainty of a frequency below which it is not stated: that of Newton's method."""

UNMEASURED = "the state is stable, or the growth is too slow or too fast to be measured"


@result
class LinearMode:
    """A linear mode."""

    mode: int = declare("number of the mode, by ascending frequency", digits="d")
    frequency: float = declare("angular frequency", "frequency", symbol="\\omega", digits=".8g")
    participation: float = declare(
        "participation number of the atoms' mean kinetic energies e, (sum e)^2 / sum e^2", digits=".4g"
    )
    bead: float = declare("mean number of the bead, weighted with these energies", digits=".4g")
    chain: float = declare("mean number of the chain, weighted with these energies", digits=".4g")


@result
class StateLine:
    """A periodic state."""

    mode: int = declare("number of the linear mode whose branch it is on", digits="d")
    state: int = declare("number of the state along the branch", digits="d")
    role: str = declare(
        "``branch``: a point of the continuation; ``energy``: of a given energy; ``bifurcation``: just behind one",
        digits="",
    )
    energy: float = declare("energy above rest", "energy", digits=".6g", symbol="E")
    frequency: float = declare("angular frequency", "frequency", digits=".8g", symbol="\\omega")
    residual: float = declare(
        "norm of the velocities at half a period over that of the start, both weighted as energies", digits=".1e"
    )
    multiplier: float = declare(
        "largest modulus of its Floquet multipliers, without the pair at 1 of its own motion", digits=".7g"
    )
    tolerance: float = declare("deviation of that modulus from 1 that errors can cause", digits=".1e")
    stable: str = declare(
        "``yes`` where no multiplier is outside the unit circle by more than that, or ``no``", digits=""
    )
    participation: float = declare(
        "participation number of the atoms' mean kinetic energies e, (sum e)^2 / sum e^2", digits=".4g"
    )
    bead: float = declare("mean number of the bead, weighted with these energies", digits=".4g")
    chain: float = declare("mean number of the chain, weighted with these energies")
    least_overlap: float = declare(
        "least overlap of neighbours over a period, at 33 times; negative where they are apart", "length", digits=".3g"
    )


@result
class BifurcationLine:
    """A change of stability along a branch."""

    mode: int = declare("number of the linear mode whose branch it is on", digits="d")
    kind: str = declare(
        "where the multipliers leave or enter the unit circle: ``+1``, ``-1``, ``collision`` (a pair elsewhere), or "
        "``fold`` (at 1, where the energy has an extremum)",
        digits="",
    )
    energy: float = declare("energy in the middle of the interval in which it is", "energy", digits=".6g")
    uncertainty: float = declare("half of that interval", "energy", digits=".1e")
    frequency: float = declare("angular frequency in the middle of the interval", "frequency", digits=".6g")
    before: int = declare("multipliers outside the unit circle before it", digits="d")
    after: int = declare("multipliers outside the unit circle after it", digits="d")


@result
class LammpsLine:
    """LAMMPS started on a periodic state."""

    mode: int = declare("number of the linear mode whose branch the state is on", digits="d")
    state: int = declare("number of the state along the branch", digits="d")
    energy: float = declare("energy above rest", "energy", digits=".6g")
    steps: int = declare("steps of LAMMPS in a period", digits="d")
    velocity: float = declare("norm of the velocities after a period", "velocity", digits=".3g")
    velocity_finer: float = declare("the same with twice the steps", "velocity", digits=".3g")
    order: float = declare("binary logarithm of their ratio; the scheme's order is 2", digits=".3f")
    distance: float = declare("distance from the start after a period", "length", digits=".2g")
    periods: int = declare("periods that were run", digits="d")
    later: float | None = declare(
        "distance from the start after these", "length", "the state is unstable", digits=".2g"
    )
    growth: float | None = declare(
        "rate at which a small deviation along the unstable direction grows, with twice the steps",
        "rate",
        UNMEASURED,
        digits=".6g",
    )
    uncertainty: float | None = declare(
        "the larger of its standard error and its difference from the rate with the steps",
        "rate",
        UNMEASURED,
        digits=".1e",
    )
    predicted: float | None = declare(
        "logarithm of the largest multiplier over the period", "rate", UNMEASURED, digits=".6g"
    )


@dataclass(frozen=True)
class BranchOfMode:
    """A branch, as it was computed.

    Attributes:
        mode: number of the linear mode, from 0.
        data: see `workflow.studies.modes.branches.computed`.
    """

    mode: int
    data: dict[str, Any]

    @property
    def states(self) -> list[dict[str, Any]]:
        """Plain data of the states, in order."""
        states: list[dict[str, Any]] = self.data["states"]
        return states


@dataclass(frozen=True)
class ModesRequest:
    """What is asked for, dimensionless.

    Attributes:
        modes: numbers of the linear modes whose branches are followed, from 0; none for linear modes alone.
        energy: largest energy, in units of m V^2.
        points: largest number of states of a branch.
        energies: of further states, in units of m V^2.
        lammps: whether LAMMPS is started on some of the states.
    """

    modes: tuple[int, ...]
    energy: float
    points: int
    energies: tuple[float, ...]
    lammps: bool


@dataclass(frozen=True)
class ModesResult:
    """Linear modes and branches of a scene."""

    problem: Problem
    linear: LinearModes
    branches: list[BranchOfMode]
    checks: list[LammpsLine]

    def modes(self) -> list[LinearMode]:
        """All linear modes."""
        chains = self.problem.chains
        return [
            LinearMode(number, float(frequency), *centre(energies, chains))
            for number, (frequency, energies) in enumerate(
                zip(self.linear.frequency, self.linear.energies, strict=True), 1
            )
        ]

    def states(self) -> list[StateLine]:
        """States of all branches."""
        lines = []
        for branch in self.branches:
            for number, state in enumerate(branch.states, 1):
                participation, bead, chain = centre(np.array(state["kinetic"]), self.problem.chains)
                lines.append(
                    StateLine(
                        mode=branch.mode + 1,
                        state=number,
                        role=state["role"],
                        energy=state["energy"],
                        frequency=2.0 * math.pi / state["period"],
                        residual=state["residual"],
                        multiplier=state["largest"],
                        tolerance=state["tolerance"],
                        stable="yes" if state["stable"] else "no",
                        participation=participation,
                        bead=bead,
                        chain=chain,
                        least_overlap=state["least_overlap"],
                    )
                )
        return lines

    def bifurcations(self) -> list[BifurcationLine]:
        """Changes of stability of all branches."""
        lines = []
        for branch in self.branches:
            for change in branch.data["bifurcations"]:
                (low, high), periods = change["energies"], change["periods"]
                frequency = 4.0 * math.pi / sum(periods)
                middle, half = 0.5 * (low + high), 0.5 * abs(high - low)
                lines.append(
                    BifurcationLine(branch.mode + 1, change["kind"], middle, half, frequency, *change["outside"])
                )
        return lines

    def sentences(self) -> list[str]:
        """What came out, in sentences: bands, and each branch."""
        scale, lines = self.problem.scale, []
        if self.linear.zeros:
            lines.append(f"linear modes of the frequency 0: {self.linear.zeros} of {len(self.linear.frequency)}")
        edges = bands(self.problem.system)
        if edges is not None:
            texts = [" to ".join(f"{scale.measured(end, 'frequency'):.6g}" for end in band) for band in edges]
            lines.append(f"small waves of an infinite chain have frequencies from {', and from '.join(texts[:6])}")
        for branch in self.branches:
            lines += self._of_branch(branch)
        return lines

    def _of_branch(self, branch: BranchOfMode) -> list[str]:
        scale, number = self.problem.scale, branch.mode + 1
        if not branch.states:
            return [f"mode {number} has no branch: {branch.data['why']}"]
        last = branch.states[-1]
        energy = scale.written(last["energy"], "energy", ".6g")
        frequency = scale.written(2.0 * math.pi / last["period"], "frequency", ".9g")
        start = scale.written(float(self.linear.frequency[branch.mode]), "frequency", ".9g")
        uncertainty = branch.data["uncertainty"]
        error = ""
        if uncertainty is not None:
            change = max(uncertainty, _ROUNDING) * 2.0 * math.pi / last["period"]
            error = f" +- {scale.measured(change, 'frequency'):.0e}"
        line = (
            f"the branch of mode {number} (linear frequency {start}) has the frequency {frequency}{error} "
            f"at the energy {energy}; {branch.data['steps']} steps a period"
        )
        unstable = sum(not state["stable"] for state in branch.states)
        words = "all" if not unstable else f"{len(branch.states) - unstable} of"
        lines = [line, f"{words} {len(branch.states)} states of this branch are stable"]
        if branch.data["why"]:
            lines.append(f"the branch of mode {number} ends there: {branch.data['why']}")
        return lines

    def plain(self) -> dict[str, Any]:
        """Plain data of the result in the scene's units, for scripts."""
        scale = self.problem.scale
        return {
            "modes": plain(self.modes(), scale),
            "states": plain(self.states(), scale),
            "bifurcations": plain(self.bifurcations(), scale),
            "lammps": plain(self.checks, scale),
        }


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
        RunError: LAMMPS failed, or a process was killed.
    """
    problem = problem_of(scene, source)
    linear = modes_of(problem, source, linear_only=not request.modes)
    with STUDY.evaluating(directory) as values:
        computed = values([_branch_case(scene, source, linear, mode, request) for mode in request.modes])
        branches = [BranchOfMode(mode, data) for mode, data in zip(request.modes, computed, strict=True)]
        chosen = _checked(branches) if request.lammps and not deck.refusal(problem.system) else []
        cases = [_check_case(scene, source, branch, number) for branch, number in chosen]
        lines = [
            _lammps_line(branch, number, value) for (branch, number), value in zip(chosen, values(cases), strict=True)
        ]
        found = ModesResult(problem, linear, branches, lines)
        scale = problem.scale
        tables = {
            MODES: to_csv(LinearMode, found.modes(), scale),
            STATES: to_csv(StateLine, found.states(), scale),
            BIFURCATIONS: to_csv(BifurcationLine, found.bifurcations(), scale),
            LAMMPS: to_csv(LammpsLine, lines, scale),
        }
        STUDY.write(directory, tables, _figures(found))
        write_bytes(directory / ARRAYS, _arrays(found))
        for branch, number in chosen:
            _write_deck(
                problem, directory / DECKS / f"mode-{branch.mode + 1}-state-{number}", branch.states[number - 1]
            )
    return found


def _branch_case(
    scene: dict[str, Any], source: str, linear: LinearModes, mode: int, request: ModesRequest
) -> Computation:
    arguments = {
        "plain": scene,
        "source": source,
        "mode": mode,
        "energy": request.energy,
        "points": request.points,
        "energies": list(request.energies),
        "bisections": BISECTIONS,
    }
    return case("workflow.studies.modes.branches:computed", arguments, cost=1.0 / float(linear.frequency[mode]))


def _check_case(scene: dict[str, Any], source: str, branch: BranchOfMode, number: int) -> Computation:
    state = branch.states[number - 1]
    arguments = {
        "plain": scene,
        "source": source,
        "mode": branch.mode,
        "state": state,
        "steps": branch.data["steps"],
    }
    return case("workflow.studies.modes.lammps_check:computed", arguments, cost=state["period"])


def _checked(branches: Sequence[BranchOfMode]) -> list[tuple[BranchOfMode, int]]:
    """States that LAMMPS is started on, with their numbers: those of given energies, ends of branches, bifurcations."""
    chosen = [
        (_ORDER[state["role"]], place, number)
        for place, branch in enumerate(branches)
        for number, state in enumerate(branch.states, 1)
        if state["role"] != "branch" or number == len(branch.states)
    ]
    return [
        (branches[place], number) for _, place, number in sorted(sorted(chosen)[:MOST_CHECKED], key=lambda x: x[1:])
    ]


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


def _arrays(found: ModesResult) -> bytes:
    """Contents of a file of arrays: of each branch displacements [state, line, bead], periods and multipliers."""
    scale, arrays = found.problem.scale, {}
    for branch in found.branches:
        name, states = f"mode_{branch.mode + 1}", branch.states
        arrays[f"{name}_displacement"] = scale.measured(np.array([state["x"] for state in states]), "length")
        arrays[f"{name}_period"] = scale.measured(np.array([state["period"] for state in states]), "time")
        pairs = np.array([state["multipliers"] for state in states]).reshape(len(states), -1, 2)
        arrays[f"{name}_multipliers"] = pairs[..., 0] + 1j * pairs[..., 1]
    arrays["shapes"] = found.linear.shapes
    content = io.BytesIO()
    np.savez(content, **arrays)
    return content.getvalue()


def _figures(found: ModesResult) -> "dict[str, Figure]":
    """Figures of the first branches; none without branches."""
    from analysis.figures import periodic_states  # matplotlib takes half a second to import

    curves = [_curve(found, branch) for branch in found.branches if branch.states][:MOST_BRANCHES]
    if not curves:
        return {}
    scale, name = found.problem.scale, found.problem.name
    energy, frequency = (
        Label("energy", "E", scale.symbol("energy")),
        Label("angular frequency", "\\omega", scale.symbol("frequency")),
    )
    displacement, time = Label("displacement", "x", scale.symbol("length")), Label("time", "t", scale.symbol("time"))
    edges = bands(found.problem.system)
    measured = scale.measured(np.zeros(0) if edges is None else np.unique(edges), "frequency")
    return {
        FIGURES[0]: periodic_states.frequency_figure(curves, measured, (energy, frequency), name),
        FIGURES[1]: periodic_states.shape_figure(curves, name),
        FIGURES[2]: periodic_states.multiplier_figure(curves, name),
        FIGURES[3]: periodic_states.motion_figure(curves, (displacement, time), name),
    }


def _curve(found: ModesResult, branch: BranchOfMode) -> "BranchCurve":
    from analysis.figures.periodic_states import BranchCurve

    scale, states = found.problem.scale, branch.states
    last = [state for state in states if state["role"] == "branch"][-1]
    pairs = np.array(last["multipliers"]).reshape(-1, 2)
    half = np.array(branch.data["motion"])
    changes: list[tuple[float, float]] = [
        (scale.measured(line.energy, "energy"), scale.measured(line.frequency, "frequency"))
        for line in found.bifurcations()
        if line.mode == branch.mode + 1
    ]
    return BranchCurve(
        name=f"mode {branch.mode + 1}",
        energy=scale.measured(_floats(states, "energy"), "energy"),
        frequency=scale.measured(2.0 * np.pi / _floats(states, "period"), "frequency"),
        stable=np.array([state["stable"] for state in states]),
        bifurcations=np.array(changes).reshape(-1, 2),
        linear=found.linear.shapes[branch.mode],
        last=np.array(last["x"]),
        multipliers=pairs[:, 0] + 1j * pairs[:, 1],
        motion=scale.measured(np.concatenate([half, half[-2::-1]]), "length"),
        period=scale.measured(float(last["period"]), "time"),
        chains=found.problem.chains,
    )


def _floats(states: Sequence[dict[str, Any]], key: str) -> Floats:
    return np.array([state[key] for state in states], dtype=np.float64)


# --- command ----------------------------------------------------------------------------------------------------------

ANSWERS = "the linear modes, the periodic states with their stability, and LAMMPS's deviations from them"
DRAWS = True
EXAMPLES = (
    "modes precompressed -o modes --linear",
    "modes chain.yaml --mode 1,12 --energy 0.5 --at-energy 0.1,0.2 -o modes",
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
        default=POINTS,
        help=f"largest number of states of a branch (default {POINTS})",
    )
    parser.add_argument(
        "--at-energy", metavar="E,...", type=options.listed(float), default=(), help="further states, of these energies"
    )
    parser.add_argument("--linear", action="store_true", help="linear modes alone")
    parser.add_argument("--no-lammps", action="store_true", help="do not start LAMMPS on states")
    options.add_output(parser)


def _requested(arguments: argparse.Namespace, problem: Problem, linear: LinearModes) -> ModesRequest:
    """What the arguments ask for.

    Raises:
        InputError: there is no such mode, or another has its frequency, or an energy is above the largest.
    """
    scale, count = problem.scale, len(linear.frequency)
    energy = physics.energy(problem.system) if arguments.energy is None else arguments.energy / scale.energy
    energies = tuple(value / scale.energy for value in arguments.at_energy)
    for value, given in zip(energies, arguments.at_energy, strict=True):
        if not 0.0 < value <= energy * (1.0 + 1e-12):
            largest = scale.written(energy, "energy", ".6g")
            raise InputError(f"--at-energy: {given:g} given; above 0, and at most the largest energy, {largest}")
    alone = [mode for mode in range(count) if linear.alone(mode)]
    if arguments.linear:
        return ModesRequest((), energy, arguments.points, (), lammps=False)
    if arguments.mode is None:
        if not alone:
            raise InputError("--mode: each linear mode shares its frequency with another; none can be followed alone")
        return ModesRequest(
            tuple(dict.fromkeys((alone[0], alone[-1]))), energy, arguments.points, energies, not arguments.no_lammps
        )
    for number in arguments.mode:
        if not 1 <= number <= count:
            raise InputError(f"--mode: {number} given; the scene has modes 1 to {count}")
        if number - 1 not in alone:
            reason = "has the frequency 0" if number <= linear.zeros else "has the frequency of another mode"
            raise InputError(f"--mode: {number} given; it {reason}, so that no branch of it alone can be followed")
    modes = tuple(dict.fromkeys(number - 1 for number in arguments.mode))
    return ModesRequest(modes, energy, arguments.points, energies, not arguments.no_lammps)


def execute(arguments: argparse.Namespace) -> CommandResult:
    """Print the branches; exit code 1 where a mode has none, 130 when interrupted, with all computed branches kept."""
    name = arguments.scene
    scene = library.find(name)
    plain_scene = scene.plain()
    problem = problem_of(plain_scene, name)
    linear = modes_of(problem, name, linear_only=arguments.linear)
    request = _requested(arguments, problem, linear)
    print_heading(scene.name, scene.units)
    try:
        found = study(plain_scene, name, arguments.output, request)
    except KeyboardInterrupt:
        return options.interrupted()
    _print(found, request)
    figures = figure_files(*FIGURES) if any(branch.states for branch in found.branches) else ()
    decks = (DECKS,) if found.checks else ()
    print_files(arguments.output, (MODES, STATES, BIFURCATIONS, LAMMPS, ARRAYS, *decks, *figures))
    return CommandResult(0 if all(branch.states for branch in found.branches) else 1, found.plain())


def _print(found: ModesResult, request: ModesRequest) -> None:
    """Print tables of the modes that were followed, given energies, bifurcations and LAMMPS's runs, and sentences."""
    scale, numbers = found.problem.scale, {mode + 1 for mode in request.modes}
    shown = [line for line in found.modes() if not numbers or line.mode in numbers]
    print_records("linear modes", LinearMode, shown, scale)
    lines = found.states()
    last = {branch.mode + 1: len(branch.states) for branch in found.branches}
    ends = [line for line in lines if line.role == "energy" or line.state in (1, last[line.mode])]
    for title, kind, records in (
        ("periodic states: first, of given energies, and last", StateLine, ends),
        ("changes of stability", BifurcationLine, found.bifurcations()),
        ("LAMMPS", LammpsLine, found.checks),
    ):
        if records:
            print_records(title, kind, records, scale)
    for sentence in found.sentences():
        print(sentence)
    if request.lammps and (why := deck.refusal(found.problem.system)):
        print(f"LAMMPS is not started: {why}")
