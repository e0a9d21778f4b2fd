"""What the check of a run costs, and a sweep with two processes against one."""

import functools
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from lammps_inputs import strict_yaml
from workflow.engines.lammps.mpi import cores
from workflow.runs.run import run
from workflow.studies.bench.decks import scene
from workflow.studies.bench.study import Ratio, make_ratio, ratio_of, seconds

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
