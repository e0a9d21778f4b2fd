"""Traces of a run as they would have been measured: of each channel, over time."""

import numpy as np

from analysis.against import common_times
from analysis.files.traces import Channel
from analysis.gauges.forces import at_frames
from analysis.gauges.gauge import Gauge, gauges
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem, physics


def complaint(channel: Channel, problem: Problem) -> str | None:
    """Why a problem has no such channel; None if it has."""
    beads = problem.beads
    if not 1 <= channel.chain <= problem.chains:
        return f"the scene has chains 1 to {problem.chains}"
    if channel.kind == "wall":
        sides = [link.side > 0.0 for link in physics.walls(problem.system)]
        return None if channel.right in sides else f"the scene has no {'right' if channel.right else 'left'} wall"
    first, last = {"contact": (1, beads - 1), "sensor": (2, beads - 1)}.get(channel.kind, (1, beads))
    return None if first <= channel.bead <= last else f"beads {first} to {last} of the scene have such"


def beads_of(channels: tuple[Channel, ...], problem: Problem) -> tuple[int, ...]:
    """Beads whose motion the channels follow from, ascending."""
    found = set()
    for channel in channels:
        if channel.kind == "wall":
            found.add(problem.beads if channel.right else 1)
        else:
            before, after = {"contact": (0, 1), "sensor": (1, 1)}.get(channel.kind, (0, 0))
            found |= set(range(channel.bead - before, channel.bead + after + 1))
    return tuple(sorted(found))


def read(trajectory: Trajectory, channels: tuple[Channel, ...]) -> Floats:
    """Dimensionless values at the frames, [frame, channel]; the beads of `beads_of` must be recorded."""
    problem = trajectory.problem
    asked = [(_gauge(channel, problem), channel) for channel in channels]
    distinct = {gauge.name: gauge for gauge, _ in asked if gauge is not None}
    force = at_frames(trajectory, tuple(distinct.values()))
    place = {name: number for number, name in enumerate(distinct)}
    values = np.empty((trajectory.frames, len(channels)))
    for column, (gauge, channel) in enumerate(asked):
        if gauge is not None:
            values[:, column] = force[:, channel.chain - 1, place[gauge.name]]
            if channel.dynamic:
                values[:, column] -= gauge.static[channel.chain - 1]
        else:
            of = trajectory.velocity if channel.kind == "velocity" else trajectory.displacement
            values[:, column] = of[:, channel.chain - 1, trajectory.bead(channel.bead)]
    return values


def read_at(run: Trajectory, channels: tuple[Channel, ...], times: Floats) -> Floats:
    """Values at ascending times, both in the scene's units, [time, channel]; 0 before the start.

    Raises:
        InputError: times beyond the end of the run.
    """
    scale = run.problem.scale
    worth = np.array([getattr(scale, channel.quantity) for channel in channels])
    values = np.zeros((len(times), len(channels)))
    started = times >= 0.0
    if started.any():
        values[started] = read(common_times.at_times(run, times[started] / scale.time), channels) * worth
    return values


def _gauge(channel: Channel, problem: Problem) -> Gauge | None:
    system = problem.system
    if channel.kind == "wall":
        found = gauges(system, wall=True, contacts=(), sensors=())
        return next(gauge for gauge in found if (gauge.name == "right wall") == channel.right)
    if channel.kind == "contact":
        return gauges(system, wall=False, contacts=(channel.bead,), sensors=())[0]
    if channel.kind == "sensor":
        return gauges(system, wall=False, contacts=(), sensors=(channel.bead,))[0]
    return None
