"""Runs for scripts and notebooks: made, opened, resumed; the deck of one."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any

from lammps_inputs import file_names, plugins
from workflow.checked import Between, checked
from workflow.engines.registry import EngineName
from workflow.inputs import AnyRun, AnyScene, load, source_of
from workflow.runs import check as checking
from workflow.runs import resume as resuming
from workflow.runs import run as running
from workflow.runs.completed_run import CompletedRun
from workflow.runs.deck_directory import write_deck
from workflow.runs.run_directory import RunDirectory
from workflow.runs.status import State, status
from workflow.screen import progress_bar
from workflow.verdicts import analyse as analysing
from workflow.verdicts.analyse import Analysis

Ranks = Annotated[int, Between(1)]
"""Number of MPI ranks of LAMMPS."""


@dataclass(frozen=True, repr=False)
class Run(CompletedRun):
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

    @property
    def dataset(self) -> Any:
        """All frames as an ``xarray.Dataset`` in the scene's units: what ``granchain export --to netcdf`` writes.

        Its dimensions are ``time``, ``chain`` and ``bead``; its attributes are the scene, versions and the error.

        Raises:
            InputError: xarray is not installed.
        """
        from workflow.runs.labelled import dataset  # for those who have xarray

        return dataset(self.directory, self.trajectory)

    def view(self) -> Any:
        """Write its page, see `view`; needs Bokeh.

        Returns:
            The page, which a notebook displays.

        Examples:
            >>> granchain.run("one-chain", "seen", engine="reference").view()
            <page seen/view.html>
        """
        return plugins.load("functions", "view")(self)


@checked
def run(
    scene: AnyScene,
    directory: Path | str,
    *,
    engine: EngineName = "lammps",
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
    return Run(opened, _OUTCOMES.get(status(opened.path).state, "interrupted"), checking.stored_check(opened))


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
    directory = run.directory if isinstance(run, CompletedRun) else run
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
