"""Result of a design study: the best designs beside LAMMPS, and the effect of manufacturing errors on the best."""

import statistics
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from granchain.parts import RunDirectory, html, screen
from workflow.plugins.derivatives.derivative import Derivative
from workflow.plugins.design.file import Design, Variable
from workflow.plugins.design.search import Compute, DesignRecord, worth

SET_AGAINST = "set against"
"""Heading of the scene `beside`."""


# --- manufacture ------------------------------------------------------------------------------------------------------

FEWEST = 8
"""Least number of members with an objective for statistics of an ensemble."""


@dataclass(frozen=True)
class Sensitivity:
    """The objective in an ensemble of designs with manufacturing errors.

    Attributes:
        spread: largest relative error of a number.
        asked: number of members: designs whose beads (sizes and stiffnesses) and varied numbers all have random errors.
        members: objective of each member that has one.
        refused: number of members that are no valid scene.
        reason: why the first of these is none.
        undefined: number of members that are a scene, but whose objective is undefined.
        broken: quantity -> number of members that do not keep its limit.
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
        """Whether the members with an objective suffice for statistics."""
        return len(self.members) >= max(FEWEST, 0.5 * self.asked)


def sensitivity(design: Design, compute: Compute, best: dict[str, Any]) -> Sensitivity:
    """Sensitivity of a design to manufacturing errors.

    Args:
        design: the design file.
        compute: designs -> their records.
        best: field -> value of the design.

    Returns:
        Statistics of the ensemble.
    """
    spread, members = design.request.manufacture.spread, design.request.manufacture.members
    numbers = [v for v in design.variables if not v.steps]
    chance = np.random.default_rng(design.request.search.seed)
    made = []
    for member in range(members):
        off = {v.field: _off(v, best[v.field], spread * (2.0 * chance.random(v.coordinates) - 1.0)) for v in numbers}
        beads = {"disorder.radius": spread, "disorder.stiffness": spread, "disorder.seed": member + 1}
        made.append({**best, **off, **beads})
    records = compute(made)
    values = [None if record.refused else record.quantities.get(design.objective) for record in records]
    refused = [record.refused for record in records if record.refused]
    objectives = tuple(value for value in values if value is not None)
    return Sensitivity(
        spread=spread,
        asked=members,
        members=objectives,
        refused=len(refused),
        reason=refused[0] if refused else "",
        undefined=members - len(refused) - len(objectives),
        broken=dict(Counter(name for record in records for name in design.broken(record.quantities))),
    )


def _off(variable: Variable, value: Any, share: Any) -> Any:
    if variable.places is None:
        return value * (1.0 + float(share[0]))
    return [number * (1.0 + float(part)) for number, part in zip(value, share, strict=True)]


# --- result -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Verified:
    """One scene in LAMMPS beside the reference.

    Attributes:
        directory: its run directory.
        values: field -> value; empty for the scene beside.
        reference: quantities by the reference, in the scene's units; None where undefined.
        lammps: quantities by LAMMPS, in the same units.
        error: largest error of its velocities against the reference, in units of V.
    """

    directory: RunDirectory
    values: dict[str, Any]
    reference: dict[str, float | None]
    lammps: dict[str, float | None]
    error: float

    def difference(self, name: str) -> float | None:
        """Relative difference of a quantity by LAMMPS from that by the reference; None where it is undefined."""
        reference, lammps = self.reference[name], self.lammps[name]
        return None if reference is None or lammps is None or reference == 0.0 else lammps / reference - 1.0

    def plain(self) -> dict[str, Any]:
        """Plain data of the scene for ``design.json``."""
        return {
            "values": self.values,
            "reference": self.reference,
            "lammps": self.lammps,
            "error_velocity": self.error,
            "directory": self.directory.path.name,
        }


@dataclass(frozen=True)
class DesignResult:
    """Result of a search.

    Attributes:
        design: the design file.
        records: all designs of the search, in its order.
        verified: the best designs in LAMMPS, the best first.
        beside: the scene to compare them with; None if there is none.
        sensitivity: effect of manufacturing errors on the best.
        seconds: mean processor time of a design, in s.
        derivatives: derivatives of the quantities at the best design; none where they were not asked for.
    """

    design: Design
    records: list[DesignRecord]
    verified: list[Verified]
    beside: Verified | None
    sensitivity: Sensitivity
    seconds: float
    derivatives: Sequence[Derivative] = ()

    def __repr__(self) -> str:
        best, word = self.best.quantities.get(self.design.objective), "least" if self.design.sign > 0 else "most"
        return (
            f"<design: {word} {self.design.objective} of {len(self.records)}: {'-' if best is None else f'{best:.6g}'}>"
        )

    def _repr_html_(self) -> str:
        notes = "".join(html.text(f"warning: {warning}") for warning in self.warnings)
        return html.table(repr(self)[1:-1], *self.table()) + notes

    def table(self) -> tuple[list[str], list[list[str]]]:
        """Head, and rows: fields, quantities by the reference, their difference in LAMMPS, and the error of LAMMPS."""
        design, name = self.design, self.design.heading
        columns = {f"no. {place}": scene for place, scene in enumerate(self.verified, 1)}
        columns |= {} if self.beside is None else {SET_AGAINST: self.beside}
        scenes = list(columns.values())
        rows = [
            [name(v.field), *(screen.cell(scene.values.get(v.field)) for scene in scenes)] for v in design.variables
        ]
        for quantity in design.names:
            rows.append([name(quantity), *(screen.cell(scene.reference[quantity]) for scene in scenes)])
            differences = (screen.cell(scene.difference(quantity), ".1e") for scene in scenes)
            rows.append([f"{quantity}: LAMMPS / reference - 1", *differences])
        rows.append(["error of LAMMPS's velocities / V", *(screen.cell(scene.error, ".1e") for scene in scenes)])
        return ["", *columns], rows

    @property
    def best(self) -> DesignRecord:
        """The best design by the reference."""
        return min(self.records, key=lambda record: worth(self.design, record))

    @property
    def undefined(self) -> int:
        """Number of designs whose objective, or a quantity with a limit, is undefined; they do not count."""
        wanted = (self.design.objective, *self.design.request.where)
        return sum(any(r.quantities.get(name, 0.0) is None for name in wanted) for r in self.records)

    @property
    def warnings(self) -> list[str]:
        """Restrictions of the result: the best at a bound, and members of the ensemble that fail or break a limit."""
        design, small, best = self.design, self.sensitivity, self.best
        sentences = []
        for variable in design.variables:
            bound = variable.bound(best.values[variable.field])
            if bound:
                end = variable.low if bound == "from" else variable.high
                sentences.append(
                    f"the best is at a bound of the search ({variable.field}: {bound} {end:g}); a better design may "
                    "lie beyond it"
                )
        for name, count in small.broken.items():
            sentences.append(
                f"{count} of {small.asked} members of the tolerance ensemble do not keep the limit of {name}"
            )
        if small.refused:
            sentences.append(
                f"{small.refused} of {small.asked} members of the tolerance ensemble are no valid scene; the first: "
                f"{small.reason}"
            )
        if small.undefined:
            sentences.append(
                f"{small.undefined} of {small.asked} members of the tolerance ensemble have no {design.objective}"
            )
        return sentences

    @property
    def tolerance(self) -> str:
        """The objective within the manufacturing tolerance, in words."""
        small, name = self.sensitivity, self.design.heading(self.design.objective)
        subject = f"manufacturing tolerance {small.spread:.2g}: {name} of {len(small.members)} of {small.asked} members"
        if not small.enough:
            values = ", ".join(f"{value:.5g}" for value in small.members)
            return f"{subject}: {values or 'none'}; no statistics of fewer than {FEWEST}, or of less than half"
        worst = max(small.members, key=lambda value: self.design.sign * value)
        return (
            f"{subject}: mean {statistics.fmean(small.members):.5g}, standard deviation "
            f"{statistics.stdev(small.members):.2g}, worst {worst:.5g}"
        )

    def plain(self) -> dict[str, Any]:
        """Contents of ``design.json``."""
        return {
            "objective": self.design.objective,
            "exhaustive": self.design.exhaustive,
            "asked": len(self.records),
            "undefined": self.undefined,
            "best": self.best.values,
            "quantities": self.best.quantities,
            "verified": [verified.plain() for verified in self.verified],
            "beside": None if self.beside is None else self.beside.plain(),
            "manufacture": asdict(self.sensitivity),
            "warnings": self.warnings,
            "seconds_a_design": self.seconds,
            **({"derivatives": [asdict(line) for line in self.derivatives]} if self.derivatives else {}),
        }
