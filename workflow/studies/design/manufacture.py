"""What small errors of manufacture do to a design: an ensemble, and each number of it alone."""

from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np

from workflow.studies.design.file import Design, Variable
from workflow.studies.design.search import Compute

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


def sensitivity(design: Design, compute: Compute, best: dict[str, Any]) -> Sensitivity:
    """Of the design with these values; computed, whatever its mass, as all others."""
    spread, members = design.asked.manufacture.spread, design.asked.manufacture.members
    numbers = [v for v in design.variables if not v.steps]
    chance = np.random.default_rng(design.asked.search.seed)
    made = []
    for member in range(members):
        off = {v.field: _off(v, best[v.field], spread * (2.0 * chance.random(v.coordinates) - 1.0)) for v in numbers}
        beads = {"disorder.radius": spread, "disorder.stiffness": spread, "disorder.seed": member + 1}
        made.append({**best, **off, **beads})
    for v in numbers:
        made += [{**best, v.field: _off(v, best[v.field], np.full(v.coordinates, s * spread))} for s in (-1.0, 1.0)]
    found = compute(made)
    values = [None if record.refused else record.quantities.get(design.objective) for record in found]
    refused = [record.refused for record in found[:members] if record.refused]
    known = tuple(value for value in values[:members] if value is not None)
    return Sensitivity(
        spread=spread,
        asked=members,
        members=known,
        refused=len(refused),
        reason=refused[0] if refused else "",
        undefined=members - len(refused) - len(known),
        broken=dict(Counter(name for record in found[:members] for name in design.broken(record.quantities))),
        alone={v.field: (values[members + 2 * k], values[members + 2 * k + 1]) for k, v in enumerate(numbers)},
    )


def _off(variable: Variable, value: Any, share: Any) -> Any:
    if variable.places is None:
        return value * (1.0 + float(share[0]))
    return [one * (1.0 + float(part)) for one, part in zip(value, share, strict=True)]
