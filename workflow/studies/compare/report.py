"""What is written of a comparison: ``compare.json`` and a figure."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.trajectory import Floats
from lammps_inputs import Problem
from lammps_inputs.numbers import known
from workflow.runs.whole_files import write_figure
from workflow.studies.compare.measure import Result

REPORT, FIGURE = "compare.json", "compare"


@dataclass(frozen=True)
class Comparison:
    """Several engines' results of one scene.

    Attributes:
        rows: numbers of the beads that are shown.
        last: last bead up to which every engine passed an impulse on; 1 if none did.
        answer: sentences that say what was found.
    """

    problem: Problem
    results: tuple[Result, ...]
    rows: tuple[int, ...]
    last: int
    answer: tuple[str, ...]

    def of(self, engine: str) -> Result | None:
        """The result of one engine, if it ran."""
        return next((result for result in self.results if result.engine == engine), None)


def plain(found: Comparison) -> dict[str, Any]:
    """The contents of ``compare.json``, dimensionless (times in T, impulses in m V; ``scale`` has the units).

    | key            | what                                                                               |
    |----------------|------------------------------------------------------------------------------------|
    | answer         | sentences                                                                          |
    | last_bead      | up to which every engine passed an impulse on                                      |
    | beads          | struck bead of each row of the arrays below                                        |
    | engines        | per engine: first_impulse, impulse, contacts, first_time [chain][row]; imbalance;  |
    |                | peak [chain][shown]; momentum_share, energy_share (last: springs); seconds         |
    """
    problem, scale = found.problem, found.problem.scale
    return {
        "scene": problem.name,
        "kappa": problem.kappa,
        "gap": problem.gap,
        "theta": math.sqrt(2.0 * problem.kappa) * problem.gap,
        "duration": problem.duration,
        "scale": {"mass": scale.mass, "length": scale.length, "time": scale.time, "velocity": scale.velocity},
        "answer": list(found.answer),
        "last_bead": found.last,
        "shown": list(found.rows),
        "beads": found.results[0].impulses.bead.tolist(),
        "engines": {result.engine: _plain_result(result) for result in found.results},
    }


def _plain_result(result: Result) -> dict[str, Any]:
    impulses = result.impulses
    return {
        "seconds": result.seconds,
        "wall_seconds": result.wall,
        "momentum_share": _numbers(result.momentum),
        "energy_share": _numbers(result.energy),
        "peak": _numbers(result.peak),
        "first_impulse": _numbers(impulses.first),
        "impulse": _numbers(impulses.whole),
        "contacts": impulses.contacts.tolist(),
        "first_time": _numbers(impulses.time),
        "imbalance": known(impulses.imbalance),
    }


def _numbers(values: Floats) -> Any:
    """Nested lists with None for what is not finite."""
    if values.ndim > 1:
        return [_numbers(part) for part in values]
    return [known(value) for value in values.tolist()]


def draw(directory: Path, found: Comparison) -> None:
    """Write the figure."""
    from analysis.figures.engines import Curve, engines_figure  # matplotlib takes half a second to import

    curves = [
        Curve(result.engine, result.time, result.velocity, result.impulses.bead, result.impulses.first)
        for result in found.results
    ]
    figure = engines_figure(found.problem, found.rows, curves)
    write_figure(directory, FIGURE, figure)
