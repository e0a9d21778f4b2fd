"""Frequency-response curve of a driven, damped scene: plan, tables, figure and what is printed.

Frequencies are those of the drive, in cycles per unit time, as the scene has them.
"""

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from granchain import InputError, Scene
from granchain.parts import Floats, Problem, Study, computations, deck, options, panels, screen, units
from workflow.plugins.derivatives import tangent
from workflow.plugins.modes import driven
from workflow.plugins.modes.linear import MOST_FREE
from workflow.plugins.modes.response_tables import ResponseBifurcation, ResponseLine, ResponseResult, SweepLine

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RESPONSES, BIFURCATIONS, SWEEP, FIGURE = "responses.csv", "bifurcations.csv", "sweep.csv", "response"
TABLES = RESPONSES, BIFURCATIONS, SWEEP
STUDY = Study("modes", f"{RESPONSES} is the table", tables=TABLES, figures=(FIGURE,), cache="cases.jsonl")

POINTS, STEPS = 400, 12
"""Default largest number of responses of the curve, and of frequencies of LAMMPS's sweep."""

BISECTIONS = 10
"""Halvings of the interval of a bifurcation."""


@dataclass(frozen=True)
class ResponseRequest:
    """What is asked for.

    Attributes:
        ends: lowest and highest frequency of the drive, in cycles per T.
        points: largest number of responses of the curve.
        place: chain and bead whose amplitude is stated, from 1; None for that of the largest.
        steps: frequencies of LAMMPS's sweep; 0 for none.
    """

    ends: tuple[float, float]
    points: int
    place: tuple[int, int] | None
    steps: int

    @property
    def periods(self) -> list[float]:
        """Periods of the sweep, from the lowest frequency to the highest, in units of T."""
        return [1.0 / float(frequency) for frequency in np.linspace(*self.ends, self.steps)]


def refuse_unusable(problem: Problem, source: str, request: ResponseRequest) -> None:
    """Refuse a scene without responses, and a bead that is none.

    Raises:
        InputError: see `workflow.plugins.modes.driven.refuse_no_response`; or there are too many atoms, or no bead
            that is free to move at the place.
    """
    moving = driven.moving_atoms(problem.system)
    if np.count_nonzero(moving) > MOST_FREE:
        raise InputError(f"{source}: {np.count_nonzero(moving)} atoms; at most {MOST_FREE} for responses")
    driven.refuse_no_response(problem, source)
    if request.place is not None:
        chain, bead = request.place
        if not (1 <= chain <= problem.chains and 1 <= bead <= problem.beads and moving[chain - 1, bead - 1]):
            raise InputError(f"--bead: chain {chain}, bead {bead} given; a bead of the scene whose motion is not given")


def study(scene: dict[str, Any], source: str, directory: Path, request: ResponseRequest) -> ResponseResult:
    """Compute the curve of responses and LAMMPS's sweep; what an earlier start computed is not computed again.

    Args:
        scene: plain data of the scene.
        source: its name in messages.
        directory: made if need be.
        request: what is asked for.

    Raises:
        InputError: the directory cannot be used.
        RunError: LAMMPS failed, and the curve is written; or a process was killed.
    """
    problem = tangent.problem_of(scene, source)
    sweeping = bool(request.steps) and not deck.refusal(problem.system)
    arguments = {
        "plain": scene,
        "source": source,
        "periods": [1.0 / end for end in request.ends],
        "points": request.points,
        "further": request.periods if sweeping else [],
        "bisections": BISECTIONS,
    }
    with STUDY.evaluating(directory) as values:
        [data] = values(
            [computations.case("workflow.plugins.modes.response:computed", arguments, cost=1.0)], of=1 + sweeping
        )
        curve = ResponseResult(problem, request.place or _largest(problem, data), data, [])
        _write(directory, curve)  # before LAMMPS, which may fail
        if sweeping and data["states"]:
            energy = max(state["energy"] for state in data["states"])
            sweep_arguments = {
                "plain": scene,
                "source": source,
                "periods": request.periods,
                "energy": energy,
                "decay": driven.slowest_decay(problem, source),
            }
            [sweep] = values(
                [computations.case("workflow.plugins.modes.lammps_sweep:computed", sweep_arguments, cost=1.0)]
            )
            curve = replace(curve, sweep=sweep)
            _write(directory, curve)
    return curve


def _write(directory: Path, curve: ResponseResult) -> None:
    """Write tables, and the figure where there are responses."""
    tables: dict[str, Any] = {
        RESPONSES: (ResponseLine, curve.responses()),
        BIFURCATIONS: (ResponseBifurcation, curve.bifurcations()),
        SWEEP: (SweepLine, curve.steps()),
    }
    STUDY.write(directory, tables, {FIGURE: _figure(curve)} if curve.data["states"] else {}, curve.problem.scale)


