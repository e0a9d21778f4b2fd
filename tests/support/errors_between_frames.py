"""Errors of numbers of the leading waves by the time between frames, beside their stated bounds, by scene and cadence.

``python tests/support/errors_between_frames.py [SCENE...] [--random N] [--scheme verlet] [--worst 20]`` integrates each
scene by the reference integrator with frames 0.0125 T apart, takes every 8th, 20th, 40th and 80th frame, and compares
the leading waves in these with those of all frames. Ten small scenes take a minute. ``--scheme verlet`` emulates LAMMPS
with the scene's time step, whose velocities differ from the slope of its displacements; ``suzuki4`` its fourth order.
``--of run`` compares that emulation with the reference at frames 0.05 T apart, and its errors with the stated ones;
``--of spectra`` takes the spectra of four beads over the last two thirds of each run, with the line at every drive.

| column      | content                                                                                             |
|-------------|-----------------------------------------------------------------------------------------------------|
| ``held``    | share in which the error is at most the stated bound                                                |
| ``error``   | median error, in T or V                                                                             |
| ``largest`` | largest error of those with a finite bound                                                          |
| ``bound``   | median ratio of bound and error, of errors above `LEAST`                                            |
| ``unknown`` | share of arrivals that are undefined (of peaks: without a finite bound) and defined in all frames   |
| ``absent``  | beads without a leading wave, which have one in all frames                                          |
"""

import argparse
import itertools
import random
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

sys.path.append(str(Path(__file__).resolve().parent))
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
from workflow.engines.reference.schemes import BLANES_MOAN, SUZUKI4, VERLET
from workflow.measures.spectra import SpectrumMeter, VelocitySpectra, amplitude_at

SCHEMES = {scheme.name: scheme for scheme in (BLANES_MOAN, VERLET)} | {"suzuki4": SUZUKI4}

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
    "wall-reflection": {"beads": 30, "duration": 60.0, "output": {}},
    "resonators": {"beads": 40, "duration": 50.0, "resonators": {"mass": 0.3, "stiffness": 0.2, "rows": [11, 25]}},
    "damped-contacts": {"beads": 40, "duration": 50.0},
    "precompressed": {"beads": 40, "duration": 40.0},
    "half-sine-push": {"beads": 40, "duration": 60.0},
    "driven-chain": {"beads": 20, "duration": 40.0, "output": {}},
    "plastic-contacts": {"beads": 30, "duration": 50.0},
}
"""Installed scenes, shortened: other values of their keys; durations in units of T."""

OfWaves = Literal["arrival", "peak", "speed", "lag", "width", "residual"]
OfSpectra = Literal["line", "highest", "frequency", "drive", "passed on"]
Quantity = OfWaves | OfSpectra

QUANTITIES: tuple[OfWaves, ...] = ("arrival", "peak")
"""Numbers of passages themselves, from which others follow."""

OF_RUN = 0.05
"""Time between the frames in which an emulated run is compared with the reference, in units of T."""


