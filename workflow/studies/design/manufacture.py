"""What small errors of manufacture do to a design: an ensemble, and each number of it alone."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from workflow.studies.design.evaluator import Evaluator, Record
from workflow.studies.design.file import Design
from workflow.studies.design.variables import Variable


@dataclass(frozen=True)
class Sensitivity:
    """The objective where a design is not made as it should be.

    Attributes:
        spread: by how much numbers are off, at most, as a share of them.
        members: objective of each member of the ensemble, whose beads (sizes and stiffnesses) and varied numbers are
            all off by chance; those that are no scene, or have no objective, are left out.
        alone: field -> objective where this one is smaller, and larger, by the spread; None where it has none.
        refused: why there is no ensemble; empty if there is.
    """

    spread: float
    members: tuple[float, ...]
    alone: dict[str, tuple[float | None, float | None]]
    refused: str


def sensitivity(design: Design, evaluator: Evaluator, best: dict[str, Any]) -> Sensitivity:
    """Of the design with these values; kept like all others."""
    spread, members = design.manufacture.spread, design.manufacture.members
    numbers = [v for v in design.variables if not v.steps]
    chance = np.random.default_rng(design.search.seed)
    made = []
    for member in range(members):
        off = {v.field: _off(v, best[v.field], spread * (2.0 * chance.random(v.coordinates) - 1.0)) for v in numbers}
        beads = {"disorder.radius": spread, "disorder.stiffness": spread, "disorder.seed": member + 1}
        made.append({**best, **off, **beads})
    records = evaluator.all_of(made, whole=True)
    sides = [
        {**best, v.field: _off(v, best[v.field], np.full(v.coordinates, sign * spread))}
        for v in numbers
        for sign in (-1.0, 1.0)
    ]
    beside = [_objective(design, record) for record in evaluator.all_of(sides, whole=True)]
    found = [value for record in records if (value := _objective(design, record)) is not None]
    return Sensitivity(
        spread=spread,
        members=tuple(found),
        alone={v.field: (beside[2 * k], beside[2 * k + 1]) for k, v in enumerate(numbers)},
        refused="" if found else next((record.refused for record in records if record.refused), "no objective"),
    )


def _off(variable: Variable, value: Any, share: Any) -> Any:
    if variable.places is None:
        return value * (1.0 + float(share[0]))
    return [one * (1.0 + float(part)) for one, part in zip(value, share, strict=True)]


def _objective(design: Design, record: Record) -> float | None:
    return None if record.refused else record.quantities.get(design.objective)
