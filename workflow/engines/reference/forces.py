"""The laws of a problem's links, compiled: their scalar functions, inlined into the kernel's loops.

| kind of link | here     | what it is to the kernel                                                        |
|--------------|----------|---------------------------------------------------------------------------------|
| along        | ``along``  | tuple of laws; the contact with the bead behind, so bead 1 has one with row 0  |
| across       | ``across`` | tuple of (distance to the other bead in memory, law), or of (array of those,    |
|              |            | law with parameters [distance, place]) where there are more than `UNROLLED`     |
| ground       | ``ground`` | tuple of laws                                                                  |

Forces from outside, over time, are tuples of (position in memory, law). Those of ``drifted`` act while beads drift,
exactly as on free beads; those of ``kicked`` act as LAMMPS has them, by their means over a step.

An empty tuple costs nothing: what is not there is gone when the loop is compiled. A parameter is a number or an array
of the shape of the state, flat; positions in memory are unsigned, which spares the loops a test for negative ones.
"""

# ruff: noqa: ARG001, ARG005  numba wants the arguments of what is overloaded, used or not
from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.extending import overload
from numpy.typing import NDArray

from lammps_inputs import System, laws
from lammps_inputs.links import Across

Floats = NDArray[np.float64]

UNROLLED = 2
"""Distances to neighbours that the loop is written out for, which an open row has; each doubles the compiler's time."""


class Forces(NamedTuple):
    """All forces of a problem as the kernel takes them."""

    along: tuple[Any, ...]
    gap: float
    across: tuple[tuple[Any, Any], ...]
    ground: tuple[Any, ...]
    lightness: Any
    """One over the masses; an empty tuple where all are 1."""
    drifted: tuple[tuple[int, Any], ...]
    kicked: tuple[tuple[int, Any], ...]


def make_forces(system: System, *, as_lammps: bool = False) -> Forces:
    """The forces of a system on a state [bead + 2, chain], whose rows 0 and beads + 1 stay at rest.

    Args:
        system: what is integrated.
        as_lammps: whether forces from outside act as LAMMPS has them.
    """
    loads = tuple((load.bead * system.chains + load.chain - 1, load.law) for load in system.loads)
    return Forces(
        along=tuple(_flat(link.law, system, first=2) for link in system.along),
        gap=system.gap,
        across=tuple(neighbour for link in system.across for neighbour in _neighbours(link, system)),
        ground=tuple(_flat(link.law, system, first=1) for link in system.ground),
        lightness=_lightness(system),
        drifted=() if as_lammps else loads,
        kicked=loads if as_lammps else (),
    )


def _lightness(system: System) -> Any:
    if isinstance(system.mass, float):
        return ()
    rows = np.ones((system.beads + 2, system.chains))
    rows[1:-1] = 1.0 / system.mass.T
    return rows.reshape(-1)


def _flat(law: Any, system: System, *, first: int) -> Any:
    """A law whose parameters that differ lie as the state does, those of the first link in row ``first``."""

    def laid(parameter: Any) -> Any:
        if np.ndim(parameter) == 0:
            return float(parameter)
        rows = np.zeros((system.beads + 2, system.chains))
        rows[first : first + parameter.shape[1]] = parameter.T
        return rows.reshape(-1)

    return type(law)(*map(laid, law))


def _neighbours(link: Across, system: System) -> list[tuple[Any, Any]]:
    """(distance, law) of the springs to chains of lower numbers, the nearest last, then of higher ones.

    Where a chain has no other at that distance, the law's parameters are 0, which makes no force. More than `UNROLLED`
    are one, whose arrays have the distances as their first axis.
    """
    found: dict[int, list[Floats]] = {}
    for edge, (lower, higher) in enumerate(link.edges):
        values = [np.broadcast_to(laws.at(link.law, edge)[k], system.beads) for k in range(len(tuple(link.law)))]
        for here, there in ((higher, lower), (lower, higher)):
            empty = [np.zeros((system.beads + 2, system.chains)) for _ in values]
            for array, value in zip(found.setdefault(there - here, empty), values, strict=True):
                array[1:-1, here] += value
    distances = np.array([distance % 2**64 for distance in sorted(found)], dtype=np.uint64)
    springs = [type(link.law)(*(array.reshape(-1) for array in found[distance])) for distance in sorted(found)]
    if len(distances) > UNROLLED:
        return [(distances, type(link.law)(*map(np.stack, zip(*springs, strict=True))))]
    return list(zip(distances, springs, strict=True))


def at(parameter: Any, k: Any) -> Any:
    """A parameter at a place in memory."""
    raise NotImplementedError


def force(law: Any, k: Any, strain: Any) -> Any:
    """Force of one law at a place in memory."""
    raise NotImplementedError


def sum_of(laws: Any, k: Any, strain: Any) -> Any:
    """Force of several laws on the same link."""
    raise NotImplementedError


def pull(across: Any, x: Any, k: Any) -> Any:
    """Force that drives a bead back towards those of its row."""
    raise NotImplementedError


def over_mass(force: Any, lightness: Any, k: Any) -> Any:
    """Acceleration by a force at a place in memory."""
    raise NotImplementedError


@overload(over_mass, inline="always", strict=False)
def _over_mass(force: Any, lightness: Any, k: Any) -> Any:
    if isinstance(lightness, types.Array):
        return lambda force, lightness, k: force * lightness[k]
    return lambda force, lightness, k: force


def pull_of(neighbours: Any, x: Any, k: Any) -> Any:
    """The same of the neighbours at one distance, or at all distances of an array."""
    raise NotImplementedError


@overload(at, inline="always", strict=False)
def _at(parameter: Any, k: Any) -> Any:
    if isinstance(parameter, types.Array):
        return lambda parameter, k: parameter[k]
    return lambda parameter, k: parameter


