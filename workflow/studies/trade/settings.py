"""What a user can choose for a scene: the settings of every engine, from coarse to fine, and how each is run and timed;
and what errors are measured against: an accurate reference with the scene's frames, on the disk.

Times are of an engine's time loop with its frames on the disk, apart from its start.
"""

import math
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path

import numpy as np

from analysis.compare.difference import errors_of, matched
from analysis.files import recording
from analysis.quantity import declare, result
from analysis.tracking.leading_waves import leading_finder, leading_passages
from analysis.tracking.peaks import PeakFinder, Peaks, sharp
from analysis.trajectory import Trajectory
from lammps_inputs import Problem, file_names, physics
from lammps_inputs import scheme as schemes
from lammps_inputs.decks import deck
from lammps_inputs.facts import Fact
from lammps_inputs.limits.rates import stability_bound
from lammps_inputs.scheme import SchemeName
from lammps_inputs.window import HEADROOM, LEAST_WINDOW
from workflow.engines.lammps import engine as lammps
from workflow.engines.lammps import mpi
from workflow.engines.reference import engine as reference
from workflow.engines.reference.schemes import BLANES_MOAN
from workflow.engines.reference.step_halving import StepHalving, Uncertainty
from workflow.runs.engines import write_frames

# --- runs -------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Setting:
    """One choice of the user's.

    Attributes:
        method: what varies, with the engine's name before it.
        value: its step, ranks or rows.
        problem: with its own time step and frames; LAMMPS's scheme and window are in it.
        ranks: of LAMMPS.
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
        """First word of the method."""
        return self.method.partition(" ")[0]

    @property
    def forces(self) -> int:
        """Evaluations of all forces."""
        return self.problem.steps * (BLANES_MOAN.forces_per_step if self.method == REFERENCE else 1)

    @property
    def effort(self) -> float:
        """Work relative to other settings of the engine: the forces of all beads that exist."""
        return self.forces * self.problem.rows / self.problem.beads / min(self.ranks, 2)


def run(setting: Setting, directory: Path) -> float:
    """Run a setting with its files in a directory, over those of the one before; seconds of the time loop.

    Raises:
        RunError: it failed.
    """
    problem, dump = setting.problem, directory / file_names.DUMP
    dump.unlink(missing_ok=True)
    if setting.method == REFERENCE:
        reference.load()
        started = time.perf_counter()
        ending = write_frames(dump, problem, reference.blocks(problem, steps_per_frame=problem.steps_per_frame))
        outcome, seconds = ending["outcome"], time.perf_counter() - started
    else:
        (directory / file_names.DATA).write_text(deck.render_data(problem))
        (directory / file_names.DECK).write_text(deck.render_deck(problem))
        end = lammps.run(directory, ranks=setting.ranks, problem=problem)
        outcome, seconds = end.end, end.seconds
    if outcome != "done":
        raise KeyboardInterrupt
    return seconds


# --- settings ---------------------------------------------------------------------------------------------------------

COARSEST = 0.6
"""Longest step (of a composition: cycle) in the stability bound of velocity Verlet."""

FINEST = {"verlet": 1024, "suzuki4": 64, "blanes-moan": 64}
"""Steps, or cycles, in the coarsest one."""

LEAST_FRAMES = 10
"""Of a run whose step spans several frames of the scene."""

MOST_RANKS = 4

WIDEN, MOST_WIDTHS = 1.5, 6

LAMMPS = "LAMMPS "
RANKS, WINDOW, REFERENCE = f"{LAMMPS}ranks", f"{LAMMPS}window", "reference blanes-moan"


def settings(problem: Problem) -> list[Setting]:
    """Everything to be measured for a problem, which has the scene's own frames and time step; that is among them."""
    by_reference = [Setting(REFERENCE, own.timestep, own) for own in stepped(problem, FINEST["blanes-moan"])]
    if deck.refusal(problem.system):
        return by_reference
    names: tuple[SchemeName, ...] = ("verlet", "suzuki4") if problem.system.holds(Fact.REVERSIBLE) else ("verlet",)
    found = []
    for name in names:
        several = stepped(replace(problem, scheme=name), FINEST[name], schemes.cycle(name))
        several += [problem] * (name == "verlet" and problem.timestep not in [own.timestep for own in several])
        several.sort(key=lambda own: -own.timestep)
        found += [Setting(LAMMPS + name, own.timestep, own) for own in several]
    most = 1 if mpi.launcher() is None else min(MOST_RANKS, mpi.cores(), problem.beads)
    ranks = [Setting(RANKS, 2**power, problem, ranks=2**power) for power in range(1, most.bit_length())]
    window = [Setting(WINDOW, rows, replace(problem, window=rows)) for rows in windows(problem)]
    return [*found, *by_reference, *ranks, *window]


def stepped(problem: Problem, finest: int, stages: int = 1) -> list[Problem]:
    """The problem with cycles of ever fewer frames, then parts of one, their lengths halved from `COARSEST`.

    Args:
        problem: whose frames and stability bound count; frames are left out where a cycle spans several.
        finest: cycles in the coarsest one.
        stages: steps of a cycle.
    """
    longest = math.floor(math.log2(COARSEST * stability_bound(problem.system) / problem.every))
    longest = min(longest, max(0, math.floor(math.log2(problem.frames / LEAST_FRAMES))))
    found = []
    for power in range(longest, longest - finest.bit_length(), -1):
        frames, steps = 2 ** max(0, power), stages * 2 ** max(0, -power)
        every = problem.every * frames
        found.append(replace(problem.coarser(frames), timestep=every / steps, steps_per_frame=steps))
    return found


