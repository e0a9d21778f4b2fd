"""Stiffness and energy of a force that is a formula, by sympy; a program of its own, which imports nothing of ours.

It reads a request from standard input and writes one line of JSON for each thing found, the fast ones first: sympy may
never find an energy, and is stopped after some time (`lammps_inputs.formulas.expression.derived`).
"""

import ast
import json
import math
import resource
import sys
import time
from typing import Any

STRAIN, SQUARE = "s", "s_squared"


TIME_LIMIT = 10
"""Seconds of processor time from the end of sympy's import; an energy that is not found by then is not known."""


def symbols_of(signs: dict[str, int], sympy: Any) -> dict[str, Any]:
    """Symbols of parameters with the signs of their values; 0 for those that are 0."""
    kinds: dict[int, dict[str, Any]] = {1: {"positive": True}, -1: {"negative": True}}
    return {name: sympy.Symbol(name, **kinds[sign]) if sign else sympy.Integer(0) for name, sign in signs.items()}


def read(node: ast.AST, symbols: dict[str, Any], sympy: Any) -> Any:
    """The expression of a syntax tree that has passed `expression.tree`."""
    if isinstance(node, ast.Constant):
        return sympy.Rational(repr(node.value))
    if isinstance(node, ast.Name):
        return symbols[node.id]
    if isinstance(node, ast.UnaryOp):
        value = read(node.operand, symbols, sympy)
        return -value if isinstance(node.op, ast.USub) else value
    if isinstance(node, ast.BinOp):
        left, right = read(node.left, symbols, sympy), read(node.right, symbols, sympy)
        if isinstance(node.op, ast.Pow):
            return left**right
        if isinstance(node.op, ast.Mult):
            return left * right
        if isinstance(node.op, ast.Div):
            return left / right
        return left + right if isinstance(node.op, ast.Add) else left - right
    assert isinstance(node, ast.Call)
    assert isinstance(node.func, ast.Name)
    name = {"abs": "Abs"}.get(node.func.id, node.func.id)
    return getattr(sympy, name)(read(node.args[0], symbols, sympy))


def main() -> None:
    """Answer a request: ``{"force": text, "signs": {name: -1, 0 or 1}, "exponents": {name: number as text}}``."""
    import sympy

    # the first import after an installation compiles all of sympy, which may take as long as the integral
    limit = math.ceil(time.process_time()) + TIME_LIMIT
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))
    request = json.loads(sys.stdin.read())
    s, q = sympy.Symbol(STRAIN, real=True), sympy.Symbol(SQUARE, positive=True)
    symbols = symbols_of(request["signs"], sympy) | {STRAIN: s, "pi": sympy.pi}
    symbols |= {name: sympy.nsimplify(sympy.Rational(text)) for name, text in request["exponents"].items()}
    force = read(ast.parse(request["force"], mode="eval").body, symbols, sympy)

    def answer(**forms: Any) -> None:
        sys.stdout.write(json.dumps({name: str(form) for name, form in forms.items()}) + "\n")
        sys.stdout.flush()

    answer(stiffness=sympy.diff(force, s))
    energy = sympy.integrate(force, s)
    forms = [sympy.factor(energy)] if energy.is_rational_function(s) else []
    for form in (
        *forms,
        energy,
        energy.replace(sympy.log, lambda x: sympy.log(sympy.Abs(x))),
    ):  # some have logs below 0
        integral = form - form.subs(s, 0)
        if not integral.has(sympy.I):
            answer(energy=integral, even=integral.subs(s, sympy.sqrt(q)))


if __name__ == "__main__":
    main()
