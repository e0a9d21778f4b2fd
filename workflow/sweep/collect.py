"""The table of a sweep: its columns, with names, units and numbers; gathered from its cases, and drawn over fields.

Plug-ins take this module for tables of sweeps: `collect` gathers the cases below a directory into a `SweepTable`.

Examples:
    >>> scene = granchain.load("one-chain", {"beads": 20, "duration": 30.0})
    >>> done = granchain.run(scene, tmp / "runs" / "first", engine="reference")
    >>> waves = granchain.analyze(done).waves
    >>> table = collect.collect(tmp / "runs", ["peak_velocity@10"])
    >>> table.numbers("peak_velocity@10").round(3)  # [case]
    array([0.682])
"""

import contextlib
import csv
import io
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from analysis.quantity import data_frame, structured, to_csv
from analysis.sharing.verdict import EquipartitionState
from analysis.trajectory import Flags, Floats
from lammps_inputs import InputError, complaints, file_names, html, strict_yaml
from lammps_inputs.numbers import text
from lammps_inputs.units import REDUCED, Label, in_si
from workflow.quantities.columns import AT_BEAD, QUANTITIES, UNCERTAINTIES, at_bead, column_called, kicked_chain
from workflow.runs.figures import write_figure
from workflow.runs.files import RECORD
from workflow.runs.job import account
from workflow.runs.status import cluster_queue, status
from workflow.screen import count_bar
from workflow.sweep import fields
from workflow.sweep.cases import CaseRequest, is_analysed, read_json, request_of, task
from workflow.verdicts.analysis_report import REPORT, WAVES
from workflow.verdicts.places import OWN
from workflow.workers import computations
from workflow.workers.pool import Pool

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from analysis.figures.studies import StudyAxis

# --- table ------------------------------------------------------------------------------------------------------------

SHOWN = {
    "amplitude": ".4f",
    "agree_10": "d",
    "agree_1": "d",
    "energy_share": ".3f",
    "error_velocity": ".0e",
    "wall_seconds": ".2f",
}
"""Columns of the printed table, and their formats; the file has all of them."""

UNSETTLED = (EquipartitionState.BEATING.value, EquipartitionState.SHORT.value, EquipartitionState.UNSURE.value)
"""States of a case whose chains have not come to share equally, so that its numbers may yet change."""


Waves = dict[int, dict[str, float]]
"""Numbers of one chain's leading wave by bead and name of the quantity, in the scene's units."""


