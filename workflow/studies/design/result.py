"""What a design study found: the best beside LAMMPS, and what small errors of manufacture do to it."""

import statistics
from collections import Counter
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from lammps_inputs import html
from workflow.runs.run_directory import RunDirectory
from workflow.screen import cell
from workflow.studies.design.file import Design, Variable
from workflow.studies.design.search import Compute, DesignRecord, worth

SET_AGAINST = "set against"
"""What the scene `beside` is called."""


# --- manufacture ------------------------------------------------------------------------------------------------------

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
    """

    spread: float
    asked: int
    members: tuple[float, ...]
    refused: int
    reason: str
    undefined: int
    broken: dict[str, int]

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
    found = compute(made)
    values = [None if record.refused else record.quantities.get(design.objective) for record in found]
    refused = [record.refused for record in found if record.refused]
    known = tuple(value for value in values if value is not None)
    return Sensitivity(
        spread=spread,
        asked=members,
        members=known,
        refused=len(refused),
        reason=refused[0] if refused else "",
        undefined=members - len(refused) - len(known),
        broken=dict(Counter(name for record in found for name in design.broken(record.quantities))),
    )


def _off(variable: Variable, value: Any, share: Any) -> Any:
    if variable.places is None:
        return value * (1.0 + float(share[0]))
    return [one * (1.0 + float(part)) for one, part in zip(value, share, strict=True)]


# --- result -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Verified:
    """One scene in LAMMPS beside the reference.

    Attributes:
        directory: of its run.
        values: field -> value; empty for the scene beside.
        reference, lammps: quantities.
        error: largest error of its velocities against the reference, in units of V.
    """

    directory: RunDirectory
    values: dict[str, Any]
    reference: dict[str, float | None]
    lammps: dict[str, float | None]
    error: float

    def difference(self, name: str) -> float | None:
        """Of a quantity, LAMMPS from the reference, as a share of it."""
        one, other = self.reference[name], self.lammps[name]
        return None if one is None or other is None or one == 0.0 else other / one - 1.0

    def plain(self) -> dict[str, Any]:
        """For ``design.json``."""
        kept = {"values": self.values, "reference": self.reference, "lammps": self.lammps}
        return {**kept, "error_velocity": self.error, "directory": self.directory.path.name}


@dataclass(frozen=True)
class DesignResult:
    """Result of a search.

    Attributes:
        design: the objective.
        records: all that the search asked for, in its order.
        verified: the best few, the best first.
        beside: the scene to set them against; None if there is none.
        sensitivity: of the best.
        seconds: mean processor time of a design.
    """

    design: Design
    records: list[DesignRecord]
    verified: list[Verified]
    beside: Verified | None
    sensitivity: Sensitivity
    seconds: float

    def __repr__(self) -> str:
        best, word = self.best.quantities.get(self.design.objective), "least" if self.design.sign > 0 else "most"
        return (
            f"<design: {word} {self.design.objective} of {len(self.records)}: {'-' if best is None else f'{best:.6g}'}>"
        )

    def _repr_html_(self) -> str:
        notes = "".join(html.text(f"warning: {warning}") for warning in self.warnings)
        return html.table(repr(self)[1:-1], *self.table()) + notes

    def table(self) -> tuple[list[str], list[list[str]]]:
        """Head, and rows: fields, quantities by the reference, how far LAMMPS is from them, and its error."""
        design, name = self.design, self.design.heading
        columns = {f"no. {place}": one for place, one in enumerate(self.verified, 1)}
        columns |= {} if self.beside is None else {SET_AGAINST: self.beside}
        scenes = list(columns.values())
        rows = [[name(v.field), *(cell(one.values.get(v.field)) for one in scenes)] for v in design.variables]
        for of in design.names:
            rows.append([name(of), *(cell(one.reference[of]) for one in scenes)])
            rows.append([f"{of}: LAMMPS / reference - 1", *(cell(one.difference(of), ".1e") for one in scenes)])
        rows.append(["error of LAMMPS's velocities / V", *(cell(one.error, ".1e") for one in scenes)])
        return ["", *columns], rows

    @property
    def best(self) -> DesignRecord:
        """By the reference."""
        return min(self.records, key=lambda record: worth(self.design, record))

    @property
    def undefined(self) -> int:
        """How many designs do not count because the objective, or a quantity with a limit, is undefined there."""
        wanted = (self.design.objective, *self.design.asked.where)
        return sum(any(r.quantities.get(name, 0.0) is None for name in wanted) for r in self.records)

    @property
    def warnings(self) -> list[str]:
        """What restricts the answer: the best at a bound, and members of the ensemble that fail or break a limit."""
        design, small, best = self.design, self.sensitivity, self.best
        said = []
        for variable in design.variables:
            bound = variable.bound(best.values[variable.field])
            if bound:
                end = variable.low if bound == "from" else variable.high
                said.append(
                    f"the best is at a bound of the search ({variable.field}: {bound} {end:g}); a better design may "
                    "lie beyond it"
                )
        for name, count in small.broken.items():
            said.append(f"{count} of {small.asked} members of the tolerance ensemble do not keep the limit of {name}")
        if small.refused:
            said.append(
                f"{small.refused} of {small.asked} members of the tolerance ensemble are no valid scene; the first: "
                f"{small.reason}"
            )
        if small.undefined:
            said.append(
                f"{small.undefined} of {small.asked} members of the tolerance ensemble have no {design.objective}"
            )
        return said

    @property
    def tolerance(self) -> str:
        """The objective within the manufacturing tolerance, in words."""
        small, name = self.sensitivity, self.design.heading(self.design.objective)
        said = f"manufacturing tolerance {small.spread:.2g}: {name} of {len(small.members)} of {small.asked} members"
        if not small.enough:
            values = ", ".join(f"{value:.5g}" for value in small.members)
            return f"{said}: {values or 'none'}; no statistics of fewer than {FEWEST}, or of less than half"
        worst = max(small.members, key=lambda value: self.design.sign * value)
        return (
            f"{said}: mean {statistics.fmean(small.members):.5g}, standard deviation "
            f"{statistics.stdev(small.members):.2g}, worst {worst:.5g}"
        )

    def plain(self) -> dict[str, Any]:
        """For ``design.json``."""
        return {
            "objective": self.design.objective,
            "exhaustive": self.design.exhaustive,
            "asked": len(self.records),
            "undefined": self.undefined,
            "best": self.best.values,
            "quantities": self.best.quantities,
            "verified": [one.plain() for one in self.verified],
            "beside": None if self.beside is None else self.beside.plain(),
            "manufacture": asdict(self.sensitivity),
            "warnings": self.warnings,
            "seconds_a_design": self.seconds,
        }
