"""What plug-ins use of the core is documented: shapes, units, errors, and an example of each name, which runs."""

import ast
import functools
import importlib
import inspect
import re
import textwrap
from itertools import pairwise
from pathlib import Path
from types import ModuleType

import pytest
from docstring_examples import PARTS, failures

import granchain
from granchain import parts
from workflow import lazy_names

PLUG_INS = Path(granchain.__file__).parents[2] / "plugins"
FACE = lazy_names.sources(granchain.__file__)

ARRAY = re.compile(r"NDArray|ndarray|Floats|Integers|Flags|Parameter\b")
WITHOUT_UNIT = re.compile(r"int64|uint64|bool|Integers|Flags")
SHAPE = re.compile(r"\[[^\]]+\]")
UNIT = re.compile(r"\bunits?\b|dimensionless")
ERRORS = ("InputError", "RunError", "ValueError")
EXAMPLE = ">>> "


# --- what there is to document ----------------------------------------------------------------------------------------


def attributes(source):
    """(module of `granchain.parts`, attribute) of all uses of an attribute in a source of a plug-in."""
    tree = list(ast.walk(ast.parse(source)))
    imports = [node for node in tree if isinstance(node, ast.ImportFrom) and node.module == "granchain.parts"]
    modules = {alias.asname or alias.name: alias.name for node in imports for alias in node.names}
    nodes = [node for node in tree if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)]
    return {(modules[node.value.id], node.attr) for node in nodes if node.value.id in modules}


@functools.cache
def things():
    """Name -> function or class that plug-ins use: of `granchain.parts`, or as an attribute of a module of it."""
    objects = {name: getattr(parts, name) for name in PARTS}
    uses = set().union(*(attributes(path.read_text(encoding="utf-8")) for path in PLUG_INS.rglob("*.py")))
    for module, attribute in sorted(uses):
        objects[f"{module}.{attribute}"] = getattr(objects[module], attribute, None)  # None: of a local variable
    return {name: thing for name, thing in objects.items() if inspect.isfunction(thing) or inspect.isclass(thing)}


def assigned(module, name):
    """String that follows the assignment of a name in a module: the documentation of a constant or an alias."""
    body = ast.parse(inspect.getsource(module)).body
    for statement, following in pairwise(body):
        target = statement.target if isinstance(statement, ast.AnnAssign) else getattr(statement, "targets", [None])[0]
        if isinstance(target, ast.Name) and target.id == name and isinstance(following, ast.Expr):
            return inspect.cleandoc(ast.literal_eval(following.value))
    return ""


def documentation(name, sources):
    """Docstring of a name: of the module, class or function that it is, or the string after its assignment."""
    module, attribute = sources[name]
    thing = lazy_names.imported(module, attribute)
    if inspect.isfunction(thing) or inspect.isclass(thing) or isinstance(thing, ModuleType):
        return inspect.getdoc(thing) or ""
    return assigned(importlib.import_module(module), attribute)


# --- docstrings -------------------------------------------------------------------------------------------------------


def section(docstring, title):
    """Text of a section, such as ``Args``; empty without it."""
    return docstring.partition(f"\n{title}:\n")[2].partition("\n\n")[0]


def entries(docstring, title):
    """Name -> text of each entry of a section; a line may name several."""
    texts = {}
    names = []
    for line in section(docstring, title).splitlines():
        if named := re.match(r" {4}(\w[\w, ]*): (.*)", line):
            names = named[1].split(", ")
        texts |= {name: f"{texts.get(name, '')} {line.strip()}" for name in names}
    return texts


def undocumented(function):
    """What the docstring of a function lacks: shapes and units of arrays, and errors that it raises itself."""
    function = inspect.unwrap(function)
    docstring, signature = inspect.getdoc(function) or "", inspect.signature(function)
    kinds = {name: str(parameter.annotation) for name, parameter in signature.parameters.items()}
    arguments, head = entries(docstring, "Args"), docstring.partition("\nArgs:\n")[0]
    texts = {name: (kind, arguments.get(name, "")) for name, kind in kinds.items()}
    texts["result"] = str(signature.return_annotation), head + section(docstring, "Returns")
    lacking = []
    for name, (kind, text) in texts.items():
        if ARRAY.search(kind):
            lacking += [] if SHAPE.search(text) else [f"{name}: shape"]
            lacking += [] if WITHOUT_UNIT.search(kind) or UNIT.search(text) else [f"{name}: unit"]
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    calls = [node.exc for node in ast.walk(tree) if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call)]
    raised = {ast.unparse(call.func) for call in calls} & set(ERRORS)
    return lacking + [f"raises {name}" for name in sorted(raised - set(entries(docstring, "Raises")))]


@pytest.mark.slow
@pytest.mark.parametrize("name", list(things()))
def test_what_plug_ins_use_has_a_docstring_with_shapes_units_and_errors(name):
    thing = things()[name]
    assert thing.__doc__
    if inspect.isfunction(thing):
        assert undocumented(thing) == []


# --- examples ---------------------------------------------------------------------------------------------------------

NAMES = [(name, PARTS) for name in PARTS] + [(name, FACE) for name in FACE if name not in PARTS]
RUN_HERE = [*PARTS, "materials"]
"""All but the functions and classes of `granchain`, whose examples run in `test_docstrings.py`."""


@pytest.mark.parametrize(("name", "sources"), NAMES, ids=[name for name, _ in NAMES])
def test_a_name_has_an_example(name, sources):
    assert EXAMPLE in documentation(name, sources)


@pytest.mark.parametrize("name", RUN_HERE)
def test_the_example_of_a_name_prints_what_is_written(name, tmp_path):
    assert failures(documentation(name, PARTS if name in PARTS else FACE), tmp_path) == ""


# --- the test itself --------------------------------------------------------------------------------------------------
