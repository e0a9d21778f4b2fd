"""The in-house reference: a splitting scheme of high order on the rows that can move. Independent of LAMMPS.

Examples:
    >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 5.0}).problem()
    >>> trajectory = engine.run(problem)
    >>> trajectory.velocity.shape  # [frame, chain, bead], in units of V
    (51, 1, 20)
    >>> engine.default_steps_per_frame(problem)
    2
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analysis.tracking.peaks import THRESHOLD
from analysis.trajectory import EXCHANGES, Floats, Integers, Trajectory, frames_per_block, joined
from lammps_inputs import Problem, System, physics
from lammps_inputs.chains import coupled_chains
from lammps_inputs.laws import dashpot
from lammps_inputs.limits import rates
from lammps_inputs.limits.rates import stability_bound
from lammps_inputs.rows import Rows
from lammps_inputs.units import DIMENSIONLESS
from workflow.engines.reference import kernel
from workflow.engines.reference.kernel import FrameArrays, Passing, Steps
from workflow.engines.reference.kernel_inputs import make_terms
from workflow.engines.reference.schemes import BLANES_MOAN, VERLET, Scheme
from workflow.processor_time import check

STEPS_PER_BOUND = 15.0
"""Steps of the default scheme in the stability bound of velocity Verlet; 0.05 for the paper's scenes."""

FORCES_PER_STEP = BLANES_MOAN.forces_per_step
"""Evaluations of all forces in a step of the default scheme."""

_FORCES_A_CALL = 1e7
"""Forces on beads in one call of the compiled step, some 0.03 s, after which a limit on processor time is checked."""

_ABRUPT = 8.0
"""More steps for an exponent of contacts that is lower by 1: measured, for errors as small as those of spheres."""


def run(
    problem: Problem, *, scheme: Scheme = BLANES_MOAN, steps_per_frame: int | None = None, rows: int | None = None
) -> Trajectory:
    """The whole trajectory; arguments as for `blocks`."""
    return joined(blocks(problem, scheme=scheme, steps_per_frame=steps_per_frame, rows=rows))


def load() -> None:
    """Load the compiled kernel, or compile it (once on a machine), so that the next run starts at once."""
    run(two_beads())


def two_beads() -> Problem:
    """The smallest problem, whose run compiles or loads the kernel."""
    return Problem(
        name="two-beads",
        system=System(chains=1, beads=2, kicks=((1, 1, 1.0),), links=coupled_chains(1, 0.0)),
        timestep=0.1,
        steps_per_frame=1,
        frames=1,
        rows=Rows(2),
        scale=DIMENSIONLESS,
    )


def default_steps_per_frame(problem: Problem) -> int:
    """Steps between frames, an even number, that leave an error of some 1e-6 of V, with gaps more."""
    system = problem.system
    bound = stability_bound(system)
    if system.dampers:  # drag on beads alone does not bind LAMMPS
        bound = min(bound, 2.0 / rates.drag(system))
    # contacts of lower exponents open and close more abruptly
    abrupt = max(0.0, 1.5 - (physics.exponent(system) or 1.5))
    steps = STEPS_PER_BOUND * (1.0 + _ABRUPT * abrupt)
    return 2 * max(1, math.ceil(0.5 * problem.every * steps / bound * (1.0 - 1e-9)))


