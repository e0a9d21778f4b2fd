"""What the commands do, for scripts and notebooks: ``from workflow.api import load, run, analyse``.

Scenes may be given by name, as a file, as plain data or as a `Scene`; directories as text or paths, or as the `Run`
that is in them. `analyse` does what the command ``analyze`` does. Mistakes raise `InputError`, failures `RunError`;
nothing ends the interpreter. A notebook displays results as tables and figures. On a terminal and in a notebook long
work has a progress bar. Studies that are installed have functions here, too: `fit`, `design` and `gallery` are
granchain's own (entry points ``granchain.api``, see `lammps_inputs.plugins`).
"""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from lammps_inputs import InputError, Scene, library, plugins
from workflow.errors import RunError
from workflow.runs import run as running
from workflow.runs.run_directory import RunDirectory
from workflow.screen import progress_bar
from workflow.sweep import collect as collecting
from workflow.sweep import file
from workflow.sweep.collect import SweepTable, named_fields
from workflow.sweep.statistics import Group, default_fields, grouped
from workflow.verdicts import analyse as analysing
from workflow.verdicts import validate as validating
from workflow.verdicts.analyse import Analysis
from workflow.verdicts.validate import Validation
from workflow.verdicts.validate_against import run_or_file, validate_against
from workflow.view import need_bokeh

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "InputError",
    "NotebookFigure",
    "Page",
    "Run",
    "RunError",
    "analyse",
    "analyze",
    "collect",
    "load",
    "plot",
    "run",
    "statistics",
    "sweep",
    "universe",
    "validate",
    "view",
    *plugins.declared("api"),
]


@dataclass(frozen=True)
class Page:
    """An HTML page, which a notebook in a directory above it displays."""

    path: Path

    def _repr_html_(self) -> str:
        place = escape(os.path.relpath(self.path), quote=True)
        return f'<p><a href="{place}">{place}</a></p><iframe src="{place}" width="100%" height="900"></iframe>'


@dataclass(frozen=True)
class NotebookFigure:
    """A figure of matplotlib, which a notebook displays."""

    figure: "Figure"

    def _repr_png_(self) -> bytes:
        from analysis.figures.style import picture  # matplotlib takes half a second to import

        return picture(self.figure, "png", dpi=100)


@dataclass(frozen=True, repr=False)
class Run(running.CompletedRun):
    """A run that came to an end.

    Attributes:
        directory: the run directory; ``directory.path`` is its path.
        outcome: "done", or "interrupted" with the frames until then.
        check: its error against the reference; None if that was not asked for, or another engine than LAMMPS ran.
        trajectory: all frames in units of V, T and L: ``time`` [frame], ``displacement`` and ``velocity``
            [frame, chain, bead], float64.
        si: all frames in the scene's units, SI or reduced.
    """

    def view(self) -> Page:
        """Write its page, see `view`."""
        return view(self)


