"""The points of a study as CSV."""

import csv
import io
import math
from collections.abc import Sequence
from typing import Any

from lammps_inputs import Problem
from workflow.studies.trade.certified import QUANTITIES
from workflow.studies.trade.harness import Point

ENGINES, FRAMES = "trade.csv", "frames.csv"

Points = Sequence[Point[Any]]


def engines_csv(points: Points, problem: Problem) -> str:
    """A row for each setting; errors in units of V and T, ``timestep`` and ``every`` in the scene's.

    ``seconds`` is the median of the repeats, or the first call where ``repeats`` is 0; ``start`` is not in it.
    """
    scale, time = problem.scale, problem.scale.time
    steps = [scale.heading(name, "time") for name in ("timestep", "every")]
    head = ["method", "setting", *steps, "ranks", "window", *_errors(), "forces"]
    rows = []
    for point in points:
        job = point.setting.what
        window = job.window or job.problem.window
        own = [job.problem.timestep * time, job.problem.every * time, job.ranks, window]
        rows.append([*_name(point), *own, *_measured(point, ("forces",)), *_timed(point)])
    return _csv([*head, *_TIMED, "start", "note"], rows)


def frames_csv(points: Points, problem: Problem) -> str:
    """A row for each way to record; errors of reading alone; ``seconds`` is running and reading."""
    rows = []
    for point in points:
        job = point.setting.what
        own = [job.problem.every * problem.scale.time, job.format]
        rows.append([*_name(point), *own, *_measured(point, ("bytes", "run", "read")), *_timed(point)])
    head = ["method", "setting", problem.scale.heading("every", "time"), "format", *_errors(), "bytes", "run", "read"]
    return _csv([*head, *_TIMED, "start", "note"], rows)


_TIMED = ("seconds", "seconds_min", "seconds_max", "seconds_first", "repeats")


def _errors() -> list[str]:
    return [f"{name}_error" for name in QUANTITIES]


def _name(point: Point[Any]) -> list[object]:
    return [point.setting.curve, point.setting.label]


def _measured(point: Point[Any], costs: Sequence[str]) -> list[object]:
    if not point.measured:
        return [None] * (len(QUANTITIES) + len(costs))
    return [*(point.errors[name] for name in QUANTITIES), *(point.cost(name) for name in costs)]


def _timed(point: Point[Any]) -> list[object]:
    if not point.measured:
        return [None] * 6 + [point.left_out]
    seconds = point.costs("seconds")
    start = point.cost("start") if "start" in point.first else None
    return [
        point.cost("seconds"), min(seconds), max(seconds), point.first["seconds"], len(point.repeats), start, ""
    ]  # fmt: skip


def _csv(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(head)
    for row in rows:
        writer.writerow(["" if value is None else _number(value) for value in row])
    return out.getvalue()


def _number(value: object) -> str:
    if isinstance(value, float):
        return "" if math.isnan(value) else repr(float(value))
    return str(value)
