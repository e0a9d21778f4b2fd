"""The leading pulse at every bead: the first passage above the threshold, its peak, and its local speed.

With kicks both ways not every first maximum of a bead is the leading pulse's (`leading_passages`).
"""

import csv
import io
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from analysis.columns import Columns
from analysis.quantity import declare, declared, result, table
from analysis.tracking.peaks import PeakFinder, Peaks
from analysis.tracking.pulses import EARLIEST, FAINTEST, LATEST, Pulse, local_speed, track_pulses
from analysis.trajectory import Flags, Floats, Integers, direction_of, mirrored_bead
from lammps_inputs import Problem, physics
from lammps_inputs.units import Scale


@result
class Waves(Columns):
    """Leading pulse of each chain at each bead that it reached, [wave], sorted by chain, then bead."""

    chain: Integers = declare("number of the chain")
    bead: Integers = declare("number of the bead")
    arrival: Floats = declare(
        "time at which the pulse passes the bead: that of the largest velocity, or the centre of the impulse",
        "time",
        "the largest velocity is reached on a plateau (a bead that flies freely)",
        "t",
    )
    peak_velocity: Floats = declare(
        "largest velocity of the bead, positive along the pulse's way", "velocity", symbol="v"
    )
    speed: Floats = declare(
        "speed of the pulse along its way, from the arrivals at the recorded beads on either side (at an end: one)",
        "speed",
        "one bead of the chain was reached, an arrival is undefined, or another pulse leads from one of these beads to "
        "the next: amplitude and delay jump there",
        "c",
    )
    arrival_error: Floats = declare(
        "bound on the error of the arrival by the time between frames", "time", "so is the arrival"
    )
    peak_velocity_error: Floats = declare(
        "bound on the error of the peak velocity by the time between frames", "velocity"
    )
    time: Floats
    """Time at which the bead is fastest, in units of T, whether or not that is sharp."""

    def __repr__(self) -> str:
        chains, beads = (len(np.unique(numbers)) for numbers in (self.chain, self.bead))
        return f"<leading pulses of {chains} chains at {beads} beads: {', '.join(self.arrays())}>"

    def measured(self, scale: Scale) -> "Waves":
        """The same in the units of a scene."""
        columns = dict(zip(declared(Waves), table(self, scale).values(), strict=False))
        return replace(self, **columns, time=self.time * scale.time)

    def array(self) -> NDArray[np.void]:
        """A structured array of these columns."""
        columns = self.arrays()
        made = np.zeros(len(self), dtype=[(name, column.dtype) for name, column in columns.items()])
        for name, column in columns.items():
            made[name] = column
        return made

    def at(self, bead: int) -> "Waves":
        """The chains' leading pulses at one bead."""
        return self.where(self.bead == bead)

    def of_chain(self, chain: int) -> "Waves":
        """One chain's leading pulse at all beads."""
        return self.where(self.chain == chain)


Arrival = Literal["maximum", "impulse"]

ARRIVALS: tuple[Arrival, ...] = ("maximum", "impulse")
"""What an arrival may be: when the bead is fastest; or the centre in time of the impulse that made it so.

The first is not defined where beads fly freely at their largest velocity, as between the contacts of chains with gaps.
"""


def usual_arrival(problem: Problem) -> Arrival:
    """The maximum, where it is sharp: in chains that touch."""
    return "impulse" if physics.gap(problem.system) > 0.0 else "maximum"


def leading_waves(peaks: Peaks, arrival: Arrival = "maximum") -> Waves:
    """The first peak of every bead, which is the pulse that runs ahead of all others."""
    found = peaks.first()
    time, error = (found.time, found.time_error) if arrival == "maximum" else (found.centre, found.centre_error)
    defined = np.where(np.isfinite(error), time, np.nan)
    waves = with_speeds(found.chain, found.bead, defined, found.velocity, direction=found.direction)
    return replace(waves, time=found.time, arrival_error=error, peak_velocity_error=found.velocity_error)


def with_speeds(
    chain: Integers, bead: Integers, arrival: Floats, peak_velocity: Floats, *, direction: int = 1
) -> Waves:
    """Waves whose local speeds follow from their arrivals, without errors; entries are sorted by chain, then bead."""
    speed = np.full(len(chain), np.nan)
    for number in np.unique(chain):
        row = chain == number
        speed[row] = direction * local_speed(bead[row], arrival[row])
        other = another_leads(bead[row], direction * arrival[row], peak_velocity[row])
        speed[np.flatnonzero(row)[np.append(other, False) | np.insert(other, 0, False)]] = np.nan
    unknown = np.full(len(chain), np.nan)
    return Waves(chain, bead, arrival, peak_velocity, speed, unknown, unknown, time=arrival)


