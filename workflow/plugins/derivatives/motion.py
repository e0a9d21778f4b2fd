"""Derivatives of a run of the reference by numbers of its scene, from the tangent flow.

The motion of a scene whose numbers differ a little obeys the equations linearised about the run, with what these
numbers change in forces, masses and the start as a source. The source is a difference of the forces that problems with
other numbers (`Sides`) exert on the beads of the run, which is smooth in the numbers. The vectors are advanced by the
scheme's own steps, as those of `workflow.plugins.derivatives.tangent`, at equal times in units of each problem's T.
"""

import itertools
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from granchain import InputError
from granchain.parts import (
    Floats,
    Problem,
    Trajectory,
    engine,
    frames_per_block,
    kernel,
    kernel_inputs,
    motion,
    physics,
    schemes,
    units,
)
from workflow.plugins.derivatives import tangent

MOST_BYTES = 4e9
"""Memory that frames of all derivatives may take."""


@dataclass(frozen=True)
class Sides:
    """Problems beside another, whose scenes differ in one number.

    Attributes:
        problems: two or more, as many smaller as larger.
        changes: by how much the number of each differs from the run's.
    """

    problems: tuple[Problem, ...]
    changes: tuple[float, ...]

    @cached_property
    def weights(self) -> Floats:
        """Weights [side] with which values sum to the derivative, exactly for polynomials up to their number."""
        size = max(map(abs, self.changes))
        powers = np.vander(np.array(self.changes) / size, increasing=True).T
        return np.asarray(np.linalg.solve(powers, np.eye(len(powers))[1]) / size)


@dataclass(frozen=True)
class DerivativesOfMotion:
    """Frames of a run and their derivatives by numbers, at the run's own frames, in units of each problem's scale.

    Attributes:
        problem: what was run.
        time: [frame], in units of T.
        x, v: displacements and velocities [frame, line, bead].
        dx, dv: their derivatives by each number, [number, frame, line, bead].
    """

    problem: Problem
    time: Floats
    x: Floats
    v: Floats
    dx: Floats
    dv: Floats

    def moved(self, number: int, change: float, problem: Problem, scale: units.Scale | None = None) -> Trajectory:
        """Frames of a problem in which a number differs by a small change, to first order in the change.

        Args:
            number: place of the number.
            change: its change.
            problem: the problem that has it.
            scale: units of the derivatives, those of the sides; None if they are the problem's.
        """
        scale = scale or problem.scale
        x, v = self.x + change * self.dx[number], self.v + change * self.dv[number]
        x, v = x * (scale.length / problem.scale.length), v * (scale.velocity / problem.scale.velocity)
        time = np.arange(len(x), dtype=np.float64) * problem.every
        return Trajectory.of_atoms(problem, time, np.asarray(x), np.asarray(v), 1, None, None)

    def small(self, number: int, size: float, moved: float) -> float:
        """Change of a number: a share of its size, or less where a velocity would change by more than that share of V.

        Args:
            number: place of the number.
            size: its absolute value, or 1 for a logarithm.
            moved: the share.
        """
        return moved / max(float(np.max(np.abs(self.dv[number]), initial=0.0)), 1.0 / size)

    def trajectory(self) -> Trajectory:
        """Frames of the run."""
        return Trajectory.of_atoms(self.problem, self.time, self.x, self.v, 1, None, None)


