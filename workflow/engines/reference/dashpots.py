"""Forces against velocities, compiled: of contacts, across chains and on beads; beside the `forces` of positions.

A dashpot's force is the rate of a function of the strain (`lammps_inputs.laws.dashpot`, ``impulse``). So where no
tension is cut, velocities are replaced by ``w = v - impulses / masses`` (as Lienard did): w changes by the forces of
positions alone, by kicks that are exact, and ``x' = w + impulses(x) / masses`` is the drift at fixed w. Forces that
jump where contacts open become mere kinks that way. Where tension is cut, a kick is the solution of
``masses * v' = forces(x) + drag(x, v)`` at fixed x. Either is one step of the classical Runge-Kutta method: of order 4,
as the scheme, and its error is far below that (a part of a step times the drag, to the fifth power, over 120).

LAMMPS instead takes the drag of the velocities that it has when forces are computed, those of half a step before.

An empty tuple in place of one of the classes costs nothing. The stages are written out one by one: with a function for
a stage, a step takes 1.5 to 2.7 times as long.

What dashpots take is counted along the way. A kick at fixed positions takes no energy from the motion but by their
power, which is integrated as the velocities are. A drift at fixed w takes kinetic energy alone, and exactly that.
"""

# ruff: noqa: ARG001, ARG005  numba wants the arguments of what is overloaded, used or not
from typing import Any, NamedTuple

import numpy as np
from numba import types
from numba.extending import overload

from lammps_inputs import System
from lammps_inputs.laws import dashpot
from lammps_inputs.links import Across, Along, Ground, WallDamper
from workflow.compiled import inner
from workflow.engines.reference.forces import (
    Floats,
    count_on,
    flat,
    give_on,
    neighbours,
    over_mass,
    over_the_way,
    travel_on,
    written_for_laws,
    written_for_neighbours,
)


class Given(NamedTuple):
    """Dashpots, and room to solve the flow of a drift; the velocities of the state are w. Arrays are flat, as it."""

    along: tuple[Any, ...]
    across: tuple[tuple[Any, Any], ...]
    ground: tuple[Any, ...]
    walls: tuple[Any, ...]
    squeeze: Floats
    """Force, or impulse, of the dashpot of every contact with the bead behind."""
    drag: Floats
    """Force, or impulse, on every bead."""
    actual: Floats
    """Velocities."""
    total: Floats
    trial: Floats
    lost: tuple[Floats, Floats, Floats, Floats]
    """Energy that dashpots along, across, to the ground and of walls have taken from every bead; below 0 of one that is
    dragged along."""
    before: tuple[Floats, Floats, Floats]
    """Positions, velocities and impulses at the start of a drift."""
    after: Floats
    """Impulses at its end."""


class Flow(NamedTuple):
    """Dashpots, and room to solve the flow of a kick."""

    along: tuple[Any, ...]
    across: tuple[tuple[Any, Any], ...]
    ground: tuple[Any, ...]
    walls: tuple[Any, ...]
    squeeze: Floats
    drag: Floats
    steady: Floats
    """Accelerations by forces of positions."""
    total: Floats
    trial: Floats
    lost: tuple[Floats, Floats, Floats, Floats]
    """As above."""


class HalfStep(NamedTuple):
    """Dashpots whose forces are kept until positions change."""

    along: tuple[Any, ...]
    across: tuple[tuple[Any, Any], ...]
    ground: tuple[Any, ...]
    walls: tuple[Any, ...]
    squeeze: Floats
    drag: Floats


def make_dampers(system: System, *, as_lammps: bool) -> Any:
    """The dashpots of a system on a state [bead + 2, chain]; an empty tuple where there are none."""
    if not system.dampers:
        return ()
    grounded = [link for link in system.dampers if isinstance(link, Ground)]
    laws = (
        tuple(flat(link.law, system, first=2) for link in system.dampers if isinstance(link, Along)),
        tuple(near for link in system.dampers if isinstance(link, Across) for near in neighbours(link, system)),
        tuple(flat(link.law, system, first=1) for link in grounded if not isinstance(link, WallDamper)),
        tuple(flat(link.law, system, first=1) for link in grounded if isinstance(link, WallDamper)),
    )

    def room(count: int) -> Any:
        return tuple(np.zeros((system.beads + 2) * system.chains) for _ in range(count))

    if as_lammps:
        return HalfStep._make([*laws, *room(2)])
    if any(dashpot.cut(link.law) for link in system.dampers):
        return Flow._make([*laws, *room(5), room(4)])
    return Given._make([*laws, *room(5), room(4), room(3), *room(1)])


