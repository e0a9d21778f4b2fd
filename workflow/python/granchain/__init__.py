"""Shock pulses in granular chains, single or weakly coupled: what the commands do, for scripts and notebooks.

A function has the name and the arguments of its command. A scene may be a name, a file, plain data or a `Scene`; a run
is a `Run` or the path of its directory; numbers and arrays of NumPy count as those of Python. Bad input raises
`InputError`, a run that fails `RunError`, each with one line of text that names the argument; nothing ends the
interpreter. On a terminal and in a notebook long work has a progress bar.

Studies and tools that are installed are functions, too (``fit``, ``design``, ``gallery``, ``threshold``, ``lyapunov``,
``modes``, ``trade``, ``extremes``, ``adopt``, ``explore``, ``export``), and loaded when they are first used.

Examples:
    >>> import granchain
    >>> run = granchain.run("two-chains", "demo")
    >>> run.trajectory.velocity.shape  # [frame, chain, bead], in units of V
    (1921, 2, 120)
    >>> analysis = granchain.analyze(run)
    >>> analysis.waves.of_chain(1).arrival[:3].round(2)  # in the scene's units
    array([0.  , 1.82, 3.05])
    >>> granchain.open("demo").trajectory.frames  # later, or on another machine
    1921
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from analysis.tracking.leading_waves import Arrival
from lammps_inputs import InputError, Scene, file_names, plugins
from lammps_inputs.complaints import suggestion
from lammps_inputs.materials import CATALOGUE as materials  # noqa: N811  no constant to those who read it
from lammps_inputs.materials import Solid
from lammps_inputs.numbers import plain_values
from workflow.arguments import AnyDefinition, AnyRun, AnyScene, Processes, directory_of, load, source_of
from workflow.checked import Between, checked
from workflow.errors import RunError
from workflow.plugins.pages import need_bokeh
from workflow.runs import check as checking
from workflow.runs import resume as resuming
from workflow.runs import run as running
from workflow.runs.deck_directory import write_deck
from workflow.runs.run_directory import RunDirectory
from workflow.runs.status import State, status
from workflow.screen import progress_bar
from workflow.study_kit.gradient import of_run, with_derivatives
from workflow.sweep import collect as collecting
from workflow.sweep import file
from workflow.sweep.collect import SweepTable, named_fields
from workflow.sweep.statistics import Group, default_fields, grouped
from workflow.verdicts import analyse as analysing
from workflow.verdicts import validate as validating
from workflow.verdicts.analyse import Analysis
from workflow.verdicts.analysis_report import WavesTable
from workflow.verdicts.validate import Validation
from workflow.verdicts.validate_against import run_or_file, validate_against

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from workflow.plugins.adopt.function import adopt as adopt
    from workflow.plugins.design.study import design as design
    from workflow.plugins.explore.notebook import explore as explore
    from workflow.plugins.export.tool import export as export
    from workflow.plugins.extremes.function import extremes as extremes
    from workflow.plugins.fit.study import fit as fit
    from workflow.plugins.gallery.study import gallery as gallery
    from workflow.plugins.lyapunov.function import lyapunov as lyapunov
    from workflow.plugins.modes.function import modes as modes
    from workflow.plugins.threshold.function import threshold as threshold
    from workflow.plugins.trade.function import trade as trade

    __version__: str

__all__ = [
    "Analysis",
    "Group",
    "InputError",
    "NotebookFigure",
    "Page",
    "Run",
    "RunError",
    "Scene",
    "Solid",
    "SweepTable",
    "Validation",
    "WavesTable",
    "analyze",
    "collect",
    "deck",
    "load",
    "materials",
    "open",
    "plot",
    "resume",
    "run",
    "statistics",
    "sweep",
    "universe",
    "validate",
    "view",
]

if not TYPE_CHECKING:  # a type checker would take any name for one of this module

    def __getattr__(name: str) -> Any:
        """Function that an installed distribution adds, or the version; both are looked up when they are used."""
        if name in plugins.declared("functions"):
            return plugins.load("functions", name)
        if name == "__version__":
            from importlib.metadata import version

            return version("granchain")
        raise AttributeError(f"module 'granchain' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*__all__, *plugins.declared("functions"), "__version__"])


Ranks = Annotated[int, Between(1)]
"""Number of MPI ranks of LAMMPS."""

MOST_EMBEDDED = 6_000_000
"""Bytes of a page that is part of a notebook's file when it is displayed; of a larger one there is a link."""