@dataclass(frozen=True)
class SweepTable:
    """All cases.

    Attributes:
        fields: what is varied in any of them.
        rows: one a case: its name as ``case``, fields, ``outcome``, quantities, ``reason``; None is unknown.
        si: whether the scenes are in SI units; None if some are and some are not.
        scene: name of the scenes; empty if they have several.
        labels: words, symbol and unit of the fields.
        bands: case -> lowest and highest frequencies at which small waves pass, [[low, high], ...]; where known.
        at_beads: columns of the leading wave at chosen beads, such as ``peak_velocity@100``.

    Examples:
        >>> table = granchain.collect("swept")
        >>> [(row["kick.velocity"], row["outcome"]) for row in table.rows]
        [(1.0, 'done'), (2.0, 'done')]
    """

    fields: list[str]
    rows: list[dict[str, Any]]
    si: bool | None
    scene: str = ""
    labels: dict[str, Label] = field(default_factory=dict)
    bands: dict[str, list[list[float]]] = field(default_factory=dict)
    at_beads: tuple[str, ...] = ()

    @property
    def columns(self) -> list[str]:
        """Names of the columns, in order.

        Returns:
            The names; each row has them as keys.

        Examples:
            >>> table = granchain.collect("swept")
            >>> table.columns[:3]
            ['case', 'kick.velocity', 'outcome']
        """
        return ["case", *self.fields, "outcome", *self.at_beads, *QUANTITIES, "reason"]

    @property
    def summary(self) -> list[str]:
        """Names of the columns that are printed.

        Returns:
            The varied fields, the outcome, and the first quantities.

        Examples:
            >>> granchain.collect("swept").summary[:3]
            ['kick.velocity', 'outcome', 'amplitude']
        """
        return [*self.fields, "outcome", *SHOWN]

    def __repr__(self) -> str:
        return f"<table of {len(self.rows)} cases over {', '.join(self.fields)}>"

    def _repr_html_(self) -> str:
        measured = [name for name, column in QUANTITIES.items() if column.file != RECORD]
        names = [*self.fields, "outcome", *self.at_beads, *measured, "reason"]
        names = [name for name in names if any(row[name] not in (None, "") for row in self.rows)]
        rows = [[row[name] for name in names] for row in self.rows]
        head = [html.with_unit(name, self.label(name).unit) for name in names]
        return html.table(repr(self)[1:-1], head, rows) + self._picture()

    def _picture(self) -> str:
        """Image of the first printed quantity with numbers over the varied field, or two; empty where there is none."""
        measured = (name for name in SHOWN if QUANTITIES[name].file != RECORD)
        quantity = next((name for name in measured if np.sum(np.isfinite(self.numbers(name))) > 1), None)
        if quantity is None or len(self.fields) not in (1, 2):
            return ""
        try:
            figure = drawn(self, quantity, ",".join(self.fields))
        except InputError:  # fields without numbers, or several cases at a point
            return ""
        from analysis.figures.style import picture  # matplotlib takes half a second to import

        return html.image(picture(figure, "png", dpi=100))

    def array(self) -> NDArray[Any]:
        """The table as a structured array, [case]: a field per column, text or float64; NaN is unknown.

        Returns:
            The array; a column has the unit of its heading.

        Examples:
            >>> granchain.collect("swept").array()["kick.velocity"]
            array([1., 2.])
        """
        columns: dict[str, NDArray[Any]] = {}
        for name in self.columns:
            if any(isinstance(row[name], str | list | dict) for row in self.rows):
                columns[name] = np.array(["" if row[name] is None else str(row[name]) for row in self.rows])
            else:
                columns[name] = self.numbers(name)
        return structured(columns)

    def pandas(self) -> Any:
        """The table as a ``pandas.DataFrame``, headed with units.

        Returns:
            A ``pandas.DataFrame``, a row for each case.

        Raises:
            ImportError: pandas is not installed; `array` needs nothing.
        """
        return data_frame(self.array(), self.heading)

    def to_csv(self) -> str:
        """One line a case; numbers read back exactly, and what is unknown is empty.

        Returns:
            The text.

        Examples:
            >>> granchain.collect("swept").to_csv().splitlines()[0][:26]
            'case,kick.velocity,outcome'
        """
        return to_csv({self.heading(name): [_written(row[name]) for row in self.rows] for name in self.columns})

    def numbers(self, name: str) -> Floats:
        """A column as numbers, [case], in the unit of its heading; NaN where it holds none.

        Args:
            name: name of the column.

        Returns:
            The numbers.

        Raises:
            InputError: there is no such column.

        Examples:
            >>> granchain.collect("swept").numbers("kick.velocity")
            array([1., 2.])
        """
        if name not in self.columns:
            names = [each for each in self.columns if each not in ("case", "outcome", "reason")]
            hint = complaints.suggestion(str(name)[:60], names) or f"; columns are {', '.join(names)}"
            raise InputError(f"name: {str(name)[:60]!r} is no column{hint}")
        values = (row[name] for row in self.rows)
        return np.array(
            [float(value) if isinstance(value, int | float) else math.nan for value in values],
            dtype=np.float64,
        )

    def unsettled(self, name: str) -> Flags:
        """Whether chains have not come to share equally, [case], where a column is one of equipartition.

        Args:
            name: name of the column.

        Returns:
            The mask; such numbers change if the run goes on.

        Examples:
            >>> granchain.collect("swept").unsettled("agree_1")
            array([False, False])
        """
        shares = name in QUANTITIES and QUANTITIES[name].path[0] == "equipartition"
        return np.array([shares and row["state"] in UNSETTLED for row in self.rows], dtype=bool)

    def uncertainty(self, name: str) -> str:
        """Name of the column that holds the uncertainty of a column, in the same unit.

        Args:
            name: name of the column.

        Returns:
            The name; empty where there is none.

        Examples:
            >>> granchain.collect("swept").uncertainty("beat_length")
            'beat_length_uncertainty'
        """
        return UNCERTAINTIES.get(name, "")

    def axis(self, name: str) -> "StudyAxis":
        """A column as figures and pages draw it: numbers, uncertainties, and which cases are not settled.

        Args:
            name: name of the column.

        Returns:
            The axis; cases that are not done have no number, but in varied fields.

        Examples:
            >>> granchain.collect("swept").axis("kick.velocity").values
            array([1., 2.])
        """
        from analysis.figures.studies import StudyAxis  # matplotlib takes half a second to import

        done, error = [row["outcome"] == "done" or name in self.fields for row in self.rows], self.uncertainty(name)
        return StudyAxis(
            self.label(name),
            np.where(done, self.numbers(name), math.nan),
            self.numbers(error) if error else None,
            self.unsettled(name),
            "uncertainty",
        )

    def passed(self, name: str) -> Floats | None:
        """Frequencies at which small waves pass, [band, 2], in the field's unit; None where cases differ.

        Args:
            name: name of a varied field.

        Returns:
            The bands; None for a column that is no frequency, too.

        Examples:
            >>> granchain.collect("swept").passed("kick.velocity") is None
            True
        """
        if name.rpartition(".")[2] != "frequency":
            return None
        by_case = [np.array(self.bands.get(row["case"], []), dtype=np.float64) for row in self.rows]
        if not by_case or any(bands.ndim != 2 or bands.shape != by_case[0].shape for bands in by_case):
            return None
        # a load is rounded a little differently in each case
        same = 1e-3 * np.max(np.abs(by_case[0]), initial=0.0)
        return by_case[0] if all(np.all(np.abs(bands - by_case[0]) <= same) for bands in by_case) else None

    def heading(self, name: str) -> str:
        """The name of a column in the table; with its unit where the scenes are in SI.

        Args:
            name: name of the column.

        Returns:
            The heading.

        Examples:
            >>> granchain.collect("swept").heading("arrival")
            'arrival'
        """
        unit = self._unit(name)
        return name if unit in ("", REDUCED) or (unit in OWN and not self.si) else f"{name} ({unit})"

    def label(self, name: str) -> Label:
        """Words, symbol and unit of a column: ``.mathtext`` in figures, ``.plain`` in pages; of text its name.

        Args:
            name: name of the column.

        Returns:
            The label.

        Examples:
            >>> granchain.collect("swept").label("kick.velocity").unit
            'reduced'
        """
        if name in self.labels:
            return self.labels[name]
        column = column_called(name)
        return column.axis(si=self.si) if column is not None and column.label else Label(name)

    def _unit(self, name: str) -> str:
        """Unit of a column; empty where it has none, or the scenes do not agree on one."""
        if name in self.fields:
            return self.labels[name].unit if name in self.labels else ""
        column = column_called(name)
        unit = "" if column is None else column.unit(si=self.si is True)
        return unit if self.si is not None or unit in OWN else ""


