"""The leading pulse at every bead: the first passage above the threshold, its peak, and its local speed.

`succession` finds where one leading pulse ends and another one leads.

Plug-ins take this module for the leading pulses: `Waves` is the table that a survey has, `usual_arrival` the definition
of an arrival.

Examples:
    >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem()
    >>> frames = engine.run(problem)
    >>> peaks = leading_passages.leading_meter(problem).read(frames.blocks())
    >>> leading_waves.leading_waves(peaks, problem).speed[:2].round(3)  # at beads 1 and 2, in beads / T
    array([0.531, 0.641])
    >>> leading_waves.usual_arrival(problem)
    'maximum'
"""

from dataclasses import replace
from typing import Literal, NamedTuple, Self

import numpy as np

from analysis.columns import Columns
from analysis.quantity import declare, declared, in_units, result
from analysis.tracking.leading_passages import beyond_kicks
from analysis.tracking.peaks import Peaks
from analysis.tracking.pulses import Pulse, local_speed, local_speed_error
from analysis.tracking.succession import Change, changes, numbers
from analysis.trajectory import Flags, Floats, Integers
from lammps_inputs import Problem, physics
from lammps_inputs.units import Scale


@result
class Waves(Columns):
    """Leading pulse of each chain at each bead that it reached, [wave], sorted by chain, then bead."""

    chain: Integers = declare("number of the chain")
    bead: Integers = declare("number of the bead")
    pulse: Integers = declare(
        "number of the pulse that leads at the bead, from 1 in the order of the beads: where it changes, the pulse has "
        "ended, and another one arrives first"
    )
    arrival: Floats = declare(
        "time at which the pulse passes the bead: that of the largest velocity, or the centre of the impulse",
        "time",
        "the largest velocity is reached on a plateau (a bead that flies freely)",
        "t",
    )
    peak_velocity: Floats = declare(
        "first maximum over time, above 1e-3 V, of the bead's velocity in the direction of the pulse; where pulses "
        "overlap, the bead's whole velocity counts",
        "velocity",
        symbol="v",
    )
    speed: Floats = declare(
        "speed of the pulse in its direction, from the arrivals at the recorded beads on either side (at an end of the "
        "chain, and at the last bead reached: one), which it passed one after the other",
        "speed",
        "one bead of the chain was reached, an arrival is undefined or not later than that at the bead before, or the "
        "pulse begins or ends there within the chain, as at a kicked bead",
        "c",
    )
    arrival_error: Floats = declare(
        "bound on the error of the arrival by the time between frames and by the run (``run_error``)",
        "time",
        "so is the arrival, or the motion of rigid beads follows rounding there",
    )
    peak_velocity_error: Floats = declare(
        "bound on the error of the peak velocity by the time between frames and by the run (``run_error``)",
        "velocity",
        "the motion of rigid beads follows rounding there",
    )
    speed_error: Floats = declare(
        "bound on the error of the speed by those of the arrivals and by the run (``run_error``)",
        "speed",
        "so is the speed, an error of an arrival is, or these errors exceed the time between the arrivals",
    )
    time: Floats
    """Time at which the bead is fastest, in units of T, whether or not that is sharp."""

    def __repr__(self) -> str:
        chains, beads = (len(np.unique(numbers)) for numbers in (self.chain, self.bead))
        return f"<leading pulses of {chains} chains at {beads} beads: {', '.join(self.arrays())}>"

    def measured(self, scale: Scale) -> Self:
        """Waves in the units of a scene.

        Args:
            scale: units of the scene.

        Returns:
            The waves.

        Examples:
            >>> analysis = granchain.analyze("steel")
            >>> in_scene = analysis.survey.waves.measured(analysis.problem.scale)
            >>> f"{in_scene.arrival[1]:.2e} s"
            '2.77e-05 s'
        """
        columns = {
            name: in_units(getattr(self, name), quantity.unit, scale)
            for name, (quantity, _) in declared(type(self)).items()
        }
        return replace(self, **columns, time=self.time * scale.time)

    @property
    def ends(self) -> Integers:
        """Positions, [end], of entries after which another pulse of the chain leads; entries are sorted by bead.

        Returns:
            The positions.

        Examples:
            >>> granchain.analyze("out").waves.ends
            array([], dtype=int64)
        """
        return np.flatnonzero((np.diff(self.chain) == 0) & (np.diff(self.pulse) != 0))

    def at(self, bead: int) -> Self:
        """Entries of all chains at one bead, numbered from 1.

        Args:
            bead: number of the bead.

        Returns:
            The entries, in the order of the chains.

        Examples:
            >>> granchain.analyze("out").waves.at(60).chain
            array([1, 2])
        """
        return self.where(self.bead == bead)

    def of_chain(self, chain: int) -> Self:
        """Entries of one chain, numbered from 1, at all beads that its leading pulse reached.

        Args:
            chain: number of the chain.

        Returns:
            The entries, in the order of the beads.

        Examples:
            >>> granchain.analyze("out").waves.of_chain(2).bead[:3]
            array([1, 2, 3])
        """
        return self.where(self.chain == chain)


Arrival = Literal["maximum", "impulse"]

ARRIVALS: tuple[Arrival, ...] = ("maximum", "impulse")
"""Definitions of an arrival: the time at which the bead is fastest, or the centre in time of the impulse until then.

The first is not defined where beads fly freely at their largest velocity, as between the contacts of chains with gaps.
"""


def usual_arrival(problem: Problem) -> Arrival:
    """Definition of an arrival by default: the maximum where it is sharp, in chains that touch; else the impulse."""
    return "impulse" if physics.gap(problem.system) > 0.0 else "maximum"


