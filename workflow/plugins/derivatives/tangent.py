"""Tangent flow of the reference: how small changes of a state grow or decay along a run.

The vectors obey the equations of motion, linearised about the run, and are advanced by the scheme's own steps, so that
they are the derivative of the computed map to rounding. Only forces whose slope is continuous in time can be
linearised: contacts open and close with a continuous force. Not so dashpots that are cut where the contact would pull,
whose force jumps, and contacts with a state, whose force bends where the largest overlap is exceeded.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from granchain import InputError, Scene
from granchain.parts import (
    Flags,
    Floats,
    Problem,
    System,
    dashpot,
    engine,
    kernel,
    kernel_inputs,
    library,
    physics,
    schemes,
)

_LEFT_OUT = ("window", "timestep", "accuracy", "scheme", "output")
"""Keys of a scene that do not matter to a tangent flow along its run."""


def refuse_without_slope(system: System) -> None:
    """Refuse a system that cannot be linearised.

    Raises:
        InputError: says which of its forces jumps or bends.
    """
    if physics.contacts_with_state(system):
        raise InputError("the equations cannot be linearised: contacts that yield have a force that bends in time")
    if any(dashpot.cut(link.law) for link in system.dampers):
        raise InputError(
            "the equations cannot be linearised: with `tension: cut` the force of dashpots jumps where contacts open; "
            "`tension: allowed` has none"
        )
    for link in system.along:
        exponent = link.law.exponent
        if exponent is not None and np.any(np.asarray(exponent) <= 1.0):
            raise InputError("the equations cannot be linearised: contacts of exponent 1 have a slope that jumps")


def problem_of(plain: dict[str, Any], source: str) -> Problem:
    """The problem of a scene, whatever its end, time step and output.

    Args:
        plain: the scene.
        source: its name in messages.

    Raises:
        InputError: it is no scene, or one that cannot be linearised.
    """
    scene: Scene = library.from_plain({key: value for key, value in plain.items() if key not in _LEFT_OUT}, source)
    problem = scene.model_copy(update={"duration": scene.scale.time}).resolved().problem()
    try:
        refuse_without_slope(problem.system)
    except InputError as error:
        raise InputError(f"{source}: {error}") from None
    return problem


@dataclass(frozen=True)
class TangentFlow:
    """A run of the reference and vectors in its tangent space, both advanced in place.

    Displacements and velocities of vectors are [vector, line, bead], in units of each other's choice: the flow is
    linear in them.

    Attributes:
        problem: what is integrated.
        step: time step, in units of T.
        scheme: the scheme.
        state: the run's state.
        program: compiled step of the problem's laws with their slopes.
        arrays: the vectors as the program takes them, [vector, place].
    """

    problem: Problem
    step: float
    scheme: schemes.Scheme
    state: engine.IntegratorState
    program: Any
    arrays: kernel.TangentArrays

    @property
    def free(self) -> Flags:
        """Atoms whose motion is not given, [line, bead]; without those that a line lacks."""
        system = self.problem.system
        shape = (physics.lines(system), system.beads)
        free = np.broadcast_to(np.isfinite(physics.masses(system, absent=np.inf)), shape).copy()
        for motion in system.motions:
            free[motion.chain - 1, motion.bead - 1] = False
        return free

    @property
    def vectors(self) -> Floats:
        """The vectors, [vector, displacement or velocity, line, bead]; with dashpots ``v - impulses / mass``."""
        rows = self.state.x.shape
        pair = np.stack([self.arrays.dx, self.arrays.dv], axis=1)
        return np.ascontiguousarray(pair.reshape(len(pair), 2, *rows)[:, :, 1:-1].swapaxes(2, 3))

    def put(self, vectors: Floats) -> None:
        """Replace the vectors by others of the shape of `vectors`."""
        rows = (len(vectors), *self.state.x.shape)
        for values, array in zip((self.arrays.dx, self.arrays.dv), vectors.swapaxes(0, 1), strict=True):
            values.reshape(rows)[:, 1:-1] = array.swapaxes(1, 2)

    def advance(self, first_step: int, steps: int) -> None:
        """Take some steps after ``first_step`` earlier ones."""
        stepping = engine.make_steps(self.scheme, self.step)
        self.program.advance_tangent(
            self.state.compiled, self.arrays, self.state.parameters, stepping, first_step, steps
        )


def make_flow(problem: Problem, vectors: int, step: float, scheme: schemes.Scheme = schemes.BLANES_MOAN) -> TangentFlow:
    """The start of a problem with so many vectors, all 0.

    Args:
        problem: what is integrated.
        vectors: number of vectors.
        step: time step, in units of T.
        scheme: `BLANES_MOAN`, or `VERLET` without dashpots.

    Raises:
        InputError: the system cannot be linearised, see `refuse_without_slope`.
    """
    system = problem.system
    refuse_without_slope(system)
    state = engine.make_state(problem, None)
    state.span[:] = 1, problem.beads, problem.beads, 1  # vectors move beads that are at rest
    terms, _ = kernel_inputs.make_terms(system, as_lammps=False, step=step)
    arrays = make_arrays(terms, vectors, state.x.size)
    return TangentFlow(problem, step, scheme, state, kernel.make_tangent_program(terms), arrays)


def make_arrays(terms: kernel_inputs.Terms, vectors: int, places: int) -> kernel.TangentArrays:
    """Vectors that are 0, and scratch arrays of a state of so many places."""
    dx, dv = np.zeros((2, vectors, places))
    slopes, pulls = np.zeros((2, places))
    stiffness = np.zeros((len(terms.across) + len(terms.ground), places))
    damped = bool(terms.dampers) and terms.dashpots == "drift"
    nearby, gains = np.zeros((2, vectors if damped else 0, places))
    return kernel.TangentArrays(dx, dv, slopes, pulls, stiffness, nearby, gains, np.zeros(places if damped else 0))
