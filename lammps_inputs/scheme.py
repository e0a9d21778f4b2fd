"""How a run goes through time: velocity Verlet, or Suzuki's fourth-order composition of five Verlet steps.

LAMMPS knows only the Verlet step. A composition is a cycle of Verlet steps of different lengths, so it needs no code in
LAMMPS: the length is set anew after every step. The numbers stand beside the LAMMPS lines that mean the same.
"""

from typing import Literal

SchemeName = Literal["verlet", "suzuki4"]

_OUTER = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))

_WEIGHTS: dict[SchemeName, tuple[float, ...]] = {
    "verlet": (1.0,),
    "suzuki4": (_OUTER, _OUTER, 1.0 - 4.0 * _OUTER, _OUTER, _OUTER),
}

_PHASE: dict[SchemeName, float] = {"verlet": 2.0, "suzuki4": 2.72 / 5.0}
"""Largest stable product of angular frequency and mean step, from the trace of the cycle of an oscillator."""


QUIET = ("log none                         # LAMMPS has four lines to say about every substep",)
LOUD = ("log log.lammps append", 'print "arrived at step $(step)"')

_SINCE = 20220623
"""Earlier releases go on with the old time step until the next setup of a run."""

TOO_OLD = "scheme suzuki4 needs LAMMPS of 23Jun2022 or later, which changes the time step between steps"


def weights(scheme: SchemeName) -> tuple[float, ...]:
    """Lengths of a cycle's Verlet steps in units of the cycle (Suzuki, Phys. Lett. A 146 (1990) 319, eq. 15)."""
    return _WEIGHTS[scheme]


def cycle(scheme: SchemeName) -> int:
    """Verlet steps in a cycle; frames and the end of a run fall between two cycles."""
    return len(_WEIGHTS[scheme])


def largest_phase(scheme: SchemeName) -> float:
    """Largest product of angular frequency and (mean) Verlet step for which an oscillator stays bounded."""
    return _PHASE[scheme]


def variable_lines(scheme: SchemeName) -> list[str]:
    """LAMMPS variables for `run_command`; ``timestep`` is the mean step of a cycle."""
    if scheme == "verlet":
        return []
    outer, *_ = _WEIGHTS[scheme]
    return [
        f"variable outer equal {5.0 * outer!r}   # Suzuki's weights: 4 Verlet steps of this many mean ones,",
        f"variable inner equal {5.0 * _WEIGHTS[scheme][2]!r}   # the one in their middle backwards",
        "variable verlet equal v_timestep*(v_outer+(v_inner-v_outer)*(step%5==2))",
        f'if "$(version) < {_SINCE}" then "print \'{TOO_OLD}\'" "quit 1"',
    ]


def timestep_command(scheme: SchemeName) -> str:
    """The command before the first step."""
    return "timestep ${timestep}" if scheme == "verlet" else "timestep $(v_verlet:%.17g)"


def advance_command(scheme: SchemeName, steps: str) -> str:
    """The command that goes on by some Verlet steps (a number or a LAMMPS variable) after ``run 0``."""
    every = "" if scheme == "verlet" else ' every 1 "timestep $(v_verlet:%.17g)"'
    return f"run {steps} pre no post no{every}"


def run_lines(scheme: SchemeName, steps: str) -> list[str]:
    """A whole run of some Verlet steps."""
    if scheme == "verlet":
        return [f"run {steps}"]
    return ["run 0 post no", *QUIET, advance_command(scheme, steps), *LOUD]