def all_of(laws: Any, k: Any, strain: Any, rate: Any) -> Any:
    """Force of several dashpots on the same link."""
    raise NotImplementedError


def hold(across: Any, x: Any, v: Any, k: Any) -> Any:
    """Force of dashpots to other chains against the motion of a bead."""
    raise NotImplementedError


def given(laws: Any, k: Any, strain: Any) -> Any:
    """Impulse of several dashpots on the same link."""
    raise NotImplementedError


def given_by(across: Any, x: Any, k: Any) -> Any:
    """Impulse of dashpots to other chains against the motion of a bead."""
    raise NotImplementedError


def slow(dampers: Any, x: Any, v: Any, a: Any, forces: Any, chains: Any, first: Any, last: Any) -> Any:
    """Add what dashpots do at these velocities to accelerations in rows first to last."""
    raise NotImplementedError


@overload(all_of, inline="always", strict=False)
def _all_of(laws: Any, k: Any, strain: Any, rate: Any) -> Any:
    return written_for_laws("damping", laws, "laws, k, strain, rate", "strain, rate")


@overload(hold, inline="always", strict=False)
def _hold(across: Any, x: Any, v: Any, k: Any) -> Any:
    return written_for_neighbours("damping", across, "across, x, v, k", "x[k] - x[{other}], v[k] - v[{other}]")


@overload(given, inline="always", strict=False)
def _given(laws: Any, k: Any, strain: Any) -> Any:
    return written_for_laws("impulse", laws, "laws, k, strain", "strain")


@overload(given_by, inline="always", strict=False)
def _given_by(across: Any, x: Any, k: Any) -> Any:
    return written_for_neighbours("impulse", across, "across, x, k", "x[k] - x[{other}]")


@inner
def brake(dampers: Any, x: Floats, v: Floats, gap: float, chains: int, first: int, last: int) -> None:
    """Force of all dashpots on the beads of rows first to last, which touch none that moves, into ``drag``."""
    row = np.uint64(chains)
    dampers.squeeze[first * chains : (first + 1) * chains] = 0.0
    dampers.squeeze[(last + 1) * chains : (last + 2) * chains] = 0.0
    for k in range(np.uint64((first + 1) * chains), np.uint64((last + 1) * chains)):
        dampers.squeeze[k] = all_of(dampers.along, k, x[k - row] - x[k] - gap, v[k - row] - v[k])
    for k in range(np.uint64(first * chains), np.uint64((last + 1) * chains)):
        held = hold(dampers.across, x, v, k) + all_of(dampers.ground, k, x[k], v[k])
        held += all_of(dampers.walls, k, x[k], v[k])
        dampers.drag[k] = dampers.squeeze[k] - dampers.squeeze[k + row] - held


@inner
def impulses(given_all: Any, x: Floats, gap: float, chains: int, first: int, last: int) -> None:
    """What all dashpots have given the beads of rows first to last, which touch none that moved, into ``drag``."""
    row = np.uint64(chains)
    squeeze, drag = given_all.squeeze, given_all.drag
    squeeze[first * chains : (first + 1) * chains] = 0.0
    squeeze[(last + 1) * chains : (last + 2) * chains] = 0.0
    for k in range(np.uint64((first + 1) * chains), np.uint64((last + 1) * chains)):
        squeeze[k] = given(given_all.along, k, x[k - row] - x[k] - gap)
    for k in range(np.uint64(first * chains), np.uint64((last + 1) * chains)):
        held = given_by(given_all.across, x, k) + given(given_all.ground, k, x[k])
        held += given(given_all.walls, k, x[k])
        drag[k] = squeeze[k] - squeeze[k + row] - held


