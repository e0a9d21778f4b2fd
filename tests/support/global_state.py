"""What belongs to the whole process, to compare before and after a call of a public function.

Imported first, since libraries have global state of their own: MDAnalysis and Bokeh add filters of warnings,
threadpoolctl an environment variable, rich draws a random number.
"""

import gc
import importlib
import locale
import logging
import multiprocessing
import os
import random
import signal
import sys
import threading
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

LIBRARIES = ("MDAnalysis", "bokeh.embed", "matplotlib.figure", "numba", "rich.progress", "scipy.optimize")

SCENE: dict[str, Any] = {
    "name": "tiny",
    "chains": 2,
    "beads": 8,
    "coupling": {"stiffness": 0.1},
    "kick": {"velocity": 1.0},
    "duration": 4.0,
}


def state(place: Path) -> dict[str, Any]:
    """All that a function could change beyond its arguments and its files."""
    mask = os.umask(0o022)
    os.umask(mask)
    plots = sys.modules["matplotlib"]
    loggers = [logging.root, *(logging.getLogger(name) for name in ("granchain", "matplotlib", "MDAnalysis", "numba"))]
    standard = [(found.st_dev, found.st_ino) for found in map(os.fstat, (0, 1, 2))]
    return {
        "handlers of signals": {number: signal.getsignal(number) for number in signal.valid_signals()},
        "blocked signals": signal.pthread_sigmask(signal.SIG_BLOCK, []),
        "environment": dict(os.environ),
        "threads": set(threading.enumerate()),
        "processes": set(multiprocessing.active_children()),
        "start method": multiprocessing.get_start_method(allow_none=True),
        "directory": Path.cwd(),
        "umask": mask,
        "standard streams": (sys.stdin, sys.stdout, sys.stderr, *standard),
        "files of the run": {
            file for file in map(Path.resolve, Path("/proc/self/fd").iterdir()) if place in file.parents
        },
        "path": list(sys.path),
        "hooks": (sys.excepthook, sys.displayhook, sys.unraisablehook, threading.excepthook),
        "limits": (sys.getrecursionlimit(), sys.getswitchinterval(), gc.get_threshold(), gc.isenabled()),
        "warnings": (list(warnings.filters), warnings.showwarning),
        "loggers": [(logger.level, logger.disabled, list(logger.handlers)) for logger in loggers],
        "locale": locale.setlocale(locale.LC_ALL),
        "random numbers": (random.getstate(), repr(np.random.get_state())),  # noqa: NPY002  a user's may be
        "numpy": (np.geterr(), np.geterrcall(), np.get_printoptions()),
        "matplotlib": (dict(plots.rcParams), plots.get_backend(auto_select=False)),
        "numba": {name: value for name, value in vars(sys.modules["numba"].config).items() if name.isupper()},
    }


def assert_state_remains(call: Callable[[], object], place: Path) -> None:
    """A call leaves the state of the process as it was, with the handlers of signals that a script has.

    Args:
        call: of a public function.
        place: directory below which files are watched.
    """
    for name in LIBRARIES:
        importlib.import_module(name)
    own = {number: signal.signal(number, lambda *_: None) for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)}
    try:
        gc.collect()  # files that earlier tests dropped
        before = state(place)
        call()
        assert state(place) == before
    finally:
        for number, handler in own.items():
            signal.signal(number, handler)