def __getattr__(name: str) -> Any:
    """Function of a study, which an installed distribution declares; imported when it is first used."""
    if name not in plugins.declared("api"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return plugins.load("api", name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


AnyScene = Scene | Mapping[str, Any] | Path | str
AnyRun = running.CompletedRun | RunDirectory | Path | str


def load(scene: AnyScene) -> Scene:
    """A scene by the name of an installed one, from a file, or from plain data.

    Raises:
        InputError: there is no such scene, or it is invalid.
    """
    if isinstance(scene, Scene):
        return scene
    if isinstance(scene, Mapping):
        return library.from_plain(library.with_files(dict(scene), Path()), "scene")
    return library.find(str(scene))


def run(
    scene: AnyScene,
    directory: Path | str,
    *,
    engine: Literal["lammps", "reference", "collisions"] = "lammps",
    ranks: int = 1,
    overwrite: bool = False,
    check: bool = True,
) -> Run:
    """Run a scene in a new directory, after determining what it leaves open.

    Args:
        scene: see `load`.
        directory: new or empty, or an earlier run's with ``overwrite``.
        engine: LAMMPS, the reference integrator, or rigid beads.
        ranks: MPI ranks of LAMMPS.
        overwrite: whether an earlier run's files may be replaced.
        check: whether to measure the error of a LAMMPS run against the reference.

    Raises:
        InputError: the scene or the directory cannot be used.
        RunError: the run failed.
    """
    if not isinstance(ranks, int):
        raise InputError(f"ranks: {ranks!r} given; a whole number, 1 or more")
    ready = running.prepare_run(
        load(scene), as_path(directory), engine=engine, ranks=ranks, overwrite=overwrite, source="scene"
    )
    with progress_bar(ready.scene.name, ready.problem) as progress:
        done = running.run_prepared(ready, check=check, progress=progress)
    return Run(done.directory, done.outcome, done.check)


def analyse(run: AnyRun, *, figures: bool = False) -> Analysis:
    """Find the waves in a run; writes ``waves.csv`` and ``analysis.json`` beside the frames, and figures if asked to.

    What it returns has ``waves`` (in V and T), ``si`` (the same in the scene's units) and ``findings`` (forces, energy
    and others that only some runs have); all quantities are in ``analysis.json``.

    Raises:
        InputError: there are no frames, or they are damaged.
    """
    return analysing.analyse(_directory(run), figures=figures)


analyze = analyse


def validate(
    run: AnyRun,
    *,
    against: AnyRun | None = None,
    units: Literal["scene", "dimensionless"] = "scene",
    tolerances: Mapping[str, float] | None = None,
) -> Validation:
    """Compare a run with an accurate reference, with another run of its scene, or with a table or traces of your own.

    Args:
        run: what to validate.
        against: another run, or its directory, or a file of yours; the reference if omitted.
        units: of that file.
        tolerances: quantity -> tolerance in V, T and L, in place of the default, such as ``{"velocity": 1e-3}``.

    Raises:
        InputError: frames or file cannot be used, or the two runs are of different scenes.
    """
    directory, limits = _directory(run), dict(tolerances or {})
    if against is None:
        return validating.validate(directory, limits)
    other = run_or_file(Path(against)) if isinstance(against, str | Path) else _directory(against)
    return validate_against(directory, other, dimensionless=units == "dimensionless", tolerances=limits)


def universe(run: AnyRun) -> Any:
    """A run as an ``MDAnalysis.Universe``, continued or not, with SI values; see `analysis.mda.universe`.

    Raises:
        InputError: there are no frames, or they are damaged.
    """
    from analysis.mda.universe import universe as make_universe

    directory = _directory(run)
    try:
        return make_universe(directory.problem, directory.dumps)
    except (OSError, ValueError) as error:
        raise InputError(str(error)) from None


def sweep(
    definition: Mapping[str, Any] | Path | str, directory: Path | str, *, jobs: int | None = None, check: bool = True
) -> SweepTable:
    """Run a scene for lists or ranges of its fields, on all cores, and gather the cases; runs what is missing.

    Args:
        definition: a sweep file, or its content as a mapping.
        directory: new, or resumed.
        jobs: cases at a time; as many as there are cores by default.
        check: whether to measure the errors against the reference.

    Raises:
        InputError: a case is no valid scene.
        RunError: the sweep was interrupted.
    """
    from workflow.sweep.run_sweep import sweep as carry_out

    read = (
        file.from_plain(dict(definition), Path("sweep"))
        if isinstance(definition, Mapping)
        else file.load(Path(definition))
    )
    end = carry_out(read, as_path(directory), processes=jobs, check=check)
    if end.interrupted:
        raise RunError("interrupted: completed cases remain; the same call runs the rest")
    return collect(directory)


def collect(directory: Path | str, at_beads: Sequence[str] = ()) -> SweepTable:
    """Gather the cases of a sweep into one table, those that failed with the reason.

    Args:
        directory: directory of the sweep.
        at_beads: further columns, of the leading wave at chosen beads, such as ``peak_velocity@100``.

    Raises:
        InputError: there are none.
    """
    return collecting.collect(as_path(directory), at_beads)


def statistics(table: SweepTable, quantity: str, over: str | None = None) -> list[Group]:
    """Statistics of a column of a sweep's table over its cases, as ``granchain collect --statistics`` computes them.

    Args:
        table: of a sweep.
        quantity: a column of numbers.
        over: fields of the groups, with commas between; all varied fields but seeds by default.

    Raises:
        InputError: no such column or field.
    """
    collecting.refuse_unless_numeric("statistics", quantity)
    return grouped(table, quantity, default_fields(table) if over is None else named_fields("over", over, table))


def plot(table: SweepTable, quantity: str, over: str, beside: str | None = None) -> NotebookFigure:
    """Draw a column of a sweep's table over a varied field, or over two, as ``granchain collect --plot`` does.

    Args:
        table: of a sweep.
        quantity: a column of numbers.
        over: a varied field, or two with a comma between, for a map.
        beside: a second field, with a line for each of its values.

    Raises:
        InputError: no such column or field, nothing to draw, or several cases at one point.
    """
    return NotebookFigure(collecting.drawn(table, quantity, over, beside))


def view(run_or_sweep: AnyRun) -> Page:
    """Write the page of a run or a sweep.

    Raises:
        InputError: there are no frames or cases, or Bokeh is not installed.
    """
    need_bokeh()
    from workflow.view import write

    if isinstance(run_or_sweep, running.CompletedRun):
        run_or_sweep = run_or_sweep.directory
    path = run_or_sweep.path if isinstance(run_or_sweep, RunDirectory) else as_path(run_or_sweep)
    return Page(write.write(path))


def _directory(run: AnyRun) -> RunDirectory:
    if isinstance(run, running.CompletedRun):
        return run.directory
    return run if isinstance(run, RunDirectory) else RunDirectory(as_path(run))


def as_path(path: object) -> Path:
    """A directory as the user gave it.

    Raises:
        InputError: it is no path.
    """
    if not isinstance(path, str | os.PathLike):
        raise InputError(f"directory: {path!r} given; a path such as 'out'")
    return Path(path)