def leading_waves(
    peaks: Peaks,
    problem: Problem,
    arrival: Arrival | None = None,
    succession: tuple[Change, ...] | None = None,
) -> Waves:
    """The first maximum of every bead that the leading pulse comes to, and which pulse that is.

    Args:
        peaks: maxima of a run.
        problem: what was run.
        arrival: definition of an arrival; by default `usual_arrival`.
        succession: ends of leading pulses after which another one leads; by default those that the maxima show.

    Returns:
        The waves, sorted by chain, then bead; times in units of T, velocities in units of V.
    """
    passages = beyond_kicks(peaks, problem)
    first = passages.first()
    at_maximum = (arrival or usual_arrival(problem)) == "maximum"
    time, error = (first.time, first.time_error) if at_maximum else (first.centre, first.centre_error)
    defined = np.where(np.isfinite(error), time, np.nan)
    number = numbers(first, changes(passages, problem) if succession is None else succession, problem)
    waves = with_speeds(first.chain, first.bead, defined, first.velocity, number, error, direction=first.direction)
    waves = replace(waves, time=first.time, peak_velocity_error=first.velocity_error)
    return _without_speeds(waves, _begins_within(first, problem))


def _without_speeds(waves: Waves, undefined: Flags) -> Waves:
    """Waves whose speeds are NaN where a mask, [wave], says so."""
    speed, error = (np.where(undefined, np.nan, values) for values in (waves.speed, waves.speed_error))
    return replace(waves, speed=speed, speed_error=error)


def _begins_within(first: Peaks, problem: Problem) -> Flags:
    """Mask, [first maximum], of the beads at which the first pulse of a chain begins, but for ends of chains."""
    along = first.direction * first.bead
    begins = np.full(problem.chains + 1, np.max(along, initial=-problem.beads))
    np.minimum.at(begins, first.chain, along)
    return np.asarray((along == begins[first.chain]) & (along > np.min(first.direction * problem.rows.numbers)))


def speeds_of_pulses(waves: Waves, pulses: tuple[Pulse, ...], direction: int) -> Waves:
    """Leading waves whose speeds are NaN next to a bead at which another pulse leads.

    Args:
        waves: leading waves.
        pulses: those that were followed along the chains.
        direction: 1 if the waves run towards higher bead numbers, else -1.

    Returns:
        The waves, [wave], with these speeds.
    """
    number = np.full(len(waves), -1)
    for each, pulse in enumerate(pulses):
        if pulse.direction == direction:
            number[(waves.chain == pulse.chain) & np.isin(waves.time, pulse.arrival)] = each
    changes = (np.diff(waves.chain) == 0) & (np.diff(number) != 0) & (number[1:] >= 0) & (number[:-1] >= 0)
    beside = np.append(changes, False) | np.insert(changes, 0, False)
    return _without_speeds(waves, beside) if np.any(beside) else waves


def with_speeds(
    chain: Integers,
    bead: Integers,
    arrival: Floats,
    peak_velocity: Floats,
    pulse: Integers | None = None,
    arrival_error: Floats | None = None,
    *,
    direction: int = 1,
) -> Waves:
    """Waves whose local speeds follow from their arrivals; entries are sorted by chain, then bead.

    A speed is that of one pulse between beads that it passed one after the other, else NaN.

    Args:
        chain: [wave] number of the chain, from 1.
        bead: [wave] number of the bead, from 1.
        arrival: [wave] in units of T.
        peak_velocity: [wave] in units of V.
        pulse: [wave] number of the pulse in its chain; by default one pulse leads everywhere.
        arrival_error: [wave] bound on the error of the arrival, in units of T; unknown by default.
        direction: 1 towards higher bead numbers, -1 towards lower ones.

    Returns:
        The waves, in units of V and T; errors that are not known are NaN.
    """
    unknown = np.full(len(chain), np.nan)
    number = np.ones(len(chain), dtype=np.int64) if pulse is None else pulse
    error = unknown if arrival_error is None else arrival_error
    speed, speed_error = unknown.copy(), unknown.copy()
    for each in np.unique(chain):
        in_chain = chain == each
        along, passed = bead[in_chain], arrival[in_chain]
        speed[in_chain] = direction * local_speed(along, passed)
        speed_error[in_chain] = local_speed_error(along, passed, error[in_chain])
    waves = Waves(chain, bead, number, arrival, peak_velocity, speed, error, unknown, speed_error, time=arrival)
    backward = np.flatnonzero((np.diff(chain) == 0) & (direction * np.diff(arrival) <= 0.0))
    undefined = speed <= 0.0  # past a bead without an arrival
    for last in (waves.ends, backward):
        undefined[last] = undefined[last + 1] = True
    return _without_speeds(waves, undefined)


class Lags(NamedTuple):
    """Arrivals behind those in one chain at the same beads, [wave] in units of T, and bounds on their errors."""

    value: Floats
    error: Floats


def lags(waves: Waves, chain: int) -> Lags:
    """Arrivals behind those in a chain; NaN where that was not reached, errors 0 in that chain itself."""
    reference = waves.of_chain(chain)
    place = {bead: k for k, bead in enumerate(reference.bead.tolist())}
    at = np.array([place.get(bead, -1) for bead in waves.bead.tolist()], dtype=np.int64)
    of_reference = [np.append(values, np.nan)[at] for values in (reference.arrival, reference.arrival_error)]
    error = np.where(waves.chain == chain, 0.0, waves.arrival_error + of_reference[1])
    value = waves.arrival - of_reference[0]
    return Lags(value, np.where(np.isnan(value), np.nan, error))
