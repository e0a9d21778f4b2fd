"""Arguments of the functions of `granchain`: what one cannot be ends in a line that names it, before anything runs."""

import inspect
import itertools
import re

import numpy as np
import pytest

import granchain
from lammps_inputs import InputError, Scene

SCENE = {"name": "tiny", "beads": 8, "kick": {"velocity": 1.0}, "duration": 4.0}
FUNCTIONS = {
    name: function for name in dir(granchain) if inspect.isfunction(function := getattr(granchain, name, None))
}
VALID = {
    "scene": SCENE,
    "run": "there-is-none",
    "run_or_sweep": "there-is-none",
    "against": "there-is-none",
    "path": "there-is-none",
    "definition": {"scene": SCENE, "vary": {"kick.velocity": [1.0]}, "engine": "reference"},
    "deck": "there-is-none",
    "to": "csv",
    "free": ["kick.velocity"],
    "where": {"peak_velocity@5": 1.0},
    "vary": {"kick.velocity": (1.0, 2.0)},
    "quantity": "speed",
    "over": "kick.velocity",
    "table": granchain.SweepTable([], [], si=False),
}
"""A value of each argument that has no default."""

WRONG = (
    *(None, -1, -1.5, float("nan"), float("inf"), 10**400, True),
    *("", "no such word", b"bytes", "\0", object(), [object()], {"no such word": object()}, {1: 2}, ()),
    *(np.array(2.5), np.full((2, 2), np.nan), np.float64("nan"), Scene, len),
)


def arguments(function):
    """Name of each argument, also of those beside the signature, and whether it has a default."""
    for name, each in inspect.signature(function).parameters.items():
        if each.kind is inspect.Parameter.VAR_KEYWORD:
            [options] = each.annotation.__args__
            yield from ((option, True) for option in options.__annotations__)
        else:
            yield name, each.default is not inspect.Parameter.empty


def valid(function, place):
    """Valid values of the arguments without a default, of which the directory is a new one."""
    needed = [name for name, has_default in arguments(function) if not has_default]
    return {name: str(place / "new") if name == "directory" else VALID[name] for name in needed}


OPTION = re.compile(r"(?<![\w-])(--[a-z]|-o\b)")
"""An option of the command line, which no message of a function names but within a quoted command."""


BEGUN = {"explore": "workflow.plugins.explore.notebook.ExplorerPage", "trade": "workflow.plugins.trade.function.study"}
"""Functions that compute without the worker pool, and what they begin with."""


@pytest.fixture(autouse=True)
def nothing_runs(monkeypatch):
    """A function that gets past its arguments and its files ends there."""
    from workflow.runs import run
    from workflow.workers import pool

    def begun(*_, **__):
        raise granchain.RunError("begun")

    for name in BEGUN.keys() & FUNCTIONS:
        monkeypatch.setattr(BEGUN[name], begun)
    monkeypatch.setattr(run, "run_prepared", begun)
    monkeypatch.setattr(run, "settle", begun)
    monkeypatch.setattr(pool.Pool, "__enter__", begun)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_name_that_no_argument_has_one_that_is_missing_and_a_value_of_no_kind_are_refused(name, tmp_path):
    function = FUNCTIONS[name]
    names, given = dict(arguments(function)), valid(function, tmp_path)
    first = next(iter(names))
    with pytest.raises(InputError, match=f"^{first}x: is no argument of {name} \\(did you mean `{first}`"):
        function(**given, **{f"{first}x": 1})
    for missing in list(given)[:1]:
        with pytest.raises(InputError, match=f"^{missing}: is missing"):
            function()
    for argument in names:
        with pytest.raises(InputError, match=rf"^{argument}: <object object at \w+> given; \S") as refused:
            function(**{**given, argument: object()})
        assert "--" not in str(refused.value)
    assert not (tmp_path / "new").exists()


@pytest.mark.slow
@pytest.mark.parametrize("name", FUNCTIONS)
def test_whatever_an_argument_is_ends_in_our_errors_alone(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    function = FUNCTIONS[name]
    for (argument, _), value in itertools.product(arguments(function), WRONG):
        said = ""
        try:
            function(**{**valid(function, tmp_path), argument: value})
        except (InputError, granchain.RunError) as error:
            said = str(error)
        assert "\n" not in said
        assert not OPTION.search(re.sub("`[^`]*`", "", said))


CALLS = (
    lambda: granchain.validate("out", tolerances={"velocty": 1}),
    lambda: granchain.validate("out", tolerances={"velocity": -1}),
    lambda: granchain.load("two-chains", ["coupling"]),
    lambda: granchain.sweep([1], "new"),
    lambda: granchain.analyze("out", gradient=3),
    lambda: granchain.analyze("out", beads=[1, 2.5]),
    lambda: granchain.run(SCENE, "new", ranks=0),
    lambda: granchain.run(SCENE, "new", ranks=1.0),
    lambda: granchain.run(SCENE, "new", "lammps"),
)


def test_a_value_that_cannot_be_is_refused_with_what_can(tmp_path, monkeypatch, golden):
    monkeypatch.chdir(tmp_path)
    said = []
    for call in CALLS:
        with pytest.raises(InputError) as refused:
            call()
        said.append(str(refused.value))
    golden("arguments", "\n".join(said))
    assert not list(tmp_path.iterdir())


def numpy_of(data):
    """The same data with numbers of NumPy, arrays and tuples."""
    if isinstance(data, dict):
        return {key: numpy_of(value) for key, value in data.items()}
    if isinstance(data, list):
        return tuple(map(numpy_of, data)) if any(isinstance(value, dict | str) for value in data) else np.array(data)
    kinds = {bool: np.bool_, int: np.int64, float: np.float64}
    return kinds.get(type(data), lambda value: value)(data)


@pytest.mark.parametrize("name", ["two-chains", "precompressed", "disordered-chain"])
def test_a_scene_of_numbers_of_numpy_is_that_of_python(name):
    plain = granchain.load(name).plain()
    assert granchain.load(numpy_of(plain)) == granchain.load(plain) == Scene(**numpy_of(plain))
    assert granchain.load(numpy_of(plain)).plain() == plain
