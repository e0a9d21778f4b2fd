"""Each name that plug-ins may use of the core has an example, which runs."""

import ast
import importlib
import inspect
from itertools import pairwise
from types import ModuleType

import pytest
from docstring_examples import PARTS, failures

import granchain
from workflow import lazy_names

FACE = lazy_names.sources(granchain.__file__)


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


@pytest.mark.parametrize("name", [*PARTS, "materials"])
def test_a_name_has_an_example_that_prints_what_is_written(name, tmp_path):
    """Examples of the functions and classes of `granchain` are those of `test_docstrings.py`."""
    text = documentation(name, PARTS if name in PARTS else FACE)
    assert ">>> " in text
    assert failures(text, tmp_path) == ""
