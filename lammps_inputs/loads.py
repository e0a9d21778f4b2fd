"""Forces on single beads from outside, over time, and what they are to LAMMPS.

LAMMPS's beads are pushed by the mean of the force over the step around each instant, so that the impulse is exact at
any time step, also where the force begins and ends within one; the error still falls as the square of the step.
"""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from lammps_inputs.laws.in_time import TimeLaw
from lammps_inputs.lines import Lines
from lammps_inputs.numbers import text

if TYPE_CHECKING:
    from lammps_inputs.problem import Problem


@dataclass(frozen=True, eq=False)
class Load:
    """A force on one bead, towards higher bead numbers where positive.

    Attributes:
        chain, bead: counted from 1.
        law: of the force in time.
    """

    chain: int
    bead: int
    law: TimeLaw

    def __eq__(self, other: object) -> bool:
        """Whether all is the same, to the last number of every array."""
        return (
            isinstance(other, Load)
            and (self.chain, self.bead, type(self.law)) == (other.chain, other.bead, type(other.law))
            and all(map(np.array_equal, tuple(self.law), tuple(other.law)))  # type: ignore[arg-type]
        )

    def __hash__(self) -> int:
        return hash((self.chain, self.bead, type(self.law)))

    def force(self, time: Any) -> Any:
        """At a time."""
        return self.law.force(time, *self.law)  # type: ignore[misc]

    def rate(self, time: Any) -> Any:
        """How fast the force changes."""
        return self.law.rate(time, *self.law)  # type: ignore[misc]

    def impulse(self, time: Any) -> Any:
        """Given until a time."""
        return self.law.impulse(time, *self.law)  # type: ignore[misc]

    @property
    def end(self) -> float:
        """Time from which on there is no force."""
        return self.law.kinks[-1]

    def at(self, bead: int) -> "Load":
        """The same on another bead."""
        return replace(self, bead=bead)

    def mirrored(self, bead: int) -> "Load":
        """The opposite force on another bead."""
        return replace(self, bead=bead, law=self.law.reversed())


def lines(loads: tuple[Load, ...], problem: "Problem") -> list[Lines]:
    """What the loads are to LAMMPS, one after the other.

    Raises:
        ValueError: LAMMPS cannot be told.
    """
    return [_lines(load, f"push{number}", problem) for number, load in enumerate(loads, 1)]


def _lines(load: Load, name: str, problem: "Problem") -> Lines:
    first, last = text(load.law.kinks[0]), text(load.law.kinks[-1])
    variables = load.law.variables(name)
    if variables:
        last = f"v_{name}duration"

    def within(time: str) -> str:
        before = "" if first == "0" else f"{first}*({time}<={first})+"
        return f"{before}{time}*({time}>{first})*({time}<{last})+{last}*({time}>={last})"

    return Lines(
        variables=variables,
        motion=(
            f"# push on bead {load.bead} of chain {load.chain}: mean of the force over the step around each instant",
            f"variable {name}before equal (step-0.5)*v_timestep",
            f"variable {name}after equal (step+0.5)*v_timestep",
            f"variable {name}from equal {within(f'v_{name}before')}",
            f"variable {name}to equal {within(f'v_{name}after')}",
            f"variable {name} equal ({load.law.formula(name)})/v_timestep*(1+(step==0))",
            f"group {name} id {(load.chain - 1) * problem.rows + load.bead}",
            f"fix {name} {name} addforce v_{name} 0.0 0.0",
        ),
    )