def _largest(problem: Problem, data: dict[str, Any]) -> tuple[int, int]:
    """Chain and bead, from 1, of the largest speed of all responses, among beads that are free to move."""
    speeds = [state["speed"] for state in data["states"]] or [np.zeros((problem.chains, problem.beads))]
    size = (np.max(speeds, axis=0) * driven.moving_atoms(problem.system))[: problem.chains]
    chain, bead = np.unravel_index(int(np.argmax(size)), size.shape)
    return int(chain) + 1, int(bead) + 1


def _figure(curve: ResponseResult) -> "Figure":
    from workflow.plugins.modes import branch_figures

    scale, lines, changes = curve.problem.scale, curve.responses(), curve.bifurcations()

    def points(records: Sequence[Any]) -> Floats:
        """Frequency and amplitude of lines, [line, 2]."""
        pairs = [
            (scale.measured(each.frequency, "cycles"), scale.measured(each.amplitude, "velocity")) for each in records
        ]
        return np.array(pairs, dtype=np.float64).reshape(-1, 2)

    marked = {
        "fold": points([change for change in changes if change.kind == "fold"]),
        "other change of stability": points([change for change in changes if change.kind != "fold"]),
    }
    marked |= {
        f"LAMMPS, sweep {name}": points([step for step in curve.steps() if step.direction == name])
        for name in ("up", "down")
    }
    labels = (
        units.Label("drive frequency", "f", scale.symbol("cycles")),
        units.Label(f"largest speed of bead {curve.place[1]} of chain {curve.place[0]}", "", scale.symbol("velocity")),
    )
    stable = np.array([line.stable == "yes" for line in lines])
    return branch_figures.response_figure(points(lines), stable, marked, labels, panels.title(curve.problem))


# --- command ----------------------------------------------------------------------------------------------------------


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command that are of responses."""
    parser.add_argument(
        "--frequencies",
        metavar="LOW,HIGH",
        type=options.listed(float),
        help="of a driven, damped scene: its responses from one frequency of the drive to another, in cycles per unit "
        "time of the scene, as `drive.frequency`",
    )
    parser.add_argument(
        "--bead",
        metavar="CHAIN,BEAD",
        type=options.listed(int),
        help="bead whose largest speed is the amplitude of responses (default that of the largest)",
    )
    parser.add_argument(
        "--sweep",
        metavar="N",
        type=options.within(int, 2, 1000),
        help=f"frequencies of the sweep in LAMMPS, up and down (default {STEPS})",
    )


def requested(arguments: argparse.Namespace, problem: Problem) -> ResponseRequest | None:
    """What the arguments ask for of a driven scene; None where they ask for modes.

    Raises:
        InputError: the range of frequencies is none, or options of the two do not go together.
    """
    modes = {"--mode": arguments.mode, "--energy": arguments.energy, "--at-energy": arguments.at_energy}
    modes["--linear"] = arguments.linear
    frequencies = arguments.frequencies
    others = {"--bead": arguments.bead, "--sweep": arguments.sweep} if frequencies is None else modes
    for option, value in others.items():
        if value:
            reason = "belongs to" if frequencies is None else "does not go with"
            raise InputError(f"{option}: {reason} `--frequencies`, the responses of a driven scene")
    if frequencies is None:
        return None
    if len(frequencies) != 2 or not 0.0 < frequencies[0] < frequencies[1] < math.inf:
        text = ",".join(f"{value:g}" for value in frequencies)
        raise InputError(f"--frequencies: {text} given; LOW,HIGH with 0 < LOW < HIGH, such as 0.1,0.3")
    if arguments.bead is not None and len(arguments.bead) != 2:
        raise InputError(f"--bead: {len(arguments.bead)} numbers given; CHAIN,BEAD, such as 1,2")
    low, high = (float(value * problem.scale.time) for value in frequencies)
    steps = 0 if arguments.no_lammps else arguments.sweep or STEPS
    return ResponseRequest((low, high), arguments.points or POINTS, arguments.bead, steps)


def execute(arguments: argparse.Namespace, scene: Scene, request: ResponseRequest) -> screen.CommandResult:
    """Print the responses; exit code 1 where there are none, 130 when interrupted."""
    plain_scene, name = scene.plain(), arguments.scene
    refuse_unusable(tangent.problem_of(plain_scene, name), name, request)
    screen.print_heading(scene.name, scene.units)
    try:
        curve = study(plain_scene, name, arguments.output, request)
    except KeyboardInterrupt:
        return options.interrupted()
    scale = curve.problem.scale
    for title, kind, records in (
        ("changes of stability", ResponseBifurcation, curve.bifurcations()),
        ("LAMMPS, sweep of the frequency", SweepLine, curve.steps()),
    ):
        STUDY.print_records(title, kind, records, scale)
    for sentence in curve.sentences():
        print(sentence)
    if request.steps and (why := deck.refusal(curve.problem.system)):
        print(f"LAMMPS is not started: {why}")
    figures = STUDY.figure_files if curve.data["states"] else ()
    screen.print_files(arguments.output, (*TABLES, *figures))
    return screen.CommandResult(0 if curve.data["states"] else 1, curve.plain())
