"""What belongs to the whole process is after every public function what it was before: it is a script's."""

import gc
from types import FunctionType

import pytest
from global_state import SCENE, assert_state_remains

import granchain
from lammps_inputs import plugins
from workflow.cli import main

SWEEP = {"scene": SCENE, "vary": {"kick.velocity": [1.0, 2.0]}, "engine": "reference"}

CALLS = {
    "load": lambda _, __: granchain.load("two-chains"),
    "run": lambda path, _: granchain.run(SCENE, path / "new"),
    "analyze": lambda _, run: granchain.analyze(run, figures=True),
    "open": lambda _, run: [granchain.open(run).analysis, granchain.open(run).si],
    "resume": lambda _, run: granchain.resume(run),
    "deck": lambda path, _: granchain.deck(SCENE, path / "new"),
    "validate": lambda _, run: granchain.validate(run),
    "trace_file": lambda path, _: granchain.trace_file(path / "scope.csv", {"time": "TIME"}),
    "universe": lambda _, run: [*(ts.frame for ts in granchain.universe(run).trajectory), gc.collect()],
    "collect": lambda _, run: granchain.collect(run.parent),
    "plot": lambda _, run: granchain.plot(granchain.collect(run.parent), "peak_velocity", "kick.velocity"),
    "statistics": lambda _, run: granchain.statistics(granchain.collect(run.parent), "peak_velocity"),
    "sweep": lambda path, _: granchain.sweep(SWEEP, path / "new", jobs=2),
    "main, done": lambda path, _: main(["run", "one-chain", "-o", str(path / "new"), "--engine", "reference"]),
    "main, refused": lambda path, _: main(["analyze", str(path)]),
    "main, help": lambda _, __: explained(),
}
SLOW = ("sweep",)


def explained():
    with pytest.raises(SystemExit):
        main(["--help"])


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """A run, of a sweep."""
    path = tmp_path_factory.mktemp("ran") / "sweep"
    granchain.sweep(SWEEP, path, jobs=1)
    return next(path.glob("*/run.json")).parent


def test_every_public_function_is_asked():
    public = set(dir(granchain)) - plugins.declared("functions").keys()
    functions = {name for name in public if isinstance(getattr(granchain, name), FunctionType)}
    assert {name for name in CALLS if not name.startswith("main")} == functions


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.slow] * (name in SLOW)) for name in CALLS])
def test_it_is_as_before(name, ran, tmp_path, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")  # bars of progress have threads
    assert_state_remains(lambda: CALLS[name](tmp_path, ran), ran.parents[1])