def windows(problem: Problem) -> list[int]:
    """Rows of the windows that are measured; none where a scene can have no window or is too short for one."""
    system = problem.system
    forward = all(velocity > 0.0 and bead <= LEAST_WINDOW - HEADROOM for _, bead, velocity in system.kicks)
    if problem.recorded is not None or not (physics.uniform(system) and forward and system.holds(Fact.FRONT)):
        return []
    widths = [round(LEAST_WINDOW * WIDEN**power) for power in range(MOST_WIDTHS)]
    return [rows for rows in widths if rows < 0.9 * problem.beads]


# --- truth ------------------------------------------------------------------------------------------------------------

QUANTITIES = ("velocity", "amplitude", "arrival")

GOAL = 1e-10
"""Uncertainty of velocities beyond which the reference is not refined."""

REFINEMENT = 4


@dataclass(frozen=True)
class Truth:
    """The reference run of a problem.

    Attributes:
        problem: with the scene's frames.
        path: its frames.
        uncertainty: of its velocities and arrivals.
        seconds: wall time of the run that was kept.
    """

    problem: Problem
    path: Path
    uncertainty: Uncertainty
    seconds: float

    @property
    def floors(self) -> dict[str, float]:
        """Uncertainty of each quantity."""
        found = self.uncertainty
        return {"velocity": found.velocity, "amplitude": found.velocity, "arrival": found.arrival}

    def errors(self, blocks: Iterable[Trajectory]) -> dict[str, float]:
        """Largest errors of a run whose frames are among this problem's; infinite where they are undefined.

        Of a window, only the rows count that `analysis.compare.common_times.near_the_front` takes to be right.
        """
        stream = iter(blocks)
        first = next(stream)
        stride = max(1, round(first.problem.every / self.problem.every))
        own = replace(self.problem, window=first.problem.window)
        exact = recording.blocks([self.path], self.problem, stride)
        found = errors_of(chain([first], stream), (replace(block, problem=own) for block in exact))
        sizes = {name: found[name].largest if name in found else math.inf for name in QUANTITIES}
        return {name: size if math.isfinite(size) else math.inf for name, size in sizes.items()}


def make_truth(problem: Problem, directory: Path, *, seconds: float) -> Truth:
    """Refine the reference until its uncertainty is below `GOAL`, or the next refinement would take too long.

    Args:
        problem: with the scene's frames.
        directory: for its frames.
        seconds: wall time that the last refinement may take.
    """
    path, steps = directory / "reference.bin", None
    reference.run(replace(problem, frames=1))  # compiles what it takes
    while True:
        started = time.perf_counter()
        halving = StepHalving(problem, steps_per_frame=steps)
        if write_frames(path, problem, halving.blocks())["outcome"] != "done":
            raise KeyboardInterrupt
        found = Truth(problem, path, halving.uncertainty, time.perf_counter() - started)
        if found.uncertainty.velocity <= GOAL or REFINEMENT * found.seconds > seconds:
            return found
        steps = REFINEMENT * halving.steps_per_frame


# --- frames -----------------------------------------------------------------------------------------------------------

NEAR = 0.025
"""Time between frames (T) at which passages are taken to be exact: to 1e-9 of T and of V."""

FARTHEST = 2.0
"""Time between frames (T) from which on a wave falls between them."""


@result
class Interval:
    """Largest errors of the leading pulse that are due to the time between frames."""

    every: float = declare("time between frames", "time", digits=".4g")
    amplitude_error: float = declare("largest error of a peak velocity", "V", "a peak is missed", digits=".1e")
    arrival_error: float = declare("largest error of an arrival", "T", "a peak is missed", digits=".1e")
    megabytes: float = declare("size of all frames", "MB", digits=".3g")


def intervals(problem: Problem) -> list[Interval]:
    """Errors of amplitudes (V) and arrivals (T) read from other frames than the scene's, and the size of all frames."""
    halvings = max(1, math.ceil(math.log2(problem.every / NEAR)))
    step = problem.every / 2**halvings
    fine = replace(problem, timestep=step, steps_per_frame=1, frames=problem.frames * 2**halvings)
    most = min(math.log2(FARTHEST / step), math.log2(fine.frames / LEAST_FRAMES))
    seldom = [fine.coarser(2**power) for power in range(1 + max(0, math.floor(most)))]
    exact, *others = _passages(fine, seldom)
    return [_interval(own, found, exact) for own, found in zip(seldom[1:], others, strict=True)][::-1]


def _passages(fine: Problem, seldom: list[Problem]) -> Iterator[Peaks]:
    """The leading pulse at each bead, as several frequencies of frames show it."""
    finders: list[PeakFinder] = [leading_finder(own) for own in seldom]
    done = 0
    for block in reference.blocks(fine):
        for own, finder in zip(seldom, finders, strict=True):
            part = block[-done % own.steps_per_frame :: own.steps_per_frame]
            if part.frames:
                finder.add(replace(part, problem=own))
        done += block.frames
    return (leading_passages(finder.result(), own).first() for finder, own in zip(finders, seldom, strict=True))


def _interval(own: Problem, found: Peaks, exact: Peaks) -> Interval:
    """Errors of what was found; infinite where a passage is missing that does not end with the run."""
    early = exact.where(exact.time < own.duration - 2.0 * own.every)
    missing = len(matched(found, early, own.beads)[0]) < len(matched(early, early, own.beads)[0])
    found, true = matched(found, exact, own.beads)
    amplitude = float(np.max(np.abs(found.velocity - true.velocity), initial=math.inf if missing else 0.0))
    arrival = float(np.max(np.abs(found.time - true.time)[sharp(true)], initial=math.inf if missing else 0.0))
    return Interval(own.every, amplitude, arrival, 24e-6 * own.frames * own.chains * len(own.recorded_beads))
