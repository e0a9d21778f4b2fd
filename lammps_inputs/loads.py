"""Forces on single beads from outside, over time, and beads whose motion is given; and what they are to LAMMPS.

LAMMPS's beads are pushed by the mean of the force over the step around each instant, so that the impulse is exact at
any time step, also where the force begins and ends within one; the error still falls as the square of the step.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from lammps_inputs import file_names
from lammps_inputs.deck_lines import BeadLayout, DeckLines
from lammps_inputs.laws import table_lines
from lammps_inputs.laws.in_time import Sine, TabulatedForce, TimeLaw
from lammps_inputs.numbers import text


@dataclass(frozen=True, eq=False)
class Load:
    """A force on one bead, towards higher bead numbers where positive.

    Attributes:
        chain, bead: counted from 1.
        law: law of the force in time.
    """

    chain: int
    bead: int
    law: TimeLaw

    def __eq__(self, other: object) -> bool:
        """Whether all is the same, to the last number of every array."""
        if not isinstance(other, Load):
            return False
        alike = (self.chain, self.bead, type(self.law)) == (other.chain, other.bead, type(other.law))
        parameters: Any = zip(self.law, other.law, strict=False)
        return alike and all(np.array_equal(mine, theirs) for mine, theirs in parameters)

    def __hash__(self) -> int:
        return hash((self.chain, self.bead, type(self.law)))

    def force(self, time: Any) -> Any:
        """Force at a time."""
        return self.law.force(time, *self.law)

    def rate(self, time: Any) -> Any:
        """Rate of change of the force at a time."""
        return self.law.rate(time, *self.law)

    def impulse(self, time: Any) -> Any:
        """Impulse until a time."""
        return self.law.impulse(time, *self.law)

    def travel(self, time: Any) -> Any:
        """Distance that a free bead of mass 1 has gone from rest until a time."""
        return self.law.travel(time, *self.law)

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
    """A bead of prescribed motion: by ``amplitude * (sin(omega t + phase) - sin(phase))``.

    Attributes:
        chain, bead: counted from 1.
        amplitude: in units of L.
        omega: angular frequency, in units of 1 / T.
        phase: in radians.
    """

    chain: int
    bead: int
    amplitude: float
    omega: float
    phase: float

    @property
    def law(self) -> Sine:
        """Law of the acceleration in time; the displacement is 0 at the start."""
        return Sine(-self.amplitude * self.omega**2, self.omega, self.phase)

    def displacement(self, time: Any) -> Any:
        """Displacement at a time, in units of L."""
        return self.amplitude * (np.sin(self.omega * time + self.phase) - np.sin(self.phase))

    def velocity(self, time: Any) -> Any:
        """Velocity at a time, in units of V."""
        return self.amplitude * self.omega * np.cos(self.omega * time + self.phase)

    def acceleration(self, time: Any) -> Any:
        """Acceleration at a time, in units of V / T."""
        return self.law.force(time, *self.law)

    def jerk(self, time: Any) -> Any:
        """Rate of change of the acceleration at a time."""
        return self.law.rate(time, *self.law)

    @property
    def speed(self) -> float:
        """Largest speed of the bead, in units of V."""
        return abs(self.amplitude) * self.omega


def tables(system: Any) -> str:
    """Text of the file with the vectors of long tables, which a deck includes; empty where it has none."""
    texts = [line for name, law in _long_tables(system) for line in table_lines.vectors(law, name)]
    return "\n".join([*table_lines.HEAD, *texts, *table_lines.TAIL]) + "\n" if texts else ""


def include_lines(system: Any) -> tuple[str, ...]:
    """LAMMPS command that reads the file of `tables`, where there is one."""
    return (f"include {file_names.TABLES}",) if any(_long_tables(system)) else ()


def _long_tables(system: Any) -> Iterator[tuple[str, TabulatedForce]]:
    """Name and law of each load whose table is too long for a formula."""
    for number, load in enumerate(system.loads, 1):
        if load.law.long:
            yield f"push{number}", load.law


def lines(loads: Sequence[Load], motions: Sequence[Motion], layout: BeadLayout) -> list[DeckLines]:
    """LAMMPS commands of the loads and of the beads of prescribed motion, one after the other.

    Raises:
        ValueError: LAMMPS has no command for it.
    """
    pushes = [_push_lines(load, f"push{number}", layout) for number, load in enumerate(loads, 1)]
    return pushes + [_motion_lines(motion, f"drive{n}", layout) for n, motion in enumerate(motions, 1)]


def _motion_lines(motion: Motion, name: str, layout: BeadLayout) -> DeckLines:
    """LAMMPS commands of a bead that no force acts on and that is moved by a formula."""
    turn = f"v_{name}omega*step*v_timestep+v_{name}phase"
    return DeckLines(
        variables=(
            f"variable {name}amplitude index {text(motion.amplitude)}",
            f"variable {name}omega index {text(motion.omega)}",
            f"variable {name}phase index {text(motion.phase)}",
        ),
        motion=(
            f"# bead {motion.bead} of chain {motion.chain} has a prescribed motion; no force acts on it",
            f"variable {name}x equal v_{name}amplitude*(sin({turn})-sin(v_{name}phase))",
            f"variable {name}v equal v_{name}amplitude*v_{name}omega*cos({turn})",
            f"group {name} id {layout.atom(motion.chain, motion.bead)}",
            f"fix {name}free {name} setforce 0.0 NULL NULL",
        ),
        moved=(f"fix {name} {name} move variable v_{name}x NULL NULL v_{name}v NULL NULL",),
    )


def start_lines(motions: Sequence[Motion], layout: BeadLayout) -> list[str]:
    """LAMMPS commands that set the initial velocities of beads of prescribed motion."""
    return [
        f"set atom {layout.atom(motion.chain, motion.bead)} "
        f"vx $(v_drive{number}amplitude*v_drive{number}omega*cos(v_drive{number}phase):%.17g)"
        for number, motion in enumerate(motions, 1)
    ]


def _push_lines(load: Load, name: str, layout: BeadLayout) -> DeckLines:
    first, last = text(load.law.kinks[0]), text(load.law.kinks[-1])
    variables = load.law.variables(name)
    lookup: tuple[str, ...] = ()
    since: tuple[str, ...] = ()
    if load.law.long:
        lookup, since = table_lines.lines(cast(TabulatedForce, load.law), name), (table_lines.SINCE,)
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
