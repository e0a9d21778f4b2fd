"""Statistics of columns of a sweep's table over its cases, by groups of the varied fields: tables and figures."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis.quantity import to_csv
from analysis.statistics import Histogram, Statistics, histogram, statistics
from analysis.trajectory import Floats
from lammps_inputs import InputError
from lammps_inputs.numbers import known
from workflow.runs.figures import write_figure
from workflow.sweep.collect import SweepTable, file_name, refuse_axes, refuse_lines

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class Group:
    """Statistics of a quantity over the cases of a sweep that have the same values in some fields.

    Attributes:
        quantity: a column of the sweep's table.
        fields: field -> its value in these cases.
        statistics: statistics of the quantity, in the scenes' units.
        histogram: histogram of the quantity.

    Examples:
        >>> [group] = granchain.statistics(granchain.collect("swept"), "peak_velocity")
        >>> round(group.statistics.mean, 3), group.histogram.count
        (1.022, array([1, 0, 1]))
    """

    quantity: str
    fields: dict[str, Any]
    statistics: Statistics
    histogram: Histogram

    def __repr__(self) -> str:
        numbers = self.statistics
        at = "".join(f", {name} = {value}" for name, value in self.fields.items())
        spread = f"mean {numbers.mean:.6g}, standard error {numbers.standard_error:.2g}"
        return f"<statistics of {self.quantity} over {numbers.values} cases{at}: {spread}>"

    def plain(self) -> dict[str, Any]:
        """Quantity, fields and statistics for JSON; what is undefined is None.

        Returns:
            The numbers by name, beside the quantity and the fields.

        Examples:
            >>> [group] = granchain.statistics(granchain.collect("swept"), "speed")
            >>> list(group.plain())[:3]
            ['quantity', 'values', 'undefined']
        """
        numbers = {name: known(number) for name, number in asdict(self.statistics).items()}
        return {"quantity": self.quantity, **self.fields, **numbers}


def default_fields(table: SweepTable) -> tuple[str, ...]:
    """Fields of the groups unless others are chosen: all but seeds; none where no seed is varied."""
    others = tuple(name for name in table.fields if name.rpartition(".")[2] != "seed")
    return others if len(others) < len(table.fields) else ()


def grouped(table: SweepTable, quantity: str, fields: Sequence[str]) -> list[Group]:
    """Groups of the cases with the same values in some fields, in the order of the table.

    Args:
        table: of a sweep; a case that is not done counts as undefined.
        quantity: a column of numbers.
        fields: varied fields; without any all cases are one group.

    Returns:
        A group for each combination of values of the fields, in the order of the table.
    """
    rows: dict[str, list[dict[str, Any]]] = {}
    for row in table.rows:
        rows.setdefault(json.dumps([row[name] for name in fields], default=str), []).append(row)
    groups = []
    for cases in rows.values():
        done = [row if row["outcome"] == "done" else {**row, quantity: None} for row in cases]
        values = replace(table, rows=done).numbers(quantity)
        groups.append(Group(quantity, {name: cases[0][name] for name in fields}, statistics(values), histogram(values)))
    return groups


def statistics_csv(table: SweepTable, groups: Sequence[Group]) -> str:
    """One line a group; what is undefined is empty."""
    return _csv(table, groups, [[asdict(group.statistics)] for group in groups])


def histogram_csv(table: SweepTable, groups: Sequence[Group]) -> str:
    """One line a bin of each group."""
    bins = []
    for group in groups:
        columns = {name: column.tolist() for name, column in vars(group.histogram).items()}
        bins.append([dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)])
    return _csv(table, groups, bins)


def _csv(table: SweepTable, groups: Sequence[Group], lines: Sequence[list[dict[str, Any]]]) -> str:
    """Quantity and fields of each group before the columns of its lines."""
    rows = [
        {"quantity": table.heading(group.quantity)}
        | {table.heading(name): value for name, value in group.fields.items()}
        | line
        for group, of_group in zip(groups, lines, strict=True)
        for line in of_group
    ]
    return to_csv({name: [row[name] for row in rows] for name in (rows[0] if rows else ["quantity"])})


def plot(table: SweepTable, directory: Path, groups: Sequence[Group], title: str = "") -> tuple[Path, ...]:
    """Draw the groups of one quantity into a directory; see `drawn`."""
    return write_figure(directory, file_name(groups[0].quantity, "statistics"), drawn(table, groups, title))


def drawn(table: SweepTable, groups: Sequence[Group], title: str = "") -> "Figure":
    """Figure of the groups of one quantity: means with standard errors over one field, lines for a second one.

    One group is drawn as its histogram.

    Args:
        table: of the sweep.
        groups: of one quantity, one of which has a value.
        title: which cases these are, where the table holds not all.

    Returns:
        The figure, of matplotlib.

    Raises:
        InputError: the groups have more than two fields, one without numbers, or too many lines.
    """
    from analysis.figures.studies import StudyAxis, histogram_figure, swept_figure  # takes half a second to import

    label = table.label(groups[0].quantity)
    counts = [group.statistics.values for group in groups]
    smallest, largest = min(counts), max(counts)
    number = f"n = {smallest}" + (f" to {largest}" if largest > smallest else "")
    title = ", ".join(filter(None, (table.scene, title, number)))
    if len(groups) == 1:
        return histogram_figure(label, groups[0].histogram, groups[0].statistics, title)
    rows = replace(table, rows=[group.fields for group in groups])
    over, *others = groups[0].fields
    if len(others) > 1:
        raise InputError(f"--over: {', '.join(groups[0].fields)}: a figure of groups has at most two fields")
    refuse_axes(rows, [over, *others])
    if others:
        refuse_lines("--over", rows, others[0], f"--over {others[0]},{over} exchanges axis and lines")
    axes = [StudyAxis(table.label(name), rows.numbers(name)) for name in (over, *others)]
    mean = replace(label, words=f"mean of {label.words}")
    error = _numbers(groups, "standard_error")
    means = StudyAxis(mean, _numbers(groups, "mean"), error, error_words="standard error of the mean")
    return swept_figure(means, axes[0], axes[1] if others else None, title)


def _numbers(groups: Sequence[Group], name: str) -> Floats:
    return np.array([getattr(group.statistics, name) for group in groups], dtype=np.float64)
