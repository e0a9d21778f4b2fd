"""Analyse the frames of a run directory, which are read twice: waves, measurements, tables, and panels of figures.

Plug-ins take this module for the analysis of a run: `measure` makes it and writes nothing, `default_beads` are those
whose velocity is drawn, `figures_in` the figures that were drawn.

Examples:
    >>> scene = granchain.load("one-chain", {"beads": 20, "duration": 30.0})
    >>> done = granchain.run(scene, tmp / "run", engine="reference")
    >>> measured = analyse.measure(done.directory, figures=False)
    >>> measured.survey.waves.at(15).peak_velocity.round(3), sorted(measured.tables)  # in units of V
    (array([0.682]), ['waves.csv'])
    >>> analyse.default_beads(done.directory.problem)
    (4, 11, 18)
"""

import hashlib
import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from analysis.conservation import Conservation, ConservationMeter
from analysis.figures.panels import Sheet
from analysis.figures.spacetime import BeadHistory, HistoryMeter, space_time_meter, spacetime_sheet
from analysis.figures.waves import distance_sheet, response_sheet, shape_sheet
from analysis.files.binary_dump import CutDumpWarning
from analysis.meters import Meter
from analysis.quantity import csv_of
from analysis.sharing.equipartition import runs_exact_waves
from analysis.sharing.is_solitary import Tolerances
from analysis.sharing.run_error import UNMEASURED, MeasuredError, with_run_error
from analysis.sharing.survey import Survey, surveyed
from analysis.tracking.leading_waves import Arrival
from analysis.tracking.undisturbed import CLEAR
from analysis.trajectory import Trajectory, along_the_way
from lammps_inputs import InputError, Problem, html, physics
from lammps_inputs.facts import Fact
from lammps_inputs.output import too_far_apart
from workflow.formats import in_any_format
from workflow.measures.measurement import Measurement, Recorded
from workflow.measures.registry import MEASUREMENTS
from workflow.runs.engines import engine_called
from workflow.runs.exchange import accountant
from workflow.runs.run_directory import RunDirectory, digested
from workflow.verdicts.analysis_report import WAVES, WavesTable, waves_table
from workflow.verdicts.pulse_table import pulse_table

FIGURES = ("spacetime", "response", "distance", "shape", *(kind.figure for kind in MEASUREMENTS if kind.figure))
"""All that an analysis may draw."""


def figures_in(directory: Path) -> list[str]:
    """Names of the files of figures that an analysis has drawn into a directory, in the order of `FIGURES`."""
    return [name for name in in_any_format(*FIGURES) if (directory / name).is_file()]


LARGEST = 1e100
"""Displacement or velocity that no run has, far from where squares overflow; dimensionless."""