@dataclass(frozen=True)
class Comparison:
    """Leading waves of frames far apart beside those of all frames, [wave]; times in units of T, velocities of V."""

    scene: str
    cadence: float
    chain: Integers
    bead: Integers
    error: dict[Quantity, Floats]
    bound: dict[Quantity, Floats]
    """NaN or infinite where the quantity is not known."""
    absent: int

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
    """All frames of a problem; a scheme of LAMMPS takes its time step."""
    chosen = SCHEMES[scheme]
    if chosen is BLANES_MOAN:
        return engine.run(problem)
    steps = problem.steps_per_frame if chosen is VERLET else max(1, problem.steps_per_frame // 5)
    run = engine.run(problem, scheme=chosen, steps_per_frame=steps)
    return replace(run, problem=replace(problem, scheme="verlet" if chosen is VERLET else "suzuki4"))


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


def numbers(results: Survey) -> dict[OfWaves, tuple[Floats, Floats]]:
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
    found = waves.where(seen)
    absent = len(exact.waves) - len(found)
    return Comparison(results.problem.name, cadence, found.chain, found.bead, error, bound, absent)


def of_steps(scene: Scene) -> Comparison:
    """Numbers of a run of LAMMPS's scheme beside those of the reference, with bounds by the run's measured errors."""
    problem = scene.problem()
    reference, run = integrated(problem), integrated(problem, VERLET.name)
    exact, results = surveyed(reference), surveyed(run)
    errors = compare(results, exact, OF_RUN).error
    velocity = float(np.max(np.abs(run.velocity - reference.velocity)))
    measured = MeasuredError(velocity, float(np.max(errors["peak"])), float(_largest(errors["arrival"])), measured=True)
    return compare(with_run_error(results, measured), exact, OF_RUN)


def spectra_of(run: Trajectory) -> VelocitySpectra:
    """Spectra of four beads over the last two thirds of a run."""
    recorded = run.problem.rows.numbers
    beads = tuple(sorted(set(recorded[np.linspace(0, len(recorded) - 1, 4).astype(int)].tolist())))
    spectra = SpectrumMeter(run.problem, beads, run.problem.duration / 3.0).read(run.blocks())
    assert spectra is not None
    return spectra


def compared_spectra(run: Trajectory, cadences: tuple[float, ...] = CADENCES) -> Iterator[Comparison]:
    """Lines of spectra at each cadence beside those at the same frequencies in all frames of a run."""
    exact, start = spectra_of(run), run.problem.duration / 3.0
    columns = run.problem.rows.positions(exact.beads)
    velocity = run.velocity[run.time >= start * (1.0 - 1e-12)][:, :, columns]
    for cadence in cadences:
        spectra = spectra_of(thinned(run, max(1, round(cadence / run.problem.every))))
        lines = np.array([amplitude_at(velocity, run.problem.every, each) for each in spectra.frequency.tolist()])
        chain, place = (index.ravel() for index in np.indices(lines.shape[1:]))
        highest = spectra.found(run.problem).beads
        others = [line.frequency for line in exact.found(run.problem).beads]
        at = np.argmax(spectra.amplitude[1:], axis=0).ravel() + 1
        values: dict[Quantity, tuple[Floats, Floats]] = {
            "line": (np.abs(spectra.amplitude - lines)[1:], spectra.amplitude_error[1:]),
            "highest": (
                np.abs(spectra.amplitude - lines)[at, chain, place],
                spectra.amplitude_error[at, chain, place],
            ),
            "frequency": (
                np.abs(np.array([line.frequency for line in highest]) - others),
                np.array([line.frequency_error for line in highest]) + 0.5 * exact.resolution,
            ),
            "drive": (np.abs(spectra.at_drive - exact.at_drive), spectra.at_drive_error),
            "passed on": (
                np.abs(spectra.transmissibility - exact.transmissibility),
                spectra.transmissibility_error,
            ),
        }
        error = {name: value.ravel() for name, (value, _) in values.items()}
        bound = {name: stated.ravel() for name, (_, stated) in values.items()}
        yield Comparison(run.problem.name, cadence, chain + 1, np.array(exact.beads)[place], error, bound, 0)


def _largest(errors: Floats) -> Floats:
    """Largest of the finite errors."""
    return np.asarray(np.max(errors, where=np.isfinite(errors), initial=0.0))


def compared(run: Trajectory, cadences: tuple[float, ...] = CADENCES) -> Iterator[Comparison]:
    """Leading waves at each cadence beside those of all frames of a run."""
    strides = [max(1, round(cadence / run.problem.every)) for cadence in cadences]
    frames = [(run.frames - 1) // stride * stride + 1 for stride in strides]  # both end with the same frame
    exact = {count: surveyed(run[:count], samples=2048) for count in set(frames)}
    for cadence, stride, count in zip(cadences, strides, frames, strict=True):
        yield compare(surveyed(thinned(run[:count], stride)), exact[count], cadence)


def rows(comparisons: list[Comparison]) -> Iterator[str]:
    """Lines of the table; numbers that are undefined in either are left out, but for arrivals."""
    for quantity in comparisons[0].error:
        chosen = [~np.isnan(each.error[quantity]) for each in comparisons]
        error = np.concatenate([each.error[quantity][mask] for each, mask in zip(comparisons, chosen, strict=True)])
        bound = np.concatenate([each.bound[quantity][mask] for each, mask in zip(comparisons, chosen, strict=True)])
        held = np.concatenate([each.held(quantity)[mask] for each, mask in zip(comparisons, chosen, strict=True)])
        known = np.isfinite(bound) & np.isfinite(error)
        unknown = np.isinf(error) | (~np.isfinite(bound) & np.isfinite(error))
        ratio = bound[known & (error > LEAST)] / error[known & (error > LEAST)]
        size, largest = (np.median(error[known]), np.max(error[known])) if np.any(known) else (np.nan, np.nan)
        yield (
            f"{quantity:10}{len(error):6}{np.mean(held) if len(held) else np.nan:9.4f}{size:10.1e}{largest:10.1e}"
            f"{np.median(ratio) if len(ratio) else np.nan:9.1f}{np.mean(unknown) if len(error) else 0.0:9.4f}"
        )


def print_tables(comparisons: list[Comparison], worst: int, *, each_scene: bool) -> None:
    """Print shares by scene and cadence, over all scenes, and the entries that exceed their bounds most."""
    heading = f"{'scene':26}{'every':>6}  {'':10}{'count':>6}{'held':>9}{'error':>10}{'largest':>10}{'bound':>9}"
    print(heading + "  unknown  absent")
    names = list(dict.fromkeys(each.scene for each in comparisons)) if each_scene else []
    cadences = list(dict.fromkeys(each.cadence for each in comparisons))
    for name, cadence in [*itertools.product(names, cadences), *(("all", cadence) for cadence in cadences)]:
        part = [each for each in comparisons if each.cadence == cadence and name in (each.scene, "all")]
        for row in rows(part):
            print(f"{name:26}{cadence:6g}  {row}{sum(each.absent for each in part):8}")
    excess = [
        (each.error[quantity][k] / max(each.bound[quantity][k], 1e-300), quantity, each, k)
        for each in comparisons
        for quantity in each.error
        for k in np.flatnonzero(~each.held(quantity))
    ]
    for ratio, quantity, each, k in sorted(excess, key=lambda entry: -entry[0])[:worst]:
        chain, bead = (column[k % len(column)] for column in (each.chain, each.bead))
        print(
            f"{each.scene}, {each.cadence:g} T: {quantity} at chain {chain}, bead {bead}: error "
            f"{each.error[quantity][k]:.2e}, bound {each.bound[quantity][k]:.2e}, {ratio:.3g} times"
        )


def main() -> None:
    """Read the arguments and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="*", choices=[*SMALL, []], help="by default all")
    parser.add_argument("--random", type=int, metavar="N", help="N random scenes instead")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scheme", choices=SCHEMES, default=BLANES_MOAN.name)
    parser.add_argument(
        "--of", choices=["frames", "run", "spectra"], default="frames", help="what the errors are due to"
    )
    parser.add_argument("--worst", type=int, default=20, metavar="N", help="entries that are listed")
    given = parser.parse_args()
    every, names = OF_RUN if given.of == "run" else FINEST, given.scene or SMALL
    scenes = drawn(given.random, given.seed) if given.random else (small(name, every) for name in names)
    if given.of == "run":
        comparisons = [of_steps(scene) for scene in scenes]
    elif given.of == "spectra":
        runs = (integrated(scene.problem(), given.scheme) for scene in scenes)
        comparisons = [each for run in runs for each in compared_spectra(run)]
    else:
        comparisons = [each for scene in scenes for each in compared(integrated(scene.problem(), given.scheme))]
    print_tables(comparisons, given.worst, each_scene=not given.random)


if __name__ == "__main__":
    main()