@inner
def slide(given_all: Any, x: Floats, w: Floats, forces: Any, time: float, factor: float, chains: int, first: int,
          last: int) -> None:  # fmt: skip
    """Positions after a drift of length ``factor`` from a time on, at a w that only forces from outside change."""
    low, high = np.uint64(first * chains), np.uint64((last + 1) * chains)
    lightness, gap, loads, moved = forces.lightness, forces.gap, forces.drifted, forces.moved
    drag, total, trial, actual = given_all.drag, given_all.total, given_all.trial, given_all.actual
    place, early, start = given_all.before
    half = 0.5 * factor
    impulses(given_all, x, gap, chains, first, last)
    for k in range(low, high):
        slope = w[k] + over_mass(drag[k], lightness, k)
        place[k] = x[k]
        start[k] = drag[k]
        early[k] = slope
        total[k] = slope
        trial[k] = x[k] + half * slope
    travel_on(loads, lightness, trial, time, half, low, high)
    travel_on(moved, (), trial, time, half, low, high)
    impulses(given_all, trial, gap, chains, first, last)
    for k in range(low, high):
        slope = w[k] + over_mass(drag[k], lightness, k)
        total[k] += 2.0 * slope
        trial[k] = x[k] + half * slope
    travel_on(loads, lightness, trial, time, half, low, high)
    travel_on(moved, (), trial, time, half, low, high)
    impulses(given_all, trial, gap, chains, first, last)
    for k in range(low, high):
        slope = w[k] + over_mass(drag[k], lightness, k)
        total[k] += 2.0 * slope
        trial[k] = x[k] + factor * slope
    travel_on(loads, lightness, trial, time, factor, low, high)
    travel_on(moved, (), trial, time, factor, low, high)
    impulses(given_all, trial, gap, chains, first, last)
    for k in range(low, high):
        x[k] += factor / 6.0 * (total[k] + w[k] + over_mass(drag[k], lightness, k))
    travel_on(loads, lightness, x, time, factor, low, high)
    travel_on(moved, (), x, time, factor, low, high)
    give_on(loads, lightness, (), w, time, factor, low, high)
    give_on(moved, (), (), w, time, factor, low, high)

    impulses(given_all, x, gap, chains, first, last)
    for k in range(low, high):
        given_all.after[k] = drag[k]
        actual[k] = w[k] + over_mass(drag[k], lightness, k)
        trial[k] = 0.5 * (place[k] + x[k]) + 0.125 * factor * (early[k] - actual[k])
    impulses(given_all, trial, gap, chains, first, last)
    for k in range(low, high):
        total[k] = w[k] + over_mass(drag[k], lightness, k)
    give_on(loads, lightness, (), total, time + factor, -half, low, high)
    give_on(moved, (), (), total, time + factor, -half, low, high)
    count_on(loads, forces.work, early, total, actual, time, factor, low, high)
    _lose(given_all, x, chains, first, last)


@inner
def _lose(given_all: Any, x: Floats, chains: int, first: int, last: int) -> None:
    """Count what dashpots have taken in a drift."""
    drag, after, middle, late, trial = (
        given_all.drag,
        given_all.after,
        given_all.total,
        given_all.actual,
        given_all.trial,
    )
    place, early, start = given_all.before
    along, across, ground, walls = given_all.lost
    for k in range(np.uint64(first * chains), np.uint64((last + 1) * chains)):
        along[k] -= over_the_way(early[k], middle[k], late[k], drag[k] - start[k], after[k] - drag[k])
    if len(given_all.across) > 0:
        for k in range(np.uint64(first * chains), np.uint64((last + 1) * chains)):
            then = given_by(given_all.across, trial, k)
            since, until = then - given_by(given_all.across, place, k), given_by(given_all.across, x, k) - then
            taken = over_the_way(early[k], middle[k], late[k], since, until)
            across[k] += taken
            along[k] -= taken
    if len(given_all.ground) > 0:
        for k in range(np.uint64(first * chains), np.uint64((last + 1) * chains)):
            then = given(given_all.ground, k, trial[k])
            since, until = then - given(given_all.ground, k, place[k]), given(given_all.ground, k, x[k]) - then
            taken = over_the_way(early[k], middle[k], late[k], since, until)
            ground[k] += taken
            along[k] -= taken
    if len(given_all.walls) > 0:
        for k in range(np.uint64(first * chains), np.uint64((last + 1) * chains)):
            then = given(given_all.walls, k, trial[k])
            since, until = then - given(given_all.walls, k, place[k]), given(given_all.walls, k, x[k]) - then
            taken = over_the_way(early[k], middle[k], late[k], since, until)
            walls[k] += taken
            along[k] -= taken


