"""The search: all designs where they can be counted out, else evolution, and at its end steps along each coordinate.

Evolution is scipy's differential evolution (Storn & Price, J. Global Optim. 11, 1997). Its course follows from the seed
and from what designs are worth alone: one that was interrupted goes the same way again, through what is remembered.
"""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import differential_evolution
from scipy.stats import qmc

from analysis.trajectory import Floats
from workflow.studies.design.file import Design, Variable, values_of
from workflow.study_kit import scene_quantities
from workflow.sweep import fields
from workflow.workers.evaluate import key_of

# --- designs ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class DesignRecord:
    """One design.

    Attributes:
        values: field -> value.
        quantities: name -> value, None where it has none; no more than the mass where that rules it out; empty if
            refused.
        refused: why it is no scene; empty if it is one.
        seconds: processor time.
    """

    values: dict[str, Any]
    quantities: dict[str, float | None]
    refused: str
    seconds: float


Compute = Callable[[Sequence[dict[str, Any]]], list[DesignRecord]]
"""Designs, each field -> value -> their records, in their order."""


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
        design: the objective.
        designs: each field -> value.
        evaluated: cases -> their values (`workflow.study_kit.directory.Study.evaluating`).
        limited: whether no more than the mass is computed of those that it rules out.
        **shown: options of ``evaluated``.

    Raises:
        RunError: a process was killed.
    """
    limit = design.asked.where.get(scene_quantities.MASS) if limited else None
    masses = (limit.low, limit.high) if limit else scene_quantities.NO_LIMIT
    scenes = [fields.put_all(design.scene, values) for values in designs]
    cases = [scene_quantities.case(scene, design.names, design.source, masses) for scene in scenes]
    found = evaluated(cases, **shown)
    return [
        DesignRecord(values, one.get("quantities", {}), one.get("refused", ""), one["seconds"])
        for values, one in zip(designs, found, strict=True)
    ]


RULED_OUT = 1e30
"""Worth of what violates a limit, times one and by how much, so that any other is better and less is better (Deb,
Comput. Methods Appl. Mech. Eng. 186, 2000)."""


def worth(design: Design, record: DesignRecord) -> float:
    """The smaller the better; infinite of what is no scene."""
    if record.refused:
        return math.inf
    limits = design.asked.where
    broken = sum(limits[name].violation(record.quantities[name]) for name in limits if name in record.quantities)
    value = record.quantities.get(design.objective)
    if broken > 0.0:
        return RULED_OUT * (1.0 + broken)
    return math.inf if value is None or not math.isfinite(value) else design.sign * value


# --- search -----------------------------------------------------------------------------------------------------------

LEFT = 0.2
"""Share of the evaluations that is left for the steps at the end."""

STRIDES = (0.1, 0.03, 0.01, 0.003)
"""Of a number, in its range, one after the other."""


def search(design: Design, compute: Compute) -> list[DesignRecord]:
    """Records of all designs that were asked for, in that order; each once."""
    asked: dict[str, DesignRecord] = {}

    def ask(vectors: Sequence[Floats]) -> list[float]:
        records = compute([values_of(design.variables, vector.tolist()) for vector in vectors])
        for record in records:
            asked.setdefault(key_of(record.values), record)
        return [worth(design, record) for record in records]

    if design.exhaustive:
        bounds = [variable.bounds for variable in _axes(design)]
        vectors = map(np.array, itertools.product(*(np.arange(low, high + 1.0) for low, high in bounds)))
        while batch := list(itertools.islice(vectors, design.population)):
            ask(batch)
    else:
        best = _evolved(design, ask)
        _stepped(design, ask, *best)
    return list(asked.values())


def _axes(design: Design) -> list[Variable]:
    """The variable of each coordinate."""
    return [variable for variable in design.variables for _ in range(variable.coordinates)]


def _evolved(design: Design, ask: Any) -> tuple[Floats, float]:
    """The best vector of the evolution, and its worth."""
    low, high = np.array([variable.bounds for variable in _axes(design)]).T
    whole = np.array([variable.steps for variable in _axes(design)])
    generations = max(1, math.floor((1.0 - LEFT) * design.asked.search.evaluations / design.population) - 1)
    first = qmc.scale(
        qmc.LatinHypercube(len(low), seed=design.asked.search.seed).random(design.population),
        np.where(whole, low - 0.499, low),
        np.where(whole, high + 0.499, high),
    )
    first = np.where(whole, np.round(first), first)
    best: list[Any] = [first[0], math.inf]

    def together(_: Any, vectors: Any) -> list[float]:
        chosen = [np.where(whole, np.round(vector), vector) for vector in vectors]
        found: list[float] = ask(chosen)
        k = int(np.argmin(found))
        if found[k] < best[1]:
            best[:] = chosen[k], found[k]
        return found

    differential_evolution(
        len,  # never called: `together` takes its place
        list(zip(low, high, strict=True)),
        maxiter=generations,
        init=np.clip(first, low, high),
        integrality=whole,
        workers=together,
        updating="deferred",
        polish=False,
        tol=0.0,
        mutation=(0.5, 1.0),
        recombination=0.9,
        seed=design.asked.search.seed,
    )
    return best[0], best[1]


def _stepped(design: Design, ask: Any, vector: Floats, value: float) -> None:
    """From the best on, the best of all changes of one coordinate, until none is better or the evaluations are over."""
    left = int(LEFT * design.asked.search.evaluations)
    for stride in STRIDES:
        while True:
            around = _around(design, vector, stride)[:left]
            if not around:
                return
            left -= len(around)
            found = ask(around)
            k = int(np.argmin(found))
            if not found[k] < value:
                break
            vector, value = around[k], found[k]


def _around(design: Design, vector: Floats, stride: float) -> list[Floats]:
    found = []
    for place, variable in enumerate(_axes(design)):
        for other in _others(variable, float(vector[place]), stride):
            moved = vector.copy()
            moved[place] = other
            found.append(moved)
    return found


def _others(variable: Variable, at: float, stride: float) -> list[float]:
    """Other values of a coordinate: every choice, whole numbers on either side, or a stride up and down."""
    low, high = variable.bounds
    if variable.choices:
        return [float(k) for k in range(round(low), round(high) + 1) if k != round(at)]
    step = max(1.0, round(stride * (high - low))) if variable.steps else stride * (high - low)
    moved = {min(max(at + sign * step, low), high) for sign in (-1.0, 1.0)}
    return sorted(moved - {at})
