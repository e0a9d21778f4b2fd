"""The textbook way to the same waves, to measure against: a plain deck, a text dump, MDAnalysis's stock reader.

Not used by anything but `granchain bench`.
"""

import time
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analysis.tracking.leading_waves import leading_waves, to_csv
from analysis.tracking.peaks import find_peaks
from analysis.trajectory import Trajectory
from lammps_inputs import Problem, file_names
from lammps_inputs.decks import deck
from lammps_inputs.numbers import text

TEXT_DUMP = "chains.dump.txt"


def plain_deck(problem: Problem, *, dump: bool) -> str:
    """A deck as the manual suggests it: periodic across, default neighbour lists, ``%.17g`` text dump."""
    lines = [
        f"atom_style {'hybrid sphere bond' if problem.coupled else 'sphere'}",
        "boundary s p p",
        "comm_modify vel yes",
        f"read_data {file_names.DATA}",
        "set group all mass 1.0",
        *(line for section in deck.interactions(problem) for line in section if line.startswith("pair")),
    ]
    if problem.coupled:
        lines += ["bond_style harmonic", f"bond_coeff 1 {text(problem.kappa / 2.0)} 0"]
    lines.append("fix motion all nve")
    if problem.coupled:
        lines.append("fix line all setforce NULL 0 0")
    lines += [
        f"set atom {(chain - 1) * problem.beads + bead} vx {text(velocity)}" for chain, bead, velocity in problem.kicks
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
    side = text(2.0 * problem.spacing)
    half = text(problem.diameter)
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
    rest = np.arange(1, problem.beads + 1) * problem.spacing
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
    (directory / "waves.csv").write_text(to_csv(waves, problem.scale))
    return Timing(read, time.perf_counter() - started)
