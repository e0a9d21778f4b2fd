"""What gauges have read, and as a table."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.gauges.gauge import Gauge
from analysis.gauges.reflection import Reflection
from analysis.quantity import declare, result
from analysis.trajectory import Floats
from lammps_inputs.units import Scale

PULSE = 0.01
"""Share of its largest value, above the static one, from which a force is that of a pulse."""


NOT_ABOVE = "the force never exceeds the static one by more than the numerical noise"
NO_LOAD = "there is no static load"


@result
class Reading:
    """What one gauge has read at one chain."""

    kind: str = declare("``wall``, ``contact`` or ``sensor``")
    name: str = declare("name of the gauge, with which its columns in ``forces.csv`` begin")
    chain: int = declare("number of the chain")
    bead: int = declare("bead at the wall; the first bead of a contact; the bead with the sensor")
    largest: float = declare("largest total force, between frames too", "force", symbol="F_m")
    at: float = declare("time of the largest force", "time", NOT_ABOVE)
    static: float | None = declare("force at rest, which ``largest`` includes", "force", NO_LOAD, "F_0")
    dynamic: float | None = declare("largest force above the static one", "force", f"{NO_LOAD}, or {NOT_ABOVE}")
    impulse: float = declare("integral over time of the total force minus the static one", "momentum")
    dwell: float = declare(
        "duration of the contact in which the force was largest; under a static load, of the time around the maximum "
        "in which the force exceeded the static one by 1 % of its largest excess; until the end of the record where it "
        "had not ended",
        "time",
        "under a static load, frames are too far apart to show it",
    )
    dwell_ended: bool | None = declare("whether the dwell had ended by the end of the record", undefined=NOT_ABOVE)
    last: float = declare(
        "force above the static one at the end of the record over the largest: from 0.01 on the record ends inside a "
        "pulse, and ``impulse`` is that until then",
        undefined=NOT_ABOVE,
    )
    contacts: int = declare("number of times that the contact has closed; one that is closed at the start counts")
    reflected: Reflection | None = declare(
        "at a wall: what it reflects of the first pulse that meets it",
        undefined="not at a wall; there is a static load, a foundation or unlike beads; a pulse was not seen at enough "
        "beads; or the uncertainty exceeds 0.05",
    )


@result
class ForceTable:
    """Table of forces over time."""

    time: Floats = declare("time of the frame", "time", symbol="t")
    force: Floats = declare(
        "force at each gauge and chain, in columns such as ``contact 10 chain 1``; under a static load ``total``, and "
        "``dynamic`` without it",
        "force",
        symbol="F",
    )


@dataclass(frozen=True)
class Readings:
    """What the gauges read, dimensionless.

    Attributes:
        gauges: which.
        time: [frame], in units of T.
        force: [frame, chain, gauge] total: the static force is included.
        static: [chain, gauge] force at rest; 0 without a static load.
        largest, largest_at: [chain, gauge] largest total force, between frames too, and when; at NaN where the force
            never exceeds the static one by more than the numerical noise.
        impulse: [chain, gauge] integral over time of the total force minus the static one.
        dwell: [chain, gauge] how long the contact lasted in which the force was largest; under a static load, for how
            long the force exceeded the static one by more than `PULSE` of its largest excess, around its maximum. So
            far, where that has not ended; NaN under a load where frames are too far apart to show it.
        ended: [chain, gauge] whether that has ended before the last frame.
        contacts: [chain, gauge] how often the contact has closed; one that is closed at the start counts.
    """

    gauges: tuple[Gauge, ...]
    time: Floats
    force: Floats
    static: Floats
    largest: Floats
    largest_at: Floats
    impulse: Floats
    dwell: Floats
    ended: NDArray[np.bool_]
    contacts: NDArray[np.int64]

    def entries(self, reflected: Mapping[str, Sequence[Reflection | None]]) -> list[Reading]:
        """Gauge by gauge, and chain by chain; ``reflected`` by the wall of each side, chain by chain."""
        found = []
        for place, gauge in enumerate(self.gauges):
            for chain in range(self.force.shape[1]):
                at = chain, place
                there = bool(np.isfinite(self.largest_at[at]))
                found.append(
                    Reading(
                        kind=gauge.kind,
                        name=gauge.name,
                        chain=chain + 1,
                        bead=gauge.bead,
                        largest=float(self.largest[at]),
                        at=float(self.largest_at[at]),
                        static=float(self.static[at]) if self.loaded else None,
                        dynamic=float(self.dynamic[at]) if self.loaded else None,
                        impulse=float(self.impulse[at]),
                        dwell=float(self.dwell[at]),
                        dwell_ended=bool(self.ended[at]) if there else None,
                        last=float(self.last[at]),
                        contacts=int(self.contacts[at]),
                        reflected=reflected[gauge.side][chain] if gauge.kind == "wall" else None,
                    )
                )
        return found

    def columns(self, scale: Scale) -> dict[str, Floats]:
        """Force over time in the scene's units: a column for every gauge and chain: ``contact 10 chain 1 (N)``.

        Under a static load those are ``contact 10 chain 1 total (N)``, and as many columns ``... dynamic (N)``, without
        it, follow.
        """
        found = {scale.heading("time", "time"): self.time * scale.time}
        for which in (" total", " dynamic") if self.loaded else ("",):
            force = (self.force - self.static if which == " dynamic" else self.force) * scale.force
            for place, gauge in enumerate(self.gauges):
                for chain in range(force.shape[1]):
                    found[scale.heading(f"{gauge.name} chain {chain + 1}{which}", "force")] = force[:, chain, place]
        return found

    @property
    def loaded(self) -> bool:
        """Whether any of them bears a static load."""
        return bool(np.any(self.static))

    @property
    def dynamic(self) -> Floats:
        """[chain, gauge] largest force above the static one; NaN where it never exceeds it."""
        return np.where(np.isfinite(self.largest_at), self.largest - self.static, np.nan)

    @property
    def last(self) -> Floats:
        """[chain, gauge] force above the static one in the last frame, as a share of the largest; NaN likewise."""
        return np.asarray((self.force[-1] - self.static) / self.dynamic)