def derivatives_of_motion(
    problem: Problem, sides: Sequence[Sides], steps_per_frame: int | None = None
) -> DerivativesOfMotion:
    """Run a problem with its derivatives by numbers.

    Args:
        problem: what is integrated; without a window.
        sides: problems beside it for each number, with frames at the same numbers of steps.
        steps_per_frame: steps between frames; by default as many as `engine.default_steps_per_frame` says.

    Raises:
        InputError: the system cannot be linearised, a number changes the form of its equations, or the frames would
            take too much memory.
    """
    system = problem.system
    tangent.refuse_without_slope(system)
    steps = engine.default_steps_per_frame(problem) if steps_per_frame is None else steps_per_frame
    state = engine.make_state(problem, None)
    terms, _ = kernel_inputs.make_terms(system, as_lammps=False, step=0.0)
    shift = _shift_arrays(problem, sides, terms, state.parameters)
    arrays = tangent.make_arrays(terms, len(sides), state.x.size)
    for dx, dv, side in zip(arrays.dx, arrays.dv, sides, strict=True):
        starts = np.array([_start_of_state(end) for end in side.problems])
        for vector, change in zip((dx, dv), np.tensordot(side.weights, starts, axes=1), strict=True):
            vector.reshape(state.x.shape)[1:-1] = change.T
    program = kernel.make_derivative_program(terms)
    stepping = engine.make_steps(schemes.BLANES_MOAN, problem.every / steps)
    moving = _empty_frames(problem, len(sides))
    stretches = [_stretch(problem, side) for side in sides]
    direct = not system.dampers and not any(stretches)
    recorded = problem.rows.numbers if direct else np.arange(1, problem.beads + 1)
    size = frames_per_block(problem)
    for first in (0, *range(1, problem.frames + 1, size)):
        place = slice(first, min(first + size, problem.frames + 1) if first else 1)
        recorded_frames = kernel.DerivativeFrames(
            moving.x[place], moving.v[place], moving.dx[:, place], moving.dv[:, place]
        )
        frames = recorded_frames if direct else _frames_of_all(recorded_frames, physics.lines(system), problem.beads)
        earlier, between = max(0, first - 1) * steps, steps if first else 0
        program.advance_derivatives(
            state.compiled, arrays, state.parameters, stepping, earlier, between, shift, recorded, frames
        )
        if not direct:
            of_all = _completed(frames, moving.time[place], problem, sides, stretches)
            for array, values in zip(recorded_frames, of_all, strict=True):
                array[:] = values[..., : problem.lines, problem.rows.numbers - 1]
    return moving


def _start_of_state(problem: Problem) -> Floats:
    """Displacements and velocities of the kernel's state at the start, [2, line, bead] in units of L and V."""
    x, v = physics.initial_state(problem.system)
    return np.stack([x, engine.velocity_of_state(problem.system, x, v)])


def _frames_of_all(frames: kernel.DerivativeFrames, lines: int, beads: int) -> kernel.DerivativeFrames:
    """Arrays for as many frames of all atoms."""
    x, v = np.empty((2, len(frames.x), lines, beads))
    dx, dv = np.empty((2, *frames.dx.shape[:2], lines, beads))
    return kernel.DerivativeFrames(x, v, dx, dv)


def _stretch(problem: Problem, sides: Sides) -> float:
    """Derivative of the logarithm of the time between frames in units of T, which frames at equal times need."""
    return float(np.sum(sides.weights * np.array([side.every for side in sides.problems]))) / problem.every


def _completed(
    frames: kernel.DerivativeFrames, time: Floats, problem: Problem, sides: Sequence[Sides], stretches: Sequence[float]
) -> kernel.DerivativeFrames:
    """Frames of all atoms with complete velocities, and derivatives at equal times.

    Velocities get what dashpots have given. The program's derivatives are those at times in units of T, which depends
    on the number; at equal times a bead is farther on its way.

    Args:
        frames: frames of all atoms.
        time: their times [frame], in units of T.
        problem: what is integrated.
        sides: problems beside it.
        stretches: `_stretch` of each.
    """
    x, v = frames.x, frames.v + engine.given_by_dashpots(problem.system, frames.x)
    system = Trajectory.of_atoms(problem, time, x, v).system_at(slice(None))
    acceleration = motion.acceleration(system, x, time=time, velocity=v)
    dx, dv = [], []
    for side, stretch, x_rate, v_rate in zip(sides, stretches, frames.dx, frames.dv, strict=True):
        later = (stretch * time)[:, np.newaxis, np.newaxis]
        dx.append(x_rate + later * v)
        dv.append(v_rate + _given(side, x, x_rate) + later * acceleration)
    return kernel.DerivativeFrames(x, v, np.array(dx), np.array(dv))


def bytes_of_frames(problem: Problem, numbers: int) -> float:
    """Memory, in bytes, that the frames of a problem take with derivatives by so many numbers."""
    return 16.0 * (1 + numbers) * (problem.frames + 1) * problem.lines * len(problem.rows.numbers)


def _empty_frames(problem: Problem, numbers: int) -> DerivativesOfMotion:
    """Arrays for all frames.

    Raises:
        InputError: they would take too much memory.
    """
    time = np.arange(problem.frames + 1, dtype=np.float64) * problem.every
    shape = (len(time), problem.lines, len(problem.rows.numbers))
    size = bytes_of_frames(problem, numbers)
    if size > MOST_BYTES:
        raise InputError(
            f"the frames of {numbers} derivatives would take {size / 1e9:.2g} GB of memory, more than "
            f"{MOST_BYTES / 1e9:g}; record less often, with a larger `output.every`"
        )
    x, v = np.empty((2, *shape))
    dx, dv = np.empty((2, numbers, *shape))
    return DerivativesOfMotion(problem, time, x, v, dx, dv)


