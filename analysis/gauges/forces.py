"""Force over time as it is measured: on walls, in contacts, and inside a bead, with what a gauge there would report.

Force follows from displacements. Between two frames a displacement is the polynomial of degree five through its value
and two derivatives there (degree three, where the beads around were not recorded), so that a force is known at any
time: its impulse is an integral by Gauss rules, cut where a contact opens or closes; its largest value lies between
frames, and so do the moments at which contacts open and close.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from analysis import hermite
from analysis.gauges.gauge import (
    Curve,
    Gauge,
    at_frames,
    borders,
    excursion,
    maximum,
    memory_at_frames,
    strain_at_frames,
)
from analysis.gauges.reflection import Reflection
from analysis.quantity import declare, result
from analysis.trajectory import Flags, Floats, Integers, Trajectory, joined
from lammps_inputs import Problem

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
    force: dict[str, Floats] = declare(
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
        largest, at: [chain, gauge] largest total force, between frames too, and when; at NaN where the force
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
    at: Floats
    impulse: Floats
    dwell: Floats
    ended: Flags
    contacts: Integers

    def entries(self, reflected: Mapping[str, Sequence[Reflection | None]]) -> list[Reading]:
        """Gauge by gauge, and chain by chain; ``reflected`` by the wall of each side, chain by chain."""
        names = ("largest", "at", "impulse", "dwell", "last", *(("static", "dynamic") if self.loaded else ()))
        columns = {name: getattr(self, name) for name in names}
        unloaded: dict[str, Any] = {"static": None, "dynamic": None}
        return [
            Reading(
                kind=gauge.kind,
                name=gauge.name,
                chain=chain + 1,
                bead=gauge.bead,
                **unloaded | {name: float(one[chain, place]) for name, one in columns.items()},
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

    @property
    def loaded(self) -> bool:
        """Whether any of them is under a static load."""
        return bool(np.any(self.static))

    @property
    def dynamic(self) -> Floats:
        """[chain, gauge] largest force above the static one; NaN where it never exceeds it."""
        return np.where(np.isfinite(self.at), self.largest - self.static, np.nan)

    @property
    def last(self) -> Floats:
        """[chain, gauge] force above the static one in the last frame, as a share of the largest; NaN likewise."""
        return np.asarray((self.force[-1] - self.static) / self.dynamic)


CLOSED = 1e-9
"""Force from which on a contact counts as closed, of an overlap of 1e-6, far above rounding: behind a pulse beads touch
with hardly any force.
"""

NEARLY = 0.01
"""Share of the largest force that a panel's ends may be below it for the largest to be looked for in it: forces are
round enough for a panel to hide 0.2%.
"""

_JUST = 1e-9
"""Of the time between frames: how long after a contact has closed its force is taken."""

MOST_ENTRIES = 4000
"""Stretches from frame to frame that are looked at together, which bounds the memory."""


class ForceMeter:
    """Reads gauges in a run that is given piece by piece; holds one frame and what it found."""

    def __init__(self, problem: Problem, gauges: tuple[Gauge, ...]) -> None:
        self.problem = problem
        self.gauges = gauges
        shape = (problem.chains, len(gauges))
        self._time: list[Floats] = []
        self._force: list[Floats] = []
        self._static = np.stack([gauge.static for gauge in gauges], axis=-1)
        self._largest, self._impulse = np.full(shape, -np.inf), np.zeros(shape)
        self._largest_at = np.full(shape, np.nan)
        self._closed = np.zeros(shape, dtype=bool)
        self._changes: list[list[tuple[Integers, Floats, Flags]]] = [[] for _ in gauges]
        self._carried: Trajectory | None = None

    def add(self, block: Trajectory) -> None:
        """Take the next frames, evenly spaced in time with those before."""
        self._time.append(block.time.copy())
        self._force.append(at_frames(block, self.gauges))
        if self._carried is not None:
            block = joined([self._carried, block])
        else:
            self._largest = self._force[0][0].copy()
            self._largest_at[:] = block.time[0]
            self._closed = at_frames(block[:1], self.gauges, dashpots=False)[0] > CLOSED
        step = max(1, MOST_ENTRIES // self.problem.chains)
        for start in range(0, block.frames - 1, step):
            part = block[start : start + step + 1]
            for place, gauge in enumerate(self.gauges):
                self._read(part, place, gauge)
        self._carried = block.last()

    def result(self) -> Readings:
        """Of the frames so far.

        Raises:
            ValueError: there was none.
        """
        if not self._time:
            raise ValueError("no frames to read forces from")
        time, force = np.concatenate(self._time), np.concatenate(self._force)
        largest = self._largest.copy()
        risen = largest - self._static > CLOSED * np.maximum(1.0, self._static)
        largest_at = np.where(risen, self._largest_at, np.nan)
        dwell, ended = np.zeros(largest.shape), np.zeros(largest.shape, dtype=bool)
        contacts = np.zeros(largest.shape, dtype=np.int64)
        for place, changes in enumerate(self._changes):
            for chain in range(self.problem.chains):
                starts = [when[(of == chain) & closes] for of, when, closes in changes]
                ends = [when[(of == chain) & ~closes] for of, when, closes in changes]
                start = np.sort(np.concatenate([time[:1][self._closed[chain, place : place + 1]], *starts]))
                end = np.sort(np.concatenate([*ends, [np.inf]]))
                contacts[chain, place] = len(start)
                at, static = largest_at[chain, place], self._static[chain, place]
                if np.isnan(at) or len(start) == 0:
                    continue
                at_largest = max(int(np.searchsorted(start, at, side="right")) - 1, 0)
                span = start[at_largest], end[at_largest]
                if static > 0.0:
                    above = PULSE * (largest[chain, place] - static)
                    span = excursion(time, force[:, chain, place] - static, float(at), above)
                ended[chain, place] = span[1] <= time[-1]
                dwell[chain, place] = min(span[1], time[-1]) - max(span[0], time[0])
        return Readings(
            self.gauges, time, force, self._static, largest, largest_at, self._impulse.copy(), dwell, ended, contacts
        )

    def _read(self, block: Trajectory, place: int, gauge: Gauge) -> None:
        """Take in what one gauge reads from the first frame of a block to its last."""
        spacing, chains = block.spacing, np.arange(self.problem.chains)
        curves = [
            Curve.between(probe, strain_at_frames(block, probe), memory_at_frames(block, probe), chains, spacing)
            for probe in gauge.probes
        ]
        chain = curves[0].chain
        moving = np.flatnonzero(np.any([np.any(curve.polynomial != 0.0, axis=0) for curve in curves], axis=0))
        border = borders(spacing)
        static = gauge.static[chain]
        forces = np.tile(static, (len(border), 1))
        forces[:, moving] = 0.0
        pressing = forces.copy() if gauge.damped else forces
        impulse = np.zeros(len(chain))
        for curve in curves:
            single = curve.of(moving)
            at_borders = [np.full(len(moving), s) for s in border]
            forces[:, moving] += np.stack([single(s) for s in at_borders]) / len(curves)
            if gauge.damped:
                pressing[:, moving] += np.stack([single.elastic(s) for s in at_borders]) / len(curves)
            impulse[moving] += (single.integral(border) - curve.probe.static[chain[moving]]) * spacing / len(curves)
        # term by term: the order must not depend on how many there are at once
        np.add.at(self._impulse[:, place], chain, impulse)

        def mean(entry: Integers, s: Floats) -> Floats:
            return np.asarray(sum(curve.of(entry)(s) for curve in curves)) / len(curves)

        shut = pressing > CLOSED
        panel, entry = np.nonzero(shut[:-1] != shut[1:])
        before, changing = shut[panel, entry], [curve.of(entry) for curve in curves]

        def closed(s: Floats) -> Flags:
            return np.asarray(sum(curve.elastic(s) for curve in changing)) / len(curves) > CLOSED

        at = hermite.change(closed, before, border[panel], border[panel + 1])
        start = np.repeat(block.time[:-1], self.problem.chains)[entry]
        self._changes[place].append((entry % self.problem.chains, start + at * spacing, ~before))
        if gauge.damped:  # a dashpot's force may jump to its largest where a contact closes
            entry, after = entry[~before], np.minimum(at[~before] + _JUST, 1.0)
            self._take_values(place, entry, start[~before] + after * spacing, mean(entry, after))
        self._take_largest(place, block, forces.reshape(len(border), -1, self.problem.chains), border, mean)

    def _take_values(self, place: int, entry: Integers, time: Floats, value: Floats) -> None:
        """Take values at times for the largest, where they are larger than those so far."""
        chain = entry % self.problem.chains
        for k in np.argsort(value):
            if value[k] > self._largest[chain[k], place]:
                self._largest[chain[k], place] = value[k]
                self._largest_at[chain[k], place] = time[k]

    def _take_largest(
        self,
        place: int,
        block: Trajectory,
        forces: Floats,
        border: Floats,
        mean: Callable[[Integers, Floats], Floats],
    ) -> None:
        """Refine what is nearly the largest of the values at borders, [border, interval, chain]."""
        value = forces.max(axis=0)
        most = np.maximum(value.max(axis=0), self._largest[:, place])
        interval, chain = np.nonzero(value > most - NEARLY * np.abs(most))
        top = np.argmax(forces[:, interval, chain], axis=0)
        low, high = border[np.maximum(top - 1, 0)], border[np.minimum(top + 1, len(border) - 1)]
        entry = interval * forces.shape[2] + chain
        at = maximum(lambda s: mean(entry, s), low, high)
        self._take_values(place, entry, block.time[interval] + at * block.spacing, mean(entry, at))
