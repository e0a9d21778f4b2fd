"""Run directories as they come back from a cluster, right and wrong in known ways."""

import re
import subprocess
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from processes import HANGS
from stock_lammps import WHEEL

from analysis.files.recording import Writer
from analysis.motion import acceleration
from analysis.trajectory import Trajectory
from lammps_inputs import Scene, file_names
from lammps_inputs.decks import scene_files
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.diagnose import diagnose

Floats = NDArray[np.float64]
States = tuple[Floats, Floats]


def deck_run(scene: Scene, path: Path, edit: Callable[[Path], None] | None = None, *options: str) -> RunDirectory:
    """The deck of a scene in a new directory, edited, and run by plain ``lmp``; no ``run.json``.

    Nor a log, which would state values that were edited.
    """
    path.mkdir()
    scene_files.write(scene, path)
    if edit is not None:
        edit(path)
    command = [str(WHEEL), "-in", file_names.DECK, "-log", "none", "-screen", "none", *options]
    subprocess.run(command, cwd=path, check=True, timeout=HANGS)
    return RunDirectory(path)


def without_uncertainties(causes: Iterable[str]) -> list[str]:
    """Sentences without the uncertainties in brackets."""
    return [re.sub(r" \(± [^)]*\)", "", cause) for cause in causes]


def causes(trajectory: Trajectory, reference: Trajectory) -> list[str]:
    """What is named as the causes of a difference, without uncertainties."""
    return without_uncertainties(diagnose(trajectory, reference).causes)


def replaced(name: str, old: str, new: str) -> Callable[[Path], None]:
    """An edit of one of the deck's files."""

    def edit(path: Path) -> None:
        text = (path / name).read_text()
        assert text.count(old) == 1
        (path / name).write_text(text.replace(old, new))

    return edit


def substituted(pattern: str, new: str | Callable[[re.Match[str]], str]) -> Callable[[Path], None]:
    """An edit of the deck wherever it has a pattern."""

    def edit(path: Path) -> None:
        text, found = re.subn(pattern, new, (path / file_names.DECK).read_text())
        assert found
        (path / file_names.DECK).write_text(text)

    return edit


def without_spring(row: int) -> Callable[[Path], None]:
    """An edit that takes the spring of a row of two chains away."""

    def edit(path: Path) -> None:
        text = (path / file_names.DATA).read_text()
        beads = int(text.split(" bonds")[0].split()[-1])
        bond = f"\n{row} 1 {row} {row + beads}\n"
        assert text.count(bond) == 1
        (path / file_names.DATA).write_text(text.replace(f"{beads} bonds", f"{beads - 1} bonds").replace(bond, "\n"))

    return edit


def rewritten(good: RunDirectory, path: Path, change: Callable[[Trajectory], States]) -> RunDirectory:
    """A copy of a run whose displacements and velocities were changed on their way into the dump."""
    path.mkdir()
    scene_files.write(good.scene, path)
    problem = good.problem
    with Writer(path / file_names.DUMP, problem) as writer:
        for frame, (displacement, velocity) in enumerate(zip(*change(good.trajectory), strict=True)):
            writer.append(frame * problem.steps_per_frame, displacement, velocity)
    return RunDirectory(path)


def six_digits(values: Floats) -> Floats:
    """What is left of numbers that were printed with ``%g``."""
    return np.asarray(np.vectorize(lambda value: float(f"{value:g}"))(values))


def rest(run: Trajectory) -> Floats:
    """Rest positions of the recorded beads."""
    return run.beads * run.problem.layout.spacing


def at_half_steps(run: Trajectory) -> States:
    """Velocities half a time step before the positions, as of a leapfrog."""
    return run.displacement, run.velocity - 0.5 * run.problem.timestep * acceleration(
        run.problem.system, run.displacement
    )


CUBIC = replaced(file_names.DECK, "(v_kappa/2:%.17g) 0", "(v_kappa/2:%.17g) 8")
"""A bond at rest at the lateral distance of the chains is cubic along them."""

ONE_PERCENT_MORE = replaced(file_names.DECK, "kappa index 0.1\n", "kappa index 0.101\n")
