"""Forces on single beads from outside, over time, and beads whose motion is given; and what they are to LAMMPS.

LAMMPS's beads are pushed by the mean of the force over the step around each instant, so that the impulse is exact at
any time step, also where the force begins and ends within one; the error still falls as the square of the step.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, cast

from lammps_inputs import file_names
from lammps_inputs.deck_lines import BeadLayout, DeckLines
from lammps_inputs.laws import table_lines
from lammps_inputs.laws.in_time import Table, TimeLaw
from lammps_inputs.numbers import text


@dataclass(frozen=True)
class Load:
    """A force on one bead, towards higher bead numbers where positive.

    Attributes:
        chain, bead: counted from 1.
        law: law of the force in time.
    """

    chain: int
    bead: int
    law: TimeLaw

    def force(self, time: Any) -> Any:
        """Force at a time."""
        return self.law.force(time, *self.law)

    def rate(self, time: Any) -> Any:
        """Rate of change of the force at a time."""
        return self.law.rate(time, *self.law)

    def impulse(self, time: Any) -> Any:
        """Impulse from the start until a time."""
        return self.law.impulse(time, *self.law) - self.law.impulse(0.0, *self.law)

    def travel(self, time: Any) -> Any:
        """Distance that a free bead of mass 1 has gone from rest until a time."""
        travel, impulse = self.law.travel, self.law.impulse
        return travel(time, *self.law) - travel(0.0, *self.law) - impulse(0.0, *self.law) * time

    @property
    def end(self) -> float:
        """Time from which on there is no force; infinite where it never ends."""
        return self.law.kinks[-1]

    @property
    def endless(self) -> bool:
        """Whether the force never ends."""
        return math.isinf(self.end)

    @property
    def total_impulse(self) -> float:
        """Impulse of the load from start to end; of one that never ends, that of half a period."""
        return self.law.total if self.endless else float(self.impulse(self.end))


@dataclass(frozen=True)
class Motion:
    """A bead of prescribed motion, the sum of some.

    Attributes:
        chain, bead: counted from 1.
        laws: laws of the motions in time; the displacement is 0 at the start.
    """

    chain: int
    bead: int
    laws: tuple[TimeLaw, ...]

    def displacement(self, time: Any) -> Any:
        """Displacement at a time, in units of L."""
        return sum(law.travel(time, *law) - law.travel(0.0, *law) for law in self.laws)

    def velocity(self, time: Any) -> Any:
        """Velocity at a time, in units of V."""
        return sum(law.impulse(time, *law) for law in self.laws)

    def acceleration(self, time: Any) -> Any:
        """Acceleration at a time, in units of V / T."""
        return sum(law.force(time, *law) for law in self.laws)

    def jerk(self, time: Any) -> Any:
        """Rate of change of the acceleration at a time."""
        return sum(law.rate(time, *law) for law in self.laws)

    @property
    def omega(self) -> float:
        """Largest angular frequency, in units of 1 / T; 0 where none is harmonic."""
        return float(max(law.omega for law in self.laws))

    @property
    def end(self) -> float:
        """Time from which on it goes on smoothly, in units of T; infinite where it oscillates for ever."""
        return max(law.kinks[-1] for law in self.laws)

    @property
    def fastest(self) -> float:
        """Velocity of largest size, in units of V; of a sum, at most that, with the sign of the largest part."""
        fastest = [law.fastest for law in self.laws]
        return math.copysign(sum(map(abs, fastest)), max(fastest, key=abs))


def summed(motions: Iterable[Motion]) -> tuple[Motion, ...]:
    """Motions of which those of one bead are added."""
    laws: dict[tuple[int, int], tuple[TimeLaw, ...]] = {}
    for motion in motions:
        place = motion.chain, motion.bead
        laws[place] = (*laws.get(place, ()), *motion.laws)
    return tuple(Motion(*place, of_bead) for place, of_bead in laws.items())


def tables(system: Any) -> str:
    """Text of the file with the vectors of tables, which a deck includes; empty where it has none."""
    texts = [line for name, law, moves in _tables(system) for line in table_lines.vectors(law, name, moves=moves)]
    return "\n".join([*table_lines.HEAD, *texts, *table_lines.TAIL]) + "\n" if texts else ""


def include_lines(system: Any) -> tuple[str, ...]:
    """LAMMPS command that reads the file of `tables`, where there is one."""
    return (f"include {file_names.TABLES}",) if any(_tables(system)) else ()


def _tables(system: Any) -> Iterator[tuple[str, Table, bool]]:
    """Name and law of each load whose table is too long for a formula, and of each motion; whether it is a motion."""
    for number, load in enumerate(system.loads, 1):
        if load.law.long:
            yield f"push{number}", load.law, False
    for _, parts in _named(system.motions):
        for name, law in parts:
            if law.points:
                yield name, cast(Table, law), True


def _named(motions: Iterable[Motion]) -> Iterator[tuple[Motion, list[tuple[str, TimeLaw]]]]:
    """Every motion, and its laws with their names in the deck."""
    number = 0
    for motion in motions:
        yield motion, [(f"drive{n}", law) for n, law in enumerate(motion.laws, number + 1)]
        number += len(motion.laws)


def lines(loads: Sequence[Load], motions: Sequence[Motion], layout: BeadLayout) -> list[DeckLines]:
    """LAMMPS commands of the loads and of the beads of prescribed motion, one after the other.

    Raises:
        ValueError: LAMMPS has no command for it.
    """
    pushes = [_push_lines(load, f"push{number}", layout) for number, load in enumerate(loads, 1)]
    return pushes + [_motion_lines(motion, parts, layout) for motion, parts in _named(motions)]


def _motion_lines(motion: Motion, parts: list[tuple[str, TimeLaw]], layout: BeadLayout) -> DeckLines:
    """LAMMPS commands of a bead that no force acts on and that is moved by formulas, or by tables."""
    name = parts[0][0]
    courses = [law.course(part) for part, law in parts]
    displacement, velocity = ("+".join(formulas) for formulas in zip(*courses, strict=True))
    tables = [(part, cast(Table, law)) for part, law in parts if law.points]
    return DeckLines(
        variables=(
            *(line for part, law in parts for line in law.variables(part)),
            *((table_lines.SINCE,) if tables else ()),
        ),
        motion=(
            f"# bead {motion.bead} of chain {motion.chain} has a prescribed motion; no force acts on it",
            *(line for part, law in tables for line in table_lines.moved_lines(law, part)),
            f"variable {name}x equal {displacement}",
            f"variable {name}v equal {velocity}",
            f"group {name} id {layout.atom(motion.chain, motion.bead)}",
            f"fix {name}free {name} setforce 0.0 NULL NULL",
        ),
        moved=(f"fix {name} {name} move variable v_{name}x NULL NULL v_{name}v NULL NULL",),
    )


def start_lines(motions: Sequence[Motion], layout: BeadLayout) -> list[str]:
    """LAMMPS commands that set the initial velocities of beads of prescribed motion."""
    return [
        f"set atom {layout.atom(motion.chain, motion.bead)} "
        f"vx $({'+'.join(law.start(name) for name, law in parts)}:%.17g)"
        for motion, parts in _named(motions)
    ]


def _push_lines(load: Load, name: str, layout: BeadLayout) -> DeckLines:
    first, last = text(load.law.kinks[0]), text(load.law.kinks[-1])
    variables = load.law.variables(name)
    lookup: tuple[str, ...] = ()
    since: tuple[str, ...] = ()
    if load.law.long:
        lookup, since = table_lines.lines(cast(Table, load.law), name), (table_lines.SINCE,)
    if variables and not load.endless:
        last = f"v_{name}duration"

    def within(time: str) -> str:
        before = "" if first == "0" else f"{first}*({time}<={first})+"
        during = f"{before}{time}*({time}>{first})"
        return during if load.endless else f"{during}*({time}<{last})+{last}*({time}>={last})"

    return DeckLines(
        variables=(*variables, *since),
        motion=(
            f"# push on bead {load.bead} of chain {load.chain}: force averaged over a time step about each instant",
            f"variable {name}before equal (step-0.5)*v_timestep",
            f"variable {name}after equal (step+0.5)*v_timestep",
            f"variable {name}from equal {within(f'v_{name}before')}",
            f"variable {name}to equal {within(f'v_{name}after')}",
            *lookup,
            f"variable {name} equal ({load.law.formula(name)})/v_timestep*(1+(step==0))",
            f"group {name} id {layout.atom(load.chain, load.bead)}",
            f"fix {name} {name} addforce v_{name} 0.0 0.0",
        ),
    )
