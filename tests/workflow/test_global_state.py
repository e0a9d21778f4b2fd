"""What belongs to the whole process is after every public function what it was before: a script's, not ours to change.

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
from pathlib import Path
from types import FunctionType

import measured
import numpy as np
import pytest

import granchain
from workflow.cli import main
from workflow.studies.fit import study as fit

LIBRARIES = ("MDAnalysis", "bokeh.embed", "matplotlib.figure", "numba", "rich.progress", "scipy.optimize")

SCENE = {"name": "tiny", "chains": 2, "beads": 8, "coupling": {"stiffness": 0.1}, "kick": {"velocity": 1.0}}
SCENE["duration"] = 4.0
SWEEP = {"scene": SCENE, "vary": {"kick.velocity": [1.0, 2.0]}, "engine": "reference"}
DESIGN = {"scene": SCENE, "vary": {"beads": {"from": 6, "to": 8}}, "minimize": "mass", "also": ["peak_velocity"]}
DESIGN |= {"verify": 1}

CALLS = {
    "load": lambda _, __: granchain.load("two-chains"),
    "run": lambda path, _: granchain.run(SCENE, path / "new"),
    "analyze": lambda _, run: granchain.analyze(run, figures=True),
    "deck": lambda path, _: granchain.deck(SCENE, path / "new"),
    "validate": lambda _, run: granchain.validate(run),
    "universe": lambda _, run: [*(ts.frame for ts in granchain.universe(run).trajectory), gc.collect()],
    "collect": lambda _, run: granchain.collect(run.parent),
    "plot": lambda _, run: granchain.plot(granchain.collect(run.parent), "peak_velocity", "kick.velocity"),
    "statistics": lambda _, run: granchain.statistics(granchain.collect(run.parent), "peak_velocity"),
    "view": lambda _, run: granchain.view(run),
    "sweep": lambda path, _: granchain.sweep(SWEEP, path / "new", jobs=2),
    "fit": lambda path, _: granchain.fit(
        measured.scene(), measured.table(path / "t.csv"), ["kick.velocity"], path / "new", lammps=False, offset=0.0
    ),
    "design": lambda path, _: granchain.design(DESIGN, path / "new", jobs=1),
    "gallery": lambda path, _: granchain.gallery(path / "new", ["tapered"]),
    "main, done": lambda path, _: main(["run", "one-chain", "-o", str(path / "new"), "--engine", "reference"]),
    "main, refused": lambda path, _: main(["analyze", str(path)]),
    "main, help": lambda _, __: explained(),
}
SLOW = ("sweep", "fit", "design", "gallery")


def explained():
    with pytest.raises(SystemExit):
        main(["--help"])


def state(place):
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


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """A run, of a sweep."""
    for name in LIBRARIES:
        importlib.import_module(name)
    path = tmp_path_factory.mktemp("ran") / "sweep"
    granchain.sweep(SWEEP, path, jobs=1)
    return next(path.glob("*/run.json")).parent


def test_every_public_function_is_asked():
    functions = {name for name in dir(granchain) if isinstance(getattr(granchain, name), FunctionType)}
    assert {name for name in CALLS if not name.startswith("main")} == functions


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.slow] * (name in SLOW)) for name in CALLS])
def test_it_is_as_before(name, ran, tmp_path, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")  # bars of progress have threads
    for count in ("STARTS", "BEGUN"):  # of a fit, which is no better for it
        monkeypatch.setattr(fit, count, 1)
    own = {number: signal.signal(number, lambda *_: None) for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)}
    try:
        gc.collect()  # files that earlier tests dropped
        before = state(ran.parents[1])
        CALLS[name](tmp_path, ran)
        assert state(ran.parents[1]) == before
    finally:
        for number, handler in own.items():
            signal.signal(number, handler)
