"""Places at which force is read: walls, contacts, and the inside of beads; and what their force is between frames.

The force of a damped contact is all of it, that of its dashpot included, at the velocities that frames hold: those of
the moment of their positions. (LAMMPS itself takes the dashpot's at velocities of half a step before.)

Between frames: `analysis.gauges.curve`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from analysis import motion
from analysis.against import common_times
from analysis.files.traces import Channel
from analysis.trajectory import Floats, Integers, Trajectory
from lammps_inputs import Problem, System, laws, physics
from lammps_inputs.laws import dashpot
from lammps_inputs.links import Wall

Kind = Literal["wall", "contact", "sensor"]


@dataclass(frozen=True)
class Probe:
    """One contact, at the same place in every chain.

    Attributes:
        behind, ahead: beads whose difference of displacements is its strain, counted from 1; 0 for what is at rest.
        force: strain [chain, ...] -> elastic force [chain, ...], that at rest included, never negative; 0 where the
            contact is open.
        static: [chain] at rest.
        loss: strain, its rate -> force of the dashpot; None where there is none.
        slot: place of its memory in those of frames (`analysis.trajectory.Trajectory`); ``force`` takes one.
    """

    behind: int
    ahead: int
    force: Callable[[Floats, Integers, Any], Floats]
    static: Floats
    loss: Callable[[Floats, Floats, Integers], Floats] | None = None
    slot: int = 0


@dataclass(frozen=True)
class Gauge:
    """A place at which force is read, in every chain: the mean of its contacts.

    Attributes:
        kind: what is read.
        name: for tables and figures.
        bead: the first or last one, at a wall; the first of a contact; the one with the sensor.
    """

    kind: Kind
    name: str
    bead: int
    probes: tuple[Probe, ...]

    @property
    def static(self) -> Floats:
        """[chain] at rest; 0 without a static load."""
        return np.asarray(sum(probe.static for probe in self.probes) / len(self.probes))

    @property
    def damped(self) -> bool:
        """Whether forces against velocities are among what is read, so that it may be negative."""
        return any(probe.loss is not None for probe in self.probes)

    @property
    def side(self) -> str:
        """Of a wall: ``left`` or ``right``."""
        return "left" if self.bead == 1 else "right"


def gauges(
    system: System, *, wall: bool = False, contacts: tuple[int, ...] = (), sensors: tuple[int, ...] = ()
) -> tuple[Gauge, ...]:
    """Gauges at walls, between beads n and n + 1, and inside beads; from left to right by kind."""
    found = []
    for link in physics.walls(system) if wall else ():
        name, bead = ("right wall", system.beads) if link.side > 0.0 else ("left wall", 1)
        found.append(Gauge("wall", name, bead, (_at_wall(system, link),)))
    found += [Gauge("contact", f"contact {bead}", bead, (_between(system, bead),)) for bead in contacts]
    found += [
        Gauge("sensor", f"sensor {bead}", bead, (_between(system, bead - 1), _between(system, bead)))
        for bead in sensors
    ]
    return tuple(found)


def far_wall(system: System) -> Gauge | None:
    """The gauge at the wall that the largest excitation goes towards; None where there is none."""
    side = "right" if physics.largest_excitation(system)[2] > 0.0 else "left"
    return next((gauge for gauge in gauges(system, wall=True) if gauge.side == side), None)


def _at_wall(system: System, link: Wall) -> Probe:
    right = link.side > 0.0
    place = system.beads - 1 if right else 0

    def force(strain: Floats, chain: Integers, memory: Any) -> Floats:
        law = laws.with_memory(laws.at(link.law, chain, place), memory)
        return np.asarray(np.maximum(laws.force(law, strain - link.gap) + laws.load(law), 0.0))

    static = np.broadcast_to(laws.load(laws.at(link.law, np.arange(system.chains), place)), system.chains)
    behind, ahead = (system.beads, 0) if right else (0, 1)
    loss = _loss(physics.wall_loss(system, link.side), place, link.gap)
    return Probe(behind, ahead, force, static, loss, system.beads if right else 0)


def _between(system: System, bead: int) -> Probe:
    def force(strain: Floats, chain: Integers, memory: Any) -> Floats:
        contact = np.full(chain.shape, bead - 1)
        overlap = strain - physics.gap(system) + motion.rest_overlap(system, chain, contact)
        found = (laws.with_memory(laws.at(link.law, chain, contact), memory) for link in system.along)
        return np.asarray(sum(laws.whole_force(law, overlap) for law in found))

    static = np.broadcast_to(motion.static_force(system, Ellipsis, bead - 1), system.chains)
    loss = _loss(physics.contact_loss(system), bead - 1, physics.gap(system))
    return Probe(bead, bead + 1, force, static, loss, bead)


TOUCHING = 1e-12
"""Overlap, in units of L, from which on a dashpot acts: one that is rounding does not close a contact."""


def _loss(damper: Any, place: int, gap: float) -> Callable[[Floats, Floats, Integers], Floats] | None:
    """The force of a dashpot, if there is one."""

    def loss(strain: Floats, rate: Floats, chain: Integers) -> Floats:
        law: Any = laws.at(damper, chain, place)
        closed = strain - gap + law.rest > TOUCHING
        return np.where(closed, dashpot.damping(law, strain - gap, rate), 0.0)

    return None if damper is None else loss


# --- at frames --------------------------------------------------------------------------------------------------------


def at_frames(block: Trajectory, gauges: tuple[Gauge, ...], *, dashpots: bool = True) -> Floats:
    """What gauges read at the frames of a run, [frame, chain, gauge]; the beads they need must be recorded."""
    force = np.zeros((block.frames, block.problem.chains, len(gauges)))
    for place, gauge in enumerate(gauges):
        for probe in gauge.probes:
            strain, rate = _strain_and_rate(block, probe)
            chain = np.broadcast_to(np.arange(block.problem.chains), strain.shape)
            found = probe.force(strain, chain, memory_at_frames(block, probe))
            if dashpots and probe.loss is not None:
                found = found + probe.loss(strain, rate, chain)
            force[..., place] += found / len(gauge.probes)
    return force


def memory_at_frames(block: Trajectory, probe: Probe) -> Floats | None:
    """[frame, chain] memory of a contact; None where no force depends on it."""
    return None if block.memory is None else block.memory[:, :, probe.slot]


def strain_at_frames(block: Trajectory, probe: Probe) -> Floats:
    """Strain of a contact, [derivative, frame, chain]: with three derivatives if all beads are recorded, else one."""
    found = _strain_and_rate(block, probe)
    if block.forces_known:
        behind, ahead = (_acceleration_and_rate(block, bead) for bead in (probe.behind, probe.ahead))
        found += [one - other for one, other in zip(behind, ahead, strict=True)]
    return np.array(found)


def _strain_and_rate(block: Trajectory, probe: Probe) -> list[Floats]:
    values = block.displacement, block.velocity
    return [_column(block, each, probe.behind) - _column(block, each, probe.ahead) for each in values]


def _column(block: Trajectory, values: Floats, bead: int) -> Floats:
    """[frame, chain] of a bead; 0 for what is at rest."""
    if bead == 0:
        return np.zeros(values.shape[:2])
    return np.asarray(values[:, :, int(np.searchsorted(block.problem.recorded_beads, bead))])


def _acceleration_and_rate(block: Trajectory, bead: int) -> tuple[Floats, Floats]:
    """Second and third derivative of the displacement of a bead, each [frame, chain]; 0 for what is at rest."""
    frame, chain = np.indices((block.frames, block.problem.chains))
    if bead == 0:
        return np.zeros(frame.shape), np.zeros(frame.shape)
    return motion.acceleration_and_rate(block, frame, chain, np.full(frame.shape, bead - 1))


# --- traces as they would have been measured --------------------------------------------------------------------------


def complaint(channel: Channel, problem: Problem) -> str | None:
    """Why a problem has no such channel; None if it has."""
    beads = problem.beads
    if not 1 <= channel.chain <= problem.chains:
        return f"the scene has chains 1 to {problem.chains}"
    if channel.kind == "wall":
        side = "right" if channel.right else "left"
        there = any(gauge.side == side for gauge in gauges(problem.system, wall=True))
        return None if there else f"the scene has no {side} wall"
    first, last = {"contact": (1, beads - 1), "sensor": (2, beads - 1)}.get(channel.kind, (1, beads))
    return None if first <= channel.bead <= last else f"beads {first} to {last} of the scene have such"


def beads_of(channels: tuple[Channel, ...], problem: Problem) -> tuple[int, ...]:
    """Beads whose motion the channels follow from, ascending."""
    found: set[int] = set()
    for channel in channels:
        gauge = _gauge(channel, problem)
        probes = () if gauge is None else gauge.probes
        found |= {bead for probe in probes for bead in (probe.behind, probe.ahead)} - {0} or {channel.bead}
    return tuple(sorted(found))


def read(trajectory: Trajectory, channels: tuple[Channel, ...]) -> Floats:
    """Dimensionless values at the frames, [frame, channel]; the beads of `beads_of` must be recorded."""
    problem = trajectory.problem
    asked = [(_gauge(channel, problem), channel) for channel in channels]
    distinct = {gauge.name: gauge for gauge, _ in asked if gauge is not None}
    force = dict(zip(distinct, np.moveaxis(at_frames(trajectory, tuple(distinct.values())), -1, 0), strict=True))
    values = np.empty((trajectory.frames, len(channels)))
    for column, (gauge, channel) in enumerate(asked):
        if gauge is None:
            of = trajectory.velocity if channel.kind == "velocity" else trajectory.displacement
            values[:, column] = of[:, channel.chain - 1, trajectory.bead(channel.bead)]
        else:
            above = gauge.static[channel.chain - 1] if channel.dynamic else 0.0
            values[:, column] = force[gauge.name][:, channel.chain - 1] - above
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
    """The gauge of a force; None of a motion."""
    if channel.kind == "wall":
        return next(gauge for gauge in gauges(problem.system, wall=True) if (gauge.side == "right") == channel.right)
    if channel.kind == "contact":
        return gauges(problem.system, contacts=(channel.bead,))[0]
    if channel.kind == "sensor":
        return gauges(problem.system, sensors=(channel.bead,))[0]
    return None