def another_leads(bead: Integers, arrival: Floats, peak_velocity: Floats) -> Flags:
    """Between which neighbouring recorded beads of one chain the pulse that leads is another one, [bead - 1].

    Amplitudes differ there as those of no two passages of one pulse, and so does the delay from those before and after.
    """
    delay = np.diff(arrival) / np.diff(bead)
    beside = np.stack([np.append(np.nan, delay[:-1]), np.append(delay[1:], np.nan)])
    jumps = np.where(np.isnan(beside), True, (delay < EARLIEST * beside) | (delay > LATEST * beside)).all(axis=0)
    smaller, larger = np.sort([peak_velocity[1:], peak_velocity[:-1]], axis=0)
    return np.asarray(jumps & (smaller < FAINTEST * larger) & (len(bead) > 2))


def mirrored_waves(waves: Waves, problem: Problem) -> Waves:
    """The same waves as numbered in the mirror; twice is the waves themselves."""
    bead = mirrored_bead(problem, waves.bead)
    return replace(waves, bead=bead).where(np.lexsort((bead, waves.chain)))


def from_csv(text: str, scale: Scale, *, direction: int = 1) -> Waves:
    """The waves of a table in the scene's units; an arrival that is not given is not defined.

    Args:
        text: the table.
        scale: of the scene.
        direction: which way the waves run.

    Raises:
        ValueError: it is no such table.
    """
    rows = list(csv.DictReader(io.StringIO(text)))
    try:
        chain, bead = (np.array([int(row[name]) for row in rows], dtype=np.int64) for name in ("chain", "bead"))
        names = "arrival", "peak_velocity", "arrival_error", "peak_velocity_error"
        units = [declared(Waves)[name][0].unit for name in names]
        arrival, peak, late, off = (
            np.array([float(row[scale.heading(name, unit)] or "nan") for row in rows]) / getattr(scale, unit)
            for name, unit in zip(names, units, strict=True)
        )
    except (KeyError, TypeError) as error:
        raise ValueError(f"no table of waves ({error})") from None
    waves = with_speeds(chain, bead, arrival, peak, direction=direction)
    return replace(waves, arrival_error=np.where(np.isnan(arrival), np.inf, late), peak_velocity_error=off)


def opposed(problem: Problem) -> bool:
    """Whether there are kicks both ways, so that a bead's first maximum may be residual motion of the other pulse."""
    return any(velocity * direction_of(problem) < 0.0 for _, _, velocity in physics.excitations(problem.system))


def leading_finder(problem: Problem) -> PeakFinder:
    """What finds the maxima that `leading_passages` chooses from."""
    return PeakFinder(first_only=not opposed(problem) and not _overtaken(problem))


def leading_passages(peaks: Peaks, problem: Problem) -> Peaks:
    """Those of a run's maxima that may be the leading pulse's: all, or with kicks both ways a few."""
    if not opposed(problem):
        return beyond_kicks(peaks, problem)
    return beyond_kicks(of_pulses(peaks, track_pulses(peaks, problem)), problem)


def beyond_kicks(peaks: Peaks, problem: Problem) -> Peaks:
    """The maxima at beads that the leading pulse comes to; behind the kicked ones, walls reflect others.

    Beside slow resonators, only those of beads whose first maximum is the largest.
    """
    peaks = largest_first(peaks) if _overtaken(problem) else peaks
    if not physics.walls(problem.system):
        return peaks
    way = peaks.direction
    first = min(
        (way * bead for _, bead, velocity in physics.excitations(problem.system) if velocity * way > 0.0),
        default=-problem.beads,
    )
    return peaks.where(way * peaks.bead >= first)


LARGER = 0.01
"""Part by which a later maximum of a bead may exceed the first, which is then that of the leading pulse."""


def largest_first(peaks: Peaks) -> Peaks:
    """The maxima of the beads whose first one is the largest; where a later one is larger, no pulse leads."""
    if len(peaks) == 0:
        return peaks
    new = np.flatnonzero(np.diff(peaks.chain, prepend=0) | np.diff(peaks.bead, prepend=0))
    leads = peaks.velocity[new] * (1.0 + LARGER) >= np.maximum.reduceat(peaks.velocity, new)
    return peaks.where(np.repeat(leads, np.diff(new, append=len(peaks))))


def _overtaken(problem: Problem) -> bool:
    """Whether there are resonators so slow that what runs ahead may be smaller than what follows."""
    return physics.slowest_resonator(problem.system) < physics.PULSE_RATE


def of_pulses(peaks: Peaks, pulses: tuple[Pulse, ...]) -> Peaks:
    """The maxima that belong to pulses running their way; pulses from the far end leave others."""
    passages = {
        (pulse.chain, number, time)
        for pulse in pulses
        if pulse.direction == peaks.direction
        for number, time in zip(pulse.bead.tolist(), pulse.arrival.tolist(), strict=True)
    }
    rows = zip(peaks.chain.tolist(), peaks.bead.tolist(), peaks.time.tolist(), strict=True)
    return peaks.where(np.fromiter((row in passages for row in rows), dtype=bool, count=len(peaks)))
