"""Errors of numbers of the leading waves by the time between frames, beside their stated bounds, of small scenes.

A scene is integrated by the reference integrator with frames 0.0125 T apart; the leading waves in every 8th, 20th, 40th
and 80th frame are compared with those in all frames. `of_steps` compares the scheme of LAMMPS with the reference.
"""

import itertools
import random
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import random_scenes

from analysis.shape import waveforms
from analysis.sharing.run_error import MeasuredError, with_run_error
from analysis.sharing.survey import Survey
from analysis.tracking.leading_passages import leading_meter
from analysis.tracking.leading_waves import Waves, leading_waves, usual_arrival
from analysis.trajectory import Flags, Floats, Integers, Trajectory
from lammps_inputs import InputError, Problem, Scene, library
from lammps_inputs.installed_scenes import installed
from workflow.engines.reference import engine
from workflow.engines.reference.schemes import BLANES_MOAN, VERLET

FINEST = 0.0125
"""Time between the frames of the integration, in units of T."""

CADENCES = (0.1, 0.25, 0.5, 1.0)
"""Times between frames that are compared with these, in units of T."""

LEAST = 1e-12
"""Errors below this are rounding; a ratio to them has no meaning."""

SMALL: dict[str, dict[str, Any]] = {
    "two-chains": {"beads": 40, "duration": 60.0},
    "two-chains-gapped": {"beads": 40, "duration": 260.0},
    "dimer": {"beads": 80, "duration": 85.0},
    "resonators": {"beads": 40, "duration": 50.0, "resonators": {"mass": 0.3, "stiffness": 0.2, "rows": [11, 25]}},
    "damped-contacts": {"beads": 40, "duration": 50.0},
    "precompressed": {"beads": 40, "duration": 40.0},
    "plastic-contacts": {"beads": 30, "duration": 50.0},
}
"""Installed scenes, shortened: other values of their keys; durations in units of T."""
Quantity = Literal["arrival", "peak", "speed", "lag", "width", "residual"]

QUANTITIES: tuple[Quantity, ...] = ("arrival", "peak")
"""Numbers of passages themselves, from which others follow."""

OF_RUN = 0.05
"""Time between the frames in which an emulated run is compared with the reference, in units of T."""


@dataclass(frozen=True)
class Comparison:
    """Leading waves of frames far apart beside those of all frames, [wave]; times in units of T, velocities of V."""

    cadence: float
    chain: Integers
    bead: Integers
    error: dict[Quantity, Floats]
    bound: dict[Quantity, Floats]
    """NaN or infinite where the quantity is not known."""

    def known(self, quantity: Quantity) -> Flags:
        """Mask, [wave], of those with a finite bound and error."""
        return np.isfinite(self.bound[quantity]) & np.isfinite(self.error[quantity])

    def held(self, quantity: Quantity) -> Flags:
        """Mask, [wave], of those whose error is at most the bound, or that are stated to be unknown."""
        return ~self.known(quantity) | (self.error[quantity] <= self.bound[quantity] + LEAST)


def small(name: str, every: float = FINEST, **changes: Any) -> Scene:
    """An installed scene, shortened, with frames so far apart; durations among the changes, too, in units of T."""
    plain = library.load_plain(installed()[name])
    time = library.from_plain(plain, name).scale.time
    changed = {**plain, **SMALL[name], **changes}
    changed |= {"duration": changed["duration"] * time, "output": {"every": every * time}}
    return library.from_plain(changed, name)


def drawn(count: int, seed: int) -> Iterator[Scene]:
    """Random scenes that are accepted, in which all beads exist and are recorded, with the finest frames."""
    chance, accepted = random.Random(seed), 0
    for number in itertools.count():
        try:
            scene = random_scenes.draw(chance, f"{seed}-{number}")
            every = FINEST * scene.scale.time
            scene = scene.model_copy(update={"output": type(scene.output)(every=every), "window": None})
            problem = scene.problem()
        except (ValueError, InputError):
            continue
        if problem.duration < 4.0 or problem.frames > 8000:
            continue
        yield scene
        accepted += 1
        if accepted == count:
            return


