"""The files of an analysis: ``waves.csv`` and other tables, ``analysis.json`` and the figures, beside the frames."""

from pathlib import Path

from analysis.quantity import plain
from analysis.sharing.is_solitary import Tolerances
from analysis.tracking.leading_waves import Arrival
from workflow.formats import figure_files, in_any_format
from workflow.runs.figures import write_figure
from workflow.runs.files import write_json, write_text
from workflow.runs.output_directory import record_files
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.analyse import FIGURES, Analysis, MeasuredFrames, measure, results_of
from workflow.verdicts.analysis_report import REPORT, Report


def analyse(
    directory: RunDirectory,
    *,
    beads: tuple[int, ...] | None = None,
    figures: bool = True,
    tolerances: Tolerances | None = None,
    arrival: Arrival | None = None,
) -> Analysis:
    """Analyse what a directory holds, also of a run that was cut short.

    Args:
        directory: a run directory.
        beads: whose velocity over time is drawn; by default three, see `default_beads`.
        figures: whether to draw.
        tolerances: within which a pulse is called solitary; by default 1% each.
        arrival: what counts as the arrival of a wave; by default that of `leading_waves.usual_arrival`.

    Returns:
        The analysis; its tables and figures are in the directory.

    Raises:
        InputError: no frames, frames that hold what is no number, or a bead that was not recorded.
    """
    frames = measure(directory, beads=beads, figures=figures, tolerances=tolerances, arrival=arrival)
    return results_of(directory, frames, _write(directory, frames))


def _write(directory: RunDirectory, frames: MeasuredFrames) -> tuple[Path, ...]:
    """Write tables, the report, and figures; returns the files of the figures."""
    files = figure_files(*frames.figures)
    outdated = in_any_format(*FIGURES) if frames.figures else ()
    record_files(directory.path, (*frames.tables, REPORT, *files), outdated)
    if frames.figures:
        from analysis.figures.drawing import draw  # matplotlib takes half a second to import
    drawn = tuple(
        path for name, make in frames.figures.items() for path in write_figure(directory.path, name, draw(make()))
    )
    for name, text in frames.tables.items():
        write_text(directory.path / name, text)
    more = {key: measurement.plain() for key, measurement in frames.measurements.items()}
    content = Report(frames.survey, lambda: frames.conservation, frames.tolerances, frames.error)
    write_json(directory.path / REPORT, plain(content, frames.survey.problem.scale) | more)
    return drawn