@overload(force, inline="always", strict=False)
def _force(law: Any, k: Any, strain: Any) -> Any:
    function = njit(inline="always")(law.instance_class.force)
    if len(law.types) == 1:
        return lambda law, k, strain: function(strain, at(law[0], k))
    if len(law.types) == 2:
        return lambda law, k, strain: function(strain, at(law[0], k), at(law[1], k))
    return lambda law, k, strain: function(strain, at(law[0], k), at(law[1], k), at(law[2], k))


@overload(sum_of, inline="always", strict=False)
def _sum_of(laws: Any, k: Any, strain: Any) -> Any:
    if len(laws) == 0:
        return lambda laws, k, strain: 0.0
    if len(laws) == 1:
        return lambda laws, k, strain: force(laws[0], k, strain)
    return lambda laws, k, strain: force(laws[0], k, strain) + sum_of(laws[1:], k, strain)


@overload(pull, inline="always", strict=False)
def _pull(across: Any, x: Any, k: Any) -> Any:
    if len(across) == 0:
        return lambda across, x, k: 0.0
    if len(across) == 1:
        return lambda across, x, k: pull_of(across[0], x, k)
    return lambda across, x, k: pull_of(across[0], x, k) + pull(across[1:], x, k)


@overload(pull_of, inline="always", strict=False)
def _pull_of(neighbours: Any, x: Any, k: Any) -> Any:
    if not isinstance(neighbours[0], types.Array):
        return lambda neighbours, x, k: force(neighbours[1], k, x[k] - x[k + neighbours[0]])

    def total(neighbours: Any, x: Any, k: Any) -> Any:
        result = 0.0
        for n in range(np.uint64(neighbours[0].shape[0])):
            result += force(neighbours[1], (n, k), x[k] - x[k + neighbours[0][n]])
        return result

    return total


def drift_on(loads: Any, lightness: Any, x: Any, v: Any, time: Any, duration: Any, low: Any, high: Any) -> Any:
    """What loads add to the drift of free beads over a duration, in places of memory from low to below high."""
    raise NotImplementedError


def kick_on(loads: Any, lightness: Any, v: Any, time: Any, step: Any, duration: Any, low: Any, high: Any) -> Any:
    """What the means of loads over a step around a time give beads in a duration; at the start over half a step."""
    raise NotImplementedError


def force_on(loads: Any, lightness: Any, a: Any, time: Any, low: Any, high: Any) -> Any:
    """Add loads at a time to accelerations."""
    raise NotImplementedError


def impulse_of(law: Any, t: Any) -> Any:
    """Of a law in time, until a time."""
    raise NotImplementedError


def travel_of(law: Any, t: Any) -> Any:
    """Of a free bead under a law in time, until a time."""
    raise NotImplementedError


def force_of(law: Any, t: Any) -> Any:
    """Of a law in time, at a time."""
    raise NotImplementedError


def _call(function: Any, parameters: int) -> Any:
    """Of a law's function, with its parameters."""
    function = njit(function)
    if parameters == 2:
        return lambda law, t: function(t, law[0], law[1])
    return lambda law, t: function(t, law[0], law[1], law[2], law[3])


@overload(impulse_of, strict=False)
def _impulse_of(law: Any, t: Any) -> Any:
    return _call(law.instance_class.impulse, len(law))


@overload(travel_of, strict=False)
def _travel_of(law: Any, t: Any) -> Any:
    return _call(law.instance_class.travel, len(law))


@overload(force_of, strict=False)
def _force_of(law: Any, t: Any) -> Any:
    return _call(law.instance_class.force, len(law))


@overload(drift_on, strict=False)
def _drift_on(loads: Any, lightness: Any, x: Any, v: Any, time: Any, duration: Any, low: Any, high: Any) -> Any:
    if len(loads) == 0:
        return lambda loads, lightness, x, v, time, duration, low, high: None

    def act(loads: Any, lightness: Any, x: Any, v: Any, time: Any, duration: Any, low: Any, high: Any) -> None:
        k, law = loads[0]
        if low <= k < high:
            before, after = impulse_of(law, time), impulse_of(law, time + duration)
            gone = travel_of(law, time + duration) - travel_of(law, time) - before * duration
            x[k] += over_mass(gone, lightness, k)
            v[k] += over_mass(after - before, lightness, k)
        drift_on(loads[1:], lightness, x, v, time, duration, low, high)

    return act


@overload(kick_on, strict=False)
def _kick_on(loads: Any, lightness: Any, v: Any, time: Any, step: Any, duration: Any, low: Any, high: Any) -> Any:
    if len(loads) == 0:
        return lambda loads, lightness, v, time, step, duration, low, high: None

    def act(loads: Any, lightness: Any, v: Any, time: Any, step: Any, duration: Any, low: Any, high: Any) -> None:
        k, law = loads[0]
        if low <= k < high:
            given = impulse_of(law, time + 0.5 * step) - impulse_of(law, time - 0.5 * step)
            v[k] += over_mass(given / step * duration * (2.0 if time == 0.0 else 1.0), lightness, k)
        kick_on(loads[1:], lightness, v, time, step, duration, low, high)

    return act


@overload(force_on, strict=False)
def _force_on(loads: Any, lightness: Any, a: Any, time: Any, low: Any, high: Any) -> Any:
    if len(loads) == 0:
        return lambda loads, lightness, a, time, low, high: None

    def act(loads: Any, lightness: Any, a: Any, time: Any, low: Any, high: Any) -> None:
        k, law = loads[0]
        if low <= k < high:
            a[k] += over_mass(force_of(law, time), lightness, k)
        force_on(loads[1:], lightness, a, time, low, high)

    return act
