"""Formulas as text: which may be read, their values, and how others spell them.

A formula is checked by Python's syntax tree before anything else happens to it: names, numbers, ``+ - * / ^ **``,
brackets and the functions of `FUNCTIONS`; nothing is ever evaluated as Python but what passed. Nothing here knows what
a formula is of.
"""

import ast
import functools
import json
import re
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lammps_inputs.formulas import derivation

Floats = NDArray[np.float64]

STRAIN, SQUARE = derivation.STRAIN, derivation.SQUARE

LONGEST, DEEPEST = 300, 40
"""Characters and depth of a formula."""

_NUMPY = {"asin": "arcsin", "acos": "arccos", "atan": "arctan", "asinh": "arcsinh", "acosh": "arccosh"}
_NUMPY |= {"atanh": "arctanh"}

FUNCTIONS = ("sqrt", "exp", "log", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "abs")
"""Functions that a formula may hold; each of one argument."""

_FOUND = (*FUNCTIONS, "sign", "asinh", "acosh", "atanh")
"""Functions that may stand in what sympy finds."""

_LOGS = {
    "sinh": "((exp({0})-exp(-({0})))/2.0)",
    "cosh": "((exp({0})+exp(-({0})))/2.0)",
    "tanh": "(1.0-2.0/(exp(2.0*({0}))+1.0))",
    "log": "ln({0})",
}
"""Functions that variables of LAMMPS have by another name, or not."""

_OPERATORS: dict[type[ast.operator], str] = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**"}


class FormulaError(ValueError):
    """A text that is no formula; says what is wrong, and where."""


@functools.lru_cache(maxsize=256)
def tree(text: str, functions: tuple[str, ...] = FUNCTIONS) -> ast.expr:
    """The syntax tree of a formula.

    Raises:
        FormulaError: it is none, or holds what no formula may.
    """
    if len(text) > LONGEST and functions is FUNCTIONS:
        raise FormulaError(f"{len(text)} characters; at most {LONGEST}")
    if invalid := re.search(r"[^\w\s.+\-*/^()]", text, re.ASCII):
        raise FormulaError(f"holds {invalid[0]!r}; {_allowed()}")
    try:
        body = ast.parse(text.strip().replace("^", "**"), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        reason = error.msg if isinstance(error, SyntaxError) else "too deep"
        raise FormulaError(f"is no formula ({reason}); {_allowed()}") from None
    _check(body, functions, DEEPEST if functions is FUNCTIONS else 10 * DEEPEST)
    return body


def _allowed() -> str:
    return f"valid: names, numbers, + - * / ^ ( ) and {', '.join(FUNCTIONS)}"


def _check(node: ast.AST, functions: tuple[str, ...], depth: int) -> None:
    if depth == 0:
        raise FormulaError("is too deep; write it with fewer brackets")
    if isinstance(node, ast.Constant):
        if isinstance(node.value, bool) or not isinstance(node.value, int | float) or not abs(node.value) < 1e100:
            raise FormulaError(f"holds {ast.unparse(node)[:40]}; numbers below 1e100")
    elif isinstance(node, ast.Call):
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        if name not in functions:
            raise FormulaError(f"holds {ast.unparse(node.func)[:40]}(...); {_allowed()}")
        if len(node.args) != 1 or node.keywords:
            raise FormulaError(f"gives {name} {len(node.args) + len(node.keywords)} arguments; one is valid")
        _check(node.args[0], functions, depth - 1)
    elif isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
        _check(node.left, functions, depth - 1)
        _check(node.right, functions, depth - 1)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
        _check(node.operand, functions, depth - 1)
    elif isinstance(node, ast.Name):
        if node.id in functions:
            raise FormulaError(f"names {node.id} without an argument; valid: {node.id}(...)")
    else:
        raise FormulaError(f"holds {ast.unparse(node)[:40]!r}; {_allowed()}")


def names(text: str) -> tuple[str, ...]:
    """Names in a formula that are neither functions nor pi, in their order; with the strain."""
    body = tree(text)
    called = {id(node.func) for node in ast.walk(body) if isinstance(node, ast.Call)}
    variables = (node.id for node in ast.walk(body) if isinstance(node, ast.Name) and id(node) not in called)
    return tuple(sorted(set(variables) - {"pi"}))


def in_exponents(text: str) -> frozenset[str]:
    """Names that stand in exponents: what sympy finds depends on their values."""
    powers = (node for node in ast.walk(tree(text)) if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow))
    inside = (name.id for power in powers for name in ast.walk(power.right) if isinstance(name, ast.Name))
    return frozenset(inside) & frozenset(names(text)) - {STRAIN}


