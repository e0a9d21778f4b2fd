"""What a run in LAMMPS will cost in time, memory and bytes, by a model.

A step takes a fixed time, a time for every bead of a rank, and with more than one rank a time for the messages to the
two neighbours (a rank owns whole rows, so it sends its outermost rows only). Times and bytes a bead were measured on
one core with 100 to a million beads; the time of messages is assumed. What formulas take that LAMMPS evaluates follows
from their text in the deck, whatever law they spell. Larger runs are extrapolated, taking for granted that

- memory and its bandwidth grow with the ranks (true for ranks on different nodes, less so for those of one);
- a network takes some microseconds a message, and the outermost rows of a rank are few beads beside its own;
- frames are written by one rank, at the speed of one file.

Plug-ins take this module to plan runs on clusters: `cost` estimates time and size of a run, `MEMORY` its memory,
`step_seconds` and `frame_seconds` give the parts of its time, `bead_seconds` that of a bead alone, `MESSAGES` that of
messages between ranks.

Examples:
    >>> problem = granchain.load("one-chain", {"timestep": 0.01}).problem()
    >>> estimated = cost_model.cost(problem, ranks=1)
    >>> round(estimated.seconds, 3), estimated.frames  # in s and bytes
    (0.077, 4857434.0)
    >>> fixed, bead = cost_model.step_seconds(granchain.load("two-chains").problem())
    >>> f"{fixed:.1e} s a step, and {bead:.1e} s for each bead of a rank"
    '1.5e-06 s a step, and 2.0e-08 s for each bead of a rank'
"""

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from analysis.files.dump_layout import sizes
from lammps_inputs import Problem, physics
from lammps_inputs.deck_lines import DeckLines
from lammps_inputs.decks import deck
from lammps_inputs.rows import Rows

MEMORY = 1000
"""Memory in bytes a bead of a single chain at the start, when it is largest; 600 to 700 for coupled chains."""

REFERENCE_FORCE = 1e-9
"""Seconds of the reference integrator for the forces on a bead; measured: 0.7e-9 to 3e-9."""

LONE_BEAD = 10e-9
"""Seconds a bead and step without springs, of a million beads; 8 ns where they fit into the cache."""

COUPLED_BEAD = 20e-9
"""Seconds a bead and step with springs, of a million beads; 13 ns where they fit into the cache."""

STEP = 1.5e-6
"""Seconds a step at the least."""

MESSAGES = 10e-6
"""Seconds a step for the messages of a rank to its neighbours, and for waiting for them: assumed."""

FORMULA, POINT, VECTORS, MOTION = 20e-6, 6e-6, 40e-6, 6e-6
"""Seconds a step for a force from outside that is a formula of time, for each point of one that is a table, for a table
of any number of points that are vectors, and for a bead whose motion is given.
"""

LEPTON, DISTANCE = 40e-6, 140e-6
"""Seconds a step for each energy that is a formula, and for each occurrence of the distance in it: LAMMPS derives and
compiles the formulas of ``lepton`` anew in every step. Measured: 0.15 to 1.4 ms, 0.5 to 1.4 times this.
"""

EVALUATED = 25e-9
"""Seconds a bead and step that evaluating such an energy adds."""

OPERATION, READ = 15e-9, 0.3e-6
"""Seconds a bead and step, and a step, for each operation in a formula that LAMMPS evaluates for every atom."""

LOADED, DAMPED = 40e-9, 20e-9
"""Seconds a bead and step that a static load and dashpots of contacts add."""

FRAME = 15e-6
"""Seconds a frame beside its bytes."""

FILE = 5e8
"""Bytes a second into one file: assumed."""


@dataclass(frozen=True)
class Cost:
    """Estimated cost of a run.

    Attributes:
        step: time of a time step without frames, in s.
        seconds: time of the run with its frames, in s.
        frame: size of a frame, in bytes.
        frames: size of all frames, in bytes.
    """

    step: float
    seconds: float
    frame: float
    frames: float


def cost(problem: Problem, ranks: int) -> Cost:
    """Estimated cost of a run, by the model.

    Args:
        problem: what is to run.
        ranks: number of MPI ranks.

    Returns:
        The cost, in s and bytes.
    """
    frame, frames = sizes(problem)
    largest = math.ceil(problem.rows.existing / ranks) * problem.chains
    fixed, bead = step_seconds(problem)
    step = fixed + bead * largest + MESSAGES * (ranks > 1)
    return Cost(step, step * problem.steps + frame_seconds(frames, problem.frames), frame, frames)