@inner
def flow(flow: Any, v: Floats, x: Floats, lightness: Any, gap: float, factor: float, chains: int, first: int, last: int
) -> None:  # fmt: skip
    """Velocities after a kick of length ``factor`` by the accelerations ``steady`` and the dashpots."""
    low, high = np.uint64(first * chains), np.uint64((last + 1) * chains)
    drag, steady, total, trial = flow.drag, flow.steady, flow.total, flow.trial
    brake(flow, x, v, gap, chains, first, last)
    _take(flow, x, v, factor / 6.0, chains, first, last)
    for k in range(low, high):
        slope = steady[k] + over_mass(drag[k], lightness, k)
        total[k] = slope
        trial[k] = v[k] + 0.5 * factor * slope
    brake(flow, x, trial, gap, chains, first, last)
    _take(flow, x, trial, factor / 3.0, chains, first, last)
    for k in range(low, high):
        slope = steady[k] + over_mass(drag[k], lightness, k)
        total[k] += 2.0 * slope
        trial[k] = v[k] + 0.5 * factor * slope
    brake(flow, x, trial, gap, chains, first, last)
    _take(flow, x, trial, factor / 3.0, chains, first, last)
    for k in range(low, high):
        slope = steady[k] + over_mass(drag[k], lightness, k)
        total[k] += 2.0 * slope
        trial[k] = v[k] + factor * slope
    brake(flow, x, trial, gap, chains, first, last)
    _take(flow, x, trial, factor / 6.0, chains, first, last)
    for k in range(low, high):
        v[k] += factor / 6.0 * (total[k] + steady[k] + over_mass(drag[k], lightness, k))


@inner
def _take(flow: Any, x: Floats, v: Floats, duration: float, chains: int, first: int, last: int) -> None:
    """Count what dashpots take in a duration at these velocities, at which `brake` has found their forces."""
    drag = flow.drag
    along, across, ground, walls = flow.lost
    for k in range(np.uint64(first * chains), np.uint64((last + 1) * chains)):
        along[k] -= duration * v[k] * drag[k]
    if len(flow.across) > 0:
        for k in range(np.uint64(first * chains), np.uint64((last + 1) * chains)):
            taken = duration * v[k] * hold(flow.across, x, v, k)
            across[k] += taken
            along[k] -= taken
    if len(flow.ground) > 0:
        for k in range(np.uint64(first * chains), np.uint64((last + 1) * chains)):
            taken = duration * v[k] * all_of(flow.ground, k, x[k], v[k])
            ground[k] += taken
            along[k] -= taken
    if len(flow.walls) > 0:
        for k in range(np.uint64(first * chains), np.uint64((last + 1) * chains)):
            taken = duration * v[k] * all_of(flow.walls, k, x[k], v[k])
            walls[k] += taken
            along[k] -= taken


@overload(slow, strict=False)
def _slow(dampers: Any, x: Any, v: Any, a: Any, forces: Any, chains: Any, first: Any, last: Any) -> Any:
    if not isinstance(dampers, types.NamedTuple):
        return lambda dampers, x, v, a, forces, chains, first, last: None

    def act(dampers: Any, x: Any, v: Any, a: Any, forces: Any, chains: Any, first: Any, last: Any) -> None:
        brake(dampers, x, v, forces.gap, chains, first, last)
        for k in range(np.uint64(first * chains), np.uint64((last + 1) * chains)):
            a[k] += over_mass(dampers.drag[k], forces.lightness, k)

    return act
