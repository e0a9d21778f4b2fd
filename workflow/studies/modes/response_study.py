"""Frequency-response curve of a driven, damped scene: plan, tables, figure and what is printed.

Frequencies are those of the drive, in cycles per unit time, as the scene has them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis.quantity import declare, plain, result
from analysis.trajectory import Floats
from lammps_inputs import InputError, Problem
from lammps_inputs.decks import deck
from lammps_inputs.units import Label
from workflow.formats import figure_files
from workflow.screen import CommandResult, print_files
from workflow.studies.modes import response
from workflow.study_kit.directory import Study, print_records, to_csv
from workflow.study_kit.linearised import problem_of
from workflow.workers.evaluate import case

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RESPONSES, BIFURCATIONS, SWEEP, FIGURE = "responses.csv", "bifurcations.csv", "sweep.csv", "response"
TABLES = RESPONSES, BIFURCATIONS, SWEEP
STUDY = Study("modes", f"{RESPONSES} is the table", tables=TABLES, figures=(FIGURE,), cache="cases.jsonl")

POINTS, STEPS = 400, 12
"""Default largest number of responses of the curve, and of frequencies of LAMMPS's sweep."""

BISECTIONS = 10
"""Halvings of the interval of a bifurcation."""

MOST_FREE = 600
"""Atoms up to which responses are computed, with dense matrices."""

UNMATCHED = "no stable response of the curve has this frequency"


@result
class ResponseLine:
    """A periodic response."""

    response: int = declare("number of the response along the curve", digits="d")
    role: str = declare(
        "``branch``: a point of the continuation; ``frequency``: of one of the sweep; ``bifurcation``: just behind one",
        digits="",
    )
    frequency: float = declare("frequency of the drive, in cycles per unit time", "cycles", symbol="f", digits=".8g")
    amplitude: float = declare("largest speed of the chosen bead over a period", "velocity", digits=".6g")
    multiplier: float = declare("largest modulus of the Floquet multipliers", digits=".6g")
    stable: str = declare("``yes`` where all multipliers are inside the unit circle, or ``no``", digits="")
    residual: float = declare(
        "change of displacements, times the middle angular frequency, and velocities by a period, over their norm",
        digits=".1e",
    )
    least_overlap: float = declare(
        "least overlap of neighbours over a period, at 64 times; negative where they are apart", "length", digits=".3g"
    )


@result
class ResponseBifurcation:
    """A change of stability along the response curve."""

    kind: str = declare(
        "``fold`` (multiplier 1, where the curve turns back), ``+1`` (elsewhere), ``-1`` (period doubling) or "
        "``Neimark-Sacker`` (a pair elsewhere on the unit circle)",
        digits="",
    )
    frequency: float = declare("frequency of the drive there, in cycles per unit time", "cycles", digits=".8g")
    uncertainty: float = declare(
        "of the interval in which it is, and the change by twice the steps", "cycles", digits=".1e"
    )
    amplitude: float = declare("largest speed of the chosen bead there", "velocity", digits=".5g")
    before: int = declare("multipliers outside the unit circle before it", digits="d")
    after: int = declare("multipliers outside the unit circle after it", digits="d")


@result
class SweepLine:
    """A step of the sweep in LAMMPS."""

    direction: str = declare("``up`` or ``down``", digits="")
    frequency: float = declare("frequency of the drive, in cycles per unit time", "cycles", digits=".8g")
    periods: int = declare("periods that were run", digits="d")
    amplitude: float = declare("largest speed of the chosen bead in the last period", "velocity", digits=".6g")
    change: float = declare("change of the state by the last period, over its norm", digits=".1e")
    response: int | None = declare(
        "number of the stable response of this frequency whose amplitudes are nearest", "", UNMATCHED, digits="d"
    )
    deviation: float | None = declare(
        "relative deviation of the amplitude from that response's", "", UNMATCHED, digits=".1e"
    )


@result
class Jump:
    """A jump of LAMMPS's sweep from one piece of the curve, between folds, to another."""

    direction: str = declare("``up`` or ``down``")
    branch: str = declare("``upper`` or ``lower``: the piece that it leaves has the larger or smaller amplitude")
    before: float = declare("last frequency before the jump", "cycles")
    after: float = declare("first frequency after the jump", "cycles")
    fold: float = declare("frequency of the nearer fold at which the piece ends", "cycles")


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


