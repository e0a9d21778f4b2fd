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
"""Distances to neighbours that the loop is written out for, which an open row has."""


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


def sum_of(laws: Any, k: Any, strain: Any) -> Any:
    """Force of several laws on the same link, at a place in memory."""
    raise NotImplementedError


def pull(across: Any, x: Any, k: Any) -> Any:
    """Force that drives a bead back towards those of its row."""
    raise NotImplementedError


def over_mass(force: Any, lightness: Any, k: Any) -> Any:
    """Acceleration by a force at a place in memory."""
    raise NotImplementedError


@overload(sum_of, inline="always", strict=False)
def _sum_of(laws: Any, k: Any, strain: Any) -> Any:
    return written_for_laws("force", laws, "laws, k, strain", "strain")


@overload(pull, inline="always", strict=False)
def _pull(across: Any, x: Any, k: Any) -> Any:
    return written_for_neighbours("force", across, "across, x, k", "x[k] - x[{other}]")


@overload(over_mass, inline="always", strict=False)
def _over_mass(force: Any, lightness: Any, k: Any) -> Any:
    if isinstance(lightness, types.Array):
        return lambda force, lightness, k: force * lightness[k]
    return lambda force, lightness, k: force


# Sums over laws are written out as flat source and inlined once: where an inlined function inlines others, the compiler
# goes through them anew at every level, twice the time for each. And a function that is not inlined, but takes a tuple
# of arrays, keeps the loop around it from becoming vector instructions.


def written_for_laws(function: str, laws: Any, arguments: str, strain: str) -> Any:
    """The sum of a function of laws on the same link, with the strain first among its arguments.

    Args:
        function: of the laws, by name.
        laws: numba type of the tuple.
        arguments: of what is returned; ``laws`` is the first, ``k`` the place in memory.
        strain: first arguments of the function, as source.
    """
    names: dict[str, Any] = {}
    terms = [_call(names, function, law, f"laws[{n}]", "k", strain) for n, law in enumerate(laws)]
    return _written(names, arguments, [], terms)


def written_for_neighbours(function: str, across: Any, arguments: str, strain: str) -> Any:
    """The same over neighbours in a row; ``across`` is the first argument, ``{other}`` the place of the other bead."""
    names: dict[str, Any] = {"uint64": np.uint64}
    lines, terms = [], []
    for n, (distance, law) in enumerate(across):
        near, other = f"across[{n}]", f"k + across[{n}][0]"
        if isinstance(distance, types.Array):
            term = _call(names, function, law, f"{near}[1]", "m, k", strain.format(other=f"{other}[m]"))
            lines += [f"total{n} = 0.0", f"for m in range(uint64({near}[0].shape[0])):", f"    total{n} += {term}"]
            terms.append(f"total{n}")
        else:
            terms.append(_call(names, function, law, f"{near}[1]", "k", strain.format(other=other)))
    return _written(names, arguments, lines, terms)


def _call(names: dict[str, Any], function: str, law: Any, name: str, place: str, strain: str) -> str:
    """Source of a call of a law's function, which goes among the names."""
    called = f"{function}{len(names)}"
    names[called] = njit(inline="always")(getattr(law.instance_class, function))
    parameters = [f"{name}[{n}]" + f"[{place}]" * isinstance(kind, types.Array) for n, kind in enumerate(law.types)]
    return f"{called}({', '.join([strain, *parameters])})"


def _written(names: dict[str, Any], arguments: str, lines: list[str], terms: list[str]) -> Any:
    """A function that runs lines and returns the sum of terms, the last two added first; 0 if there are none."""
    total = " + (".join(terms or ["0.0"]) + ")" * (len(terms) - 1)
    exec("\n    ".join([f"def written({arguments}):", *lines, f"return {total}"]), names)
    return names["written"]


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


def _in_time(function: Any, parameters: int) -> Any:
    """Of a law's function, with its parameters."""
    function = njit(function)
    if parameters == 2:
        return lambda law, t: function(t, law[0], law[1])
    return lambda law, t: function(t, law[0], law[1], law[2], law[3])


@overload(impulse_of, strict=False)
def _impulse_of(law: Any, t: Any) -> Any:
    return _in_time(law.instance_class.impulse, len(law))


@overload(travel_of, strict=False)
def _travel_of(law: Any, t: Any) -> Any:
    return _in_time(law.instance_class.travel, len(law))


@overload(force_of, strict=False)
def _force_of(law: Any, t: Any) -> Any:
    return _in_time(law.instance_class.force, len(law))


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
