"""A user's table beside a run: as a trajectory of the same beads, and what is to be said of it."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from analysis.against import symptoms
from analysis.files.table import Table
from analysis.files.traces import Channel
from analysis.gauges.channels import complaint
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import InputError, Problem


def as_trajectory(given: Table, problem: Problem, *, dimensionless: bool) -> Trajectory:
    """A table made dimensionless, for every chain of the scene; NaN where the table has nothing."""
    scale = problem.scale
    units = (1.0, 1.0, 1.0) if dimensionless else (scale.time, scale.length, scale.velocity)
    values = []
    for column, unit in ((given.displacement, units[1]), (given.velocity, units[2])):
        full = np.full((len(given.time), problem.chains, len(given.beads)), np.nan)
        if column is not None:
            full[:, given.chains - 1] = column / unit
        values.append(full)
    everything = len(given.beads) == problem.beads and not np.isnan(values).any()
    recorded = None if everything else tuple(int(bead) for bead in given.beads)
    displacement, velocity = values
    return Trajectory(replace(problem, recorded=recorded), given.time / units[0], displacement, velocity)


def check_places(path: Path, given: Table, problem: Problem) -> None:
    """Refuse a table with chains or beads that the run has not.

    Raises:
        InputError: naming the first of them.
    """
    chains = np.setdiff1d(given.chains, np.arange(1, problem.chains + 1))
    if len(chains):
        raise InputError(f"{path}: has chain {chains[0]}, but the scene has chains 1 to {problem.chains}")
    beads = np.setdiff1d(given.beads, problem.recorded_beads)
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
    """Whether all of some times are within a hundredth of a step of where even steps would put them."""
    even = np.linspace(time[0], time[-1], len(time))
    return bool(np.max(np.abs(time - even)) <= 0.01 * (even[1] - even[0]))


def are_frames(theirs: Trajectory, own: Trajectory) -> bool:
    """Whether all times of one are times of the other."""
    nearest = own.time[np.clip(np.round(theirs.time / own.problem.every).astype(int), 0, own.frames - 1)]
    return bool(np.all(np.abs(theirs.time - nearest) <= 1e-9 * own.problem.every))


def rounded(path: Path, theirs: Trajectory) -> Iterator[str]:
    """Which of a table's numbers are rounded."""
    for name, values in (("displacements", theirs.displacement), ("velocities", theirs.velocity)):
        precision = symptoms.precision(values)
        if precision is not None:
            yield f"{name} in {path} have only {precision}"


def remarks(path: Path, theirs: Trajectory, own: Trajectory) -> Iterator[str]:
    """What a table's owner may not know of it beside: that it ends soon after the start."""
    if theirs.time[-1] < 0.01 * own.time[-1]:
        yield f"{path} ends at {theirs.time[-1] / own.time[-1]:.2g} of the run: is it in other units? (see --units)"


def check_channels(path: Path, channels: tuple[Channel, ...], problem: Problem) -> None:
    """Refuse traces of what the scene has not.

    Raises:
        InputError: naming the first of them.
    """
    for channel in channels:
        wrong = complaint(channel, problem)
        if wrong is not None:
            raise InputError(f"{path}: has {channel.name}, but {wrong}")
