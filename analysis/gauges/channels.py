"""Traces of forces and motions as they would have been measured in a run.

Plug-ins take this module to compare a run with data: `check` refuses channels that a scene has not, `beads_of` has the
beads to record, `read` and `read_at` give the traces. Channels are those of `analysis.files.traces`.

Examples:
    >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem()
    >>> frames = engine.run(problem)
    >>> chosen = (traces.Channel("velocity", chain=1, bead=5), traces.Channel("contact", chain=1, bead=5))
    >>> channels.beads_of(chosen, problem)
    (5, 6)
    >>> channels.read(frames, chosen)[55].round(3)  # at t = 5.5 T, in units of V and m V / T
    array([0.69 , 0.437])
"""

from pathlib import Path

import numpy as np

from analysis.compare import common_times
from analysis.files.traces import Channel
from analysis.gauges.gauge import Gauge, at_frames, gauges
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import InputError, Problem


def complaint(channel: Channel, problem: Problem) -> str | None:
    """Reason why a problem has no such channel; None if it has."""
    beads = problem.beads
    if not 1 <= channel.chain <= problem.chains:
        return f"the scene has chains 1 to {problem.chains}"
    if channel.kind == "wall":
        side = "right" if channel.right else "left"
        exists = any(gauge.side == side for gauge in gauges(problem.system, wall=True))
        return None if exists else f"the scene has no {side} wall"
    ends = {} if problem.system.closing else {"contact": (1, beads - 1), "sensor": (2, beads - 1)}
    first, last = ends.get(channel.kind, (1, beads))
    return None if first <= channel.bead <= last else f"beads {first} to {last} of the scene have such"


def check(path: Path, channels: tuple[Channel, ...], problem: Problem) -> None:
    """Refuse traces of what the scene has not.

    Args:
        path: file of the traces, for the message.
        channels: channels of the file.
        problem: problem of the scene.

    Raises:
        InputError: naming the first of them.
    """
    for channel in channels:
        wrong = complaint(channel, problem)
        if wrong is not None:
            raise InputError(f"{path}: has {channel.name}, but {wrong}")


def beads_of(channels: tuple[Channel, ...], problem: Problem) -> tuple[int, ...]:
    """Beads whose motion the channels follow from.

    Args:
        channels: channels that the problem has (`check`).
        problem: problem of the scene.

    Returns:
        Numbers of the beads, ascending.
    """
    beads: set[int] = set()
    for channel in channels:
        gauge = _gauge(channel, problem)
        probes = () if gauge is None else gauge.probes
        beads |= {bead for probe in probes for bead in (probe.behind, probe.ahead)} - {0} or {channel.bead}
    return tuple(sorted(beads))


def read(trajectory: Trajectory, channels: tuple[Channel, ...]) -> Floats:
    """Values of channels at the frames of a run.

    Args:
        trajectory: frames in which the beads of `beads_of` are recorded.
        channels: channels that its problem has (`check`).

    Returns:
        [frame, channel] in units of V, L, or m V / T.
    """
    problem = trajectory.problem
    readers = [(_gauge(channel, problem), channel) for channel in channels]
    distinct = {gauge.name: gauge for gauge, _ in readers if gauge is not None}
    force = dict(zip(distinct, np.moveaxis(at_frames(trajectory, tuple(distinct.values())), -1, 0), strict=True))
    values = np.empty((trajectory.frames, len(channels)))
    for column, (gauge, channel) in enumerate(readers):
        if gauge is None:
            motions = trajectory.velocity if channel.kind == "velocity" else trajectory.displacement
            values[:, column] = motions[:, channel.chain - 1, trajectory.bead(channel.bead)]
        else:
            above = gauge.static[channel.chain - 1] if channel.dynamic else 0.0
            values[:, column] = force[gauge.name][:, channel.chain - 1] - above
    return values


def read_at(run: Trajectory, channels: tuple[Channel, ...], times: Floats) -> Floats:
    """Values of channels at any times, interpolated between frames; 0 before the start.

    Args:
        run: frames in which the beads of `beads_of` are recorded.
        channels: channels that its problem has (`check`).
        times: [time] ascending, in the scene's unit.

    Returns:
        [time, channel] in the scene's units.

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
    """The gauge of a force; None of a motion."""
    if channel.kind == "wall":
        return next(gauge for gauge in gauges(problem.system, wall=True) if (gauge.side == "right") == channel.right)
    if channel.kind == "contact":
        return gauges(problem.system, contacts=(channel.bead,))[0]
    if channel.kind == "sensor":
        return gauges(problem.system, sensors=(channel.bead,))[0]
    return None