def blocks(
    problem: Problem,
    *,
    scheme: Scheme = BLANES_MOAN,
    steps_per_frame: int | None = None,
    rows: int | None = None,
    most_frames: int | None = None,
) -> Iterator[Trajectory]:
    """Integrate a problem and yield its frames in consecutive blocks of bounded size, the start being frame 0.

    Args:
        problem: what to integrate.
        scheme: how; its order and cost are in the scheme.
        steps_per_frame: steps between frames; by default as many as `default_steps_per_frame` says.
        rows: integrate this many rows at most, letting go of those farthest behind; by default all, or twice the
            rows of the problem's own window: until that moves frames show all rows, then those near the front.
        most_frames: frames of a block at most, for those who end early.

    Raises:
        ValueError: a window that is too narrow, or not for this problem.
    """
    steps = default_steps_per_frame(problem) if steps_per_frame is None else steps_per_frame
    if rows is None and problem.rows.follow:
        rows = WIDER * problem.rows.existing
    step = problem.every / steps
    state = make_state(problem, rows, as_lammps=scheme is VERLET, step=step)
    lines = problem.lines
    beads = _beads_of_frames(problem, state, 0.0)
    x, v = physics.initial_state(problem.system)[:, np.newaxis, :lines, beads - 1]
    counts = scheme is not VERLET and physics.exchanges(problem.system)

    def block(time: Floats, x: Floats, v: Floats, exchange: Floats, states: Floats) -> Trajectory:
        """Frames from times [frame], motion [frame, line, bead], exchange [frame, entry], and states of contacts."""
        first = int(beads[0]) if problem.rows.follow else 1
        counted = exchange if counts else None
        return Trajectory.of_atoms(problem, time, x, v, first, counted, states if states.size else None)

    yield block(np.zeros(1), x, v, np.zeros((1, len(EXCHANGES))), state.compiled.contacts[np.newaxis].copy())
    size = min(frames_per_block(problem), most_frames or problem.frames)
    if problem.rows.follow:
        size = max(1, min(size, math.floor(_ADVANCE / (rates.front_speed(problem.system) * problem.every))))
    for first in range(1, problem.frames + 1, size):
        frame = np.arange(first, min(first + size, problem.frames + 1))
        beads = _beads_of_frames(problem, state, len(frame) * problem.every)
        frames = state.frame_arrays(len(frame), lines, len(beads))
        time = np.asarray(frame * problem.every, dtype=np.float64)
        state.advance(scheme, step, (first - 1) * steps, steps, beads, frames)
        frames.exchange[:, -1] += brought_up(problem, time)
        yield block(time, *frames)


def brought_up(problem: Problem, time: Floats) -> Floats:
    """Kinetic energy [frame] of beads whose motion is given, less that at the start, in units of m V**2.

    Args:
        problem: whose motions.
        time: [frame], in units of T.
    """
    total = np.zeros_like(time)
    for motion in problem.system.motions:
        mass = physics.mass_of(problem.system, motion.chain - 1, motion.bead - 1)
        total += 0.5 * mass * (motion.velocity(time) ** 2 - motion.velocity(0.0) ** 2)
    return total


WIDER = 2
"""Rows that the reference integrates in addition to those of the window that it is compared with."""

_ADVANCE = 16.0
"""Rows that the front may advance by in a block of frames where a window follows the pulse."""


def _beads_of_frames(problem: Problem, state: "IntegratorState", ahead: float) -> NDArray[np.int64]:
    """Beads to record in the next frames, which end a time ahead."""
    if not problem.rows.follow:
        return problem.rows.numbers
    front, width = int(state.span[1]), problem.rows.existing
    # see `analysis.compare.common_times.near_the_front`: a window has moved before the front reaches its head
    first = 1 if front < width else front - width // 2
    return np.arange(
        first, min(problem.beads, front + math.ceil(rates.front_speed(problem.system) * ahead) + width) + 1
    )


