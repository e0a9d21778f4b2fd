"""How a run goes through time: velocity Verlet, or Suzuki's fourth-order composition of five Verlet steps.

LAMMPS has only the Verlet step. A composition is a cycle of Verlet steps of different lengths, so it needs no code in
LAMMPS: the length is set after every step. The numbers stand beside the LAMMPS lines that mean the same.
"""

import itertools
from typing import Literal

SchemeName = Literal["verlet", "suzuki4"]

_OUTER = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))

WEIGHTS: dict[SchemeName, tuple[float, ...]] = {
    "verlet": (1.0,),
    "suzuki4": (_OUTER, _OUTER, 1.0 - 4.0 * _OUTER, _OUTER, _OUTER),
}
"""Lengths of a cycle's Verlet steps in units of the cycle (Suzuki, Phys. Lett. A 146 (1990) 319, eq. 15)."""

LARGEST_PHASE: dict[SchemeName, float] = {"verlet": 2.0, "suzuki4": 2.72 / 5.0}
"""Largest product of angular frequency and mean Verlet step for which an oscillator stays bounded, from the trace of
its cycle.
"""

QUIET = ("log none                         # LAMMPS would write four lines for each substep",)
LOUD = ("log log.lammps append", 'print "arrived at step $(step)"')

_SINCE = 20220623
"""Earlier releases use the old time step until the next setup of a run."""

TOO_OLD = "scheme suzuki4 needs LAMMPS of 23Jun2022 or later, which changes the time step between steps"


def cycle(scheme: SchemeName) -> int:
    """Verlet steps in a cycle; frames and the end of a run fall between two cycles."""
    return len(WEIGHTS[scheme])


def variable_lines(scheme: SchemeName) -> list[str]:
    """LAMMPS variables for `run_lines` and `cycle_lines`; ``timestep`` is the mean step of a cycle."""
    if scheme == "verlet":
        return []
    outer, *_ = WEIGHTS[scheme]
    return [
        f"variable outer equal {5.0 * outer!r}   # Suzuki's weights: four Verlet steps of this length, in mean steps,",
        f"variable inner equal {5.0 * WEIGHTS[scheme][2]!r}   # and the one between them, which is negative",
        "variable verlet equal v_timestep*(v_outer+(v_inner-v_outer)*(step%5==2))",
        f'if "$(version) < {_SINCE}" then "print \'{TOO_OLD}\'" "quit 1"',
    ]


def step_variable(scheme: SchemeName) -> str:
    """The LAMMPS variable that is the length of the next Verlet step."""
    return "timestep" if scheme == "verlet" else "verlet"


def timestep_command(scheme: SchemeName) -> str:
    """The command before the first step."""
    return "timestep ${timestep}" if scheme == "verlet" else "timestep $(v_verlet:%.17g)"


def cycle_lines(scheme: SchemeName) -> list[str]:
    """LAMMPS commands of one cycle of a composition, after ``run 0``: a run for each group of equal steps.

    ``run N pre no every 1 ...`` would do the same in one line, but begins with a setup whatever ``pre`` says, and so
    with new neighbours and owners of beads that are no longer where they were.
    """
    steps = "timestep $(v_verlet:%.17g)"
    runs = [len(list(group)) for _, group in itertools.groupby(WEIGHTS[scheme])]
    return [line for number in runs for line in (steps, f"run {number} pre no post no")]


def onward_lines(scheme: SchemeName, goal: str) -> list[str]:
    """Run from a cycle's end to a step (a LAMMPS variable), without the setup that a run begins with; in a file."""
    return [
        "label cycle",
        f'if "$(step) >= $(v_{goal}:%.0f)" then "jump SELF whole"',
        *cycle_lines(scheme),
        "jump SELF cycle",
        "label whole",
    ]


def run_lines(scheme: SchemeName, steps: str) -> list[str]:
    """A whole run of some Verlet steps, from the start with all beads at rest where they are."""
    if scheme == "verlet":
        return [f"run {steps}"]
    every = f'run {steps} pre no post no every 1 "timestep $(v_verlet:%.17g)"'
    return ["run 0 post no", *QUIET, every, *LOUD]
