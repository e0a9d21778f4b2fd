"""What arrives at the far end of the chains: the force on the wall there, the energy, and the delay.

A quantity is undefined, NaN, where nothing has arrived, or the record ends before it has passed: a force or energy must
exceed the numerical noise, and its largest value must lie before the last frame (or it has stopped rising, `_settled`).
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, Self

import numpy as np

from analysis import hermite, motion
from analysis.conservation import energy_input
from analysis.gauges.contact_curve import ContactCurve, ContactFrames, crossing, maximum
from analysis.gauges.gauge import Gauge, at_frames, far_wall
from analysis.meters import Meter, Part
from analysis.quantity import declare, result
from analysis.sharing.run_error import MeasuredError
from analysis.sharing.survey import Survey
from analysis.trajectory import Floats, Integers
from lammps_inputs import Problem, System, physics
from lammps_inputs.facts import Fact
from workflow.measures.measurement import Measurement, Recorded

PART = 10
"""The far end is the last row in so many."""

FAINTEST = 1e-9
"""Force above the static one from which something has arrived, as a share of the static force where that exceeds 1:
that of an overlap of 1e-6 L, far above rounding."""

FAINTEST_ENERGY = 1e-15
"""Energy in units of m V**2 from which something has arrived: that of an overlap of 1e-6 L."""

LEVEL = 1e-3
"""Relative change within which an energy has stopped rising, as where the last beads fly off a free end."""


INSTANT = 1e-4
"""Time step of the central difference that gives the rate of an energy: accurate to 1e-8 of it in smooth motion. Where
contacts yield, whose states of an instant before are unknown, a forward difference is accurate to 1e-4.
"""

UNPASSED = "nothing has arrived, or the record ends inside the pulse"
ACTED_ON = "chains are rings, a push or drive acts on the last tenth, beads fall, or the foundation varies in time"


VALUES = ("wall_force", "wall_force_chain", "delay", "transmitted_energy")

UNCERTAIN = "its largest change by every second frame, and by the run (``run_error``)"
UNKNOWN = "so is it, or every second frame does not show it"


@result
class Transmitted:
    """What has arrived at the far end."""

    wall_force: float = declare(
        "largest force on the far wall, of all chains together, static load included",
        "force",
        f"there is no wall, {UNPASSED}",
        column="largest force on the far wall",
    )
    wall_force_chain: float = declare(
        "largest force of any one chain on the far wall, static load included",
        "force",
        f"there is no wall, {UNPASSED}",
        column="largest force of a chain on the far wall",
    )
    delay: float = declare(
        "time at which the force on the far wall is largest; without a wall, at which the energy at the far end first "
        "reaches half of its largest value",
        "time",
        f"{UNPASSED}; without a wall, {ACTED_ON}",
        column="delay until the far end",
    )
    transmitted_energy: float = declare(
        "largest share at any time of the energy input until then that is in the last tenth of the beads: kinetic, of "
        "their contacts, of the wall and of the foundation, not of springs between chains",
        undefined=f"{UNPASSED}, {ACTED_ON}, or the work is not known",
        column="largest energy at the far end / energy input",
    )
    wall_force_error: float = declare(f"uncertainty of ``wall_force``: {UNCERTAIN}", "force", UNKNOWN, default=math.nan)
    wall_force_chain_error: float = declare(
        f"uncertainty of ``wall_force_chain``: {UNCERTAIN}", "force", UNKNOWN, default=math.nan
    )
    delay_error: float = declare(f"uncertainty of ``delay``: {UNCERTAIN}", "time", UNKNOWN, default=math.nan)
    transmitted_energy_error: float = declare(
        f"uncertainty of ``transmitted_energy``: {UNCERTAIN}, 2 e sqrt(M E) + M e^2 over the energy input with mass M "
        "and energy E of these beads",
        undefined=UNKNOWN,
        default=math.nan,
    )
    supplied: float = math.nan
    """Energy input until that share is largest at a frame, in units of m V**2."""


class _FarFrames(NamedTuple):
    """What frames show of the far end.

    Attributes:
        time: [frame] in units of T.
        energy: [frame] energy of the last tenth of the beads, in units of m V**2.
        rate: [frame] its rate.
        supplied: [frame] energy input until then.
        force: [frame, chain] force on the far wall, in units of m V / T; None where there is none.
        contact: frames of the contact with it.
    """

    time: Floats
    energy: Floats
    rate: Floats
    supplied: Floats
    force: Floats | None
    contact: ContactFrames | None

    @classmethod
    def joined(cls, parts: "list[_FarFrames]") -> "_FarFrames":
        """Frames one after the other."""
        time, energy, rate, supplied = (np.concatenate(values) for values in list(zip(*parts, strict=True))[:4])
        forces = [part.force for part in parts if part.force is not None]
        contacts = [part.contact for part in parts if part.contact is not None]
        force, contact = (np.concatenate(forces), ContactFrames.joined(contacts)) if forces else (None, None)
        return cls(time, energy, rate, supplied, force, contact)

    def every_second(self, first: int) -> "_FarFrames":
        """Every second frame from a position on."""
        chosen = slice(first, None, 2)
        time, energy, rate, supplied = (values[chosen] for values in self[:4])
        force = contact = None
        if self.force is not None and self.contact is not None:
            force, contact = self.force[chosen], self.contact.near(chosen, np.arange(self.force.shape[1]))
        return _FarFrames(time, energy, rate, supplied, force, contact)


def last_tenth(problem: Problem) -> slice:
    """Positions of the last tenth of the beads in the direction of the largest excitation."""
    rows = max(1, problem.beads // PART)
    return slice(problem.beads - rows, problem.beads) if problem.direction > 0 else slice(0, rows)


@dataclass(frozen=True)
class FarEndMeter(Meter[_FarFrames, Transmitted]):
    """What arrives at the end of the chains that the largest excitation goes towards, in a run of all beads.

    Attributes:
        problem: what was run.
    """

    problem: Problem

    @cached_property
    def _rows(self) -> slice:
        """Positions of the last tenth of the beads."""
        return last_tenth(self.problem)

    @cached_property
    def _wall(self) -> Gauge | None:
        return far_wall(self.problem.system)

    @property
    def _acted_on(self) -> bool:
        """Whether forces from outside act on the last tenth of the beads, or the first bead, as in a ring."""
        system = self.problem.system
        beads = [load.bead for load in system.loads] + [prescribed.bead for prescribed in system.motions]
        if system.closing or system.weights or physics.varying(system):
            return True
        return any(self._rows.start < bead <= self._rows.stop for bead in beads)

    def of_part(self, part: Part) -> _FarFrames:
        """Energy and force at the frames of a part."""
        block, near = part.frames, slice(max(self._rows.start - 1, 0), self._rows.stop + 1)
        x, v = (values[..., near] for values in block.atoms)
        with np.errstate(over="ignore", invalid="ignore"):  # of a run that blew up
            system = block.system
            a = motion.acceleration(system, x, near.start + 1, velocity=v)
            # where forces depend on the past they are known for the instant after a frame, not for the one before
            back = INSTANT if system.holds(Fact.FRAMES) else 0.0
            now, after, before = (
                self._stored(system, near.start, x + late * v, v + late * a) for late in (0.0, INSTANT, -back)
            )
            rate = (after - before) / (INSTANT + back)
            force = contact = None
            if self._wall is not None:
                force, contact = at_frames(block, (self._wall,))[..., 0], ContactFrames.of(block, self._wall.probes[0])
            return _FarFrames(block.time.copy(), now, rate, energy_input(block), force, contact)

    def _stored(self, system: System, start: int, x: Floats, v: Floats) -> Floats:
        """Energy of the last tenth of the beads, [frame], from states of those from a position on."""
        rows = slice(self._rows.start - start, self._rows.stop - start)
        x, v = x[..., : system.chains, rows], v[..., : system.chains, rows]
        return np.asarray(motion.bead_energy(system, x, v, self._rows.start + 1).sum(axis=(1, 2)))

    def result(self, pieces: list[_FarFrames]) -> Transmitted:
        """Transmitted quantities of all frames, with what every second frame changes in them."""
        frames = _FarFrames.joined(pieces)
        values, *halves = (self._of(some) for some in (frames, frames.every_second(0), frames.every_second(1)))
        errors = np.max(np.abs(np.array(halves) - values), axis=0)
        supplied = float(frames.supplied[np.argmax(_share(frames.energy, frames.supplied))])
        of_values = {f"{name}_error": float(error) for name, error in zip(VALUES, errors, strict=True)}
        return Transmitted(*values, **of_values, supplied=supplied)

    def _of(self, frames: _FarFrames) -> tuple[float, float, float, float]:
        """Largest force on the far wall and of a chain, delay, and transmitted energy, as in `Transmitted`."""
        time, energy, rate, supplied, force, contact = frames
        delay = transmitted = math.nan
        if len(time) == 0:
            return math.nan, math.nan, math.nan, math.nan
        if not self._acted_on:
            share = _share(energy, supplied)
            if _passed(time, energy):
                delay = _reached(time, energy, rate, 0.5 * _largest(time, energy, rate, np.ones_like(time)))
            if _passed(time, share):
                transmitted = _largest(time, energy, rate, supplied)
        if self._wall is None or force is None or contact is None:
            return math.nan, math.nan, delay, transmitted
        series, chains = (time, force, contact), np.arange(self.problem.chains)
        delay, wall_force = _arrived(series, chains, self._wall)
        of_single_chain = wall_force
        if len(chains) > 1:
            of_each = [_arrived(series, chain, self._wall)[1] for chain in chains[:, None]]
            of_single_chain = float(np.fmax.reduce(of_each))
        if np.max(force) > of_single_chain:  # that of a chain in which the record ends inside the pulse
            of_single_chain = math.nan
        return wall_force, of_single_chain, delay, transmitted


def _arrived(series: tuple[Floats, Floats, ContactFrames], chains: Integers, wall: Gauge) -> tuple[float, float]:
    """Time and size of the largest force of some chains on the wall; NaN where nothing has arrived.

    Between frames it follows from the strain, as in `workflow.measures.forces`.
    """
    time, force, frames = series
    total, static = force[:, chains].sum(axis=1), float(wall.static[chains].sum())
    k = int(np.argmax(total))
    if not 0 < k < len(time) - 1 or not np.all(np.isfinite(total[k - 1 : k + 2])):
        return np.nan, np.nan
    near, spacing = slice(k - 1, k + 2), float(time[k] - time[k - 1])
    curve = ContactCurve.between(wall.probes[0], frames.near(near, chains), chains, spacing)

    def value(s: Floats) -> Floats:
        """Force of the chains together at s, [interval]."""
        return np.asarray(curve(np.repeat(s, len(chains))).reshape(2, -1).sum(axis=1))

    at = maximum(value, np.zeros(2), np.ones(2))
    largest = value(at)
    best = int(np.argmax(largest))
    if not max(largest[best], total[k]) - static > FAINTEST * max(1.0, static):
        return np.nan, np.nan
    if largest[best] < total[k]:
        return float(time[k]), float(total[k])
    return float(time[k - 1 + best] + at[best] * spacing), float(largest[best])


def _share(energy: Floats, total: Floats) -> Floats:
    """Energy over a total, [frame]; 0 where that is not positive."""
    return np.divide(energy, total, out=0.0 * total, where=total > 0.0)


def _passed(time: Floats, energy: Floats) -> bool:
    """Whether an energy has arrived, and has been largest before the end of the record.

    One that is largest in the last frame must have been level for as long as it took from a quarter to half.
    """
    largest = float(np.max(energy))
    if not FAINTEST_ENERGY < largest < np.inf or energy[0] >= 0.5 * largest:  # there from the start
        return False

    def reached(level: float) -> float:
        """Time at which the energy reaches a level, from the values alone."""
        k = int(np.argmax(energy >= level))
        return crossing(time, energy, k, level) if k else float(time[0])

    quarter, half, level = (reached(share * largest) for share in (0.25, 0.5, 1.0 - LEVEL))
    return bool(energy[-1] < largest or time[-1] - level >= half - quarter)


def _largest(time: Floats, energy: Floats, rate: Floats, total: Floats) -> float:
    """Largest of an energy over a total, by polynomials through both about the frame at which it is.

    Through the energies and their rates at three frames; through the totals, which change slowly, at five.
    """
    share = _share(energy, total)
    k = int(np.argmax(share))
    if not 0 < k < len(time) - 1:
        return float(share[k])
    spacing = float(time[k] - time[k - 1])
    stored = _about(k, energy, rate, spacing)
    nodes = tuple(range(max(-2, -k), min(2, len(time) - 1 - k) + 1))
    supplied = hermite.coefficients(nodes, total[k + nodes[0] : k + nodes[-1] + 1, np.newaxis], spacing)

    def value(s: Floats) -> Floats:
        """Energy over the total at s, [...]."""
        return np.asarray(hermite.value(stored, s) / hermite.value(supplied, s))

    return float(np.fmax(share[k], value(maximum(value, np.array([-1.0]), np.array([1.0])))[0]))


def _reached(time: Floats, energy: Floats, rate: Floats, level: float) -> float:
    """Time at which an energy first reaches a level that it exceeds later."""
    k = int(np.argmax(energy >= level))
    if k == 0:
        return float(time[0])
    spacing, middle = float(time[k] - time[k - 1]), min(k, len(time) - 2)
    below = _about(middle, level - energy, -rate, spacing)
    place = hermite.falling_zero(below, np.full((), k - 1.0 - middle), np.full((), float(k - middle)))
    return float(time[middle] + place * spacing)


def _about(k: int, energy: Floats, rate: Floats, spacing: float) -> Floats:
    """The polynomial of time, in frames, through energies and their rates at a frame and those on either side."""
    near = slice(k - 1, k + 2)
    return hermite.coefficients((-1, 0, 1), np.stack([energy[near], rate[near]], axis=1), spacing)


@dataclass(frozen=True, repr=False)
class FarEndMeasurement(Measurement):
    """Force, delay and energy."""

    key, kind = "far_end", Transmitted
    at_the_end = True

    values: Transmitted

    @classmethod
    def meter(cls, run: Recorded) -> FarEndMeter | None:
        """The far end of runs of all beads, if these are elastic."""
        problem = run.problem
        return FarEndMeter(problem) if problem.rows.complete and problem.system.holds(Fact.OVERLAPS) else None

    @classmethod
    def of_run(cls, run: Recorded, survey: Survey, measured: Transmitted | None) -> Self | None:
        """The far end, with uncertainties that cover the error of the run."""
        del survey
        if measured is None:
            return None
        return cls(run.problem, with_error(measured, run.error, run.problem))


def with_error(transmitted: Transmitted, error: MeasuredError, problem: Problem) -> Transmitted:
    """What has arrived, with uncertainties that cover the error of the run (`analysis.sharing.run_error`)."""
    if not error.measured:
        return transmitted
    mass, supplied = np.broadcast_to(problem.system.mass, (problem.chains, problem.beads)), transmitted.supplied
    energy, force = np.array(transmitted.transmitted_energy * supplied), error.of_force(problem)
    absolute = float(error.of_energy(energy, float(np.sum(mass[:, last_tenth(problem)]))))
    share = absolute / supplied if supplied else math.nan  # nothing has arrived, and a push has yet to do work
    added = (problem.chains * force, force, error.arrival, share)
    changed = {
        f"{name}_error": getattr(transmitted, f"{name}_error") + more for name, more in zip(VALUES, added, strict=True)
    }
    return replace(transmitted, **changed)