def has_root(text: str, name: str) -> bool:
    """Whether a formula holds a power of a name with an exponent that is not an integer, or its logarithm."""
    for node in ast.walk(tree(text, _FOUND)):
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
            base, integer = node.left, _integer(node.right) is not None
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in ("sqrt", "log"):
            base, integer = node.args[0], False
        else:
            continue
        if isinstance(base, ast.Name) and base.id == name and not integer:
            return True
    return False


def size(text: str) -> str:
    """A formula of how large a formula would be if the terms of its sums did not cancel, which bounds its rounding."""
    return _size(tree(text, _FOUND))


def _size(node: ast.expr) -> str:
    if isinstance(node, ast.UnaryOp):
        return _size(node.operand)
    if isinstance(node, ast.BinOp) and not isinstance(node.op, ast.Pow):
        if isinstance(node.op, ast.Div):
            return f"({_size(node.left)}/abs({ast.unparse(node.right)}))"
        return f"({_size(node.left)}{'*' if isinstance(node.op, ast.Mult) else '+'}{_size(node.right)})"
    return f"abs({ast.unparse(node)})"


@functools.lru_cache(maxsize=256)
def vanishing(text: str) -> tuple[str, ...]:
    """Parts of a formula where it may be infinite if one is 0: divisors, bases of powers, cosines of tangents."""
    parts: list[ast.expr] = []
    for node in ast.walk(tree(text, _FOUND)):
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div):
            parts.append(node.right)
        elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
            exponent = _integer(node.right)
            parts += [node.left] if exponent is None or exponent.startswith("(") else []
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in ("log", "tan"):
            cosine = ast.Call(ast.Name("cos"), node.args, [])
            parts.append(cosine if node.func.id == "tan" else node.args[0])
    texts = dict.fromkeys(ast.unparse(part) for part in parts)
    return tuple(part for part in texts if STRAIN in names(part))


class Derived(NamedTuple):
    """A force and what follows from it, as texts in Python's spelling; empty where it is not known.

    Attributes:
        force: force at the strain `STRAIN`.
        stiffness: slope of the force.
        energies: forms of the integral of the force from 0.
        even: forms of that integral in `SQUARE`, the strain squared, for a positive strain.
    """

    force: str
    stiffness: str = ""
    energies: tuple[str, ...] = ()
    even: tuple[str, ...] = ()


@functools.lru_cache(maxsize=256)
def derived(force: str, signs: tuple[tuple[str, int], ...], exponents: tuple[tuple[str, str], ...]) -> Derived:
    """Stiffness and energies that sympy finds for a force, in a separate process.

    Args:
        force: text in Python's spelling that passed `tree`.
        signs: signs of the parameters' values.
        exponents: values of the parameters that stand in exponents.
    """
    request = {"force": force, "signs": dict(signs), "exponents": dict(exponents)}
    command = [sys.executable, "-P", str(Path(derivation.__file__))]
    done = subprocess.run(command, input=json.dumps(request).encode(), capture_output=True, check=False)
    if b"ModuleNotFoundError" in done.stderr:
        raise FormulaError("needs sympy, which is not installed; `pip install sympy`")
    forms: dict[str, list[str]] = {"stiffness": [], "energy": [], "even": []}
    for line in done.stdout.decode().splitlines():
        for kind, text in json.loads(line).items():
            forms[kind] += [form] if (form := _readable(text)) else []
    stiffness = next(iter(forms["stiffness"]), "")
    energies, even = (tuple(dict.fromkeys(forms[kind])) for kind in ("energy", "even"))
    return Derived(force, stiffness, energies, even)


def _readable(text: str) -> str:
    """Text of sympy's in the functions of a formula; empty where it needs others."""
    text = re.sub(r"\bE\b", "exp(1)", text.replace("Abs(", "abs("))
    try:
        tree(text, _FOUND)
    except FormulaError:
        return ""
    return text


