"""A study as files: ``trade.json`` with every repeat, and the work-precision figure."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from workflow.runs.results import provenance
from workflow.runs.whole_files import write_figure, write_json
from workflow.studies.trade import advice, grid, work_precision
from workflow.studies.trade.certified import QUANTITIES, Certified
from workflow.studies.trade.study import FIGURE, REPORT, STUDY, Findings
from workflow.studies.trade.work_precision import Point


def write(study: Findings, directory: Path) -> list[str]:
    """Write both; returns the names of the files."""
    write_json(directory / REPORT, plain(study))
    names = [REPORT]
    if study.truth is not None and any(point.measured for point in study.engines):
        names += [path.name for path in draw(study, study.truth, directory)]
    if study.whole:
        STUDY.mark(directory, done=True)
    return names


def orders(study: Findings, truth: Certified) -> dict[str, dict[str, work_precision.Order | None]]:
    """Curve and quantity -> order."""
    return {
        name: {
            quantity: work_precision.order(points, quantity, advice.WELL_ABOVE * truth.floors[quantity])
            for quantity in QUANTITIES
        }
        for name, points in curves(study.engines).items()
        if grid.has_order(name)
    }


def curves(points: Sequence[Point[Any]]) -> dict[str, list[Point[Any]]]:
    """Points by curve."""
    found: dict[str, list[Point[Any]]] = {}
    for point in points:
        found.setdefault(point.setting.curve, []).append(point)
    return found


def plain(study: Findings) -> dict[str, Any]:
    """The contents of ``trade.json``; errors and steps dimensionless."""
    truth = study.truth
    found: dict[str, Any] = {
        "scene": study.problem.name,
        "whole": study.whole,
        "seconds": study.seconds,
        "advice": advice.sentences(study),
        "reference": None if truth is None else {**asdict(truth.certificate), "seconds": truth.seconds},
        "orders": {},
        "pareto": {},
        "engines": [_plain_point(point) for point in study.engines],
        "frames": [_plain_point(point) for point in study.frames],
        "seconds_per_step": [asdict(size) for size in study.sizes],
        **provenance(),
    }
    if truth is not None:
        found["orders"] = {
            name: {quantity: None if order is None else asdict(order) for quantity, order in by.items()}
            for name, by in orders(study, truth).items()
        }
        for quantity in QUANTITIES:
            front = work_precision.pareto(advice.comparable(study.engines), quantity, "seconds")
            found["pareto"][quantity] = [f"{point.setting.curve}, {point.setting.label}" for point in front]
    return found


def _plain_point(point: Point[Any]) -> dict[str, Any]:
    return {
        "method": point.setting.curve,
        "setting": point.setting.label,
        "value": point.setting.value,
        "errors": point.errors,
        "first": point.first,
        "repeats": point.repeats,
        "left_out": point.left_out,
    }


def draw(study: Findings, truth: Certified, directory: Path) -> tuple[Path, ...]:
    """The work-precision figure."""
    from analysis.figures.work_precision import Curve, work_precision_figure  # matplotlib takes a while to import

    drawn, fronts = [], {}
    for name, points in curves(study.engines).items():
        told = [point for point in points if point.measured]
        if told:
            seconds = [point.costs("seconds") for point in told]
            drawn.append(
                Curve(
                    name=name if grid.is_whole(name) else f"{name} (near the front)",
                    error={quantity: np.array([point.errors[quantity] for point in told]) for quantity in QUANTITIES},
                    seconds=np.array([point.cost("seconds") for point in told]),
                    low=np.array([min(each) for each in seconds]),
                    high=np.array([max(each) for each in seconds]),
                    forces=np.array([point.cost("forces") for point in told]),
                )
            )
    whole = advice.comparable(study.engines)
    for quantity in QUANTITIES:
        front = work_precision.pareto(whole, quantity, "seconds")
        fronts[quantity] = np.array([(point.cost("seconds"), point.errors[quantity]) for point in front])
    figure = work_precision_figure(study.problem, drawn, fronts, truth.floors)
    return write_figure(directory, FIGURE, figure)