def _given(sides: Sides, x: Floats, dx: Floats) -> Floats:
    """Derivative of the velocities that dashpots have given, [frame, line, bead]."""
    impulses = [
        weight * engine.given_by_dashpots(end.system, x + change * dx)
        for weight, end, change in zip(sides.weights, sides.problems, sides.changes, strict=True)
    ]
    return np.asarray(np.sum(impulses, axis=0))


def _shift_arrays(
    problem: Problem, sides: Sequence[Sides], terms: kernel_inputs.Terms, parameters: tuple[Any, ...]
) -> kernel.ShiftArrays:
    """Parameters of the sides, how they are weighed, and in what they differ.

    Raises:
        InputError: a number changes the form of the equations.
    """
    ends = [end for side in sides for end in side.problems]
    first_side = np.cumsum([0, *(len(side.problems) for side in sides)])
    made = [kernel_inputs.make_terms(end.system, as_lammps=False, step=0.0) for end in ends]
    if not all(_alike((terms, parameters), other, problem.duration) for other in made):
        raise InputError("no derivative: a small change of the number changes the form of the equations of motion")
    groups = [
        (*terms.contacts, *terms.walls),
        (*terms.across, *terms.ground),
        tuple(itertools.chain(*terms.dampers, terms.wall_dampers)),
    ]
    names = [_names(group) | {terms.inverse_mass} if group else set() for group in (*groups, _loads(terms))]
    stacked = tuple(np.stack(values) for values in zip(*(values for _, values in made), strict=True))
    differs = np.zeros((len(sides), len(names)), dtype=bool)
    for number, (first, last) in enumerate(itertools.pairwise(first_side)):
        of_number = {name: arrays[first:last] for name, arrays in zip(terms.names, stacked, strict=True)}
        unequal = {name for name, arrays in of_number.items() if np.any(arrays != arrays[0])}
        differs[number] = [bool(unequal & group) for group in names]
    weights = np.concatenate([side.weights for side in sides])
    return kernel.ShiftArrays(stacked, weights, differs, first_side)


def _loads(terms: kernel_inputs.Terms) -> tuple[kernel_inputs.Term, ...]:
    return (*terms.loads, *terms.motions)


def _names(terms: Iterable[kernel_inputs.Term]) -> set[str]:
    """Names of the parameters that terms read."""
    texts = (text for term in terms for text in (term.strain_text, term.rate_text, *term.parameters, term.over))
    return {name for text in texts for name in re.findall(r"[A-Za-z_]\w*", text)}


def same_form(problem: Problem, other: Problem) -> bool:
    """Whether the forces of two problems differ in numbers alone, and change abruptly at the same times."""
    made, others = (
        kernel_inputs.make_terms(system, as_lammps=False, step=0.0) for system in (problem.system, other.system)
    )
    return _alike(made, others, problem.duration)


def _alike(
    made: tuple[kernel_inputs.Terms, tuple[Any, ...]],
    others: tuple[kernel_inputs.Terms, tuple[Any, ...]],
    duration: float,
) -> bool:
    """`same_form` of terms and their parameters, over a duration in units of T."""
    (terms, values), (other_terms, other_values) = made, others
    if _form(terms) != _form(other_terms) or list(map(np.shape, values)) != list(map(np.shape, other_values)):
        return False
    times = [np.abs(values[n] - other_values[n]) for n, name in enumerate(terms.names) if name == terms.bends]
    return all(np.max(apart) <= 1e-12 * duration for apart in times)


def _form(terms: kernel_inputs.Terms) -> kernel_inputs.Terms:
    """Terms with the text of the force in place of a formula's law, whose other texts have numbers in exponents."""

    def with_texts(group: tuple[kernel_inputs.Term, ...]) -> tuple[kernel_inputs.Term, ...]:
        laws = (term.law if term.law.source is None else term.law.source("", "force") for term in group)
        return tuple(replace(term, law=law) for term, law in zip(group, laws, strict=True))

    contacts, across, ground, walls = map(with_texts, (terms.contacts, terms.across, terms.ground, terms.walls))
    return replace(terms, contacts=contacts, across=across, ground=ground, walls=walls)