@dataclass(frozen=True, repr=False)
class Analysis:
    """Waves, pulses and energies of a run, as ``analysis.json`` and the tables hold them.

    Attributes:
        problem: what was run; ``problem.scale`` turns dimensionless numbers into the scene's units.
        survey: waves, pulses, energies and the verdict, in units of V, T and L.
        conservation: drifts of energy and momentum, number of frames.
        complete: whether the dump holds every frame that the scene asks for.
        tables: names of the CSV files.
        figures: files drawn.
        failure: why the run failed; empty where it did not.
        altered: whether frames are not those that the run wrote, by the fingerprint in ``run.json``.
        measurements: what not every run has, by its key in ``analysis.json``, in the order of the text
            (`workflow.measures`); ``plain()`` of each is in the scene's units.
        derivatives: of quantities by fields of the scene, where they were asked for; records with ``quantity``,
            ``field``, ``value``, ``derivative``, ``uncertainty``, ``unit`` and ``relative``.
        error: measured error of the run, which the uncertainties cover.

    Examples:
        >>> analysis = granchain.analyze("out")
        >>> analysis.complete, analysis.tables
        (True, ('waves.csv',))
        >>> analysis.survey.pulses[0].direction, analysis.conservation.energy_drift < 1e-4
        (1, True)
    """

    problem: Problem
    survey: Survey
    conservation: Conservation
    complete: bool
    tables: tuple[str, ...]
    figures: tuple[Path, ...]
    failure: str
    altered: bool
    measurements: dict[str, Measurement]
    derivatives: tuple[Any, ...] = ()
    error: MeasuredError = UNMEASURED

    @cached_property
    def waves(self) -> WavesTable:
        """Leading wave of each chain at each bead: the table of ``waves.csv``, in the scene's units.

        Dimensionless, in units of V and T, are ``survey.waves``.

        Returns:
            The table, [wave]; undefined numbers are NaN.

        Examples:
            >>> analysis = granchain.analyze("out")
            >>> analysis.waves
            <leading waves of 2 chains at 120 beads: 240 rows, reduced units>
            >>> analysis.waves.arrival.shape
            (240,)
        """
        return waves_table(self.survey)

    def __repr__(self) -> str:
        several = self.problem.chains > 1
        count = len(self.survey.pulses)
        pulses = "no pulse was tracked" if count == 0 else f"{count} pulse{'s were' if count > 1 else ' was'} tracked"
        return f"<analysis of {self.problem.name}: {self.survey.verdict.sentence if several else pulses}>"

    def _repr_html_(self) -> str:
        drawn = ", ".join(path.name for path in self.figures)
        table = pulse_table(self.survey)
        head, rows = ([], []) if table is None else (table.head, table.rows)
        return html.table(repr(self)[1:-1], head, rows) + html.text(drawn)


@dataclass(frozen=True)
class MeasuredFrames:
    """What an analysis writes, before it is written.

    Attributes:
        survey: waves, pulses, energies and the verdict, in units of V, T and L.
        error: measured error of the run, which uncertainties of the survey cover.
        conservation: drifts of energy and momentum, number of frames.
        measurements: what not every run has, by its key in ``analysis.json``.
        tolerances: within which a pulse is called solitary.
        sha256: fingerprint of the frames that were read.
        tables: file name -> text of each CSV file.
        figures: name -> function that makes the panels of the figure; none where none was asked for.
    """

    survey: Survey
    error: MeasuredError
    conservation: Conservation
    measurements: dict[str, Measurement]
    tolerances: Tolerances
    sha256: str
    tables: dict[str, str]
    figures: dict[str, Callable[[], Sheet]]


def results_of(directory: RunDirectory, frames: MeasuredFrames, drawn: tuple[Path, ...] = ()) -> Analysis:
    """Results of an analysis.

    Args:
        directory: the run directory.
        frames: what was measured in its frames.
        drawn: files of the figures.

    Returns:
        The analysis.
    """
    conservation = frames.conservation
    return Analysis(
        problem=frames.survey.problem,
        survey=frames.survey,
        conservation=conservation,
        complete=conservation.frames == frames.survey.problem.frames + 1,
        tables=tuple(frames.tables),
        figures=drawn,
        failure=directory.failure,
        altered=directory.fingerprint not in ("", frames.sha256),
        measurements=frames.measurements,
        error=frames.error,
    )


