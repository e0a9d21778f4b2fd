"""Figures as files, in the formats and of the width that a command was asked for."""

from pathlib import Path
from typing import TYPE_CHECKING

from workflow.errors import RunError
from workflow.formats import figure_files
from workflow.runs.files import write_bytes

if TYPE_CHECKING:
    from matplotlib.figure import Figure  # takes a while to import


def write_figure(directory: Path, name: str, figure: "Figure") -> tuple[Path, ...]:
    """Write a figure in the formats of `workflow.formats`; returns the files.

    Raises:
        RunError: it holds numbers that cannot be drawn.
    """
    from analysis.figures.style import picture

    paths = tuple(directory / file for file in figure_files(name))
    for path in paths:
        try:
            content = picture(figure, path.suffix[1:])
        except OverflowError:
            raise RunError(f"{path}: numbers near 1e308 cannot be drawn; are the frames damaged?") from None
        write_bytes(path, content)
    return paths
