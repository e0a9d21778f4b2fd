"""Compare a run with a user's own trajectory in a file, quantity by quantity, or with measured traces."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from analysis.compare import common_times, start
from analysis.compare.difference import Deviation, DeviationPlace, DifferenceMeter, deviation_of
from analysis.compare.rounding import precision, rounding_error
from analysis.files import table, text_dump, traces
from analysis.files.table import TrajectoryTable
from analysis.gauges import channels
from analysis.trajectory import Floats, Trajectory, joined
from lammps_inputs import InputError, Problem, physics
from lammps_inputs.deck_atoms import DeckAtoms
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.diagnose import Diagnosis, diagnose
from workflow.verdicts.validate import TOLERANCES, Validation, any_exceeded, error_figure, limits_of, of_pulses, write


def validate_table(
    directory: RunDirectory, path: Path, *, dimensionless: bool = False, tolerances: dict[str, float] | None = None
) -> Validation:
    """Compare a run with a user's own trajectory in a file; writes what `validate` writes.

    Files: see `analysis.files.table`.

    The run is interpolated to the table's times. Peaks and arrivals are compared where the table has displacement and
    velocity at evenly spaced times. That the table's numbers are rounded is remarked, and is the cause where a
    tolerance is exceeded for no other reason.

    Args:
        directory: the run.
        path: the table.
        dimensionless: whether the table is in units of V = 1; else it is in the scene's own units.
        tolerances: quantity -> largest difference let pass, in place of the one in `TOLERANCES`, dimensionless.

    Raises:
        InputError: the table cannot be read, or has chains, beads or times that the run has not.
    """
    problem = directory.problem
    deck = directory.scene.adopted
    loaded = _loaded(path, problem, deck, dimensionless=dimensionless)
    rounding = _step_of_positions(loaded) / (1.0 if dimensionless else problem.scale.length)
    limits = limits_of(problem, tolerances)
    if "displacement" not in (tolerances or {}):
        limits["displacement"] += rounding
    run_frames = joined(directory.blocks_so_far())[: problem.frames + 1]
    theirs = as_trajectory(loaded, problem, dimensionless=dimensionless)
    run_part = common_times.of_recorded(run_frames, theirs.problem)
    resampled = _resampled(path, run_part, theirs.time, incomplete=run_frames.frames < problem.frames + 1)
    pair = only_where_known(resampled, theirs), only_where_known(theirs, theirs)
    difference = DifferenceMeter(limits).read(common_times.paired_parts([pair]))
    deviations = difference.deviations
    coarse = rounding > TOLERANCES["amplitude"]
    deviations = {name: deviations[name] for name in _quantities(loaded, theirs, coarse) if name in deviations}
    exceeded = any_exceeded(deviations, limits)
    diagnosable = exceeded and theirs.problem.rows.neighbours
    diagnosis = _diagnosis(path, theirs, resampled, coarse) if diagnosable else Diagnosis()
    causes, notes = diagnosis.causes, tuple(rounded(path, theirs))
    if rounding:
        notes = _rounding_of_positions(path, loaded, rounding, (diagnosis.remark,))
    elif exceeded and not causes:
        if notes:  # nothing else explains the deviation
            causes, notes = notes, ()
        elif diagnosis.remark:
            notes = (diagnosis.remark,)
    result = Validation(
        problem=problem,
        against=str(path),
        deviations=deviations,
        tolerances=limits,
        causes=causes,
        remarks=(*notes, *_of_dump(path, loaded, deck), *remarks(path, theirs, run_frames)),
        interpolation=None if are_frames(theirs, run_frames) else common_times.interpolation_error(run_part),
        frames=run_frames.frames,
        compared=len(theirs.time),
    )
    write(directory.path, result, error_figure(result, difference, path.name))
    return result


def _resampled(path: Path, run: Trajectory, times: Floats, *, incomplete: bool) -> Trajectory:
    """A run at the times [frame] of a table.

    Raises:
        InputError: they reach beyond the run.
    """
    try:
        return common_times.at_times(run, times)
    except InputError as error:
        reason = "the run is incomplete" if incomplete else "if the table is in other units, see --units"
        raise InputError(f"{path}: {error}; {reason}") from None


def _step_of_positions(loaded: TrajectoryTable) -> float:
    """Step to which positions of a dump are rounded, the largest error of a displacement; 0 without positions."""
    return 0.0 if loaded.position is None else 2.0 * rounding_error(loaded.position) * loaded.position_unit


def _rounding_of_positions(
    path: Path, loaded: TrajectoryTable, rounding: float, others: tuple[str, ...]
) -> tuple[str, ...]:
    """How far positions of a dump were rounded, what follows from that, and other remarks that are not empty."""
    step = _step_of_positions(loaded)
    line = (
        f"positions in {path} are rounded to {step:.1g} (its unit of length), so that displacements are uncertain by "
        f"{rounding:.1g} L, which is part of their tolerance"
    )
    if rounding > TOLERANCES["amplitude"]:
        line += "; peaks and arrivals do not follow from them (write them with `dump_modify ID format float %.17g`)"
    return (line, *filter(None, others))


def _of_dump(path: Path, loaded: TrajectoryTable, deck: DeckAtoms | None) -> Iterator[str]:
    """How a dump was read: through the map of an adopted deck; without displacements where it begins late."""
    if not loaded.dump:
        return
    if deck is not None:
        yield f"{path} was read as a dump of {deck.deck}, from which the scene was adopted (its atoms: key `adopted`)"
    if loaded.time[0] > 0.0 and loaded.displacement is None:
        yield f"{path} begins after the start, so that displacements are unknown and velocities alone are compared"


def _quantities(loaded: TrajectoryTable, theirs: Trajectory, coarse: bool) -> list[str]:
    """Quantities that a table determines; peaks and arrivals only by both motions at evenly spaced times.

    Where displacements are coarse, peaks between frames do not follow from them.
    """
    names = [name for name in table.VALUES if getattr(loaded, name) is not None]
    complete = not any(
        np.isnan(values[:, loaded.chains - 1]).any() for values in (theirs.displacement, theirs.velocity)
    )
    if complete and not coarse and len(theirs.time) > 8 and evenly_spaced(theirs.time):
        names += ["amplitude", "arrival"]
    return names


def _diagnosis(path: Path, theirs: Trajectory, run: Trajectory, coarse: bool) -> Diagnosis:
    """Likely causes of what a table and a run at its times differ by: those in the table, else those in the run.

    From coarse positions no forces follow, and only the velocities at the start are compared with the scene's.
    """
    if coarse:
        causes = tuple(f"{path}: {cause}" for cause in start.differences(theirs)) if theirs.time[0] == 0.0 else ()
        return Diagnosis(
            causes, "" if causes else f"{path}: no cause could be determined: positions have too few digits"
        )
    in_table = diagnose(theirs, run)
    if in_table.causes:
        return Diagnosis(tuple(f"{path}: {cause}" for cause in in_table.causes))
    in_run = diagnose(run, theirs)
    return in_run if in_run.causes else Diagnosis(remark=f"{path}: {in_table.remark}")


def _loaded(path: Path, problem: Problem, deck: DeckAtoms | None, *, dimensionless: bool) -> TrajectoryTable:
    """The table in a file, with chains and beads of a problem.

    Raises:
        InputError: it cannot be read, or has chains or beads that the problem has not.
    """
    if text_dump.is_text_dump(path):
        step = problem.timestep * problem.scale.time if deck is None else deck.timestep
        loaded = text_dump.load_dump(path, problem.beads, step / problem.scale.time if dimensionless else step, deck)
    else:
        loaded = table.load(path)
    check_places(path, loaded, problem)
    return loaded


def _beads_of(path: Path, measured: traces.Traces, problem: Problem, *, dimensionless: bool) -> tuple[int, ...]:
    """Beads whose motion traces show.

    Raises:
        InputError: the run did not record one of them, or the traces are of other things or units.
    """
    if measured.signals:
        raise InputError(f"{path}: its gain or baseline is to be estimated, which `granchain fit` does; give a number")
    if measured.units and (dimensionless or not problem.scale.si):
        raise InputError(f"{path}: names units, but is to be in others (the scene has no material, or --units)")
    channels.check(path, measured.channels, problem)
    beads = channels.beads_of(measured.channels, problem)
    missing = sorted(set(beads) - set(problem.rows.numbers.tolist()))
    if problem.rows.follow or missing:
        raise InputError(f"{path}: needs the motion of bead {(missing or beads)[0]}, which the run did not record")
    return beads


def validate_traces(
    directory: RunDirectory,
    file: Path | traces.TraceFile,
    *,
    dimensionless: bool = False,
    tolerances: dict[str, float] | None = None,
    offset: float = 0.0,
) -> Validation:
    """Compare a run with traces in a file (`analysis.files.traces`); writes ``validation-against.json`` and a figure.

    Args:
        directory: the run.
        file: the table, whose traces are zero before the start of the run.
        dimensionless: whether the table is in units of V = 1; else it is in the scene's own units.
        tolerances: quantity -> largest difference let pass, in place of the one in `TOLERANCES`, dimensionless.
        offset: by how much the table's times are later than the run's, in the table's unit of `dimensionless`.

    Raises:
        InputError: the table cannot be read, or is of chains, beads, walls or times that the run has not.
    """
    limits = {**of_pulses(TOLERANCES, directory.problem.system), **(tolerances or {})}
    path = file if isinstance(file, Path) else file.path
    problem, measured = directory.problem, traces.load(file)
    beads = _beads_of(path, measured, problem, dimensionless=dimensionless)
    measured = replace(measured, time=measured.time - offset)
    worth = np.array([getattr(problem.scale, channel.quantity) for channel in measured.channels])
    if dimensionless:
        measured = replace(measured, time=measured.time * problem.scale.time, values=measured.values * worth)
    run_frames = joined(directory.blocks())[: problem.frames + 1]
    run = common_times.of_recorded(run_frames, replace(problem, rows=problem.rows.only(beads)))
    try:
        computed = channels.read_at(run, measured.channels, measured.time)
    except InputError as error:
        raise InputError(f"{path}: {error}; if the table is in other units, see --units") from None
    apart = (computed - measured.values) / worth
    times = measured.time / problem.scale.time
    kinds = {"length": "displacement"}
    channel_limits = {
        channel.name: limits[kinds.get(channel.quantity, channel.quantity)] for channel in measured.channels
    }
    result = Validation(
        problem=problem,
        against=str(path),
        deviations={
            channel.name: _deviation(channel, column, times, channel_limits[channel.name], problem)
            for channel, column in zip(measured.channels, apart.T, strict=True)
        },
        tolerances=channel_limits,
        frames=run_frames.frames,
        compared=len(measured.time),
    )
    from analysis.figures.errors import residual_figure  # matplotlib takes half a second to import

    allowed = np.array(list(channel_limits.values())) * worth
    write(directory.path, result, residual_figure(problem, measured, computed, allowed, "tolerance"))
    return result


def _deviation(channel: traces.Channel, apart: Floats, times: Floats, tolerance: float, problem: Problem) -> Deviation:
    defined = np.isfinite(apart)
    when = times[defined]
    bead = channel.bead or (problem.beads if channel.right else 1)
    return deviation_of(apart[defined], when, tolerance, lambda k: DeviationPlace(channel.chain, bead, float(when[k])))


def as_trajectory(loaded: TrajectoryTable, problem: Problem, *, dimensionless: bool) -> Trajectory:
    """A table made dimensionless, for every chain of the scene; NaN where the table has nothing."""
    scale = problem.scale
    units = (1.0, 1.0, 1.0) if dimensionless else (scale.time, scale.length, scale.velocity)
    values = []
    for column, unit in ((loaded.displacement, units[1]), (loaded.velocity, units[2])):
        full = np.full((len(loaded.time), problem.chains, len(loaded.beads)), np.nan)
        if column is not None:
            full[:, loaded.chains - 1] = column / unit
        values.append(full)
    # a table holds the chains alone
    everything = physics.lines(problem.system) == problem.chains and len(loaded.beads) == problem.beads
    everything = everything and not np.isnan(values).any()
    rows = problem.rows.only(None if everything else loaded.beads)
    displacement, velocity = values
    return Trajectory(replace(problem, rows=rows), loaded.time / units[0], displacement, velocity)


def check_places(path: Path, loaded: TrajectoryTable, problem: Problem) -> None:
    """Refuse a table with chains or beads that the run has not.

    Raises:
        InputError: naming the first of them.
    """
    chains = np.setdiff1d(loaded.chains, np.arange(1, problem.chains + 1))
    if len(chains):
        raise InputError(f"{path}: has chain {chains[0]}, but the scene has chains 1 to {problem.chains}")
    beads = np.setdiff1d(loaded.beads, problem.rows.numbers)
    if len(beads):
        raise InputError(f"{path}: has bead {beads[0]}, which the run did not record")


def only_where_known(trajectory: Trajectory, table: Trajectory) -> Trajectory:
    """A trajectory with zeros where a table has nothing, so that nothing differs there."""
    return replace(
        trajectory,
        displacement=np.where(np.isnan(table.displacement), 0.0, trajectory.displacement),
        velocity=np.where(np.isnan(table.velocity), 0.0, trajectory.velocity),
    )


def evenly_spaced(time: Floats) -> bool:
    """Whether times [frame] are within a hundredth of a step of where even steps would put them."""
    even = np.linspace(time[0], time[-1], len(time))
    return bool(np.max(np.abs(time - even)) <= 0.01 * (even[1] - even[0]))


def are_frames(theirs: Trajectory, run_frames: Trajectory) -> bool:
    """Whether all times of one are times of the other."""
    nearest = run_frames.time[
        np.clip(np.round(theirs.time / run_frames.problem.every).astype(int), 0, run_frames.frames - 1)
    ]
    return bool(np.all(np.abs(theirs.time - nearest) <= 1e-9 * run_frames.problem.every))


def rounded(path: Path, theirs: Trajectory) -> Iterator[str]:
    """Which of a table's numbers are rounded."""
    for name, values in (("displacements", theirs.displacement), ("velocities", theirs.velocity)):
        digits = precision(values)
        if digits is not None:
            yield f"{name} in {path} have only {digits}"


def remarks(path: Path, theirs: Trajectory, run_frames: Trajectory) -> Iterator[str]:
    """What a table's owner may not know of it beside: that it ends soon after the start."""
    if theirs.time[-1] < 0.01 * run_frames.time[-1]:
        share = theirs.time[-1] / run_frames.time[-1]
        yield f"{path} ends at {share:.2g} of the run: is it in other units? (see --units)"
