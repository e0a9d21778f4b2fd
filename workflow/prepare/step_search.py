"""The time step that LAMMPS needs for an accuracy: measured by a pilot run of the scene, or of what stands for it.

What costs too much to measure is measured at a larger error, or on a shorter problem, and carried over: errors fall as
the step to the order of the scheme, and grow in proportion to time.
"""

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import Problem, physics
from lammps_inputs.facts import Fact
from workflow import screen
from workflow.engines.reference import engine
from workflow.prepare import twin
from workflow.prepare.twin import Found, UnreachableError

MOST_WORK = 3e9
"""Forces on beads that one measurement may take, some five seconds; each that fails leaves the next half as many."""

_LONG = 1e9
"""Such work is announced."""

_MARGIN = 2.0
"""Error that is reckoned with, over what is carried over. Over a shorter problem's in proportion to time, the true one
was 0.5 to 1.5 (2.5 with a gap); over that at a larger step, by the order, 0.97 to 1.03 (0.5 to 2 with a gap).
"""

_STEADY = 4.0
"""Growth of the reference's own uncertainty over that in proportion to time, up to which it counts as the same."""

_COARSEST = 1e-3
"""Largest error from which a smaller one is told by the order."""

_LEAST_ORDER = 2.5
"""Of every scheme of higher order than 2, at small steps, for contacts open and close."""

_SHORTEST = 60.0
"""Time from which on a shorter problem stands for a longer one."""

_FEWEST = 20
"""Beads left between two kicks, and beyond the last, in a shorter problem."""

_TRIALS = 2.0
"""Work of a measurement over that of its first trial, about."""


def search(problem: Problem, accuracy: float, *, most_work: float = MOST_WORK) -> Found:
    """The longest time step, within a factor of about two, that keeps every velocity within an accuracy.

    Args:
        problem: what is to be run; its own time step does not count.
        accuracy: in units of V.
        most_work: forces on beads that a measurement may take.

    Raises:
        UnreachableError: no step does.
    """
    _refuse_rounding(rounding(problem, twin.guessed_step(problem, accuracy)), 0.5 * accuracy)
    found = _found(problem, accuracy, most_work)
    _refuse_rounding(rounding(problem, found.timestep), 0.25 * accuracy)
    return found


def _found(problem: Problem, accuracy: float, most_work: float) -> Found:
    limit = budget = most_work
    for share, asked in _ways(accuracy, problem.duration):
        trial = _shorter(problem, share)
        expected = _TRIALS * _work(trial, asked)
        if expected > limit:
            continue
        if expected > _LONG:
            seconds = 5.0 * expected / MOST_WORK
            screen.hint(f"choosing the time step by a pilot run: about {seconds:.0f} s; a `timestep` avoids it")
        measured = twin.measure(trial, asked, budget)
        if measured is None:
            limit, budget = expected / 4.0, budget / 2.0  # what is hardly cheaper would not do either
        elif (share, asked) == (1.0, accuracy):
            return measured
        elif share < 1.0:
            _refuse_chaos(problem, trial, share, accuracy, most_work)
            return _carried_over(measured, problem, share, asked, accuracy)
        elif _may_be_sure(problem, accuracy, most_work):
            return _carried_over(measured, problem, share, asked, accuracy)
    return by_rule(problem, accuracy)


def by_rule(problem: Problem, accuracy: float) -> Found:
    """The step for an accuracy where nothing is measured."""
    step = twin.guessed_step(problem, accuracy)
    reference = problem.every / twin.guessed_reference_steps(problem, accuracy)
    return Found(step, reference, accuracy, accuracy, 0.0, limited=step == twin.largest_step(problem, accuracy))


def _ways(accuracy: float, duration: float) -> Iterator[tuple[float, float]]:
    """Share of the time and accuracy in it of ever cheaper measurements, the run itself first."""
    yield 1.0, accuracy
    share = 1.0
    while share == 1.0 or share * duration >= _SHORTEST:
        asked = accuracy * share / _MARGIN
        yield share, asked
        while (asked := 4.0 * asked) <= _COARSEST:
            yield share, asked
        share *= 0.5


def _work(problem: Problem, accuracy: float) -> float:
    """Of the first trial."""
    verlet = math.ceil(problem.every / twin.guessed_step(problem, accuracy))
    return twin.work(problem, verlet, twin.guessed_reference_steps(problem, accuracy))


