"""Force over time as it is measured: on walls, in contacts, and inside a bead, with what a gauge there would report.

Force follows from displacements. Between two frames a displacement is the polynomial of degree five through its value
and two derivatives there (degree three, where the beads around were not recorded), so that a force is known at any
time: its impulse is an integral by Gauss rules, cut where a contact opens or closes; its largest value lies between
frames, and so do the moments at which contacts open and close.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from analysis import hermite, motion
from analysis.gauges.between_frames import Curve, borders, change, maximum
from analysis.gauges.gauge import Gauge, Integers, Probe
from analysis.gauges.readings import Readings
from analysis.trajectory import Floats, Trajectory, joined
from lammps_inputs import Problem

CLOSED = 1e-9
"""Force from which on a contact counts as closed, of an overlap of 1e-6, far above rounding: behind a pulse beads touch
with hardly any force.
"""

NEARLY = 0.99
"""Share of the largest force that a panel's ends must have for the largest to be looked for in it: forces are round
enough for a panel to hide 0.2%.
"""

MOST_ENTRIES = 4000
"""Stretches from frame to frame that are looked at together, which bounds the memory."""


def at_frames(block: Trajectory, gauges: tuple[Gauge, ...]) -> Floats:
    """What gauges read at the frames of a run, [frame, chain, gauge]; the beads they need must be recorded."""
    force = np.zeros((block.frames, block.problem.chains, len(gauges)))
    chain = np.arange(block.problem.chains)
    for place, gauge in enumerate(gauges):
        for probe in gauge.probes:
            strain = _column(block, block.displacement, probe.behind) - _column(block, block.displacement, probe.ahead)
            force[..., place] += probe.force(strain, np.broadcast_to(chain, strain.shape)) / len(gauge.probes)
    return force


def _column(block: Trajectory, values: Floats, bead: int) -> Floats:
    """[frame, chain] of a bead; 0 for what is at rest."""
    if bead == 0:
        return np.zeros(values.shape[:2])
    return np.asarray(values[:, :, int(np.searchsorted(block.problem.recorded_beads, bead))])


class ForceMeter:
    """Reads gauges in a run that is given piece by piece; holds one frame and what it found."""

    def __init__(self, problem: Problem, gauges: tuple[Gauge, ...]) -> None:
        self.problem = problem
        self.gauges = gauges
        shape = (problem.chains, len(gauges))
        self._time: list[Floats] = []
        self._force: list[Floats] = []
        self._largest, self._impulse = np.zeros((2, *shape))
        self._largest_at = np.full(shape, np.nan)
        self._changes: list[list[tuple[Integers, Floats, NDArray[np.bool_]]]] = [[] for _ in gauges]
        self._carried: Trajectory | None = None

    def add(self, block: Trajectory) -> None:
        """Take the next frames, evenly spaced in time with those before."""
        self._time.append(block.time.copy())
        self._force.append(at_frames(block, self.gauges))
        if self._carried is not None:
            block = joined([self._carried, block])
        step = max(1, MOST_ENTRIES // self.problem.chains)
        for start in range(0, block.frames - 1, step):
            part = block[start : start + step + 1]
            for place, gauge in enumerate(self.gauges):
                self._read(part, place, gauge)
        self._carried = replace(
            block,
            time=block.time[-1:].copy(),
            displacement=block.displacement[-1:].copy(),
            velocity=block.velocity[-1:].copy(),
        )

    def result(self) -> Readings:
        """Of the frames so far.

        Raises:
            ValueError: there was none.
        """
        if not self._time:
            raise ValueError("no frames to read forces from")
        time, force = np.concatenate(self._time), np.concatenate(self._force)
        dwell, contacts = np.zeros(self._largest.shape), np.zeros(self._largest.shape, dtype=np.int64)
        for place, changes in enumerate(self._changes):
            for chain in range(self.problem.chains):
                starts = [when[(of == chain) & closes] for of, when, closes in changes]
                ends = [when[(of == chain) & ~closes] for of, when, closes in changes]
                start = np.sort(np.concatenate([time[:1][force[0, chain, place : place + 1] > CLOSED], *starts]))
                end = np.sort(np.concatenate([*ends, time[-1:]]))
                contacts[chain, place] = len(start)
                hardest = int(np.searchsorted(start, self._largest_at[chain, place])) - 1
                if 0 <= hardest < len(start):
                    dwell[chain, place] = end[hardest] - start[hardest]
        largest = np.copy(self._largest), np.copy(self._largest_at), np.copy(self._impulse)
        return Readings(self.gauges, time, force, *largest, dwell, contacts)

    def _read(self, block: Trajectory, place: int, gauge: Gauge) -> None:
        """Take in what one gauge reads from the first frame of a block to its last."""
        spacing = block.spacing
        polynomials = [self._polynomial(block, probe, spacing) for probe in gauge.probes]
        size = (block.frames - 1) * self.problem.chains
        chain = np.tile(np.arange(self.problem.chains), block.frames - 1)
        moving = np.flatnonzero(np.any([np.any(p != 0.0, axis=0) for p in polynomials], axis=0))
        border = borders(spacing)
        forces = np.zeros((len(border), size))
        for probe, polynomial in zip(gauge.probes, polynomials, strict=True):
            single = Curve(probe.force, polynomial[:, moving], chain[moving])
            forces[:, moving] += np.stack([single(np.full(len(moving), s)) for s in border]) / len(gauge.probes)
            impulse = np.zeros(size)
            impulse[moving] = single.integral(border) * spacing / len(gauge.probes)
            # term by term: the order must not depend on how many there are at once
            np.add.at(self._impulse[:, place], chain, impulse)

        def mean(entry: Integers, s: Floats) -> Floats:
            curves = (Curve(p.force, q[:, entry], chain[entry]) for p, q in zip(gauge.probes, polynomials, strict=True))
            return np.asarray(sum(curve(s) for curve in curves)) / len(gauge.probes)

        start = np.repeat(block.time[:-1], self.problem.chains)
        self._take_changes(place, start, forces > CLOSED, border, mean, spacing)
        self._take_largest(place, block, forces.reshape(len(border), -1, self.problem.chains), border, mean)

    def _take_changes(
        self,
        place: int,
        start: Floats,
        closed: NDArray[np.bool_],
        border: Floats,
        mean: Callable[[Integers, Floats], Floats],
        spacing: float,
    ) -> None:
        """Note when contacts open and close; ``start`` is the time of the frame before, of every entry."""
        panel, entry = np.nonzero(closed[:-1] != closed[1:])
        before = closed[panel, entry]
        at = change(lambda s: mean(entry, s) > CLOSED, before, border[panel], border[panel + 1])
        self._changes[place].append((entry % self.problem.chains, start[entry] + at * spacing, ~before))

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
        interval, chain = np.nonzero(value > NEARLY * np.maximum(value.max(axis=0), self._largest[:, place]))
        top = np.argmax(forces[:, interval, chain], axis=0)
        low, high = border[np.maximum(top - 1, 0)], border[np.minimum(top + 1, len(border) - 1)]
        entry = interval * forces.shape[2] + chain
        at = maximum(lambda s: mean(entry, s), low, high)
        found = mean(entry, at)
        for k in np.argsort(found):
            if found[k] > self._largest[chain[k], place]:
                self._largest[chain[k], place] = found[k]
                self._largest_at[chain[k], place] = block.time[interval[k]] + at[k] * block.spacing

    def _polynomial(self, block: Trajectory, probe: Probe, spacing: float) -> Floats:
        """Strain in s = (time - frame's) / spacing, [power, interval * chains + chain]."""
        beads = (probe.behind, probe.ahead)
        states = [[_column(block, values, bead) for bead in beads] for values in (block.displacement, block.velocity)]
        if self.problem.recorded is None:
            states.append([self._acceleration(block, bead) for bead in beads])
        data = np.array([behind - ahead for behind, ahead in states])  # [derivative, frame, chain]
        ends = np.stack([data[:, :-1], data[:, 1:]]).reshape(2, len(data), -1)
        return hermite.coefficients((0, 1), ends, spacing)

    def _acceleration(self, block: Trajectory, bead: int) -> Floats:
        if bead == 0:
            return np.zeros((block.frames, self.problem.chains))
        frame, chain = np.indices((block.frames, self.problem.chains))
        return motion.acceleration_and_rate(block, frame, chain, np.full(frame.shape, bead - 1))[0]