@dataclass(frozen=True)
class IntegratorState:
    """A problem at an instant, and what advances it; row i is bead i of every chain, rows 0 and beads + 1 stay at rest.

    Attributes:
        x, v: [bead + 2, chain], advanced in place.
        span: first and last row that may move, and so on (`kernel.State`).
        program: compiled step of the problem's laws (`kernel.make_program`).
        parameters: of the laws.
        compiled: the same state as the program takes it.
    """

    x: Floats
    v: Floats
    span: NDArray[np.int64]
    program: Any
    parameters: tuple[Any, ...]
    compiled: kernel.KernelState

    def frame_arrays(self, frames: int, lines: int, beads: int) -> FrameArrays:
        """Arrays for frames to fill, of so many lines of atoms and recorded beads."""
        x, v = np.empty((2, frames, lines, beads))
        exchange = np.zeros((frames, len(EXCHANGES)))
        return FrameArrays(x, v, exchange, np.empty((frames, *self.compiled.contacts.shape)))

    def restart(self, block: Trajectory, frame: int, x: Floats, v: Floats) -> None:
        """Continue from a frame of all beads, of which only some rows may move.

        Args:
            block: frames.
            frame: position of the frame, from 0.
            x: displacements of all atoms in it, [line, bead].
            v: velocities of the state, [line, bead].
        """
        moving = block.moving
        self.compiled.set_contacts(block.system_at(frame))
        self.x[1:-1], self.v[1:-1] = x.T, v.T
        self.span[:2], self.span[3] = (moving.start + 1, min(moving.stop, block.problem.beads)), 1
        self.compiled.push[:] = 0.0

    def advance(
        self, scheme: Scheme, h: float, first_step: int, steps: int, beads: NDArray[np.int64], frames: FrameArrays
    ) -> None:
        """Fill frames of the recorded beads, so many steps each, after ``first_step`` earlier ones.

        Args:
            scheme: how steps are taken.
            h: time step, in units of T.
            first_step: steps before these frames.
            steps: steps from frame to frame.
            beads: numbers of the beads to record, [bead].
            frames: filled, [frame, line, bead].

        Raises:
            LimitReachedError: a limit on processor time is reached.
        """
        stepping = make_steps(scheme, h)
        limit = self.steps_a_call(scheme)
        together, count = max(1, limit // steps), len(frames.x)
        for frame in range(0, count, together):
            filled = FrameArrays(*(array[frame : frame + together] for array in frames))
            begin, size = first_step + frame * steps, steps
            if steps > limit:  # the frame is overwritten until its last step
                for done in range(0, steps - limit, limit):
                    self.program.advance(self.compiled, self.parameters, stepping, begin, limit, beads, filled)
                    check()
                    begin, size = begin + limit, steps - done - limit
            self.program.advance(self.compiled, self.parameters, stepping, begin, size, beads, filled)
            check()

    def steps_a_call(self, scheme: Scheme) -> int:
        """Steps of a scheme in one call of the compiled step, so that it takes some hundredths of a second."""
        rows = min(int(self.span[2]), len(self.x) - 2)
        return max(1, int(_FORCES_A_CALL / (scheme.forces_per_step * rows * self.x.shape[1])))


def make_steps(scheme: Scheme, h: float) -> Steps:
    """A scheme and its step h, in units of T, as programs take them."""
    return Steps(np.array(scheme.kicks), np.array(scheme.drifts), h)


def make_state(problem: Problem, rows: int | None, *, as_lammps: bool = False, step: float = 0.0) -> IntegratorState:
    """The start of a problem.

    Args:
        problem: what is integrated.
        rows: largest number of rows that are integrated.
        as_lammps: whether forces from outside, and those against velocities, act as LAMMPS has them.
        step: LAMMPS's time step, in units of T.

    Raises:
        ValueError: a window too narrow for the rows that are kicked and a pulse ahead of them.
    """
    system = problem.system
    first, last = physics.span_at_start(system)
    first, last = max(1, first - 1), min(problem.beads, last + 1)
    least = last - first + 30
    if rows is not None and rows < least:
        raise ValueError(f"a window of {rows} rows is too narrow; at least {least}")
    x, v = np.zeros((2, problem.beads + 2, physics.lines(problem.system)))
    at_start = physics.initial_state(system)
    x[1:-1] = at_start[0].T
    v[1:-1] = (at_start[1] if as_lammps else velocity_of_state(system, *at_start)).T
    span = np.array([first, last, problem.beads if rows is None else rows, 1])
    terms, parameters = make_terms(system, as_lammps=as_lammps, step=step)
    state = kernel.make_state(x, v, span, terms, system)
    return IntegratorState(x, v, span, kernel.make_program(terms), parameters, state)


def given_by_dashpots(system: System, x: Floats) -> Floats:
    """Velocities that dashpots whose tension is not cut have given, [..., line, bead] in units of V.

    Those of beads whose motion is given are 0.

    Args:
        system: whose dashpots.
        x: displacements of all atoms, [..., line, bead] in units of L.
    """
    impulses = np.zeros_like(x)
    for damper in system.dampers:
        lines = damper.lines_among(system.chains)
        damper.drive(impulses[..., lines, :], damper.given(x[..., lines, :]))
    impulses /= physics.masses(system, absent=np.inf)
    for motion in system.motions:
        impulses[..., motion.chain - 1, motion.bead - 1] = 0.0
    return impulses


# --- the leading pulse without frames, for chains too long to record --------------------------------------------------


def velocity_of_state(system: System, x: Floats, v: Floats) -> Floats:
    """Velocities of the kernel, [..., line, bead] in units of V.

    Where no tension is cut, they lack the impulses of dashpots over masses.

    Args:
        system: whose.
        x: displacements, [..., line, bead] in units of L.
        v: velocities, [..., line, bead] in units of V.
    """
    if not system.dampers or any(dashpot.cut(link.law) for link in system.dampers):
        return v
    return np.asarray(v - given_by_dashpots(system, x))


class LeadingPeaks(NamedTuple):
    """The leading pulse at beads, [passage] each, by chain, then bead."""

    chain: Integers
    """Number of the chain, from 1."""
    bead: Integers
    """Number of the bead, from 1."""
    arrival: Floats
    """Time of the largest velocity, in units of T."""
    peak_velocity: Floats
    """Largest velocity, in units of V."""


def usual_timestep(problem: Problem) -> float:
    """A tenth of the time of pulses, or less where springs are stiff: peaks are then right to below 1e-5 of V."""
    system = problem.system
    pulse_time = physics.pulse_time(system)
    step = 0.1 * pulse_time / math.sqrt(max(1.0, (rates.modal_frequency(system) * pulse_time) ** 2 / 2.0))
    return step if physics.alike(system) and not physics.loaded(system) else min(step, stability_bound(system) / 8.0)


def passages(
    problem: Problem,
    *,
    rows: int | None = None,
    timestep: float | None = None,
    until_bead: int | None = None,
    threshold: float = THRESHOLD,
) -> LeadingPeaks:
    """The leading pulse at each bead, of a run until a bead is passed in every chain, or to the problem's end.

    That is the first maximum of its velocity, from the cubic polynomial through velocity and acceleration at the two
    steps around it (error below 1e-5 of V at the default step).

    Args:
        problem: what to integrate; its own time step and frames are not used, only its duration.
        window: rows that are integrated at most, those behind are let go; None for all.
        timestep: of the scheme, in units of T; by default `usual_timestep`.
        until_bead: stop when every chain's pulse has passed it.
        threshold: smallest peak that counts, in units of V.

    Raises:
        ValueError: a window that is too narrow.
    """
    timestep = usual_timestep(problem) if timestep is None else timestep
    state = make_state(problem, rows)
    arrival, peak = np.full((2, *state.x.shape), np.nan)
    starting = state.v > threshold
    arrival[starting], peak[starting] = 0.0, state.v[starting]
    passing = Passing(arrival.reshape(-1), peak.reshape(-1), *np.zeros((3, state.x.size)))
    steps = make_steps(BLANES_MOAN, timestep)
    last = problem.beads if until_bead is None else until_bead
    total, chunk, done = int(np.ceil(problem.duration / timestep)), min(1000, state.steps_a_call(BLANES_MOAN)), 0
    while done < total and np.any(np.isnan(arrival[last, : problem.chains])):
        count = min(chunk, total - done)
        state.program.follow(state.compiled, state.parameters, steps, done, count, threshold, passing)
        done += count
        check()
    arrival, peak = (values[1:-1, : problem.chains].T for values in (arrival, peak))
    chain, row = np.nonzero(~np.isnan(arrival))
    return LeadingPeaks(chain + 1, row + 1, arrival[chain, row], peak[chain, row])
