"""The search: all designs where they can be counted out, else evolution, and at its end steps along each coordinate.

Evolution is scipy's differential evolution (Storn & Price, J. Global Optim. 11, 1997). Its course depends on the seed
and the worth of designs only: an interrupted search, started again, repeats the same designs, which are cached.
"""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import differential_evolution
from scipy.stats import qmc

from granchain.parts import Floats, columns, computations, evaluate, fields
from workflow.plugins.design.file import Design, Variable, values_of

# --- designs ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class DesignRecord:
    """One design.

    Attributes:
        values: field -> value.
        quantities: name -> value in the scene's units, None where undefined; only the mass where the mass breaks its
            limit; empty if refused.
        refused: why the design is no scene; empty if it is one.
        seconds: processor time, in s.
    """

    values: dict[str, Any]
    quantities: dict[str, float | None]
    refused: str
    seconds: float


Compute = Callable[[Sequence[dict[str, Any]]], list[DesignRecord]]
"""Function from designs, each as field -> value, to their records, in the same order."""


def computed(
    design: Design,
    designs: Sequence[dict[str, Any]],
    evaluated: Callable[..., list[Any]],
    *,
    limited: bool = True,
    **shown: Any,
) -> list[DesignRecord]:
    """Records of designs, each computed once.

    Args:
        design: the design file.
        designs: field -> value of each design.
        evaluated: cases -> their values (`workflow.study_kit.directory.Study.evaluating`).
        limited: whether only the mass is computed of designs whose mass breaks its limit.
        **shown: options of ``evaluated``.

    Raises:
        RunError: a process was killed.
    """
    limit = design.request.where.get(columns.MASS) if limited else None
    masses = (limit.low, limit.high) if limit else evaluate.NO_LIMIT
    scenes = [fields.put_all(design.scene, values) for values in designs]
    cases = [evaluate.case(scene, design.names, design.source, masses) for scene in scenes]
    results = evaluated(cases, **shown)
    return [
        DesignRecord(values, result.get("quantities", {}), result.get("refused", ""), result["seconds"])
        for values, result in zip(designs, results, strict=True)
    ]


RULED_OUT = 1e30
"""Worth of a design that violates a limit, over 1 + the violation: any design within the limits is better, and so is a
smaller violation (Deb, Comput. Methods Appl. Mech. Eng. 186, 2000).
"""


def worth(design: Design, record: DesignRecord) -> float:
    """Worth of a design, the smaller the better; infinite where it is no scene or its objective is undefined."""
    if record.refused:
        return math.inf
    limits = design.request.where
    broken = sum(limits[name].violation(record.quantities[name]) for name in limits if name in record.quantities)
    value = record.quantities.get(design.objective)
    if broken > 0.0:
        return RULED_OUT * (1.0 + broken)
    return math.inf if value is None or not math.isfinite(value) else design.sign * value


# --- search -----------------------------------------------------------------------------------------------------------

LEFT = 0.2
"""Share of the evaluations that is reserved for the steps at the end."""

STRIDES = (0.1, 0.03, 0.01, 0.003)
"""Lengths of the steps of a number, as shares of its range, in the order of their use."""


def search(design: Design, compute: Compute) -> list[DesignRecord]:
    """Records of all designs of the search, in the order in which it computes them; each once."""
    by_key: dict[str, DesignRecord] = {}

    def ask(vectors: Sequence[Floats]) -> list[float]:
        """Worth of the designs of vectors, each [coordinate]."""
        records = compute([values_of(design.variables, vector.tolist()) for vector in vectors])
        for record in records:
            by_key.setdefault(computations.key_of(record.values), record)
        return [worth(design, record) for record in records]

    if design.exhaustive:
        bounds = [variable.bounds for variable in _axes(design)]
        vectors = map(np.array, itertools.product(*(np.arange(low, high + 1.0) for low, high in bounds)))
        while batch := list(itertools.islice(vectors, design.population)):
            ask(batch)
    else:
        best = _evolved(design, ask)
        _stepped(design, ask, *best)
    return list(by_key.values())


def _axes(design: Design) -> list[Variable]:
    """The variable of each coordinate."""
    return [variable for variable in design.variables for _ in range(variable.coordinates)]


def _evolved(design: Design, ask: Any) -> tuple[Floats, float]:
    """Best vector of the evolution, [coordinate], and its worth."""
    low, high = np.array([variable.bounds for variable in _axes(design)]).T
    integer = np.array([variable.steps for variable in _axes(design)])
    generations = max(1, math.floor((1.0 - LEFT) * design.request.search.evaluations / design.population) - 1)
    first = qmc.scale(
        qmc.LatinHypercube(len(low), seed=design.request.search.seed).random(design.population),
        np.where(integer, low - 0.499, low),
        np.where(integer, high + 0.499, high),
    )
    first = np.where(integer, np.round(first), first)
    best: list[Any] = [first[0], math.inf]

    def together(_: Any, vectors: Any) -> list[float]:
        chosen = [np.where(integer, np.round(vector), vector) for vector in vectors]
        worths: list[float] = ask(chosen)
        k = int(np.argmin(worths))
        if worths[k] < best[1]:
            best[:] = chosen[k], worths[k]
        return worths

    differential_evolution(
        len,  # never called: `together` takes its place
        list(zip(low, high, strict=True)),
        maxiter=generations,
        init=np.clip(first, low, high),
        integrality=integer,
        workers=together,
        updating="deferred",
        polish=False,
        tol=0.0,
        mutation=(0.5, 1.0),
        recombination=0.9,
        seed=design.request.search.seed,
    )
    return best[0], best[1]


def _stepped(design: Design, ask: Any, vector: Floats, value: float) -> None:
    """Step from a vector to the best change of one coordinate, until none is better or no evaluations are left."""
    left = int(LEFT * design.request.search.evaluations)
    for stride in STRIDES:
        while True:
            around = _around(design, vector, stride)[:left]
            if not around:
                return
            left -= len(around)
            worths = ask(around)
            k = int(np.argmin(worths))
            if not worths[k] < value:
                break
            vector, value = around[k], worths[k]


def _around(design: Design, vector: Floats, stride: float) -> list[Floats]:
    vectors = []
    for place, variable in enumerate(_axes(design)):
        for other in _others(variable, float(vector[place]), stride):
            moved = vector.copy()
            moved[place] = other
            vectors.append(moved)
    return vectors


def _others(variable: Variable, at: float, stride: float) -> list[float]:
    """Other values of a coordinate: every choice, whole numbers on either side, or a stride up and down."""
    low, high = variable.bounds
    if variable.choices:
        return [float(k) for k in range(round(low), round(high) + 1) if k != round(at)]
    step = max(1.0, round(stride * (high - low))) if variable.steps else stride * (high - low)
    moved = {min(max(at + sign * step, low), high) for sign in (-1.0, 1.0)}
    return sorted(moved - {at})
