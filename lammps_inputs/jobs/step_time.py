"""Wall time of time steps and frames in LAMMPS, by a model.

A step takes a fixed time, a time for every bead of a rank, and with more than one rank a time for messages. Times were
measured on one core with 100 to a million beads, except where a comment says that they are assumed.
"""

from lammps_inputs import physics
from lammps_inputs.laws.formula_law import AcrossChains, AlongChains
from lammps_inputs.laws.in_time import TabulatedForce
from lammps_inputs.laws.plastic import Thornton
from lammps_inputs.problem import Problem

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

LEPTON = 100e-6
"""Seconds a step where contacts have an exponent other than 1 and 1.5, whose formula LAMMPS evaluates in each."""

WRITTEN = 500e-6
"""Seconds a step for each kind of link whose energy is a formula of the scene's: measured, 0.35e-3 to 0.6e-3."""

LOADED, DAMPED = 40e-9, 20e-9
"""Seconds a bead and step that a static load and dashpots of contacts add."""

YIELDING = 2e-6
"""Seconds a bead and step of contacts that yield (`lammps_inputs.laws.plastic_lines`)."""

FRAME = 15e-6
"""Seconds a frame beside its bytes."""

FILE = 5e8
"""Bytes a second into one file: assumed."""


def bead_seconds(problem: Problem) -> float:
    """Seconds a bead and step of contacts and springs alone."""
    return COUPLED_BEAD if physics.coupled(problem.system) else LONE_BEAD


def step_seconds(problem: Problem) -> tuple[float, float]:
    """Seconds of a time step, with what the ingredients of the scene add, without `MESSAGES`.

    Returns:
        Seconds whatever the number of beads; and seconds for each bead of a rank.
    """
    system = problem.system
    tables = [load.law for load in system.loads if isinstance(load.law, TabulatedForce)]
    fixed = STEP + FORMULA * (len(system.loads) - len(tables))
    fixed += sum(VECTORS if law.long else POINT * len(law.time) for law in tables)
    fixed += MOTION * len(system.motions)
    if physics.exponent(system) not in (None, 1.0, 1.5):
        fixed += LEPTON
    fixed += WRITTEN * sum(isinstance(link.law, AlongChains | AcrossChains) for link in system.links)
    bead = bead_seconds(problem) + LOADED * physics.loaded(system)
    bead += DAMPED * (physics.contact_loss(system) is not None)
    if any(isinstance(link.law, Thornton) for link in system.along):
        bead += YIELDING
    return fixed, bead


def frame_seconds(size: float, frames: float = 1) -> float:
    """Seconds to write some frames of so many bytes in all."""
    return FRAME * frames + size / FILE