def integrated(problem: Problem, scheme: str = BLANES_MOAN.name) -> Trajectory:
    """All frames of a problem; that of LAMMPS takes its time step."""
    if scheme == BLANES_MOAN.name:
        return engine.run(problem)
    run = engine.run(problem, scheme=VERLET, steps_per_frame=problem.steps_per_frame)
    return replace(run, problem=replace(problem, scheme="verlet"))


def thinned(run: Trajectory, stride: int) -> Trajectory:
    """Every stride-th frame of a run."""
    return replace(run[::stride], problem=run.problem.coarser(stride))


def waves_of(run: Trajectory) -> Waves:
    """Leading waves in the frames of a run."""
    return leading_waves(leading_meter(run.problem).read(run.blocks()), run.problem)


def surveyed(run: Trajectory, *, samples: int = waveforms.SAMPLES) -> Survey:
    """Everything that is found in the frames of a run; waveforms of that many samples at most."""
    usual, waveforms.SAMPLES = waveforms.SAMPLES, samples
    results = Survey(run.problem, run.blocks, usual_arrival(run.problem))
    results = results.replaced(waves=results.waves, lags=results.lags, shape=results.shape)
    waveforms.SAMPLES = usual
    return results


def numbers(results: Survey) -> dict[Quantity, tuple[Floats, Floats]]:
    """Numbers of the leading waves and their bounds, each [wave]."""
    waves, shape = results.waves, results.shape
    return {
        "arrival": (waves.arrival, waves.arrival_error),
        "peak": (waves.peak_velocity, waves.peak_velocity_error),
        "speed": (waves.speed, waves.speed_error),
        "lag": results.lags,
        "width": (shape.width, shape.width_error),
        "residual": (shape.residual, shape.residual_error),
    }


def compare(results: Survey, exact: Survey, cadence: float) -> Comparison:
    """Numbers of the leading waves beside others that count as exact but for their own bounds."""
    places = {
        place: k for k, place in enumerate(zip(exact.waves.chain.tolist(), exact.waves.bead.tolist(), strict=True))
    }
    waves = results.waves
    beads = zip(waves.chain.tolist(), waves.bead.tolist(), strict=True)
    at = np.array([places.get(place, -1) for place in beads], dtype=np.int64)
    seen, at = np.flatnonzero(at >= 0), at[at >= 0]
    error: dict[Quantity, Floats] = {}
    bound: dict[Quantity, Floats] = {}
    others = numbers(exact)
    for name, (value, stated) in numbers(results).items():
        of_exact, of_bound = (values[at] for values in others[name])
        error[name] = np.abs(value[seen] - of_exact)
        if name == "arrival":
            error[name][np.isnan(value[seen]) & ~np.isnan(of_exact)] = np.inf
        bound[name] = stated[seen] + of_bound
    return Comparison(cadence, waves.chain[seen], waves.bead[seen], error, bound)


def of_steps(scene: Scene) -> Comparison:
    """Numbers of a run of LAMMPS's scheme beside those of the reference, with bounds by the run's measured errors."""
    problem = scene.problem()
    reference, run = integrated(problem), integrated(problem, VERLET.name)
    exact, results = surveyed(reference), surveyed(run)
    errors = compare(results, exact, OF_RUN).error
    velocity = float(np.max(np.abs(run.velocity - reference.velocity)))
    largest = float(np.max(errors["arrival"], where=np.isfinite(errors["arrival"]), initial=0.0))
    measured = MeasuredError(velocity, float(np.max(errors["peak"])), largest, measured=True)
    return compare(with_run_error(results, measured), exact, OF_RUN)


def compared(run: Trajectory, cadences: tuple[float, ...] = CADENCES) -> Iterator[Comparison]:
    """Leading waves at each cadence beside those of all frames of a run."""
    strides = [max(1, round(cadence / run.problem.every)) for cadence in cadences]
    frames = [(run.frames - 1) // stride * stride + 1 for stride in strides]  # both end with the same frame
    exact = {count: surveyed(run[:count], samples=2048) for count in set(frames)}
    for cadence, stride, count in zip(cadences, strides, frames, strict=True):
        yield compare(surveyed(thinned(run[:count], stride)), exact[count], cadence)
