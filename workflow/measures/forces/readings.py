"""Forces that gauges have read: largest force, its time, impulse and dwell of each, with uncertainties."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analysis.gauges.gauge import Gauge
from analysis.quantity import declare, result
from analysis.sharing.run_error import MeasuredError
from analysis.trajectory import Flags, Floats, Integers
from lammps_inputs import Problem
from workflow.measures.forces.reflection import Reflection

ENDS = 5.0
"""Error of a dwell over that of the time of the largest force, both by the run: the ends of a contact are off by more,
as it opens slowly. Measured: up to 3.7.
"""

NOT_ABOVE = "the force never exceeds the static one by more than the numerical noise"
NO_LOAD = "there is no static load"
TOO_COARSE = "frames are so far apart that its uncertainty exceeds a twentieth of"
COARSE_FORCE = f"{TOO_COARSE} the largest dynamic force"
BY_FRAMES = "by the time between frames and by the run (``run_error``)"


@result
class Reading:
    """What one gauge has read at one chain."""

    kind: str = declare("``wall``, ``contact`` or ``sensor``")
    name: str = declare("name of the gauge, with which its columns in ``forces.csv`` begin")
    chain: int = declare("number of the chain")
    bead: int = declare("bead at the wall; the first bead of a contact; the bead with the sensor")
    largest: float = declare(
        "largest total force, at frames and between them; positive where beads are pushed apart",
        "force",
        COARSE_FORCE,
        symbol="F_m",
    )
    largest_error: float = declare(f"uncertainty of ``largest`` and ``dynamic`` {BY_FRAMES}", "force", "as ``largest``")
    at: float = declare("time of the largest force", "time", f"{NOT_ABOVE}; {COARSE_FORCE}")
    at_error: float = declare(
        f"uncertainty of ``at`` {BY_FRAMES}: how far from it the force may be as large",
        "time",
        "as ``at``",
    )
    static: float | None = declare("force at rest, which ``largest`` includes", "force", NO_LOAD, "F_0")
    dynamic: float | None = declare(
        "largest force above the static one", "force", f"{NO_LOAD}; {NOT_ABOVE}; {COARSE_FORCE}"
    )
    impulse: float = declare(
        "integral over time of the total force minus the static one; negative where a contact pulls more than pushes",
        "momentum",
        f"{TOO_COARSE} the integral of the size of that difference",
    )
    impulse_error: float = declare(f"uncertainty of ``impulse`` {BY_FRAMES}", "momentum", "as ``impulse``")
    dwell: float = declare(
        "time in which the contact with the largest force pushes by over 1e-9 m V / T (overlaps over 1e-6 L), "
        "or until the end; under a static load, in which the dynamic force is over 1 % of its maximum",
        "time",
        f"{TOO_COARSE} it",
    )
    dwell_error: float = declare(
        f"uncertainty of ``dwell`` {BY_FRAMES}; where the force may be as large in other contacts, it covers theirs",
        "time",
        "as ``dwell``",
    )
    dwell_ended: bool | None = declare("whether the dwell had ended by the end of the record", undefined=NOT_ABOVE)
    last: float = declare(
        "force above the static one at the end of the record over the largest: from 0.01 on the record ends inside a "
        "pulse, and ``impulse`` is that until then",
        undefined=NOT_ABOVE,
    )
    contacts: int = declare(
        "number of times that the contact has closed, so that its elastic force pushes by more than 1e-9 m V / T; one "
        "that is closed at the start counts"
    )
    reflected: Reflection | None = declare(
        "at a wall: what it reflects of the first pulse that meets it",
        undefined="not at a wall; there is a static load, a foundation or unlike beads; a pulse was not seen at enough "
        "beads; or the uncertainty exceeds 0.05",
    )


@result
class ForceTable:
    """Table of forces over time."""

    time: Floats = declare("time of the frame", "time", symbol="t")
    force: dict[str, Floats] = declare(
        "force at each gauge and chain, in columns such as ``contact 10 chain 1``; under a static load ``total``, and "
        "``dynamic`` without it",
        "force",
        symbol="F",
    )


@dataclass(frozen=True)
class Readings:
    """Forces that the gauges read, and numbers of them, dimensionless.

    Attributes:
        gauges: the gauges.
        time: [frame], in units of T.
        force: [frame, chain, gauge] total force in units of m V / T; the static force is included.
        static: [chain, gauge] force at rest; 0 without a static load.
        largest, at: [chain, gauge] largest total force, between frames too, and when; at NaN where the force
            never exceeds the static one by more than the numerical noise.
        impulse: [chain, gauge] integral over time of the total force minus the static one.
        dwell: [chain, gauge] how long the contact lasted in which the force was largest; under a static load, for how
            long the force exceeded the static one by more than `PULSE` of its largest excess, around its maximum. So
            far, where that has not ended.
        largest_error, at_error, impulse_error, dwell_error: [chain, gauge] uncertainties of these by the time between
            frames. A number and its uncertainty are NaN where that exceeds `LARGEST_UNCERTAINTY`.
        ended: [chain, gauge] whether that has ended before the last frame.
        contacts: [chain, gauge] how often the contact has closed; one that is closed at the start counts.
    """

    gauges: tuple[Gauge, ...]
    time: Floats
    force: Floats
    static: Floats
    largest: Floats
    at: Floats
    impulse: Floats
    dwell: Floats
    largest_error: Floats
    at_error: Floats
    impulse_error: Floats
    dwell_error: Floats
    ended: Flags
    contacts: Integers

    def entries(self, reflected: Mapping[str, Sequence[Reflection | None]]) -> list[Reading]:
        """Readings gauge by gauge, and chain by chain; ``reflected``: side of the wall -> reflection of each chain."""
        uncertain = ("largest", "at", "impulse", "dwell")
        names = (*uncertain, *(f"{name}_error" for name in uncertain), "last")
        columns = {name: getattr(self, name) for name in (*names, *(("static", "dynamic") if self.loaded else ()))}
        unloaded: dict[str, Any] = {"static": None, "dynamic": None}
        return [
            Reading(
                kind=gauge.kind,
                name=gauge.name,
                chain=chain + 1,
                bead=gauge.bead,
                **unloaded | {name: float(values[chain, place]) for name, values in columns.items()},
                dwell_ended=bool(self.ended[chain, place]) if np.isfinite(self.at[chain, place]) else None,
                contacts=int(self.contacts[chain, place]),
                reflected=reflected[gauge.side][chain] if gauge.kind == "wall" else None,
            )
            for place, gauge in enumerate(self.gauges)
            for chain in range(self.force.shape[1])
        ]

    def table(self) -> ForceTable:
        """Force over time: a column for every gauge and chain, ``contact 10 chain 1``.

        Under a static load those are ``contact 10 chain 1 total``, and as many columns ``... dynamic``, without it,
        follow.
        """
        kinds = {" total": self.force, " dynamic": self.force - self.static} if self.loaded else {"": self.force}
        force = {
            f"{gauge.name} chain {chain + 1}{which}": values[:, chain, place]
            for which, values in kinds.items()
            for place, gauge in enumerate(self.gauges)
            for chain in range(values.shape[1])
        }
        return ForceTable(self.time, force)

    def with_error(self, error: MeasuredError, problem: Problem) -> "Readings":
        """Readings whose uncertainties cover the error of the run (`analysis.sharing.run_error`)."""
        if not error.measured:
            return self
        mass = float(np.max(problem.system.mass))
        force = error.of_force(problem)
        size = np.abs(self.largest - self.static)
        late = np.maximum(error.arrival, np.divide(mass * error.velocity, size, out=0.0 * size, where=size > 0.0))
        return replace(
            self,
            largest_error=self.largest_error + force,
            at_error=self.at_error + late,
            impulse_error=self.impulse_error + 2.0 * mass * error.velocity * np.maximum(self.contacts, 1),
            dwell_error=self.dwell_error + ENDS * late,
        )

    @property
    def loaded(self) -> bool:
        """Whether any of them is under a static load."""
        return bool(np.any(self.static))

    @property
    def dynamic(self) -> Floats:
        """[chain, gauge] largest force above the static one, in units of m V / T; NaN where it never exceeds it."""
        return np.where(np.isfinite(self.at), self.largest - self.static, np.nan)

    @property
    def last(self) -> Floats:
        """[chain, gauge] force above the static one in the last frame over ``dynamic``, dimensionless; else NaN."""
        return np.asarray((self.force[-1] - self.static) / self.dynamic)
