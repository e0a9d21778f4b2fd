"""Our deck, frames and reader against the textbook's: a plain deck, a text dump, MDAnalysis's stock reader."""

import time
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from analysis.conservation import Conservation
from analysis.files.recording import blocks
from analysis.quantity import csv_of
from analysis.tracking.leading_waves import leading_waves
from analysis.tracking.peaks import PeakFinder, find_peaks
from analysis.trajectory import Trajectory
from lammps_inputs import Problem, Scene, file_names, physics
from lammps_inputs.decks import deck
from lammps_inputs.numbers import text
from workflow.studies.bench.runs import lammps_seconds, scene
from workflow.studies.bench.study import Ratio, ratio_of, seconds

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
    (directory / "waves.csv").write_text(csv_of(leading_waves(find_peaks([trajectory])), problem.scale))
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
    (directory / "waves.csv").write_text(csv_of(leading_waves(finder.result()), one.scale))


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
