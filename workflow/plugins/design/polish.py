"""Steps from the best design of a search by sequential quadratic programming, with derivatives from the tangent flow.

Kraft's SLSQP of scipy: DFVLR-FB 88-28 (1988). Only fields that hold one number which need not be whole are changed.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.optimize import minimize

from granchain import InputError
from granchain.parts import Floats, computations, fields, library
from workflow.plugins.derivatives import tangent
from workflow.plugins.derivatives.gradient import why_no_derivative
from workflow.plugins.design.file import Design, Variable, values_of
from workflow.plugins.design.search import DesignRecord

STEPS = 30
"""Largest number of steps; one takes an evaluation, or a few."""

MARGIN = 1e-6
"""Relative distance that is kept from limits, so that the rounded design is within them."""

CLOSE = 1e-10
"""Relative change of the objective, over its value at the start, at which the steps end."""


class _NoValueError(Exception):
    """A quantity is undefined at a design, or it is no scene."""


def refuse_no_gradient(design: Design) -> None:
    """Refuse a design file without a field for derivatives, or whose objective has none, or whose scene.

    Raises:
        InputError: names the file.
    """
    if reason := why_no_derivative(design.objective):
        raise InputError(f"{design.source}: --gradient: {reason}")
    if not smooth(design):
        raise InputError(f"{design.source}: --gradient: no varied field is one number that need not be whole")
    middle = [0.5 * sum(variable.bounds) for variable in design.variables for _ in range(variable.coordinates)]
    plain = fields.put_all(design.scene, values_of(design.variables, middle))
    try:
        tangent.refuse_without_slope(library.from_plain(plain, design.source).system)
    except InputError as error:
        raise InputError(f"{design.source}: --gradient: {error}") from None


def smooth(design: Design) -> list[Variable]:
    """Varied fields that hold one number which need not be whole."""
    return [variable for variable in design.variables if not variable.steps and variable.places is None]


def polished(
    design: Design, start: DesignRecord, evaluated: Callable[[list[computations.Computation]], list[Any]]
) -> dict[str, Any]:
    """Values of the fields, field -> value, after the steps from a design; the design's own if there are none.

    Args:
        design: the design file.
        start: a design within the limits.
        evaluated: cases -> their values (`workflow.study_kit.directory.Study.evaluating`).
    """
    variables = smooth(design)
    low, high = np.array([variable.bounds for variable in variables]).T
    names = [variable.field for variable in variables]
    size = max(abs(start.quantities.get(design.objective) or 0.0), 1e-300)
    computed: dict[bytes, tuple[dict[str, float], dict[str, Floats]]] = {}

    def values_at(shares: Floats) -> dict[str, Any]:
        """Field -> value, at shares [field] of the ranges."""
        coordinates = low + np.clip(shares, 0.0, 1.0) * (high - low)
        moved = {v.field: v.value([float(at)]) for v, at in zip(variables, coordinates, strict=True)}
        return {**start.values, **moved}

    def at(shares: Floats) -> tuple[dict[str, float], dict[str, Floats]]:
        """Quantities, and their derivatives by shares of the ranges, at shares [field]."""
        if shares.tobytes() not in computed:
            values = values_at(shares)
            [answer] = evaluated([_slopes(design, values, names)])
            if "refused" in answer or None in [*answer["values"], *np.ravel(answer["slopes"]).tolist()]:
                raise _NoValueError
            by_share = [(high[k] - low[k]) * (values[v.field] if v.log else 1.0) for k, v in enumerate(variables)]
            slopes = np.array(answer["slopes"], dtype=np.float64) * by_share
            computed[shares.tobytes()] = (
                dict(zip(design.names, answer["values"], strict=True)),
                dict(zip(design.names, slopes, strict=True)),
            )
        return computed[shares.tobytes()]

    sign = design.sign / size
    begin = np.array([v.coordinate(start.values[v.field]) for v in variables])
    begin = (begin - low) / (high - low)
    try:
        end = minimize(
            lambda shares: sign * at(shares)[0][design.objective],
            begin,
            jac=lambda shares: sign * at(shares)[1][design.objective],
            method="SLSQP",
            bounds=[(0.0, 1.0)] * len(variables),
            constraints=_constraints(design, at),
            options={"maxiter": STEPS, "ftol": CLOSE},
        )
    except _NoValueError:
        return start.values
    return values_at(end.x)


def _slopes(design: Design, values: dict[str, Any], by: list[str]) -> computations.Computation:
    """Quantities of a design and their derivatives by some of its fields, as a case."""
    arguments = {
        "plain": fields.put_all(design.scene, values),
        "names": design.names,
        "by": by,
        "source": design.source,
    }
    return computations.case("workflow.plugins.derivatives.gradient:values_and_slopes", arguments)


def _constraints(design: Design, at: Callable[[Floats], Any]) -> list[dict[str, Any]]:
    """Limits of quantities as scipy takes them: functions that are at least 0, over the size of the limit."""
    constraints = []
    for name, limit in design.request.where.items():
        for bound, sign in ((limit.low, 1.0), (limit.high, -1.0)):
            if bound is not None:
                constraints.append(_constraint(name, float(bound), sign, at))
    return constraints


def _constraint(name: str, bound: float, sign: float, at: Callable[[Floats], Any]) -> dict[str, Any]:
    size = max(abs(bound), 1e-12)
    return {
        "type": "ineq",
        "fun": lambda shares: sign * (at(shares)[0][name] - bound) / size - MARGIN,
        "jac": lambda shares: sign * at(shares)[1][name] / size,
    }