def bead_seconds(problem: Problem) -> float:
    """Seconds a bead and step of contacts and springs alone."""
    return COUPLED_BEAD if physics.coupled(problem.system) else LONE_BEAD


def step_seconds(problem: Problem) -> tuple[float, float]:
    """Seconds of a time step, with what the ingredients of the scene add, without `MESSAGES`.

    Returns:
        Seconds whatever the number of beads; and seconds for each bead of a rank.
    """
    system = problem.system
    tables = [load.law for load in system.loads if load.law.points]
    fixed = STEP + FORMULA * (len(system.loads) - len(tables))
    fixed += sum(VECTORS if law.long else POINT * law.points for law in tables)
    fixed += MOTION * len(system.motions) + VECTORS * sum(
        bool(law.points) for each in system.motions for law in each.laws
    )
    bead = bead_seconds(problem) + LOADED * physics.loaded(system)
    bead += DAMPED * (physics.contact_loss(system) is not None)
    of_formulas = formula_seconds(_formulas(problem))
    return fixed + of_formulas[0], bead + of_formulas[1]


def _formulas(problem: Problem) -> tuple[DeckLines, ...]:
    """Lines of the laws on links; none where LAMMPS has no words for one of them, which it then does not compute."""
    try:
        return deck.link_lines(_first_rows(problem))
    except ValueError:
        return ()


_ROWS = 64
"""Rows whose lines are read, as formulas are those of all rows; more would take longer in chains of unlike beads."""


def _first_rows(problem: Problem) -> Problem:
    """The problem with its first rows alone, and all that acts on beads beyond them at the last of these."""
    system = problem.system
    if problem.beads <= _ROWS:
        return problem
    at = {(chain, min(bead, _ROWS)): velocity for chain, bead, velocity in system.kicks}
    return replace(
        problem,
        system=replace(
            system.on(np.arange(_ROWS)),
            kicks=tuple((*place, velocity) for place, velocity in at.items()),
            loads=tuple(replace(load, bead=min(load.bead, _ROWS)) for load in system.loads),
            motions=tuple(replace(motion, bead=min(motion.bead, _ROWS)) for motion in system.motions),
        ),
        rows=Rows(_ROWS),
    )


def formula_seconds(spelled: Iterable[DeckLines]) -> tuple[float, float]:
    """Seconds of a time step that the formulas in lines of a deck take: of any number of beads, and for each bead."""
    fixed = bead = 0.0
    for lines in spelled:
        for energy in _energies(lines):
            fixed += LEPTON + DISTANCE * len(re.findall(r"\br\b", energy))
            bead += EVALUATED
        operations = _operations_of_atoms((*lines.variables, *lines.motion))
        fixed, bead = fixed + READ * operations, bead + OPERATION * operations
    return fixed, bead


def _energies(lines: DeckLines) -> list[str]:
    """Energies of pairs, bonds and walls that are formulas for LAMMPS's ``lepton``, in quotation marks."""
    commands = [line for line in (*lines.interactions, *lines.beside, *lines.motion) if not line.startswith("#")]
    texts = commands if any("lepton" in line for line in commands) else []
    texts = [*texts, *(lines.coefficients if lines.style == "lepton" else ())]
    return re.findall(r'"([^"]*)"', " ".join(texts))


def _operations_of_atoms(lines: Iterable[str]) -> int:
    """Operations for each atom in the variables that fixes use, those of the variables that they name included."""
    texts = {}
    used = []
    for line in lines:
        if match := re.match(r"variable (\w+) atom (.*)", line):
            texts[match[1]] = match[2]
        elif line.startswith("fix "):
            used += re.findall(r"\bv_(\w+)", line)

    def operations(name: str) -> int:
        text = texts.get(name, "")
        return len(re.findall(r"[-+*/^%<>]|\w\(", text)) + sum(map(operations, re.findall(r"\bv_(\w+)", text)))

    return sum(map(operations, used))


def frame_seconds(size: float, frames: float = 1) -> float:
    """Time to write frames.

    Args:
        size: bytes of all of them.
        frames: number of frames.

    Returns:
        The time, in s.
    """
    return FRAME * frames + size / FILE