@dataclass(frozen=True)
class ResponseResult:
    """Curve of responses, and LAMMPS's sweep.

    Attributes:
        problem: of the scene.
        place: chain and bead of the amplitudes, from 1.
        data: see `workflow.studies.modes.response.computed`.
        sweep: see `workflow.studies.modes.lammps_sweep.computed`.
    """

    problem: Problem
    place: tuple[int, int]
    data: dict[str, Any]
    sweep: list[dict[str, Any]]

    def amplitudes(self, states: Sequence[dict[str, Any]]) -> Floats:
        """Largest speed of the chosen bead, [state], in units of V."""
        return np.array([state["speed"][self.place[0] - 1][self.place[1] - 1] for state in states], dtype=np.float64)

    def responses(self) -> list[ResponseLine]:
        """All responses, in order along the curve."""
        states = self.data["states"]
        return [
            ResponseLine(
                response=number,
                role=state["role"],
                frequency=1.0 / state["period"],
                amplitude=amplitude,
                multiplier=state["largest"],
                stable="yes" if state["stable"] else "no",
                residual=state["residual"],
                least_overlap=state["least_overlap"],
            )
            for number, (state, amplitude) in enumerate(zip(states, self.amplitudes(states).tolist(), strict=True), 1)
        ]

    def bifurcations(self) -> list[ResponseBifurcation]:
        """Changes of stability, in order along the curve."""
        states = self.data["states"]
        places, amplitudes = [state["place"] for state in states], self.amplitudes(states)
        return [
            ResponseBifurcation(
                change["kind"],
                change["frequency"],
                change["uncertainty"],
                float(np.interp(change["place"], places, amplitudes)),
                *change["outside"],
            )
            for change in self.data["bifurcations"]
        ]

    def matched(self) -> list[int | None]:
        """Position of the stable response nearest to each step of the sweep; None where there is none."""
        states = self.data["states"]
        nearest: list[int | None] = []
        for step in self.sweep:
            distance = {
                number: float(np.linalg.norm(np.subtract(state["speed"], step["speed"])))
                for number, state in enumerate(states)
                if state["stable"] and abs(state["period"] / step["period"] - 1.0) <= response.SAME
            }
            nearest.append(min(distance, key=distance.__getitem__, default=None))
        return nearest

    def steps(self) -> list[SweepLine]:
        """Steps of the sweep, in order."""
        states, lines = self.data["states"], []
        for step, number in zip(self.sweep, self.matched(), strict=True):
            amplitude = float(self.amplitudes([step])[0])
            deviation = None if number is None else amplitude / float(self.amplitudes([states[number]])[0]) - 1.0
            lines.append(
                SweepLine(
                    direction=step["direction"],
                    frequency=1.0 / step["period"],
                    periods=step["periods"],
                    amplitude=amplitude,
                    change=step["change"],
                    response=None if number is None else number + 1,
                    deviation=deviation,
                )
            )
        return lines

    def jumps(self) -> list[Jump]:
        """Jumps of the sweep between pieces of the curve."""
        folds = [change for change in self.data["bifurcations"] if change["kind"] == "fold"]
        jumps = []
        for (early, first), (late, second) in pairwise(zip(self.steps(), self.matched(), strict=True)):
            if early.direction != late.direction or first is None or second is None:
                continue
            places = [self.data["states"][number]["place"] for number in (first, second)]
            pieces = [sum(fold["place"] <= place for fold in folds) for place in places]
            if pieces[0] != pieces[1]:
                middle = 0.5 * (early.frequency + late.frequency)
                ends = [fold["frequency"] for fold in folds[max(0, pieces[0] - 1) : pieces[0] + 1]]
                branch = "upper" if early.amplitude > late.amplitude else "lower"
                nearer = min(ends, key=lambda frequency: abs(frequency - middle))
                jumps.append(Jump(early.direction, branch, early.frequency, late.frequency, nearer))
        return jumps

    def sentences(self) -> list[str]:
        """What came out, in sentences."""
        scale, states = self.problem.scale, self.data["states"]
        if not states:
            return [f"there is no curve: {self.data['why']}"]

        def frequency(value: float, digits: str = ".6g") -> str:
            return scale.written(value, "cycles", digits)

        amplitudes = self.amplitudes(states)
        top = int(np.argmax(amplitudes))
        lines = [
            f"f is the frequency of the drive in cycles per unit time; amplitudes are largest speeds of bead "
            f"{self.place[1]} of chain {self.place[0]}",
            f"the largest amplitude is {scale.written(float(amplitudes[top]), 'velocity')} at f = "
            f"{frequency(1.0 / states[top]['period'])}; {self.data['steps']} steps a period",
            f"{sum(not state['stable'] for state in states)} of {len(states)} responses are unstable",
        ]
        if self.data["uncertainty"] is not None:
            lines[1] += f", twice as many change this f, and those of folds, by {self.data['uncertainty']:.0e} of it"
        if self.data["why"]:
            lines.append(f"the curve ends at f = {frequency(1.0 / states[-1]['period'])}: {self.data['why']}")
        lines += [
            f"sweeping {jump.direction}, LAMMPS jumps from the {jump.branch} branch between f = "
            f"{frequency(jump.before)} and {frequency(jump.after)} (fold at f = {frequency(jump.fold)})"
            for jump in self.jumps()
        ]
        if self.sweep and not self.jumps():
            lines.append("LAMMPS does not jump")
        return lines

    def plain(self) -> dict[str, Any]:
        """Plain data of the result in the scene's units, for scripts."""
        scale = self.problem.scale
        return {
            "responses": plain(self.responses(), scale),
            "bifurcations": plain(self.bifurcations(), scale),
            "sweep": plain(self.steps(), scale),
            "jumps": plain(self.jumps(), scale),
        }


