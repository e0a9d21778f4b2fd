"""Settings of every engine for a scene, from coarse to fine, how each is run and timed, and the reference run.

The reference run has the scene's frames, written to disk. Times are those of an engine's time loop with the frames
written to disk, without its start.
"""

import math
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain, tee
from pathlib import Path
from typing import Any

import numpy as np

from granchain.parts import (
    Fact,
    Problem,
    StepHalving,
    Trajectory,
    deck,
    difference,
    file_names,
    leading_passages,
    mpi,
    parts_of,
    peaks,
    physics,
    quantity,
    rates,
    recording,
    run_deck,
    window,
)
from granchain.parts import engine as reference

# --- runs -------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class EngineSetting:
    """One setting of an engine.

    Attributes:
        method: the engine, and the scheme or the varied quantity.
        value: time step in units of T, number of ranks or number of rows.
        problem: problem with the time step and frames of the setting, and LAMMPS's scheme and window.
        ranks: number of ranks of LAMMPS.
    """

    method: str
    value: float
    problem: Problem
    ranks: int = 1

    @property
    def label(self) -> str:
        """The value in words."""
        if self.by_step:
            return f"step {self.value:.4g}"
        return f"{self.value:g} {'ranks' if self.method == RANKS else 'rows'}"

    @property
    def by_step(self) -> bool:
        """Whether the method varies the step."""
        return self.method not in (RANKS, WINDOW)

    @property
    def engine(self) -> str:
        """Name of the engine, the first word of the method."""
        return self.method.partition(" ")[0]

    @property
    def forces(self) -> int:
        """Number of evaluations of all forces."""
        return self.problem.steps * (reference.FORCES_PER_STEP if self.method == REFERENCE else 1)

    @property
    def effort(self) -> float:
        """Work relative to other settings of the engine: evaluations of forces times the share of beads simulated."""
        return self.forces * self.problem.rows.existing / self.problem.beads / min(self.ranks, 2)


def run(setting: EngineSetting, directory: Path) -> float:
    """Run a setting in a directory, where its files replace those of the previous setting.

    Returns:
        Time of the time loop, in s.

    Raises:
        RunError: the run failed.
    """
    problem, dump = setting.problem, directory / file_names.DUMP
    dump.unlink(missing_ok=True)
    if setting.method == REFERENCE:
        reference.load()
        started = time.perf_counter()
        _write(dump, problem, reference.blocks(problem, steps_per_frame=problem.steps_per_frame))
        return time.perf_counter() - started
    for name, text in deck.files_of(problem).items():
        (directory / name).write_text(text)
    end = run_deck(directory, ranks=setting.ranks, problem=problem)
    if end.end != "done":
        raise KeyboardInterrupt
    return end.seconds


def _write(path: Path, problem: Problem, blocks: Iterable[Trajectory]) -> None:
    """Write frames as LAMMPS would."""
    states = chain.from_iterable(block.states() for block in blocks)
    with recording.Writer(path, problem) as writer:
        for frame, state in enumerate(states):
            writer.append(frame * problem.steps_per_frame, *state)


# --- settings ---------------------------------------------------------------------------------------------------------

COARSEST = 0.6
"""Longest step (of a composition: cycle) over the stability bound of velocity Verlet."""

FINEST = {"verlet": 1024, "suzuki4": 64, "blanes-moan": 64}
"""Number of the finest steps, or cycles, in the coarsest one."""

LEAST_FRAMES = 10
"""Least number of frames of a run whose step spans several frames of the scene."""

MOST_RANKS = 4

WIDEN, MOST_WIDTHS = 1.5, 6

LAMMPS = "LAMMPS "
RANKS, WINDOW, REFERENCE = f"{LAMMPS}ranks", f"{LAMMPS}window", "reference blanes-moan"


