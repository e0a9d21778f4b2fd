"""What small errors of manufacture do to a design: an ensemble, and each number of it alone."""

from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np

from workflow.studies.design.evaluator import Evaluator, Record
from workflow.studies.design.file import Design, Variable

FEWEST = 8
"""Members with an objective that statistics of an ensemble are given of."""


@dataclass(frozen=True)
class Sensitivity:
    """The objective where a design is not made as it should be.

    Attributes:
        spread: by how much numbers are off, at most, as a share of them.
        asked: members of the ensemble: designs whose beads (sizes and stiffnesses) and varied numbers are all off by
            chance.
        members: objective of those that have one.
        refused: how many are no valid scene.
        reason: of the first of these.
        undefined: how many are, but the objective is undefined.
        broken: quantity -> how many do not keep its limit.
        alone: field -> objective where this one is smaller, and larger, by the spread; None where it has none.
    """

    spread: float
    asked: int
    members: tuple[float, ...]
    refused: int
    reason: str
    undefined: int
    broken: dict[str, int]
    alone: dict[str, tuple[float | None, float | None]]

    @property
    def enough(self) -> bool:
        """Whether there are members enough for statistics."""
        return len(self.members) >= max(FEWEST, 0.5 * self.asked)


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
    refused = [record.refused for record in records if record.refused]
    broken = Counter(name for record in records for name in design.broken(record.quantities))
    return Sensitivity(
        spread=spread,
        asked=members,
        members=tuple(found),
        refused=len(refused),
        reason=refused[0] if refused else "",
        undefined=members - len(refused) - len(found),
        broken=dict(broken),
        alone={v.field: (beside[2 * k], beside[2 * k + 1]) for k, v in enumerate(numbers)},
    )


def _off(variable: Variable, value: Any, share: Any) -> Any:
    if variable.places is None:
        return value * (1.0 + float(share[0]))
    return [one * (1.0 + float(part)) for one, part in zip(value, share, strict=True)]


def _objective(design: Design, record: Record) -> float | None:
    return None if record.refused else record.quantities.get(design.objective)