def measure(
    directory: RunDirectory,
    *,
    beads: tuple[int, ...] | None = None,
    figures: bool = True,
    tolerances: Tolerances | None = None,
    arrival: Arrival | None = None,
) -> MeasuredFrames:
    """Read the frames of a directory, also of a run that was cut short, and measure them; nothing is written.

    Args:
        directory: a run directory.
        beads: whose velocity over time is drawn; by default three, see `default_beads`.
        figures: whether there are to be figures.
        tolerances: within which a pulse is called solitary; by default 1% each.
        arrival: what counts as the arrival of a wave; by default that of `leading_waves.usual_arrival`.

    Returns:
        Results, tables and figures.

    Raises:
        InputError: no frames, frames that hold what is no number, or a bead that was not recorded.
    """
    problem, allowed = directory.problem, tolerances or Tolerances()
    shown = default_beads(problem) if beads is None else beads
    _refuse_frames(directory, shown)
    engine, run, exchange = engine_called(directory.engine), run_of(directory), accountant(directory, problem)
    digest = hashlib.sha256()
    pictures = _pictures(problem, shown) if figures else {}
    meters = {kind.key: meter for kind in MEASUREMENTS if (meter := kind.meter(run)) is not None}
    of_frames_alone, others = surveyed(
        lambda: _sane(directory, directory.blocks()),
        problem,
        {"conservation": ConservationMeter(problem), **pictures, **meters},
        tolerances=allowed,
        arrival=arrival,
        counted=lambda blocks: exchange.counted(digested(blocks, digest)),
        impulses=engine.impulses(directory.path, problem),
    )
    results = _without_errors_by_rounding(with_run_error(of_frames_alone, run.error), engine.rounded_from(run.job))
    conservation: Conservation = others["conservation"]
    if conservation.frames == 1:  # nothing has changed yet
        conservation = replace(conservation, energy_drift=np.nan, momentum_drift=np.nan, budget=None)
    of_energies = (kind.of_energies(run, conservation, exchange.uncertainty) for kind in MEASUREMENTS)
    measured = (*(kind.of_run(run, results, others.get(kind.key)) for kind in MEASUREMENTS), *of_energies)
    measurements = {measurement.key: measurement for measurement in measured if measurement is not None}
    return MeasuredFrames(
        survey=results,
        error=run.error,
        conservation=conservation,
        measurements=measurements,
        tolerances=allowed,
        sha256=digest.hexdigest(),
        tables=_tables(results, measurements),
        figures=_makers(results, measurements, others["spacetime"], others["response"]) if figures else {},
    )


def _refuse_frames(directory: RunDirectory, shown: tuple[int, ...]) -> None:
    """Refuse frames without a bead that is to be drawn, and those too far apart to find waves.

    Raises:
        InputError: naming the option or the directory.
    """
    problem = directory.problem
    for bead in shown:
        if bead not in problem.rows.numbers:
            raise InputError(f"--beads: bead {bead} is not among the recorded ones")
    if why := too_far_apart(problem.every, problem.scale, physics.pulse_time(problem.system)):
        raise InputError(f"{directory.path}: output.every: {why}")


def _pictures(problem: Problem, shown: tuple[int, ...]) -> dict[str, Meter[Any, Any]]:
    """Figure -> meter of what it shows: velocity in space and time, and of some beads."""
    return {"spacetime": space_time_meter(problem), "response": HistoryMeter(problem, np.array(shown))}


def run_of(directory: RunDirectory) -> Recorded:
    """The run of a directory as measures see it."""
    return Recorded(
        scene=directory.scene,
        problem=directory.problem,
        error=run_error(directory),
        job=directory.account,
    )


def run_error(directory: RunDirectory) -> MeasuredError:
    """Error of a run by its check, or of the reference's by step halving; of all others none is known."""
    account = directory.account
    if account.check is not None:
        reference = account.check.reference
        measured = (account.check.velocity, account.check.amplitude, account.check.arrival)
    elif account.uncertainty is not None:
        reference, measured = account.uncertainty, (0.0, None, None)
    else:
        return UNMEASURED
    velocity, amplitude, arrival = (math.nan if value is None else value for value in measured)
    of_reference = (math.nan if value is None else value for value in (reference.velocity, reference.arrival))
    return MeasuredError.of(velocity, amplitude, arrival, *of_reference)


def _without_errors_by_rounding(results: Survey, rounded_from: float | None) -> Survey:
    """Results without uncertainties of passages that rounding decides, from a time in the scene's unit on."""
    if rounded_from is None:
        return results
    waves = results.waves
    follows = waves.time * results.problem.scale.time >= rounded_from
    names = "arrival_error", "peak_velocity_error", "speed_error"
    waves = replace(waves, **{name: np.where(follows, np.nan, getattr(waves, name)) for name in names})
    lags = results.lags._replace(error=np.where(follows, np.nan, results.lags.error))
    return results.replaced(passages=waves, waves=waves, lags=lags)


