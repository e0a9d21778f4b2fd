"""Growth of tangent vectors along a run of the reference, and exponents from it.

The vectors are orthogonalised in intervals (Benettin, Galgani, Giorgilli & Strelcyn, Meccanica 15, 1980, 9 and 21): the
mean logarithm of the growth of the first is the largest exponent, that of the n-th the n-th.
"""

import math
from typing import Any

import numpy as np

from granchain.parts import Floats, Problem, engine, rates
from workflow.plugins.derivatives import tangent

RECORDS = 200
"""Times at which the growth is recorded."""

ALIGNMENT = 0.1
"""Part of a run in which vectors turn towards the directions of growth, which is left out."""

BLOCKS = 20
"""Blocks of the rest, from whose spread the uncertainty of the mean follows."""

STEPS_PER_INTERVAL = 100
"""Usual steps between two orthogonalisations: two periods of the fastest motion, in which no vector gets lost."""

_NEARBY = 1e-9
"""Standard deviation of the change of velocities at the start of a nearby run, in units of V."""


def usual_step(problem: Problem) -> float:
    """Time step of the reference, in units of T, that leaves an error of some 1e-6 of V."""
    return rates.stability_bound(problem.system) / engine.STEPS_PER_BOUND


def computed(plain: dict[str, Any], source: str, exponents: int, refinement: int, start: int, duration: float) -> Any:
    """Growth of tangent vectors along a run, as plain data.

    Args:
        plain: the scene.
        source: name of the scene in messages.
        exponents: number of vectors.
        refinement: steps in one of `usual_step`.
        start: 0 for the scene's start; each other number for a start nearby, and for other vectors.
        duration: of the run, in units of T.

    Returns:
        ``time`` [record], in units of T; ``growth`` [record, exponent], logarithm of the growth since the start.
    """
    problem = tangent.problem_of(plain, source)
    steps = STEPS_PER_INTERVAL * refinement
    step = usual_step(problem) / refinement
    flow = tangent.make_flow(problem, exponents, step)
    free, random = flow.free, np.random.default_rng(start)
    if start:
        change = _NEARBY * random.normal(size=free.shape) * free
        flow.state.v[1:-1] += change.T
    vectors = random.normal(size=(exponents, 2, *free.shape)) * free
    intervals = RECORDS * max(1, math.ceil(duration / (RECORDS * steps * step)))
    growth, time, total = [], [], np.zeros(exponents)
    for interval in range(intervals):
        flow.put(_orthonormal(vectors)[0])
        flow.advance(interval * steps, steps)
        vectors = flow.vectors
        total = total + _orthonormal(vectors)[1]
        if (interval + 1) % (intervals // RECORDS) == 0:
            time.append((interval + 1) * steps * step)
            growth.append(total.tolist())
    return {"time": time, "growth": growth}


def _orthonormal(vectors: Floats) -> tuple[Floats, Floats]:
    """Orthonormal vectors that span the same spaces, in order, and the logarithms of the lengths that these had."""
    basis, lengths = np.linalg.qr(vectors.reshape(len(vectors), -1).T)
    return basis.T.reshape(vectors.shape), np.log(np.abs(np.diag(lengths)))


def exponents_of(time: Floats, growth: Floats) -> tuple[Floats, Floats]:
    """Exponents of a run and their uncertainties, [exponent] each, in units of 1 / T.

    The uncertainty is the standard error of the mean over `BLOCKS` blocks, after `ALIGNMENT`.

    Args:
        time: [record], in units of T.
        growth: logarithm of the growth since the start, [record, exponent].
    """
    first = round(ALIGNMENT * len(time))
    edges = np.linspace(first, len(time) - 1, BLOCKS + 1).round().astype(np.int64)
    slopes = np.diff(growth[edges], axis=0) / np.diff(time[edges])[:, np.newaxis]
    weights = np.diff(time[edges])[:, np.newaxis]
    mean = np.sum(slopes * weights, axis=0) / np.sum(weights)
    return mean, np.std(slopes, axis=0, ddof=1) / math.sqrt(BLOCKS)


def drift(time: Floats, growth: Floats) -> Floats:
    """Exponent of the second half after `ALIGNMENT` less that of the first, [exponent], in units of 1 / T."""
    first = round(ALIGNMENT * len(time))
    middle = (first + len(time) - 1) // 2
    early, late = ((growth[b] - growth[a]) / (time[b] - time[a]) for a, b in ((first, middle), (middle, -1)))
    return np.asarray(late - early)
