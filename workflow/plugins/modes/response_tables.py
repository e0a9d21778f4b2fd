"""Tables of responses to a drive: what their columns mean, and their lines.

Frequencies are those of the drive, in cycles per unit time, as the scene has them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from granchain.parts import Floats, Problem, quantity
from workflow.plugins.modes.response import SAME

UNMATCHED = "no stable response of the curve has this frequency"


@quantity.result
class ResponseLine:
    """A periodic response."""

    response: int = quantity.declare("number of the response along the curve", digits="d")
    role: str = quantity.declare(
        "``branch``: a point of the continuation; ``frequency``: of one of the sweep; ``bifurcation``: just behind one",
        digits="",
    )
    frequency: float = quantity.declare(
        "frequency of the drive, in cycles per unit time", "cycles", symbol="f", digits=".8g"
    )
    amplitude: float = quantity.declare("largest speed of the chosen bead over a period", "velocity", digits=".6g")
    multiplier: float = quantity.declare("largest modulus of the Floquet multipliers", digits=".6g")
    stable: str = quantity.declare("``yes`` where all multipliers are inside the unit circle, or ``no``", digits="")
    residual: float = quantity.declare(
        "change of displacements, times the middle angular frequency, and velocities by a period, over their norm",
        digits=".1e",
    )
    least_overlap: float = quantity.declare(
        "overlap of neighbours where it is least over a period, at 64 times; less their distance where they are apart",
        "length",
        digits=".3g",
    )


@quantity.result
class ResponseBifurcation:
    """A change of stability along the response curve."""

    kind: str = quantity.declare(
        "``fold`` (multiplier 1, where the curve turns back), ``+1`` (elsewhere), ``-1`` (period doubling) or "
        "``Neimark-Sacker`` (a pair elsewhere on the unit circle)",
        digits="",
    )
    frequency: float = quantity.declare("frequency of the drive there, in cycles per unit time", "cycles", digits=".8g")
    uncertainty: float = quantity.declare(
        "by the interval in which it is, and by twice the steps", "cycles", digits=".1e"
    )
    amplitude: float = quantity.declare("largest speed of the chosen bead there", "velocity", digits=".5g")
    before: int = quantity.declare("multipliers outside the unit circle before it", digits="d")
    after: int = quantity.declare("multipliers outside the unit circle after it", digits="d")


@quantity.result
class SweepLine:
    """A step of the sweep in LAMMPS."""

    direction: str = quantity.declare("``up`` or ``down``", digits="")
    frequency: float = quantity.declare("frequency of the drive, in cycles per unit time", "cycles", digits=".8g")
    periods: int = quantity.declare("periods that were run", digits="d")
    amplitude: float = quantity.declare("largest speed of the chosen bead in the last period", "velocity", digits=".6g")
    change: float = quantity.declare("change of the state by the last period, over its norm", digits=".1e")
    response: int | None = quantity.declare(
        "number of the stable response of this frequency whose amplitudes are nearest", "", UNMATCHED, digits="d"
    )
    deviation: float | None = quantity.declare(
        "relative deviation of the amplitude from that response's", "", UNMATCHED, digits=".1e"
    )


@quantity.result
class Jump:
    """A jump of LAMMPS's sweep from one piece of the curve, between folds, to another."""

    direction: str = quantity.declare("``up`` or ``down``")
    branch: str = quantity.declare(
        "``upper`` or ``lower``: the piece that it leaves has the larger or smaller amplitude"
    )
    before: float = quantity.declare("last frequency before the jump", "cycles")
    after: float = quantity.declare("first frequency after the jump", "cycles")
    fold: float = quantity.declare("frequency of the nearer fold at which the piece ends", "cycles")


@dataclass(frozen=True)
class ResponseResult:
    """Curve of responses, and LAMMPS's sweep.

    Attributes:
        problem: of the scene.
        place: chain and bead of the amplitudes, from 1.
        data: see `workflow.plugins.modes.response.computed`.
        sweep: see `workflow.plugins.modes.lammps_sweep.computed`.
    """

    problem: Problem
    place: tuple[int, int]
    data: dict[str, Any]
    sweep: list[dict[str, Any]]

    def __repr__(self) -> str:
        return f"<{len(self.data['states'])} responses of {self.problem.name}>"

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
                if state["stable"] and abs(state["period"] / step["period"] - 1.0) <= SAME
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
            lines.append("LAMMPS jumps nowhere from one stable part of the curve to another")
        return lines

    def plain(self) -> dict[str, Any]:
        """Plain data of the result in the scene's units, for scripts."""
        scale = self.problem.scale
        return {
            "responses": quantity.plain(self.responses(), scale),
            "bifurcations": quantity.plain(self.bifurcations(), scale),
            "sweep": quantity.plain(self.steps(), scale),
            "jumps": quantity.plain(self.jumps(), scale),
        }