def _tables(results: Survey, measurements: dict[str, Measurement]) -> dict[str, str]:
    """File name -> text of each CSV file: the leading waves, and the tables of what only some runs have."""
    tables = {WAVES: waves_table(results).to_csv()}
    for measurement in measurements.values():
        if measurement.table is not None and (rows := measurement.rows()) is not None:
            tables[measurement.table[0]] = csv_of(rows, results.problem.scale)
    return tables


def _sane(directory: RunDirectory, blocks: Iterator[Trajectory]) -> Iterator[Trajectory]:
    """Blocks of numbers that can be computed with.

    Without a warning of a cut frame at their end: that the run is incomplete is said in words.

    Raises:
        InputError: one is not finite, or so large that its square is not.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CutDumpWarning)
        for block in blocks:
            for name, values in (("displacement", block.displacement), ("velocity", block.velocity)):
                size = max(float(values.max()), -float(values.min()))  # NaN comes through
                if not size < LARGEST:
                    frame, chain, bead = (int(k[0]) for k in np.nonzero(~(np.abs(values) < LARGEST)))
                    when = block.problem.scale.written(block.time[frame], "time")
                    raise InputError(
                        f"{directory.path}: the {name} of bead {block.beads[bead]} of chain {chain + 1} is "
                        f"{values[frame, chain, bead]:.3g} at t = {when}; "
                        f"{directory.failure or 'the frames are damaged, or the run went wrong: run it again'}"
                    )
            yield block


def default_beads(problem: Problem) -> tuple[int, ...]:
    """Three recorded beads: near a sixth, a half and nine tenths of the way, or near the kick where no pulse runs.

    Args:
        problem: what was run.

    Returns:
        Numbers of the beads, ascending.
    """
    beads = problem.rows.numbers
    if not problem.system.holds(Fact.PULSE):
        kicked_bead = physics.largest_excitation(problem.system)[1]
        direction = problem.direction
        return tuple(
            sorted({int(beads[np.argmin(np.abs(beads - kicked_bead - direction * far))]) for far in (0, 2, 5)})
        )
    places = np.unique(np.round(np.array([0.17, 0.5, 0.9]) * (len(beads) - 1)).astype(int))
    return tuple(int(beads[place]) for place in places)


def _makers(
    results: Survey, measurements: dict[str, Measurement], spacetime: BeadHistory, history: BeadHistory
) -> dict[str, Callable[[], Sheet]]:
    """Name -> function that makes the panels of the figure, of every figure that has something to show."""
    problem = results.problem
    system = problem.system
    waves = results.waves if system.holds(Fact.PULSE) else None
    makers: dict[str, Callable[[], Sheet]] = {"response": lambda: response_sheet(history, waves)}
    if len(spacetime.beads) > 1:
        makers["spacetime"] = lambda: spacetime_sheet(spacetime)
    if len(results.shared) > 1 and system.holds(Fact.PULSE):
        makers["distance"] = lambda: distance_sheet(problem, results.shared, results.energies, results.direction)
    beads = np.unique(along_the_way(problem, results.waves.bead[np.isfinite(results.shape.residual)]))
    beads = along_the_way(problem, beads[beads <= problem.beads - CLEAR])
    if len(beads) and runs_exact_waves(system):
        early, late = beads[min(len(beads) - 1, int(np.searchsorted(along_the_way(problem, beads), 10)))], beads[-1]
        makers["shape"] = lambda: shape_sheet(problem, results.waveforms, sorted({int(early), int(late)}))
    sheets = {measurement.figure: measurement.sheet() for measurement in measurements.values()}
    return makers | {name: lambda sheet=sheet: sheet for name, sheet in sheets.items() if sheet is not None}
