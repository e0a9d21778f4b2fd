"""Gather the cases of a sweep into one table, and draw one quantity of it over one or two fields."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lammps_inputs import InputError, file_names, library, strict_yaml
from workflow.cluster import queue
from workflow.engines.lammps.mpi import cores
from workflow.runs.files import RECORD, write_figure
from workflow.runs.job import account
from workflow.runs.status import Status, status
from workflow.sweep import fields
from workflow.sweep.directory import Asked, asked, is_analysed, read_json, task
from workflow.sweep.table import QUANTITIES, UNCERTAINTIES, UNSETTLED, Table
from workflow.verdicts.analysis_report import REPORT
from workflow.workers import evaluate
from workflow.workers.pool import Pool

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def collect(directory: Path, progress: Callable[[int, int], None] | None = None) -> Table:
    """Gather all cases below a directory; those with frames but no analysis are analysed first, on all cores.

    Args:
        directory: of a sweep, or any that run directories lie in.
        progress: called with the analyses done and their total.

    Raises:
        InputError: there is no run directory in it.
    """
    try:
        found = sorted(path for path in directory.iterdir() if (path / file_names.SCENE).is_file())
    except OSError as error:
        raise InputError(f"{directory}: cannot be read ({error.strerror})") from None
    if not found:
        raise InputError(f"{directory}: holds no run directories; `granchain sweep` makes some")
    known = queue.ask() if (directory / file_names.CASES).is_file() else None
    states = {path: status(path, known) for path in found}
    done = [path for path in found if states[path].state == "done"]
    complaints = _analyse([path for path in done if not is_analysed(path)], progress)
    requests = {path: asked(path) or Asked({}, {}, "") for path in found}
    names = sorted({name for request in requests.values() for name in request.swept})
    paths = {name: _path(name, directory, requests.values()) for name in names}
    rows, kinds, scenes, bands = [], set(), set(), {}
    for path, request in requests.items():
        report, record = read_json(path / REPORT), account(path).plain()
        scenes.add(str(request.scene.get("name", "")))
        kinds.add("material" in request.scene or report.get("units") == "SI")
        scene = request.scene or _scene(path)
        swept = {name: request.swept.get(name, fields.look_up(scene, paths[name])) for name in names}
        outcome, reason = _outcome(states[path], report.get("complete") is True, complaints.get(path.name))
        row = {"case": path.name, **swept, "outcome": outcome, **quantities(report, record, scene)}
        rows.append({**row, "reason": reason})
        spectra = report.get("spectra")
        if isinstance(spectra, dict) and _are_bands(spectra.get("bands")):
            bands[path.name] = spectra["bands"]
    rows.sort(key=lambda row: [_rank(row[name]) for name in names])
    return Table(
        names,
        rows,
        si=None if len(kinds) > 1 else kinds == {True},
        scene=scenes.pop() if len(scenes) == 1 else "",
        units={name: _shared_unit(paths[name], requests.values()) for name in names},
        bands=bands,
    )


def _shared_unit(path: fields.Path, requests: Iterable[Asked]) -> str:
    """Of a field; empty where the cases have several."""
    found = {fields.unit(path, request.scene) for request in requests if request.scene}
    return found.pop() if len(found) == 1 else ""


def _are_bands(value: Any) -> bool:
    try:
        return np.array(value, dtype=np.float64).shape[1:] == (2,)
    except (TypeError, ValueError):
        return False


def _scene(directory: Path) -> dict[str, Any]:
    """Plain data of the scene of a run that no sweep asked for; empty if it cannot be read."""
    try:
        return strict_yaml.load(directory / file_names.SCENE)
    except InputError:
        return {}


def _path(name: str, directory: Path, requests: Iterable[Asked]) -> fields.Path:
    try:
        return fields.parse(name, next((request.scene for request in requests if name in request.swept), {}))
    except InputError as error:
        raise InputError(f"{directory}: a case in it: {error}") from None


def _analyse(directories: list[Path], progress: Callable[[int, int], None] | None) -> dict[str, str]:
    """Analyse directories; name -> what went wrong."""
    if not directories:
        return {}
    cases = [evaluate.Case(path.name, task(path.absolute(), None, check=False)) for path in directories]
    show = None if progress is None else lambda done, total, _: progress(done, total)
    with Pool(min(cores(), len(cases))) as pool:
        found = evaluate.evaluate(cases, pool=pool, progress=show)
    return {name: " ".join(answer.failed.split()) for name, answer in found.items() if answer.failed}


def _outcome(found: Status, analysed: bool, complaint: str | None) -> tuple[str, str | None]:
    """State of a case in a word or two, and why."""
    if found.state == "done" and not analysed:
        return "not analysed", complaint
    return found.state, found.why or None


def quantities(report: dict[str, Any], record: dict[str, Any], scene: dict[str, Any]) -> dict[str, Any]:
    """Everything in a table between the outcome and the reason, from a run's analysis and record.

    A file of somebody else's that holds other things holds None.
    """
    sources = {REPORT: {**report, "kicked": _kicked(report, scene)}, RECORD: record}
    found: dict[str, Any] = {}
    for name, quantity in QUANTITIES.items():
        value: Any = sources[quantity.file]
        for key in quantity.path:
            value = value.get(key) if isinstance(value, dict) else None
        plain = isinstance(value, int | float) if quantity.label else isinstance(value, str)
        found[name] = value if plain else None
    return found


def _kicked(report: dict[str, Any], scene: dict[str, Any]) -> dict[str, Any]:
    """What ``analysis.json`` says of the leading wave in the chain with the largest excitation."""
    kicks = [scene.get(key) for key in ("kick", "push", "striker")]
    each = [kick for kick in kicks for kick in (kick if isinstance(kick, list | tuple) else [kick])]
    chain = max((kick for kick in each if isinstance(kick, dict)), key=_size, default={}).get("chain", 1)
    waves = report.get("waves")
    entries = waves if isinstance(waves, list) else []
    return next((entry for entry in entries if isinstance(entry, dict) and entry.get("chain") == chain), {})


def _size(kick: dict[str, Any]) -> float:
    velocity = kick.get("velocity", kick.get("peak"))
    return abs(velocity) if isinstance(velocity, int | float) else 0.0


def _rank(value: Any) -> tuple[int, float, str]:
    """For sorting: numbers by size, then everything else by its text."""
    if isinstance(value, int | float):
        return 0, float(value), ""
    return 1, 0.0, str(value)


def only(table: Table, where: dict[str, Any]) -> Table:
    """The cases of a table whose fields have these values.

    Raises:
        InputError: a field is not varied, or no case is like that.
    """
    for name, value in where.items():
        _refuse_unless_varied("--where", name, table)
        known = list(dict.fromkeys(str(row[name]) for row in table.rows))
        if all(row[name] != value for row in table.rows):
            raise InputError(f"--where: no case has {name} = {value}; {', '.join(known)}")
    rows = [row for row in table.rows if all(row[name] == value for name, value in where.items())]
    if not rows:
        raise InputError("--where: no case is all of that; leave one out")
    return replace(table, rows=rows)


def _refuse_unless_varied(option: str, name: str, table: Table) -> None:
    if name not in table.fields:
        raise InputError(f"{option}: {name!r} is not varied here; {', '.join(table.fields) or 'nothing'} is")


def _placed(row: dict[str, Any], axes: list[str]) -> bool:
    return all(isinstance(row[name], int | float) and np.isfinite(row[name]) for name in axes)


def plot(
    table: Table, directory: Path, quantity: str, over: str, beside: str | None, title: str = ""
) -> tuple[Path, ...]:
    """Draw a quantity over a field, or two, into a directory; see `drawn`."""
    figure = drawn(table, quantity, over, beside, title)
    fields = "-and-".join(filter(None, (over, beside)))
    return write_figure(directory, f"{quantity}-over-{fields}".replace("[", "").replace("]", ""), figure)


def drawn(table: Table, quantity: str, over: str, beside: str | None = None, title: str = "") -> "Figure":
    """The figure of a quantity over a field, or two.

    Args:
        table: what to draw from; cases that are not done count as having no number.
        quantity: one of `QUANTITIES`.
        over: the field along the horizontal axis.
        beside: a second field, as lines or as a map.
        title: which cases these are, where the table holds not all.

    Raises:
        InputError: no such quantity or field, nothing to draw, or several cases at one point.
    """
    from analysis.figures.swept import Axis, swept_figure  # matplotlib takes half a second to import

    shown = [name for name in (over, beside) if name is not None]
    numeric = [name for name, found in QUANTITIES.items() if found.label]
    if quantity not in numeric:
        hint = library.suggestion(quantity, numeric)
        raise InputError(f"--plot: {quantity!r} given{hint}; should be one of {', '.join(numeric)}")
    for option, name in (("--over", over), ("--and", beside)):
        if name is not None:
            _refuse_unless_varied(option, name, table)
    rows = [row for row in table.rows if row["outcome"] == "done"]
    done = replace(table, rows=rows)
    for name in shown:
        if rows and not np.all(np.isfinite(done.numbers(name))):
            raise InputError(f"{name}: is not a number in every case, so it cannot be an axis")
    if not np.any(np.isfinite(done.numbers(quantity))):
        raise InputError(f"--plot: no case that is done has a number for {quantity}")
    points = {tuple(row[name] for name in shown) for row in rows}
    if len(points) < len(rows):
        others = [name for name in table.fields if name not in shown and len({str(row[name]) for row in rows}) > 1]
        raise InputError(
            f"--plot: {len(rows)} cases lie at {len(points)} points; choose among {', '.join(others)} "
            f"with --where {others[0] if others else 'FIELD'}=VALUE, or with --and"
        )
    bands = done.passed(over)
    rows += [{**row, quantity: None} for row in table.rows if row["outcome"] != "done" and _placed(row, shown)]
    placed = replace(table, rows=rows)
    along, *second = [Axis(placed.label(name), placed.numbers(name)) for name in shown]
    error = UNCERTAINTIES.get(quantity)
    upwards = Axis(
        placed.label(quantity),
        placed.numbers(quantity),
        None if error is None else placed.numbers(error),
        np.array([QUANTITIES[quantity].path[0] == "equipartition" and row["state"] in UNSETTLED for row in rows]),
    )
    title = ", ".join(filter(None, (table.scene, title)))
    return swept_figure(upwards, along, second[0] if second else None, title, bands)