def _may_be_sure(problem: Problem, accuracy: float, most_work: float) -> bool:
    """Whether the reference gets sure enough with the usual number of steps, as far as that can be afforded."""
    steps = twin.guessed_reference_steps(problem, accuracy)
    return twin.work(problem, 0, steps) > most_work or twin.certificate(problem, steps) <= accuracy


def _refuse_chaos(problem: Problem, shorter: Problem, share: float, accuracy: float, most_work: float) -> None:
    """Give up where errors grow much faster than in proportion to time, as far as that can be afforded to be known.

    Raises:
        UnreachableError: they do.
    """
    steps = engine.default_steps_per_frame(problem)
    if twin.work(problem, 0, steps) > most_work:
        return
    certificate = twin.certificate(problem, steps)
    usual = twin.certificate(shorter, engine.default_steps_per_frame(shorter)) / share
    if certificate > max(_STEADY * usual, twin.SURE * accuracy):
        raise UnreachableError(f"errors grow {certificate / usual:.0f} times as much as they usually do: {twin.CHAOS}")


def _carried_over(measured: Found, problem: Problem, share: float, asked: float, accuracy: float) -> Found:
    """From a cheaper measurement to the run itself."""
    ratio = accuracy * share / _MARGIN / asked
    order = _LEAST_ORDER if problem.scheme != "verlet" else 2.0 if problem.system.holds(Fact.SECOND_ORDER) else 1.0
    largest = twin.largest_step(problem, accuracy)
    step = min(largest, measured.timestep * ratio ** (1.0 / order))
    return Found(
        timestep=step,
        reference_timestep=measured.reference_timestep * ratio ** (1.0 / _LEAST_ORDER),
        error=measured.error * accuracy / asked,
        measured_error=measured.error,
        measured=share,
        limited=measured.limited or step == largest,
    )


def _shorter(problem: Problem, share: float) -> Problem:
    """The same chains over a share of the time, with the kicks and the ends of the chains as much closer together."""
    system = problem.system
    if share == 1.0:
        return problem
    marks = sorted({0, problem.beads + 1, *(bead for _, bead, _ in physics.excitations(system))})
    place = {0: 0}
    for before, after in itertools.pairwise(marks):
        distance = after - before
        place[after] = place[before] + min(distance, max(_FEWEST, math.ceil(distance * share)))
    beads = place[problem.beads + 1] - 1
    kept = _kept(marks, place)
    apart = math.ceil(problem.every)  # frames at most 1 apart, so that there are some
    return replace(
        problem,
        system=replace(
            system,
            beads=beads,
            links=tuple(link.on(kept) for link in system.links),
            dampers=tuple(link.on(kept) for link in system.dampers),
            mass=physics.mass_of(system, Ellipsis, kept),
            inner_mass=None if system.inner_mass is None else system.inner_mass[:, kept],
            inner_links=tuple(link.on(kept) for link in system.inner_links),
            kicks=tuple((chain, place[bead], velocity) for chain, bead, velocity in system.kicks),
            loads=tuple(load.at(place[load.bead]) for load in system.loads),
            motions=tuple(motion.at(place[motion.bead]) for motion in system.motions),
        ),
        timestep=problem.every / apart,
        steps_per_frame=1,
        frames=max(1, math.ceil(problem.frames * apart * share)),
        recorded=None,
        window=None if problem.window is None or problem.window >= beads else problem.window,
    )


def _kept(marks: list[int], place: dict[int, int]) -> NDArray[np.int64]:
    """Rows of the longer chains, from 0, that the beads of the shorter ones stand for: those near a kick or an end."""
    kept: list[int] = []
    for before, after in itertools.pairwise(marks):
        count = place[after] - place[before]
        near = count // 2
        kept += [*range(before + 1, before + near + 1), *range(after - (count - near) + 1, after + 1)]
    return np.array(kept[:-1], dtype=np.int64) - 1  # the last mark is beyond the last bead


def _refuse_rounding(floor: float, most: float) -> None:
    if floor > most:
        raise UnreachableError(f"rounding of the positions in LAMMPS leaves up to {floor:.0e} V")


def rounding(problem: Problem, step: float) -> float:
    """What rounding leaves in LAMMPS's velocities, at most: positions grow with the beads, and each step rounds them.

    Measured in chains of 40 and 1000 beads with 6e4 to 3e6 steps: a ninth of this to a third.
    """
    return 3.0 * float(np.spacing(problem.beads * problem.layout.spacing)) * math.sqrt(problem.duration / step)