def settings(problem: Problem) -> list[EngineSetting]:
    """All settings to measure for a problem with the scene's frames and time step; its own time step is among them."""
    by_reference = [
        EngineSetting(REFERENCE, variant.timestep, variant) for variant in stepped(problem, FINEST["blanes-moan"])
    ]
    if deck.refusal(problem.system):
        return by_reference
    schemes = [replace(problem, scheme="verlet"), replace(problem, scheme="suzuki4")]
    by_lammps = []
    for with_scheme in schemes if problem.system.holds(Fact.REVERSIBLE) else schemes[:1]:
        name = with_scheme.scheme
        several = stepped(with_scheme, FINEST[name], with_scheme.cycle)
        several += [problem] * (name == "verlet" and problem.timestep not in [variant.timestep for variant in several])
        several.sort(key=lambda variant: -variant.timestep)
        by_lammps += [EngineSetting(LAMMPS + name, variant.timestep, variant) for variant in several]
    most_ranks = 1 if mpi.launcher() is None else min(MOST_RANKS, mpi.cores(), problem.beads)
    ranks = [EngineSetting(RANKS, 2**power, problem, ranks=2**power) for power in range(1, most_ranks.bit_length())]
    with_window = [
        EngineSetting(WINDOW, rows, replace(problem, rows=problem.rows.near_front(rows))) for rows in windows(problem)
    ]
    return [*by_lammps, *by_reference, *ranks, *with_window]


def stepped(problem: Problem, finest: int, stages: int = 1) -> list[Problem]:
    """Problems with cycles of decreasing length, each half of the previous one, from `COARSEST` on.

    Args:
        problem: the problem; its frames are left out where a cycle spans several.
        finest: number of the shortest cycles in the longest one.
        stages: number of steps of a cycle.
    """
    longest = math.floor(math.log2(COARSEST * rates.stability_bound(problem.system) / problem.every))
    longest = min(longest, max(0, math.floor(math.log2(problem.frames / LEAST_FRAMES))))
    problems = []
    for power in range(longest, longest - finest.bit_length(), -1):
        frames, steps = 2 ** max(0, power), stages * 2 ** max(0, -power)
        every = problem.every * frames
        problems.append(replace(problem.coarser(frames), timestep=every / steps, steps_per_frame=steps))
    return problems


def windows(problem: Problem) -> list[int]:
    """Numbers of rows of the windows to measure; none where a scene can have no window or is too short for one."""
    system = problem.system
    forward = all(
        velocity > 0.0 and bead <= window.LEAST_WINDOW - window.HEADROOM for _, bead, velocity in system.kicks
    )
    if not problem.rows.neighbours or not (physics.uniform(system) and forward and system.holds(Fact.FRONT)):
        return []
    widths = [round(window.LEAST_WINDOW * WIDEN**power) for power in range(MOST_WIDTHS)]
    return [rows for rows in widths if rows < 0.9 * problem.beads]


# --- truth ------------------------------------------------------------------------------------------------------------

QUANTITIES = ("velocity", "amplitude", "arrival")

GOAL = 1e-10
"""Uncertainty of velocities in units of V at which the reference is not refined further."""

REFINEMENT = 4


@dataclass(frozen=True)
class Truth:
    """The reference run of a problem.

    Attributes:
        problem: the problem with the scene's frames.
        path: file of the frames.
        uncertainty: uncertainty of velocities and arrivals.
        seconds: wall time of the final refinement, in s.
    """

    problem: Problem
    path: Path
    uncertainty: difference.Uncertainty
    seconds: float

    @property
    def floors(self) -> dict[str, float]:
        """Uncertainty of each quantity: velocities and amplitudes in units of V, arrivals in units of T."""
        uncertainty = self.uncertainty
        return {"velocity": uncertainty.velocity, "amplitude": uncertainty.velocity, "arrival": uncertainty.arrival}

    def errors(self, blocks: Iterable[Trajectory]) -> dict[str, float]:
        """Largest errors of a run whose frames are among those of this problem; infinite where undefined.

        In a run with a window, only rows near the front count (`analysis.compare.common_times.near_the_front`).

        Args:
            blocks: frames of the run, with displacements and velocities [frame, chain, bead].
        """
        stream = iter(blocks)
        first = next(stream)
        stride = max(1, round(first.problem.every / self.problem.every))
        truth_problem = replace(self.problem, rows=self.problem.rows.near_front(first.problem.rows.width))
        exact = recording.blocks([self.path], self.problem, stride)
        errors = difference.errors_of(
            chain([first], stream), (replace(block, problem=truth_problem) for block in exact)
        )
        sizes = {name: errors[name].largest if name in errors else math.inf for name in QUANTITIES}
        return {name: size if math.isfinite(size) else math.inf for name, size in sizes.items()}


