"""Force over time as it is measured: on walls, in contacts, and inside a bead, with what a gauge there would report.

Between frames a force and bounds on it follow from the strain of its contact (`analysis.gauges.curve`): its impulse is
an integral by Gauss rules, cut where a contact opens or closes; its largest value lies between frames, and so do the
moments at which contacts open and close. Each has an uncertainty by the time between frames.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from analysis import hermite
from analysis.gauges.curve import GaugeCurve, between_frames, borders, excursion, excursion_error, fastest, maximum
from analysis.gauges.gauge import Gauge, at_frames
from analysis.gauges.reflection import Reflection
from analysis.quantity import declare, result
from analysis.trajectory import Flags, Floats, Integers, Trajectory, joined
from lammps_inputs import Problem

PULSE = 0.01
"""Share of its largest value, above the static one, from which a force is that of a pulse."""


LARGEST_UNCERTAINTY = 0.05
"""Uncertainty of the largest force, in its excess over the static one, beyond which it is not stated; that of an
impulse, in the integral of the size of that excess; and that of a dwell, in itself.
"""

NOT_ABOVE = "the force never exceeds the static one by more than the numerical noise"
NO_LOAD = "there is no static load"
TOO_COARSE = "frames are so far apart that its uncertainty exceeds a twentieth of"
COARSE_FORCE = f"{TOO_COARSE} the largest excess over the static force"
BY_FRAMES = "by the time between frames"


@result
class Reading:
    """What one gauge has read at one chain."""

    kind: str = declare("``wall``, ``contact`` or ``sensor``")
    name: str = declare("name of the gauge, with which its columns in ``forces.csv`` begin")
    chain: int = declare("number of the chain")
    bead: int = declare("bead at the wall; the first bead of a contact; the bead with the sensor")
    largest: float = declare("largest total force, at frames and between them", "force", COARSE_FORCE, symbol="F_m")
    largest_error: float = declare(f"uncertainty of ``largest`` and ``dynamic`` {BY_FRAMES}", "force", "as ``largest``")
    at: float = declare("time of the largest force", "time", f"{NOT_ABOVE}; {COARSE_FORCE}")
    at_error: float = declare(
        f"uncertainty of ``at`` {BY_FRAMES}: how far from it the force may be as large", "time", "as ``at``"
    )
    static: float | None = declare("force at rest, which ``largest`` includes", "force", NO_LOAD, "F_0")
    dynamic: float | None = declare(
        "largest force above the static one", "force", f"{NO_LOAD}; {NOT_ABOVE}; {COARSE_FORCE}"
    )
    impulse: float = declare(
        "integral over time of the total force minus the static one",
        "momentum",
        f"{TOO_COARSE} the integral of the size of that difference",
    )
    impulse_error: float = declare(f"uncertainty of ``impulse`` {BY_FRAMES}", "momentum", "as ``impulse``")
    dwell: float = declare(
        "duration of the contact in which the force was largest; under a static load, of the time around the maximum "
        "in which the force exceeded the static one by 1 % of its largest excess; until the end of the record where it "
        "had not ended",
        "time",
        f"{TOO_COARSE} it, or leave open in which contact the force was largest",
    )
    dwell_error: float = declare(f"uncertainty of ``dwell`` {BY_FRAMES}", "time", "as ``dwell``")
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
        """Gauge by gauge, and chain by chain; ``reflected`` by the wall of each side, chain by chain."""
        stated = ("largest", "at", "impulse", "dwell")
        names = (*stated, *(f"{name}_error" for name in stated), "last")
        columns = {name: getattr(self, name) for name in (*names, *(("static", "dynamic") if self.loaded else ()))}
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

AT_ONCE = 1e-10
"""Of the time between frames: how long after the start dashpots of beads that touch act, with forces below `CLOSED`."""

FAINT = 1e-5
"""Uncertainty of forces and impulses, in m V / T and m V, up to which they are stated however small they are."""

FINE = 32
"""Parts of the time between two frames in which the largest force may lie."""

STEEP = 10.0
"""Slope of what a force between frames may be off by, in that over the time between them."""

MOST_ENTRIES = 4000
"""Stretches from frame to frame that are looked at together, which bounds the memory."""


@dataclass(frozen=True)
class _Changes:
    """Moments at which contacts close or open, each [change].

    Attributes:
        chain: whose, from 0.
        time: when.
        closes: whether it closes.
        error: uncertainty of the time.
    """

    chain: Integers
    time: Floats
    closes: Flags
    error: Floats


@dataclass(frozen=True)
class _Candidates:
    """Stretches from frame to frame in which a force may be largest.

    Attributes:
        curve: their forces.
        start: [stretch] times of the first frames.
        high: [stretch] bound on the force from above.
        jump: [stretch] where the contact has just closed, so that its dashpot's force has set in, in s; NaN elsewhere.
    """

    curve: GaugeCurve
    start: Floats
    high: Floats
    jump: Floats

    def above(self, level: Floats) -> "_Candidates":
        """Those whose bound reaches a level of their chain, [chain]."""
        chosen = np.flatnonzero(self.high >= level[self.curve.chain])
        return _Candidates(self.curve.of(chosen), self.start[chosen], self.high[chosen], self.jump[chosen])

    def tops(self, border: Floats) -> tuple[Floats, Floats]:
        """Where each force is largest, in s, and how large it is there; ``border`` of panels with one maximum each."""
        forces = np.stack([self.curve(np.full(len(self.start), s)) for s in border])
        top = np.argmax(forces, axis=0)
        at = maximum(self.curve, border[np.maximum(top - 1, 0)], border[np.minimum(top + 1, len(border) - 1)])
        value, at_border = self.curve(at), np.max(forces, axis=0)
        at, value = np.where(at_border > value, border[top], at), np.maximum(at_border, value)
        after = self.curve(np.where(np.isfinite(self.jump), self.jump, at))
        return np.where(after > value, self.jump, at), np.maximum(after, value)


class _Largest(NamedTuple):
    """Largest force of a gauge in each chain, and when, each [chain], with their uncertainties."""

    value: Floats
    at: Floats
    error: Floats
    at_error: Floats


class ForceMeter:
    """Reads gauges in a run that is given piece by piece; holds one frame, and stretches with large forces."""

    def __init__(self, problem: Problem, gauges: tuple[Gauge, ...]) -> None:
        self.problem = problem
        self.gauges = gauges
        shape = (problem.chains, len(gauges))
        self._frequency = fastest(problem)
        self._spacing = problem.every
        self._time: list[Floats] = []
        self._force: list[Floats] = []
        self._static = np.stack([gauge.static for gauge in gauges], axis=-1)
        self._impulse, self._impulse_error, self._size = np.zeros((3, *shape))
        self._lower = np.full(shape, -np.inf)
        """[chain, gauge] what the largest force is not below."""
        self._closed = np.zeros(shape, dtype=bool)
        self._changes: list[list[_Changes]] = [[] for _ in gauges]
        self._candidates: list[list[_Candidates]] = [[] for _ in gauges]
        self._carried: Trajectory | None = None

    def add(self, block: Trajectory) -> None:
        """Take the next frames, evenly spaced in time with those before."""
        self._time.append(block.time.copy())
        self._force.append(at_frames(block, self.gauges))
        self._lower = np.maximum(self._lower, self._force[-1].max(axis=0))
        if self._carried is not None:
            block = joined([self._carried, block])
        else:
            self._closed = at_frames(block[:1], self.gauges, dashpots=False)[0] > CLOSED
            block = _begun(block)
        step = max(1, MOST_ENTRIES // self.problem.chains)
        for start in range(0, block.frames - 1, step):
            part = block[start : start + step + 1]
            self._spacing = part.spacing
            for place, gauge in enumerate(self.gauges):
                self._read(part, place, gauge)
        self._carried = block.last()

    def result(self) -> Readings:
        """Readings of the frames so far.

        Raises:
            ValueError: there was none.
        """
        if not self._time:
            raise ValueError("no frames to read forces from")
        time, force = np.concatenate(self._time), np.concatenate(self._force)
        by_gauge = [self._largest(place, time, force[..., place]) for place in range(len(self.gauges))]
        largest = _Largest(*(np.stack(values, axis=-1) for values in zip(*by_gauge, strict=True)))
        excess = np.max(np.abs(force - self._static), axis=0)
        excess = np.maximum(excess, np.abs(largest.value - self._static))
        stated = largest.error <= np.maximum(LARGEST_UNCERTAINTY * excess, FAINT)
        risen = stated & (largest.value - self._static > CLOSED * np.maximum(1.0, self._static))
        at = np.where(risen, largest.at, np.nan)
        certain = self._impulse_error <= np.maximum(LARGEST_UNCERTAINTY * self._size, FAINT)
        dwell, dwell_error, ended, contacts = self._dwells(time, force, largest._replace(at=at))
        dwell, dwell_error = np.where(stated, [dwell, dwell_error], np.nan)
        return Readings(
            gauges=self.gauges,
            time=time,
            force=force,
            static=self._static,
            largest=np.where(stated, largest.value, np.nan),
            at=at,
            impulse=np.where(certain, self._impulse, np.nan),
            dwell=dwell,
            largest_error=np.where(stated, largest.error, np.nan),
            at_error=np.where(risen, largest.at_error, np.nan),
            impulse_error=np.where(certain, self._impulse_error, np.nan),
            dwell_error=dwell_error,
            ended=ended,
            contacts=contacts,
        )

    def _dwells(self, time: Floats, force: Floats, largest: _Largest) -> tuple[Floats, Floats, Flags, Integers]:
        """Dwell, its uncertainty, whether it ended, and how often contacts closed, each [chain, gauge].

        Args:
            time: [frame].
            force: [frame, chain, gauge].
            largest: of all gauges, each [chain, gauge].
        """
        dwell, error = np.zeros((2, *self._static.shape))
        ended, contacts = np.zeros(dwell.shape, dtype=bool), np.zeros(dwell.shape, dtype=np.int64)
        for chain, place in np.ndindex(*dwell.shape):
            shut, opened = self._moments(chain, place, float(time[0]))
            contacts[chain, place] = len(shut)
            at, off, static = largest.at[chain, place], largest.at_error[chain, place], self._static[chain, place]
            if np.isnan(at) or len(shut) == 0:
                continue
            number = max(int(np.searchsorted(shut[:, 0], at, side="right")) - 1, 0)
            (start, early), (end, late) = shut[number], opened[number]
            if static > CLOSED:
                above, level = force[:, chain, place] - static, PULSE * float(largest.value[chain, place] - static)
                start, end = excursion(time, above, float(at), level)
                early, late = 0.0, excursion_error(time, above, (start, end), level, float(CLOSED - static))
            ended[chain, place] = end <= time[-1]
            dwell[chain, place] = min(end, time[-1]) - max(start, time[0])
            before = opened[number - 1, 0] if number > 0 else -np.inf
            after = shut[number + 1, 0] if number + 1 < len(shut) else np.inf
            # else the force may have been largest in another contact
            error[chain, place] = early + late if before <= at - off and at + off <= after else np.inf
        stated = error <= LARGEST_UNCERTAINTY * dwell
        return np.where(stated, dwell, np.nan), np.where(stated, error, np.nan), ended, contacts

    def _moments(self, chain: int, place: int, begin: float) -> tuple[Floats, Floats]:
        """Times at which the contact of a chain closes and opens, and their uncertainties, each [change, 0 or 1].

        It opens at infinity where that was not seen.
        """
        parts = self._changes[place]
        moments = np.concatenate([np.stack([part.time, part.error, part.closes], axis=1) for part in parts] or [_NEVER])
        chains = np.concatenate([part.chain for part in parts]) if parts else np.zeros(0)
        moments = moments[chains == chain]
        moments = moments[np.argsort(moments[:, 0], kind="stable")]
        closes = moments[:, 2] > 0.0
        at_start = np.array([[begin, 0.0]] * int(self._closed[chain, place])).reshape(-1, 2)
        return (
            np.concatenate([at_start, moments[closes, :2]]),
            np.concatenate([moments[~closes, :2], [[np.inf, 0.0]]]),
        )

    def _read(self, block: Trajectory, place: int, gauge: Gauge) -> None:
        """Take in what one gauge reads from the first frame of a block to its last."""
        spacing, border = block.spacing, borders(block.spacing, self._frequency)
        curves = between_frames(block, gauge, self._frequency)
        stretch = np.flatnonzero(curves.moving)
        curve, start = curves.of(stretch), np.repeat(block.time[:-1], self.problem.chains)[stretch]
        chain, static = curve.chain, gauge.static[curve.chain]
        at_borders = [np.full(len(stretch), s) for s in border]
        force = np.stack([curve(s) for s in at_borders])
        middles = 0.5 * (border[:-1] + border[1:])
        low, high = np.stack([curve.bounds(np.full(len(stretch), s)) for s in middles], axis=1)
        # term by term: the order must not depend on how many there are at once
        np.add.at(self._impulse[:, place], chain, curve.impulse(border))
        np.add.at(self._impulse_error[:, place], chain, 0.5 * spacing * np.mean(high - low, axis=0))
        np.add.at(self._size[:, place], chain, spacing * np.mean(np.abs(0.5 * (low + high) - static), axis=0))
        pressing = np.stack([curve.elastic(s) for s in at_borders]) if gauge.damped else force
        at, entry = self._take_changes(place, curve, start, pressing > CLOSED)
        bound, jump = np.maximum(force.max(axis=0), high.max(axis=0)), np.full(len(stretch), np.nan)
        if gauge.damped and len(entry):  # a dashpot's force may jump to its largest where a contact closes
            jump[entry] = np.minimum(at + _JUST, 1.0)
            bound[entry] = np.maximum(bound[entry], curve.of(entry).bounds(jump[entry])[1])
        np.maximum.at(self._lower[:, place], chain, low.max(axis=0))
        risen = bound - static > CLOSED * np.maximum(1.0, static)
        candidates = _Candidates(curve, start, np.where(risen, bound, -np.inf), jump)
        self._candidates[place].append(candidates.above(self._level(place)))

    def _take_changes(self, place: int, curve: GaugeCurve, start: Floats, shut: Flags) -> tuple[Floats, Integers]:
        """Find where contacts close and open, [border, stretch]; where, in s, and in which stretches they close."""
        border = borders(self._spacing, self._frequency)
        panel, entry = np.nonzero(shut[:-1] != shut[1:])
        before, changing = shut[panel, entry], curve.of(entry)
        at = hermite.change(lambda s: changing.elastic(s) > CLOSED, before, border[panel], border[panel + 1])
        error = changing.late(at) * self._spacing
        moments = start[entry] + at * self._spacing
        self._changes[place].append(_Changes(curve.chain[entry], moments, ~before, error))
        return at[~before], entry[~before]

    def _level(self, place: int) -> Floats:
        """[chain] bound from above that a stretch must reach for the force to be largest in it."""
        lower = self._lower[:, place]
        return np.asarray(lower - NEARLY * np.abs(lower - self._static[:, place]))

    def _largest(self, place: int, time: Floats, force: Floats) -> _Largest:
        """Largest force of a gauge, by the frames, [frame, chain], and what is between them."""
        chains, border = np.arange(self.problem.chains), borders(self._spacing, self._frequency)
        first = np.argmax(force, axis=0)
        largest, at = force[first, chains], time[first]
        lower, upper, late = largest.copy(), largest.copy(), np.zeros(len(chains))
        parts = [candidates.above(self._level(place)) for candidates in self._candidates[place]]
        parts = [candidates for candidates in parts if len(candidates.start)]
        tops = [candidates.tops(border) for candidates in parts]
        bounds = [candidates.curve.bounds(s) for candidates, (s, _) in zip(parts, tops, strict=True)]
        for candidates, (s, value), (low, high) in zip(parts, tops, bounds, strict=True):
            chain = candidates.curve.chain
            np.maximum.at(lower, chain, low)
            np.maximum.at(upper, chain, np.maximum(high, candidates.high))
            for number in np.unique(chain).tolist():
                entry = int(np.argmax(np.where(chain == number, value, -np.inf)))
                if value[entry] > largest[number]:
                    largest[number], at[number] = value[entry], candidates.start[entry] + s[entry] * self._spacing
        for candidates, (s, _) in zip(parts, tops, strict=True):
            np.maximum.at(late, candidates.curve.chain, self._late(candidates, s, lower, at))
        return _Largest(largest, at, np.maximum(upper - largest, largest - lower), late)

    def _late(self, candidates: _Candidates, s: Floats, lower: Floats, at: Floats) -> Floats:
        """How far from a time forces may reach a level, [stretch]; 0 where they do not.

        Args:
            candidates: the stretches.
            s: [stretch] where each force is largest.
            lower: [chain] the level.
            at: [chain] the time.
        """
        curve, spacing = candidates.curve, self._spacing
        level, time = lower[curve.chain], at[curve.chain] - candidates.start
        grid = np.linspace(0.0, 1.0, FINE + 1)
        reached = np.stack([curve.bounds(np.full(len(s), place))[1] >= level for place in grid])
        between = ~reached.any(axis=0)
        first, last = np.argmax(reached, axis=0) - 1, FINE + 1 - np.argmax(reached[::-1], axis=0)
        low, high = curve.bounds(s)
        first, last = (np.where(between, s * FINE + step, end) for step, end in ((-1.0, first), (1.0, last)))
        ends = (np.clip(end / FINE, 0.0, 1.0) * spacing - time for end in (first, last))
        late = np.where(between & (high < level), 0.0, np.max(np.abs([*ends]), axis=0))
        # about the maximum itself the slope of what the force may be off by decides
        step = 1.0 / FINE
        bend = -(curve(s - step) - 2.0 * curve(s) + curve(s + step)) / step**2
        by_slope = np.where(bend > 0.0, STEEP * 0.5 * (high - low) / np.where(bend > 0.0, bend, 1.0), np.inf) * spacing
        return np.where(
            (np.abs(s * spacing - time) < step * spacing) & (late <= 3.0 * step * spacing),
            np.minimum(late, by_slope),
            late,
        )


def _begun(block: Trajectory) -> Trajectory:
    """Frames from the start of a run with dashpots, of which the first is that just after the start.

    Beads that touch at the start are closed then, and their dashpots act.
    """
    if not block.problem.system.dampers or block.frames < 2:
        return block
    displacement = block.displacement.copy()
    displacement[0] += AT_ONCE * block.spacing * block.velocity[0]
    return replace(block, displacement=displacement)


_NEVER = np.zeros((0, 3))
"""Moments where nothing closes or opens."""