@dataclass(frozen=True)
class Page:
    """HTML page, which a notebook displays: itself, so that it stays when files move, or a link where it is large.

    Attributes:
        path: the file; it needs no network.
    """

    path: Path

    def __repr__(self) -> str:
        return f"<page {self.path}>"

    def _repr_html_(self) -> str:
        if self.path.stat().st_size > MOST_EMBEDDED:
            return f'<p><a href="{self.path.resolve().as_uri()}">{escape(str(self.path))}</a></p>'
        content = escape(self.path.read_text(encoding="utf-8"), quote=True)
        return f'<iframe srcdoc="{content}" width="100%" height="900"></iframe>'


@dataclass(frozen=True)
class NotebookFigure:
    """Figure of matplotlib, which a notebook displays.

    Attributes:
        figure: the ``matplotlib.figure.Figure``, which may be changed and saved.
    """

    figure: "Figure"

    def __repr__(self) -> str:
        return "<figure; the attribute `figure` is matplotlib's>"

    def _repr_png_(self) -> bytes:
        from analysis.figures.style import picture  # matplotlib takes half a second to import

        return picture(self.figure, "png", dpi=100)


@dataclass(frozen=True, repr=False)
class Run(running.CompletedRun):
    """Run that came to an end: its ``directory``, its ``outcome`` and its ``check``.

    ``directory.path`` is the path of its files. ``outcome`` is "done", or "interrupted" with the frames until then; of
    a run that was opened also "failed" or "running". ``check`` is its error against the reference, with the uncertainty
    of that; None if that was not asked for, or another engine than LAMMPS ran.

    Examples:
        >>> done = granchain.run("one-chain", "first")
        >>> done.outcome, done.check.velocity < 2e-4
        ('done', True)
        >>> done.si.velocity.shape == done.trajectory.velocity.shape
        True
    """

    @cached_property
    def analysis(self) -> Analysis:
        """Waves, pulses and energies, measured when they are first asked for; nothing is written.

        Returns:
            The analysis, as that of `analyze`, which writes it beside the frames.

        Raises:
            InputError: there are no frames, or they are damaged.

        Examples:
            >>> done = granchain.run("one-chain", "analysed", engine="reference")
            >>> done.analysis.waves.peak_velocity[40:42].round(3)
            array([0.682, 0.682])
        """
        return analysing.results_of(self.directory, analysing.measure(self.directory, figures=False))

    def view(self) -> Page:
        """Write its page, see `view`; needs Bokeh.

        Returns:
            The page, which a notebook displays.

        Examples:
            >>> granchain.run("one-chain", "seen", engine="reference").view()
            <page seen/view.html>
        """
        return view(self)


@checked
def run(
    scene: AnyScene,
    directory: Path | str,
    *,
    engine: Literal["lammps", "reference", "collisions"] = "lammps",
    ranks: Ranks = 1,
    overwrite: bool = False,
    force: bool = False,
    check: bool = True,
) -> Run:
    """Run a scene in a new directory, after determining what it leaves open (time step, duration, window).

    Args:
        scene: see `load`.
        directory: new or empty, or an earlier run's with ``overwrite``.
        engine: LAMMPS, the reference integrator, or collisions of rigid beads.
        ranks: number of MPI ranks of LAMMPS.
        overwrite: whether an earlier run's files may be replaced.
        force: whether LAMMPS may run with a time step above the stability bound.
        check: whether to measure the error of a LAMMPS run against the reference.

    Returns:
        The run; its frames are read from the disk when they are asked for.

    Raises:
        InputError: the scene or the directory cannot be used.
        RunError: the run failed.

    Examples:
        >>> done = granchain.run("one-chain", "by-reference", engine="reference")
        >>> done.trajectory.velocity.dtype
        dtype('float64')
    """
    ready = running.prepare_run(
        load(scene), Path(directory), engine=engine, ranks=ranks, overwrite=overwrite, force=force, source="scene"
    )
    with progress_bar(ready.scene.name, ready.problem) as progress:
        done = running.run_prepared(ready, check=check, progress=progress)
    return Run(done.directory, done.outcome, done.check)


