"""The laws of a problem's links, compiled: their scalar functions, inlined into the kernel's loops.

| kind of link | here     | what it is to the kernel                                                        |
|--------------|----------|---------------------------------------------------------------------------------|
| along        | ``along``  | tuple of laws; the contact with the bead behind, so bead 1 has one with row 0  |
| across       | ``across`` | tuple of (distance to the other bead in memory, law), or of (array of those,    |
|              |            | law with parameters [distance, place]) where there are more than `UNROLLED`     |
| ground       | ``ground`` | tuple of laws                                                                  |

Forces from outside, over time, are tuples of (position in memory, law). Those of ``drifted`` act while beads drift,
exactly as on free beads; so do those of ``moved``, which are accelerations of beads that no force moves. Those of
``kicked`` act as LAMMPS has them, by their means over a step.

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
from lammps_inputs.laws import dashpot
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
    """One over the masses, 0 of beads whose motion is given; an empty tuple where all are 1."""
    moved: tuple[tuple[int, Any], ...]
    """Laws of the acceleration of beads whose motion is given."""
    drifted: tuple[tuple[int, Any], ...]
    kicked: tuple[tuple[int, Any], ...]
    work: Any
    """[1] what loads put in, and what beads that are moved do against forces; an empty tuple where nobody counts."""
    dampers: Any
    """Forces against velocities (`dashpots`); an empty tuple where there are none."""


def make_forces(system: System, dampers: Any = (), *, as_lammps: bool = False, step: float = 0.0) -> Forces:
    """The forces of a system on a state [bead + 2, chain], whose rows 0 and beads + 1 stay at rest.

    Args:
        system: what is integrated.
        dampers: its dashpots.
        as_lammps: whether forces from outside act as LAMMPS has them.
        step: of LAMMPS, where masses depend on it.
    """
    loads = tuple((load.bead * system.chains + load.chain - 1, load.law) for load in system.loads)
    motions = tuple((each.bead * system.chains + each.chain - 1, each.law) for each in system.motions)
    return Forces(
        along=tuple(flat(link.law, system, first=2) for link in system.along),
        gap=system.gap,
        across=tuple(neighbour for link in system.across for neighbour in neighbours(link, system)),
        ground=tuple(flat(link.law, system, first=1) for link in system.ground),
        lightness=_lightness(system, step if as_lammps and system.centred else 0.0),
        moved=motions,
        drifted=() if as_lammps else loads,
        kicked=loads if as_lammps else (),
        work=np.zeros(1) if system.acted_on and not as_lammps else (),
        dampers=dampers,
    )


def _lightness(system: System, step: float) -> Any:
    mass = system.mass
    if step:
        more = sum(float(np.max(dashpot.resistance(link.law, 0.0))) for link in system.dampers)
        mass = np.broadcast_to(mass + 0.5 * step * more, (system.chains, system.beads))
    if isinstance(mass, float) and not system.motions:
        return ()
    rows = np.ones((system.beads + 2, system.chains))
    rows[1:-1] /= np.transpose(mass)
    for motion in system.motions:
        rows[motion.bead, motion.chain - 1] = 0.0
    return rows.reshape(-1)


def flat(law: Any, system: System, *, first: int) -> Any:
    """A law whose parameters that differ lie as the state does, those of the first link in row ``first``."""

    def laid(parameter: Any) -> Any:
        if np.ndim(parameter) == 0:
            return float(parameter)
        rows = np.zeros((system.beads + 2, system.chains))
        rows[first : first + parameter.shape[1]] = parameter.T
        return rows.reshape(-1)

    return type(law)(*map(laid, law))


def neighbours(link: Across, system: System) -> list[tuple[Any, Any]]:
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


def travel_on(loads: Any, lightness: Any, x: Any, time: Any, duration: Any, low: Any, high: Any) -> Any:
    """How much farther free beads drift under loads in a duration, in places of memory from low to below high."""
    raise NotImplementedError


def give_on(loads: Any, lightness: Any, work: Any, v: Any, time: Any, duration: Any, low: Any, high: Any) -> Any:
    """How much faster they get; the work is that on free beads."""
    raise NotImplementedError


def count_on(loads: Any, work: Any, early: Any, middle: Any, late: Any, time: Any, duration: Any, low: Any, high: Any
) -> Any:  # fmt: skip
    """Count the work of loads on beads with these velocities at the start, the middle and the end of a duration."""
    raise NotImplementedError


def hold_on(forces: Any, moved: Any, push: Any, x: Any, v: Any, duration: Any, chains: Any) -> Any:
    """Count what beads that are moved do against forces of positions in a duration."""
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
    if parameters == 3:
        return lambda law, t: function(t, law[0], law[1], law[2])
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


@njit(inline="always")
def over_the_way(early: Any, middle: Any, late: Any, first: Any, second: Any) -> Any:
    """Integral of a velocity over what is given: ``first`` in one half of a time, ``second`` in the other.

    By the trapezoidal rule for the halves and for the whole, and what these tell of a rule of fourth order. Summed over
    all that is given to a bead, each rule has the change of its kinetic energy exactly, however that is given.
    """
    halves = 0.5 * (early + middle) * first + 0.5 * (middle + late) * second
    return (4.0 * halves - 0.5 * (early + late) * (first + second)) / 3.0


@overload(travel_on, strict=False)
def _travel_on(loads: Any, lightness: Any, x: Any, time: Any, duration: Any, low: Any, high: Any) -> Any:
    if len(loads) == 0:
        return lambda loads, lightness, x, time, duration, low, high: None

    def act(loads: Any, lightness: Any, x: Any, time: Any, duration: Any, low: Any, high: Any) -> None:
        k, law = loads[0]
        if low <= k < high:
            gone = travel_of(law, time + duration) - travel_of(law, time) - impulse_of(law, time) * duration
            x[k] += over_mass(gone, lightness, k)
        travel_on(loads[1:], lightness, x, time, duration, low, high)

    return act


@overload(give_on, strict=False)
def _give_on(loads: Any, lightness: Any, work: Any, v: Any, time: Any, duration: Any, low: Any, high: Any) -> Any:
    if len(loads) == 0:
        return lambda loads, lightness, work, v, time, duration, low, high: None

    counts = isinstance(work, types.Array)

    def act(loads: Any, lightness: Any, work: Any, v: Any, time: Any, duration: Any, low: Any, high: Any) -> None:
        k, law = loads[0]
        if low <= k < high:
            given, early = impulse_of(law, time + duration) - impulse_of(law, time), v[k]
            v[k] += over_mass(given, lightness, k)
            if counts:
                work[0] += given * 0.5 * (early + v[k])
        give_on(loads[1:], lightness, work, v, time, duration, low, high)

    return act


@overload(count_on, strict=False)
def _count_on(
    loads: Any, work: Any, early: Any, middle: Any, late: Any, time: Any, duration: Any, low: Any, high: Any
) -> Any:
    if len(loads) == 0:
        return lambda loads, work, early, middle, late, time, duration, low, high: None

    def act(
        loads: Any, work: Any, early: Any, middle: Any, late: Any, time: Any, duration: Any, low: Any, high: Any
    ) -> None:
        k, law = loads[0]
        if low <= k < high:
            half = impulse_of(law, time + 0.5 * duration)
            first, second = half - impulse_of(law, time), impulse_of(law, time + duration) - half
            work[0] += over_the_way(early[k], middle[k], late[k], first, second)
        count_on(loads[1:], work, early, middle, late, time, duration, low, high)

    return act


@overload(hold_on, strict=False)
def _hold_on(forces: Any, moved: Any, push: Any, x: Any, v: Any, duration: Any, chains: Any) -> Any:
    if len(moved) == 0 or not isinstance(forces.types[Forces._fields.index("work")], types.Array):
        return lambda forces, moved, push, x, v, duration, chains: None

    def act(forces: Any, moved: Any, push: Any, x: Any, v: Any, duration: Any, chains: Any) -> None:
        k = moved[0][0]
        force = push[k] - push[k + chains] - pull(forces.across, x, k) - sum_of(forces.ground, k, x[k])
        forces.work[0] -= duration * force * v[k]
        hold_on(forces, moved[1:], push, x, v, duration, chains)

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