def _written(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return text(value)
    return str(value)


# --- collect ----------------------------------------------------------------------------------------------------------


def collect(directory: Path, at_beads: Sequence[str] = ()) -> SweepTable:
    """Gather all cases below a directory; those with frames but no analysis are analysed first, on all cores.

    Args:
        directory: of a sweep, or any that run directories lie in.
        at_beads: further columns, of the kicked chain's leading wave at chosen beads, such as ``peak_velocity@100``.

    Returns:
        The table, sorted by the varied fields.

    Raises:
        InputError: there is no run directory in it, or no such column.
    """
    for name in at_beads:
        if not at_bead(name)[1]:
            raise InputError(f"{name}: no column at a bead; valid: {', '.join(f'{base}@BEAD' for base in AT_BEAD)}")
    try:
        directories = sorted(path for path in directory.iterdir() if (path / file_names.SCENE).is_file())
    except OSError as error:
        raise InputError(f"{directory}: cannot be read ({error.strerror})") from None
    if not directories:
        raise InputError(f"{directory}: holds no run directories; `granchain sweep` makes some")
    queue = cluster_queue() if (directory / file_names.CASES).is_file() else None
    states = {path: status(path, queue) for path in directories}
    done = [path for path in directories if states[path].state == "done"]
    complaints = _analyse([path for path in done if not is_analysed(path)])
    requests = {path: request_of(path) or CaseRequest({}, {}, "") for path in directories}
    names = sorted({name for request in requests.values() for name in request.swept})
    paths = {name: _path(name, directory, requests.values()) for name in names}
    reads_waves = any(column.file == WAVES for column in QUANTITIES.values())
    rows, kinds, scenes, bands = [], set(), set(), {}
    for path, request in requests.items():
        report, record = read_json(path / REPORT), account(path).plain()
        scenes.add(str(request.scene.get("name", "")))
        kinds.add(in_si(request.scene) or report.get("units") == "SI")
        scene = request.scene or _scene(path)
        swept = {name: request.swept.get(name, fields.look_up(scene, paths[name])) for name in names}
        state = states[path]
        unread = state.state == "done" and report.get("complete") is not True
        outcome, reason = ("not analysed", complaints.get(path.name)) if unread else (state.state, state.why or None)
        waves = _waves(path, scene) if at_beads or reads_waves else {}
        row = {"case": path.name, **swept, "outcome": outcome, **quantities(report, record, scene, waves)}
        chosen = {name: waves.get(bead, {}).get(base) for name in at_beads for base, bead in [at_bead(name)]}
        rows.append({**row, **chosen, "reason": reason})
        spectra = report.get("spectra")
        if isinstance(spectra, dict) and _are_bands(spectra.get("bands")):
            bands[path.name] = spectra["bands"]
    rows.sort(key=lambda row: [_rank(row[name]) for name in names])
    return SweepTable(
        names,
        rows,
        si=None if len(kinds) > 1 else kinds == {True},
        scene=scenes.pop() if len(scenes) == 1 else "",
        labels={name: _shared_label(paths[name], requests.values()) for name in names},
        bands=bands,
        at_beads=tuple(at_beads),
    )


def _shared_label(path: fields.Path, requests: Iterable[CaseRequest]) -> Label:
    """Label of a field; without a unit where the cases have several."""
    labels = {fields.label(path, request.scene) for request in requests if request.scene} or {fields.label(path, {})}
    return labels.pop() if len(labels) == 1 else replace(labels.pop(), unit="")


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


def _path(name: str, directory: Path, requests: Iterable[CaseRequest]) -> fields.Path:
    try:
        return fields.parse(name, next((request.scene for request in requests if name in request.swept), {}))
    except InputError as error:
        raise InputError(f"{directory}: a case in it: {error}") from None


def _analyse(directories: list[Path]) -> dict[str, str]:
    """Analyse directories; name -> what went wrong."""
    if not directories:
        return {}
    cases = [computations.Computation(path.name, task(path.absolute(), None, check=False)) for path in directories]
    with count_bar("analyse") as progress, Pool() as pool:
        answers = computations.evaluate(cases, pool=pool, progress=progress)
    return {name: " ".join(answer.failed.split()) for name, answer in answers.items() if answer.failed}


def quantities(
    report: dict[str, Any], record: dict[str, Any], scene: dict[str, Any], waves: Waves | None = None
) -> dict[str, Any]:
    """Everything in a table between the outcome and the reason, from a run's analysis and record.

    A file of somebody else's that holds other things holds None, and so does one that was written before there was
    such a number.

    Args:
        report: data of ``analysis.json``.
        record: data of ``run.json``.
        scene: plain data of the scene.
        waves: numbers of the kicked chain's leading wave, by bead.

    Returns:
        Column -> its number or text; None where it is undefined.
    """
    kicked = _kicked(report, scene)
    at_bead = (waves or {}).get(kicked.get("bead", 0), {})
    sources = {REPORT: {**report, "kicked": kicked}, RECORD: record, WAVES: at_bead}
    values: dict[str, Any] = {}
    for name, quantity in QUANTITIES.items():
        value: Any = sources.get(quantity.file)
        for key in quantity.path:
            value = value.get(key) if isinstance(value, dict) else None
        plain = isinstance(value, int | float) if quantity.label else isinstance(value, str)
        values[name] = value if plain else None
    return values


def _kicked(report: dict[str, Any], scene: dict[str, Any]) -> dict[str, Any]:
    """What ``analysis.json`` says of the leading wave in the chain with the largest excitation."""
    chain = kicked_chain(scene)
    waves = report.get("waves")
    entries = waves if isinstance(waves, list) else []
    return next((entry for entry in entries if isinstance(entry, dict) and entry.get("chain") == chain), {})


def _waves(directory: Path, scene: dict[str, Any]) -> Waves:
    """Numbers in ``waves.csv`` of the kicked chain's leading wave, by bead; none where the file cannot be read."""
    waves: Waves = {}
    with contextlib.suppress(OSError, ValueError, KeyError, TypeError, csv.Error):
        text = (directory / WAVES).read_text(encoding="utf-8")
        for row in csv.DictReader(io.StringIO(text)):
            if int(row["chain"]) == kicked_chain(scene):
                numbers = {heading.partition(" (")[0]: value for heading, value in row.items()}
                waves[int(row["bead"])] = {name: float(numbers[name]) for name in AT_BEAD if numbers.get(name)}
    return waves


def _rank(value: Any) -> tuple[int, float, str]:
    """Key for sorting: numbers by size, then everything else by its text."""
    if isinstance(value, int | float):
        return 0, float(value), ""
    return 1, 0.0, str(value)


def only(table: SweepTable, where: dict[str, Any]) -> SweepTable:
    """The cases of a table whose fields have these values.

    Args:
        table: table of a sweep.
        where: varied field -> its value.

    Returns:
        The table of these cases.

    Raises:
        InputError: a field is not varied, or no case is like that.
    """
    for name, value in where.items():
        _refuse_unless_varied("--where", name, table)
        present = list(dict.fromkeys(str(row[name]) for row in table.rows))
        if all(row[name] != value for row in table.rows):
            raise InputError(f"--where: no case has {name} = {value}; {', '.join(present)}")
    rows = [row for row in table.rows if all(row[name] == value for name, value in where.items())]
    if not rows:
        raise InputError("--where: no case is all of that; leave one out")
    return replace(table, rows=rows)


def _refuse_unless_varied(option: str, name: str, table: SweepTable) -> None:
    if name not in table.fields:
        raise InputError(f"{option}: {name!r} is not varied here; {', '.join(table.fields) or 'nothing'} is")


def named_fields(option: str, text: str, table: SweepTable) -> tuple[str, ...]:
    """Varied fields of ``A,B``.

    Args:
        option: option of the command, for messages.
        text: names of fields, with commas between.
        table: table of the sweep.

    Returns:
        Names of the fields.

    Raises:
        InputError: one is not varied, or is given twice.
    """
    names = tuple(name.strip() for name in text.split(","))
    for name in names:
        _refuse_unless_varied(option, name, table)
    if len(set(names)) < len(names):
        raise InputError(f"{option}: {text}: a field is given twice")
    return names


def refuse_unless_numeric(option: str, name: str) -> None:
    """Refuse a quantity that is no column of numbers.

    Args:
        option: option of the command, for messages.
        name: name of the quantity.

    Raises:
        InputError: it is none; names those that are.
    """
    column = column_called(name)
    if column is None or not column.label:
        numeric = [name for name, quantity in QUANTITIES.items() if quantity.label]
        hint = complaints.suggestion(name[:60], numeric)
        raise InputError(
            f"{option}: {name[:60]!r} given{hint}; should be one of {', '.join(numeric)}, or of the leading wave at a "
            f"bead: {', '.join(f'{base}@100' for base in AT_BEAD)}"
        )


def file_name(*words: str) -> str:
    """Name of a figure of quantities and fields, which are parted by hyphens, without brackets and ``@``."""
    return "-".join(words).replace("[", "").replace("]", "").replace("@", "-at-")


def plot(
    table: SweepTable, directory: Path, quantity: str, over: str, beside: str | None, title: str = ""
) -> tuple[Path, ...]:
    """Draw a quantity over a field, or two, into a directory; see `drawn`."""
    figure = drawn(table, quantity, over, beside, title)
    names = [*over.split(","), *filter(None, [beside])]
    kind = "map-over" if "," in over else "over"
    return write_figure(directory, file_name(quantity, kind, "-and-".join(names)), figure)


def drawn(table: SweepTable, quantity: str, over: str, beside: str | None = None, title: str = "") -> "Figure":
    """The figure of a quantity over a field, or two.

    Args:
        table: what to draw from; cases that are not done count as having no number.
        quantity: one of `QUANTITIES`, or one of the table's ``at_beads``.
        over: the field along the horizontal axis; two with a comma between are the axes of a map.
        beside: a second field, with a line for each of its values.
        title: which cases these are, where the table holds not all.

    Returns:
        The figure, of matplotlib.

    Raises:
        InputError: no such quantity or field, nothing to draw, too many lines, or several cases at one point.
    """
    from analysis.figures.studies import StudyAxis, map_figure, swept_figure

    refuse_unless_numeric("--plot", quantity)
    axes = named_fields("--over", over, table)
    if len(axes) > (1 if beside else 2):
        raise InputError("--over: one field and --and for lines, or two fields, A,B, for a map")
    shown = (*axes, *(named_fields("--and", beside, table) if beside else ()))
    rows = [row for row in table.rows if row["outcome"] == "done"]
    done = replace(table, rows=rows)
    refuse_axes(done, shown)
    if beside:
        refuse_lines("--and", done, beside, f"--over {over},{beside} draws a map")
    if not np.any(np.isfinite(done.numbers(quantity))):
        raise InputError(f"--plot: no case that is done has a number for {quantity}")
    points = {tuple(row[name] for name in shown) for row in rows}
    if len(points) < len(rows):
        others = [name for name in table.fields if name not in shown and len({str(row[name]) for row in rows}) > 1]
        raise InputError(
            f"--plot: {len(rows)} cases lie at {len(points)} points; choose among {', '.join(others)} "
            f"with --where {others[0] if others else 'FIELD'}=VALUE, or with --and; --statistics has their mean"
        )
    rest = replace(table, rows=[row for row in table.rows if row["outcome"] != "done"])
    finite = np.all([np.isfinite(rest.numbers(name)) for name in shown], axis=0).tolist()
    placed = replace(table, rows=rows + [row for row, placeable in zip(rest.rows, finite, strict=True) if placeable])
    along, *second = [StudyAxis(placed.label(name), placed.numbers(name)) for name in shown]
    upwards = placed.axis(quantity)
    title = ", ".join(filter(None, (table.scene, title)))
    if len(axes) == 2:
        return map_figure(upwards, along, second[0], title)
    return swept_figure(upwards, along, second[0] if second else None, title, done.passed(over))


def refuse_axes(table: SweepTable, names: Sequence[str]) -> None:
    """Refuse fields that cannot be axes.

    Args:
        table: table of a sweep.
        names: fields of the axes.

    Raises:
        InputError: a field is not a number in every row.
    """
    for name in names:
        if table.rows and not np.all(np.isfinite(table.numbers(name))):
            raise InputError(f"{name}: is not a number in every case, so it cannot be an axis")


def refuse_lines(option: str, table: SweepTable, name: str, instead: str) -> None:
    """Refuse a field that makes too many lines.

    Args:
        option: option of the command, for messages.
        table: table of a sweep.
        name: field of the lines.
        instead: what to do instead.

    Raises:
        InputError: it has too many values; names the limit, and what to do instead.
    """
    from analysis.figures.studies import MOST_LINES

    count = len({row[name] for row in table.rows})
    if count > MOST_LINES:
        raise InputError(f"{option}: {name} has {count} values; a figure has at most {MOST_LINES} lines; {instead}")