_OUTCOMES: dict[State, str] = {"done": "done", "failed": "failed", "running": "running"}
"""State of a directory -> outcome of its run; in all others it was interrupted."""


@checked
def open(directory: Path | str) -> Run:
    """Open the directory of a run that exists: of an earlier day, of the command, or back from a cluster.

    Args:
        directory: directory of the run.

    Returns:
        The run, as `run` returns it; its frames are read from the disk when they are asked for.

    Raises:
        InputError: there is no run directory, or it holds no frames.

    Examples:
        >>> earlier = granchain.open("out")
        >>> earlier.outcome, earlier.check.velocity < 2e-4
        ('done', True)
        >>> earlier.trajectory.velocity.shape, len(earlier.analysis.waves)
        ((1921, 2, 120), 240)
    """
    opened = RunDirectory(Path(directory))
    _ = opened.dumps  # refuses a directory without frames
    return Run(opened, _OUTCOMES.get(status(opened.path).state, "interrupted"), checking.recorded(opened))


@checked
def resume(run: AnyRun, *, ranks: Ranks | None = None, check: bool = True) -> Run:
    """Resume a run that was interrupted, killed, or met a full disk; bit for bit as if it had never been interrupted.

    Args:
        run: a run, or its directory.
        ranks: number of MPI ranks of LAMMPS; as many as before by default.
        check: whether to measure the error of a LAMMPS run against the reference.

    Returns:
        The run; one that was done before is opened.

    Raises:
        InputError: no run was begun there, its files were changed, or it is under way.
        RunError: the run failed.

    Examples:
        >>> granchain.resume("out").outcome  # it was done before
        'done'
    """
    directory = run.directory if isinstance(run, running.CompletedRun) else run
    path = directory.path if isinstance(directory, RunDirectory) else Path(directory)
    begun = resuming.begun(path)
    with progress_bar(begun.scene.name, begun.problem) as progress:
        done = resuming.resume(path, ranks=ranks, check=check, progress=progress)
    return open(path) if done is None else Run(done.directory, done.outcome, done.check)


@checked
def deck(scene: AnyScene, directory: Path | str, *, overwrite: bool = False, force: bool = False) -> Path:
    """Write the LAMMPS deck of a scene, for any ``lmp``; `analyze` takes the directory once the deck was run in it.

    Args:
        scene: see `load`.
        directory: new or empty, or an earlier run's with ``overwrite``.
        overwrite: whether an earlier run's files may be replaced.
        force: whether the time step may be above the stability bound.

    Returns:
        Path of the input file, ``in.chains``; ``lmp -in in.chains`` in its directory runs it.

    Raises:
        InputError: the scene or the directory cannot be used, or LAMMPS cannot compute the scene.

    Examples:
        >>> granchain.deck("one-chain", "deck").name
        'in.chains'
    """
    path = Path(directory)
    write_deck(load(scene), path, source=source_of(scene), overwrite=overwrite, force=force)
    return path / file_names.DECK


@checked
def analyze(
    run: AnyRun,
    *,
    figures: bool = False,
    beads: Sequence[Annotated[int, Between(1)]] | None = None,
    arrival: Arrival | None = None,
    gradient: Sequence[str] = (),
    by: Sequence[str] | None = None,
) -> Analysis:
    """Find the waves in a run, and write ``waves.csv`` and ``analysis.json`` beside the frames.

    Args:
        run: a run, or its directory, also one that came back from a cluster.
        figures: whether to draw figures into the directory.
        beads: beads whose velocity over time is drawn; three by default.
        arrival: definition of an arrival: when the bead is fastest ("maximum"), or the centre of the "impulse" until
            then; by default the latter where beads have gaps.
        gradient: quantities whose derivatives are computed with the reference, such as ``["peak_velocity@50"]``.
        by: fields of the scene for these; by default all its numbers.

    Returns:
        The analysis: ``waves`` is the table of ``waves.csv``; ``measurements`` are forces, energy and others;
        ``derivatives`` those that were asked for.

    Raises:
        InputError: there are no frames, they are damaged, or a bead was not recorded; or there is no such derivative.

    Examples:
        >>> analysis = granchain.analyze("out")
        >>> analysis.survey.verdict.sentence[:32]
        'equipartitioned and synchronised'
        >>> analysis = granchain.analyze("out", gradient=["peak_velocity@50"], by=["coupling.stiffness"])
        >>> round(analysis.derivatives[0].derivative, 4)  # V per unit of the coupling
        0.4692
    """
    chosen, directory = None if beads is None else tuple(beads), directory_of(run)
    derivatives = of_run(directory, gradient, by)
    analysis = analysing.analyse(directory, beads=chosen, figures=figures, arrival=arrival)
    return with_derivatives(analysis, directory, derivatives)