def requested(problem: Problem, source: str, request: ResponseRequest) -> None:
    """Refuse a scene without responses, and a bead that is none.

    Raises:
        InputError: see `workflow.studies.modes.response.refuse_no_response`; or there are too many atoms, or no bead
            that is free to move at the place.
    """
    moving = response.moving_atoms(problem.system)
    if np.count_nonzero(moving) > MOST_FREE:
        raise InputError(f"{source}: {np.count_nonzero(moving)} atoms; at most {MOST_FREE} for responses")
    response.refuse_no_response(problem, source)
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
        RunError: LAMMPS failed, or a process was killed.
    """
    problem = problem_of(scene, source)
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
        [data] = values([case("workflow.studies.modes.response:computed", arguments, cost=1.0)], of=1 + sweeping)
        sweep: list[dict[str, Any]] = []
        if sweeping and data["states"]:
            energy = max(state["energy"] for state in data["states"])
            sweep_arguments = {
                "plain": scene,
                "source": source,
                "periods": request.periods,
                "energy": energy,
                "decay": response.slowest_decay(problem, source),
            }
            [sweep] = values([case("workflow.studies.modes.lammps_sweep:computed", sweep_arguments, cost=1.0)])
        found = ResponseResult(problem, request.place or _largest(problem, data), data, sweep)
        scale = problem.scale
        tables = {
            RESPONSES: to_csv(ResponseLine, found.responses(), scale),
            BIFURCATIONS: to_csv(ResponseBifurcation, found.bifurcations(), scale),
            SWEEP: to_csv(SweepLine, found.steps(), scale),
        }
        STUDY.write(directory, tables, {FIGURE: _figure(found)} if data["states"] else {})
    return found


def _largest(problem: Problem, data: dict[str, Any]) -> tuple[int, int]:
    """Chain and bead, from 1, of the largest speed of all responses, among beads that are free to move."""
    speeds = [state["speed"] for state in data["states"]] or [np.zeros((problem.chains, problem.beads))]
    size = (np.max(speeds, axis=0) * response.moving_atoms(problem.system))[: problem.chains]
    chain, bead = np.unravel_index(int(np.argmax(size)), size.shape)
    return int(chain) + 1, int(bead) + 1


def _figure(found: ResponseResult) -> "Figure":
    from analysis.figures import periodic_states  # matplotlib takes half a second to import

    scale, lines, changes = found.problem.scale, found.responses(), found.bifurcations()

    def points(records: Sequence[Any]) -> Floats:
        pairs = [
            (scale.measured(each.frequency, "cycles"), scale.measured(each.amplitude, "velocity")) for each in records
        ]
        return np.array(pairs, dtype=np.float64).reshape(-1, 2)

    marked = {
        "fold": points([change for change in changes if change.kind == "fold"]),
        "other change of stability": points([change for change in changes if change.kind != "fold"]),
    }
    marked |= {
        f"LAMMPS, sweep {name}": points([step for step in found.steps() if step.direction == name])
        for name in ("up", "down")
    }
    labels = (
        Label("drive frequency", "f", scale.symbol("cycles")),
        Label(f"largest speed of bead {found.place[1]} of chain {found.place[0]}", "", scale.symbol("velocity")),
    )
    stable = np.array([line.stable == "yes" for line in lines])
    return periodic_states.response_figure(points(lines), stable, marked, labels, found.problem.name)


def print_result(found: ResponseResult, directory: Path, *, sweeping: bool) -> CommandResult:
    """Print tables and sentences; exit code 1 where there is no curve."""
    scale = found.problem.scale
    for title, kind, records in (
        ("changes of stability", ResponseBifurcation, found.bifurcations()),
        ("LAMMPS, sweep of the frequency", SweepLine, found.steps()),
    ):
        if records:
            print_records(title, kind, records, scale)
    for sentence in found.sentences():
        print(sentence)
    if sweeping and (why := deck.refusal(found.problem.system)):
        print(f"LAMMPS is not started: {why}")
    figures = figure_files(FIGURE) if found.data["states"] else ()
    print_files(directory, (*TABLES, *figures))
    return CommandResult(0 if found.data["states"] else 1, found.plain())