_PYTHON = ("plain", "python")


def written(text: str, replacements: Mapping[str, str], style: str) -> str:
    """A formula with all brackets, and other names or numbers in place of its own.

    Args:
        text: text of the formula.
        replacements: text that replaces each name.
        style: ``plain``, ``python`` (with NumPy), ``lepton`` (LAMMPS's potentials), or ``variable`` (those of LAMMPS).

    Raises:
        FormulaError: the style has no such function.
    """
    return _written(tree(text, _FOUND), replacements | {"pi": repr(float(np.pi))}, style)  # type: ignore[operator]


def _written(node: ast.AST, replacements: Mapping[str, str], style: str) -> str:
    def inside(part: ast.AST) -> str:
        return _written(part, replacements, style)

    if (
        style not in _PYTHON
        and not isinstance(node, ast.Constant | ast.Name)
        and (number := _number(node, replacements))
    ):
        return number
    if isinstance(node, ast.Constant):
        return repr(float(node.value))  # type: ignore[arg-type]
    if isinstance(node, ast.Name):
        return replacements[node.id]
    if isinstance(node, ast.UnaryOp):
        sign = "-" if isinstance(node.op, ast.USub) else ""
        return (
            f"({sign}{inside(node.operand)})" if style in _PYTHON else f"({'0.0-' * bool(sign)}{inside(node.operand)})"
        )
    if isinstance(node, ast.BinOp):
        right = node.right
        power = isinstance(node.op, ast.Pow)
        integer = _integer(right) if power else None
        sign = "^" if power and style not in _PYTHON else _OPERATORS[type(node.op)]
        return f"({inside(node.left)}{sign}{inside(right) if integer is None else integer})"
    assert isinstance(node, ast.Call)
    assert isinstance(node.func, ast.Name)
    name, argument = node.func.id, inside(node.args[0])
    if style == "python":
        return f"np.{_NUMPY.get(name, name)}({argument})"
    if style == "plain":
        return f"{name}({argument})"
    if name not in FUNCTIONS:
        raise FormulaError(f"LAMMPS has no {name}")
    return _LOGS[name].format(argument) if style == "variable" and name in _LOGS else f"{name}({argument})"


def _number(node: ast.AST, replacements: Mapping[str, str]) -> str:
    """The value of what holds no name but those of numbers; empty of all else."""
    called = {id(part.func) for part in ast.walk(node) if isinstance(part, ast.Call)}
    names = {part.id for part in ast.walk(node) if isinstance(part, ast.Name) and id(part) not in called}
    try:
        values = [float(replacements[name].strip("()")) for name in sorted(names)]
    except ValueError:
        return ""
    value = float(function(ast.unparse(node), (STRAIN, *sorted(names)))(0.0, *values))
    return f"({value!r})" if value < 0.0 else repr(value)


def _integer(node: ast.AST) -> str | None:
    """Text of an integer exponent, which stays an integer, for its powers are products; None of all else."""
    sign = ""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        node, sign = node.operand, "-"
    if isinstance(node, ast.Constant) and float(node.value) == int(node.value) and abs(node.value) < 100:  # type: ignore[arg-type]
        return f"({sign}{int(node.value)})" if sign else str(int(node.value))  # type: ignore[arg-type]
    return None


@functools.lru_cache(maxsize=256)
def function(text: str, arguments: tuple[str, ...]) -> Callable[..., Floats]:
    """A formula as a function of arrays that broadcast to a common shape; NaN or inf where it has no real value."""
    source = written(text, {name: name for name in arguments}, "python")
    code = compile(f"lambda {', '.join(arguments)}: {source}", "<formula>", "eval")
    raw = eval(code, {"np": np, "__builtins__": {}})  # all of it passed `tree`

    def value(*numbers: Any) -> Floats:
        """Value of the formula, an array of the arguments' common shape."""
        with np.errstate(all="ignore"):
            try:
                values = raw(*(np.asarray(number, dtype=np.float64)[()] for number in numbers))
            except (OverflowError, ZeroDivisionError):  # numbers of the formula alone
                values = np.nan
            return np.asarray(values + 0.0 * numbers[0], dtype=np.float64)

    return value
