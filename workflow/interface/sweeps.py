"""Sweeps for scripts and notebooks: run, gathered, drawn."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lammps_inputs.numbers import plain_values
from workflow.checked import checked
from workflow.errors import RunError
from workflow.inputs import AnyDefinition, Processes
from workflow.sweep import collect as collecting
from workflow.sweep import file
from workflow.sweep.collect import SweepTable, named_fields
from workflow.sweep.statistics import Group, default_fields, grouped

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@checked
def sweep(
    definition: AnyDefinition, directory: Path | str, *, jobs: Processes | None = None, check: bool = True
) -> SweepTable:
    """Run a scene for lists or ranges of its fields, on all cores, and gather the cases; runs what is missing.

    Args:
        definition: a sweep file, or its content as a mapping; its scene may be a `Scene`.
        directory: new, or resumed.
        jobs: cases at a time; as many as there are cores by default.
        check: whether to measure the errors against the reference.

    Returns:
        The table of the cases.

    Raises:
        InputError: a case is no valid scene.
        RunError: the sweep was interrupted.

    Examples:
        >>> definition = {"scene": "one-chain", "vary": {"kick.velocity": [1.0, 2.0]}, "engine": "reference"}
        >>> granchain.sweep(definition, "swept")
        <table of 2 cases over kick.velocity>
    """
    from workflow.sweep.run_sweep import sweep as carry_out

    read = (
        file.from_plain(dict(definition), Path("sweep"))
        if isinstance(definition, Mapping)
        else file.load(Path(definition))
    )
    end = carry_out(read, Path(directory), processes=jobs, check=check)
    if end.interrupted:
        raise RunError("interrupted: completed cases remain; the same call runs the rest")
    return collect(directory)


@checked
def collect(
    directory: Path | str, at_beads: Sequence[str] = (), *, where: Mapping[str, Any] | None = None
) -> SweepTable:
    """Gather the cases of a sweep into one table, those that failed with the reason.

    Args:
        directory: directory of the sweep, or any other that run directories lie in.
        at_beads: further columns, of the leading wave at chosen beads, such as ``peak_velocity@100``.
        where: varied field -> value; only cases with these values.

    Returns:
        The table of the cases.

    Raises:
        InputError: there are none.

    Examples:
        >>> table = granchain.collect("swept", ["peak_velocity@40"])
        >>> table.numbers("peak_velocity@40").round(3)
        array([0.682, 1.363])
    """
    table = collecting.collect(Path(directory), at_beads)
    return collecting.only(table, plain_values(where)) if where else table


@checked
def statistics(table: SweepTable, quantity: str, over: str | None = None) -> list[Group]:
    """Compute statistics of a column of a sweep's table over its cases, as ``granchain collect --statistics`` does.

    Args:
        table: table of a sweep.
        quantity: a column of numbers.
        over: fields of the groups, with commas between; all varied fields but seeds by default.

    Returns:
        A group for each combination of values of these fields, in the order of the table.

    Raises:
        InputError: no such column or field.

    Examples:
        >>> [group] = granchain.statistics(granchain.collect("swept"), "speed")
        >>> group.statistics.values
        2
    """
    collecting.refuse_unless_numeric("quantity", quantity)
    return grouped(table, quantity, default_fields(table) if over is None else named_fields("over", over, table))


@dataclass(frozen=True)
class NotebookFigure:
    """Figure of matplotlib, which a notebook displays.

    Attributes:
        figure: the ``matplotlib.figure.Figure``, which may be changed and saved.

    Examples:
        >>> granchain.plot(granchain.collect("swept"), "speed", over="kick.velocity")
        <figure; the attribute `figure` is matplotlib's>
    """

    figure: "Figure"

    def __repr__(self) -> str:
        return "<figure; the attribute `figure` is matplotlib's>"

    def _repr_png_(self) -> bytes:
        from analysis.figures.style import picture  # matplotlib takes half a second to import

        return picture(self.figure, "png", dpi=100)


@checked
def plot(table: SweepTable, quantity: str, over: str, beside: str | None = None) -> NotebookFigure:
    """Draw a column of a sweep's table over a varied field, or over two, as ``granchain collect --plot`` does.

    Args:
        table: table of a sweep.
        quantity: a column of numbers.
        over: a varied field, or two with a comma between, for a map.
        beside: a second field, with a line for each of its values.

    Returns:
        The figure; ``.figure`` is matplotlib's.

    Raises:
        InputError: no such column or field, nothing to draw, or several cases at one point.

    Examples:
        >>> drawn = granchain.plot(granchain.collect("swept"), "speed", over="kick.velocity")
        >>> drawn.figure.savefig("speed.pdf")
    """
    return NotebookFigure(collecting.drawn(table, quantity, over, beside))
