"""Examples in the docstrings of `granchain` and of what its functions return: they run, and print what is written."""

import doctest
import inspect
from functools import cached_property
from types import FunctionType

import pytest
from docstring_examples import failures

import granchain
from analysis.columns import Columns
from analysis.tracking.leading_waves import Waves
from analysis.trajectory import FramesInUnits, Trajectory
from lammps_inputs.scene import BaseScene
from workflow.runs.completed_run import Check, CompletedRun
from workflow.runs.run_directory import RunDirectory

SWEEP = {"scene": "one-chain", "vary": {"kick.velocity": [1.0, 2.0]}, "engine": "reference"}
BALL = {"name": "steel", "radius": 4.76e-3}
STEEL = {"name": "steel", "beads": 12, "material": BALL, "kick": {"velocity": 0.4}, "duration": 2e-4}

CLASSES = (
    *(kind for name in granchain.__all__ if inspect.isclass(kind := getattr(granchain, name))),
    *(CompletedRun, RunDirectory, Trajectory, FramesInUnits, Check, Waves, Columns, BaseScene),
)
FUNCTIONS = [function for name in dir(granchain) if inspect.isfunction(function := getattr(granchain, name))]
"""All of the module, also those of studies and tools."""


def examples():
    """Name of an object -> its examples."""
    finder = doctest.DocTestFinder(exclude_empty=True, recurse=False)
    objects = {"granchain": granchain} | {f"granchain.{function.__name__}": function for function in FUNCTIONS}
    for kind in CLASSES:
        objects[kind.__name__] = kind
        members = {name: value for name, value in vars(kind).items() if not name.startswith("_")}
        objects |= {f"{kind.__name__}.{name}": value for name, value in members.items() if inspect.getdoc(value)}
    return {
        name: tests[0]
        for name, thing in objects.items()
        if (tests := finder.find(getattr(thing, "__func__", thing), name, module=False, globs={})) and tests[0].examples
    }


EXAMPLES = examples()


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A directory with the runs `out` and `steel` and the sweep `swept`."""
    path = tmp_path_factory.mktemp("examples")
    granchain.run("two-chains", path / "out")
    granchain.run(STEEL, path / "steel", engine="reference")
    granchain.sweep(SWEEP, path / "swept", jobs=1)
    return path


@pytest.mark.slow
@pytest.mark.usefixtures("pool_here", "lammps_here")
@pytest.mark.parametrize("name", EXAMPLES)
def test_the_example_prints_what_is_written(name, place, tmp_path, monkeypatch):
    monkeypatch.chdir(place)
    assert failures(EXAMPLES[name].docstring, tmp_path) == ""


def test_every_function_and_what_results_have_is_shown_by_an_example():
    kinds = (granchain.Run, CompletedRun, granchain.Analysis, granchain.Validation, granchain.SweepTable)
    public = (FunctionType, property, cached_property)
    shown = {f"granchain.{function.__name__}" for function in FUNCTIONS}
    for kind in (*kinds, granchain.Group, granchain.WavesTable, Waves, Columns):
        members = vars(kind).items()
        shown |= {f"{kind.__name__}.{name}" for name, value in members if isinstance(value, public) and name[0] != "_"}
    # pandas and xarray need not be installed
    assert shown - set(EXAMPLES) == {"SweepTable.pandas", "WavesTable.pandas", "Run.dataset"}