def make_truth(problem: Problem, directory: Path, *, seconds: float) -> Truth:
    """Refine the reference until its uncertainty is below `GOAL`, or the next refinement would take too long.

    Args:
        problem: the problem with the scene's frames.
        directory: directory for the frames.
        seconds: largest wall time of the last refinement, in s.
    """
    path, steps = directory / "reference.bin", None
    reference.run(replace(problem, frames=1))  # compiles what it takes
    while True:
        started = time.perf_counter()
        halving = StepHalving(problem, steps_per_frame=steps)
        _write(path, problem, halving.blocks())
        truth = Truth(problem, path, halving.uncertainty, time.perf_counter() - started)
        if truth.uncertainty.velocity <= GOAL or REFINEMENT * truth.seconds > seconds:
            return truth
        steps = REFINEMENT * halving.steps_per_frame


# --- frames -----------------------------------------------------------------------------------------------------------

NEAR = 0.025
"""Time between frames, in T in contacts of strength 1, at which errors of passages are below 1e-9 T and 1e-9 V, and are
neglected.
"""

FARTHEST = 2.0
"""Time between frames, in T in contacts of strength 1, from which on a wave passes a bead between two frames."""


@quantity.result
class Interval:
    """Largest errors of the leading pulse that are due to the time between frames."""

    every: float = quantity.declare("time between frames", "time", digits=".4g")
    amplitude_error: float = quantity.declare("largest error of a peak velocity", "V", "a peak is missed", digits=".1e")
    arrival_error: float = quantity.declare("largest error of an arrival", "T", "a peak is missed", digits=".1e")
    megabytes: float = quantity.declare("size of all frames", "MB", digits=".3g")


def intervals(problem: Problem) -> list[Interval]:
    """Errors of amplitudes (V) and arrivals (T) read from other frames than the scene's, and the size of all frames."""
    pulse_time = physics.pulse_time(problem.system)
    halvings = max(1, math.ceil(math.log2(problem.every / (NEAR * pulse_time))))
    step = problem.every / 2**halvings
    fine = replace(problem, timestep=step, steps_per_frame=1, frames=problem.frames * 2**halvings)
    coarsest_power = min(math.log2(FARTHEST * pulse_time / step), math.log2(fine.frames / LEAST_FRAMES))
    seldom = [fine.coarser(2**power) for power in range(1 + max(0, math.floor(coarsest_power)))]
    exact, *others = _passages(fine, seldom)
    return [_interval(sampled, read, exact) for sampled, read in zip(seldom[1:], others, strict=True)][::-1]


def _passages(fine: Problem, seldom: list[Problem]) -> Iterator[peaks.Peaks]:
    """Leading pulse at each bead, for several times between frames, in one run."""
    meters = [leading_passages.leading_meter(problem) for problem in seldom]
    pieces: list[list[Any]] = [[] for _ in seldom]
    runs = zip(seldom, tee(reference.blocks(fine), len(seldom)), strict=True)
    parts = {number: parts_of(_frames_of(*run)) for number, run in enumerate(runs)}
    read_to = [0.0] * len(seldom)
    while parts:
        number = min(parts, key=lambda each: read_to[each])  # so that few blocks are held for the others
        part = next(parts[number], None)
        if part is None:
            del parts[number]
        else:
            pieces[number].append(meters[number].of_part(part))
            read_to[number] = float(part.frames.time[-1])
    return (
        leading_passages.leading_passages(meter.result(of_parts), problem).first()
        for meter, of_parts, problem in zip(meters, pieces, seldom, strict=True)
    )


def _frames_of(problem: Problem, blocks: Iterable[Trajectory]) -> Iterator[Trajectory]:
    """Frames of a problem among those of every step."""
    done = 0
    for block in blocks:
        yield replace(block[-done % problem.steps_per_frame :: problem.steps_per_frame], problem=problem)
        done += block.frames


def _interval(problem: Problem, measured: peaks.Peaks, exact: peaks.Peaks) -> Interval:
    """Errors of measured passages; infinite where a passage is missing that does not end with the run."""
    early = exact.where(exact.time < problem.duration - 2.0 * problem.every)
    matched = difference.matched
    missing = len(matched(measured, early, problem.beads)[0]) < len(matched(early, early, problem.beads)[0])
    measured, true = matched(measured, exact, problem.beads)
    amplitude = float(np.max(np.abs(measured.velocity - true.velocity), initial=math.inf if missing else 0.0))
    arrival = float(np.max(np.abs(measured.time - true.time)[peaks.sharp(true)], initial=math.inf if missing else 0.0))
    return Interval(
        problem.every, amplitude, arrival, 24e-6 * problem.frames * problem.chains * len(problem.rows.numbers)
    )