@checked
def validate(
    run: AnyRun,
    *,
    against: AnyRun | None = None,
    units: Literal["scene", "dimensionless"] = "scene",
    tolerances: Mapping[str, Annotated[float, Between(0.0)]] | None = None,
) -> Validation:
    """Compare a run with an accurate reference, with another run of its scene, or with a table or traces of your own.

    Args:
        run: what to validate.
        against: another run, or its directory, or a file of yours; the reference if omitted.
        units: units of that file: the scene's, or those in which V, T and L are 1.
        tolerances: quantity -> tolerance in V, T and L, in place of the default, such as ``{"velocity": 1e-3}``.

    Returns:
        The comparison, also written into the run's directory: ``validation.json``, or ``validation-against.json``.

    Raises:
        InputError: frames or file cannot be used, or the two runs are of different scenes.

    Examples:
        >>> granchain.validate("out")
        <validation of two-chains against reference: passed>
        >>> granchain.validate("out", tolerances={"velocity": 1e-12}).verdict("velocity")
        'EXCEEDED'
    """
    limits = dict(tolerances or {})
    for name in limits:
        if name not in validating.TOLERANCES:
            hint = suggestion(name[:60], validating.TOLERANCES)
            raise InputError(f"tolerances: {name[:60]!r} given{hint}; of {', '.join(validating.TOLERANCES)}")
    directory = directory_of(run)
    if against is None:
        return validating.validate(directory, limits)
    other = run_or_file(Path(against)) if isinstance(against, str | Path) else directory_of(against)
    return validate_against(directory, other, dimensionless=units == "dimensionless", tolerances=limits)


@checked
def universe(run: AnyRun) -> Any:
    """Open a run as an ``MDAnalysis.Universe``, also one that was continued; see `analysis.mda.universe`.

    Args:
        run: a run, or its directory.

    Returns:
        The universe: a segment for each chain, a residue for each bead of it. Positions are dimensionless; ``ts.data``
        has float64 values in units of V, T and L, and in the scene's units as ``ts.data["si"]``.

    Raises:
        InputError: there are no frames, or they are damaged.

    Examples:
        >>> granchain.universe("out").segments.segids.tolist()
        ['C1', 'C2']
    """
    from analysis.mda.universe import universe as make_universe

    directory = directory_of(run)
    try:
        return make_universe(directory.problem, directory.dumps)
    except (OSError, ValueError) as error:
        raise InputError(str(error)) from None


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


@checked
def view(run_or_sweep: AnyRun, against: AnyRun | None = None) -> Page:
    """Write the interactive page of a run or a sweep, ``view.html``, or of two runs, ``against-B.html``.

    Args:
        run_or_sweep: a run, or the directory of a run or a sweep; the page is in its directory.
        against: another run with the same chains and beads, or its directory B.

    Returns:
        The page, which a notebook displays.

    Raises:
        InputError: there are no frames or cases, the two runs cannot be compared, or Bokeh is not installed.

    Examples:
        >>> granchain.view("out")
        <page out/view.html>
    """
    need_bokeh()
    from workflow.plugins.pages import write

    if against is not None:
        return Page(write.write_comparison(directory_of(run_or_sweep), directory_of(against)))
    if isinstance(run_or_sweep, running.CompletedRun):
        run_or_sweep = run_or_sweep.directory
    path = run_or_sweep.path if isinstance(run_or_sweep, RunDirectory) else Path(run_or_sweep)
    return Page(write.write(path))
