"""Places at which force is read: walls, contacts, and the inside of beads; and what their force is between frames.

The force of a damped contact is all of it, that of its dashpot included, at the velocities that frames hold: those of
the moment of their positions. (LAMMPS itself takes the dashpot's at velocities of half a step before.)

Between frames: the force of a contact (`ContactCurve`), its integral and maximum; the maximum and crossings of samples.

Plug-ins take this module for forces: `gauges` chooses places of a system, `at_frames` reads their forces.

Examples:
    >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 30.0, "walls": {"right": "bead"}}).problem()
    >>> frames = engine.run(problem)
    >>> chosen = gauge.gauges(problem.system, wall=True, contacts=(10,))
    >>> [each.name for each in chosen]
    ['right wall', 'contact 10']
    >>> gauge.at_frames(frames, chosen).max(axis=0).round(2)  # [chain, gauge] in m V / T
    array([[1.12, 0.64]])
"""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np

from analysis import hermite, motion
from analysis.trajectory import Floats, Integers, Trajectory
from lammps_inputs import System, laws, physics
from lammps_inputs.laws import dashpot

Kind = Literal["wall", "contact", "sensor"]

PULSE = 0.01
"""Share of its largest value, above the static one, from which a force is that of a pulse."""


@dataclass(frozen=True)
class Probe:
    """One contact, at the same place in every chain.

    Attributes:
        behind, ahead: beads whose difference of displacements is its strain, counted from 1; 0 for a body at rest.
        force: strain [chain, ...] -> elastic force [chain, ...], that at rest included: 0 where contacts are open,
            negative where contacts that act at a distance pull.
        static: [chain] force at rest.
        loss: strain, its rate -> force of the dashpot; None where there is none.
        place: that of its state in those of frames (`analysis.trajectory.Trajectory`); ``force`` takes the state.
    """

    behind: int
    ahead: int
    force: Callable[[Floats, Integers, Floats | None], Floats]
    static: Floats
    loss: Callable[[Floats, Floats, Integers], Floats] | None = None
    place: int = 0


@dataclass(frozen=True)
class Gauge:
    """A place at which force is read, in every chain: the mean of its contacts.

    Attributes:
        kind: what is read.
        name: for tables and figures.
        bead: number of the bead at the wall, of the one before the contact, or of the one with the sensor, from 1.
        probes: the contacts whose mean force is read.
    """

    kind: Kind
    name: str
    bead: int
    probes: tuple[Probe, ...]

    @property
    def static(self) -> Floats:
        """[chain] force at rest, in units of m V / T; 0 without a static load."""
        return np.asarray(sum(probe.static for probe in self.probes) / len(self.probes))

    @property
    def damped(self) -> bool:
        """Whether forces against velocities are among what is read, which jump where contacts close or open."""
        return any(probe.loss is not None for probe in self.probes)

    @property
    def side(self) -> str:
        """Side of a wall gauge: ``left`` or ``right``."""
        return "left" if self.bead == 1 else "right"


def gauges(
    system: System, *, wall: bool = False, contacts: tuple[int, ...] = (), sensors: tuple[int, ...] = ()
) -> tuple[Gauge, ...]:
    """Gauges at walls, between beads n and n + 1, and inside beads; from left to right by kind.

    Args:
        system: its walls and contacts.
        wall: whether each wall has one.
        contacts: number n of the bead before each contact, from 1.
        sensors: number of each bead with a gauge inside, between the first and the last bead.

    Returns:
        The gauges: at walls, in contacts, inside beads.
    """
    chosen = []
    for link in system.walls if wall else ():
        name, bead, place = ("right wall", system.beads, system.beads) if link.side > 0.0 else ("left wall", 1, 0)
        chosen.append(Gauge("wall", name, bead, (_probe(system, place),)))
    chosen += [Gauge("contact", f"contact {bead}", bead, (_probe(system, bead),)) for bead in contacts]
    chosen += [
        Gauge("sensor", f"sensor {bead}", bead, (_probe(system, bead - 1), _probe(system, bead))) for bead in sensors
    ]
    return tuple(chosen)


def far_wall(system: System) -> Gauge | None:
    """The gauge at the wall that the largest excitation goes towards; None where there is none."""
    side = "right" if physics.largest_excitation(system)[2] > 0.0 else "left"
    return next((gauge for gauge in gauges(system, wall=True) if gauge.side == side), None)


def _probe(system: System, place: int) -> Probe:
    """The contact at a place, from 0 before the first bead of every chain."""
    chains, beads = np.arange(system.chains), system.beads
    contacts = list(physics.at_place(system.links, place, beads))
    dashpots = list(physics.at_place(system.dampers, place, beads))

    def force(strain: Floats, chain: Integers, state: Floats | None) -> Floats:
        """Total force of the contact, of the strain's shape [chain, ...]."""
        laws_at = (
            (laws.at_state(laws.at(link.law, chain, position), state), link.gap_at(chain, position))
            for link, position in contacts
        )
        return np.asarray(sum(laws.force(law, strain - gap) + law.load for law, gap in laws_at))

    def loss(strain: Floats, rate: Floats, chain: Integers) -> Floats:
        """Force of the dashpot, of the strain's shape [chain, ...]; 0 where the contact is open."""
        (link, position), *_ = dashpots
        law: Any = laws.at(link.law, chain, position)
        strain = strain - link.gap_at(chain, position)
        return np.where(strain + law.rest > TOUCHING, dashpot.damping(law, strain, rate), 0.0)

    static = sum(
        np.broadcast_to(laws.at(link.law, chains, position).load, system.chains) for link, position in contacts
    )
    ahead = place + 1 if place < beads else 0
    return Probe(place, ahead, force, np.asarray(static), loss if dashpots else None, place)


TOUCHING = 1e-12
"""Overlap, in units of L, from which on a dashpot acts: one that is rounding does not close a contact."""


# --- at frames --------------------------------------------------------------------------------------------------------


def at_frames(block: Trajectory, gauges: tuple[Gauge, ...], *, dashpots: bool = True) -> Floats:
    """Forces of gauges at the frames of a run.

    Args:
        block: frames in which the beads of the gauges are recorded.
        gauges: places of the forces.
        dashpots: whether the force of dashpots is included.

    Returns:
        [frame, chain, gauge] in units of m V / T.
    """
    force = np.zeros((block.frames, block.problem.chains, len(gauges)))
    for place, gauge in enumerate(gauges):
        for probe in gauge.probes:
            strain, rate = _strain_and_rate(block, probe)
            chain = np.broadcast_to(np.arange(block.problem.chains), strain.shape)
            reading = probe.force(strain, chain, block.states_of_contacts(probe.place))
            if dashpots and probe.loss is not None:
                reading = reading + probe.loss(strain, rate, chain)
            force[..., place] += reading / len(gauge.probes)
    return force


class ContactFrames(NamedTuple):
    """What frames hold of a contact, from which its force between them follows (`ContactCurve`)."""

    strain: Floats
    """Strain and its derivatives, [derivative, frame, chain], in units of L and T."""
    state: Floats | None
    """[frame, chain]; None where no force depends on one."""

    @classmethod
    def of(cls, block: Trajectory, probe: Probe) -> "ContactFrames":
        """Strain with its second derivative where the frames of a block determine forces, and state of a contact."""
        derivatives = _strain_and_rate(block, probe)
        if block.forces_known:
            derivatives.append(_acceleration(block, probe.behind) - _acceleration(block, probe.ahead))
        return cls(np.array(derivatives), block.states_of_contacts(probe.place))

    @classmethod
    def joined(cls, parts: Sequence["ContactFrames"]) -> "ContactFrames":
        """Frames one after the other."""
        states = [part.state for part in parts if part.state is not None]
        strain = np.concatenate([part.strain for part in parts], axis=1)
        return cls(strain, np.concatenate(states) if states else None)

    def near(self, frames: slice, chains: Integers) -> "ContactFrames":
        """Chosen frames of chosen chains, [chain] positions."""
        return ContactFrames(self.strain[:, frames, chains], None if self.state is None else self.state[frames, chains])


def _strain_and_rate(block: Trajectory, probe: Probe) -> list[Floats]:
    values = block.displacement, block.velocity
    return [_column(block, each, probe.behind) - _column(block, each, probe.ahead) for each in values]


def _column(block: Trajectory, values: Floats, bead: int) -> Floats:
    """Values of a bead, [frame, chain]; 0 for a body at rest."""
    if bead == 0:
        return np.zeros(values.shape[:2])
    return np.asarray(values[:, :, block.positions(bead)])


def _acceleration(block: Trajectory, bead: int) -> Floats:
    frame, chain = np.indices((block.frames, block.problem.chains))
    if bead == 0:
        return np.zeros(frame.shape)
    return motion.acceleration_and_rate(block, frame, chain, np.full(frame.shape, bead - 1))[0]


# --- between frames ---------------------------------------------------------------------------------------------------

TOUCH = 1e-15
"""Size of a force from which on there is an impulse to add up, of an overlap of 1e-10; rounding of loads is less."""

PANEL = 0.05
"""Largest stretch of time for one Gauss rule of four nodes."""


@dataclass(frozen=True)
class ContactCurve:
    """Force of one contact over s, in many stretches from frame to frame.

    Attributes:
        probe: the contact.
        polynomial: its strain, [power, stretch].
        chain: [stretch] position of the chain.
        spacing: time from s = 0 to s = 1, in units of T.
        state: [frame before or after, stretch], of a contact whose force depends on it.
    """

    probe: Probe
    polynomial: Floats
    chain: Integers
    spacing: float
    state: Floats | None = None

    @classmethod
    def between(cls, probe: Probe, frames: ContactFrames, chains: Integers, spacing: float) -> "ContactCurve":
        """Curves from frame to frame; stretches are [interval * chains + chain].

        Args:
            probe: the contact.
            frames: frames of it.
            chains: [chain] positions of the chains.
            spacing: time between frames.
        """
        strain, state = frames
        ends = np.stack([strain[:, :-1], strain[:, 1:]]).reshape(2, len(strain), -1)
        if state is not None:
            state = np.stack([state[:-1], state[1:]]).reshape(2, -1)
        chain = np.tile(chains, strain.shape[1] - 1)
        return cls(probe, hermite.coefficients((0, 1), ends, spacing), chain, spacing, state)

    def of(self, stretch: Integers) -> "ContactCurve":
        """Curves in chosen stretches, [stretch] positions."""
        state = None if self.state is None else self.state[:, stretch]
        return replace(self, polynomial=self.polynomial[:, stretch], chain=self.chain[stretch], state=state)

    def up_to_a_jump(self) -> "ContactCurve":
        """Curves by the frame before alone, which hold until a force jumps."""
        return replace(self, polynomial=self.polynomial[: len(self.polynomial) // 2])

    def rate(self, s: Floats) -> Floats:
        """Rate of the strain at s, both [stretch], in units of L / T."""
        return hermite.value(hermite.derivative(self.polynomial), s) / self.spacing

    def elastic(self, s: Floats) -> Floats:
        """Elastic force at s, both [stretch], in units of m V / T: negative where the contact pulls."""
        strain, state = hermite.value(self.polynomial, s), self.state
        if state is not None:  # a contact that opens is in its state of the frame after
            rate = hermite.value(hermite.derivative(self.polynomial), s)
            state = np.where(rate >= 0.0, state[0], state[1])
        return self.probe.force(strain, self.chain, state)

    def __call__(self, s: Floats) -> Floats:
        """Force at s, both [stretch], in units of m V / T."""
        if self.probe.loss is None:
            return self.elastic(s)
        return self.elastic(s) + self.probe.loss(hermite.value(self.polynomial, s), self.rate(s), self.chain)

    def integral(self, border: Floats) -> tuple[Floats, Floats]:
        """Integral of the force over s from 0 to 1, and its uncertainty, each [stretch]; panels are between [border].

        In a panel where the force begins or ends, it is a power 3/2 of the time from there on, for which a Gauss rule
        is inaccurate: with the square root of that time as variable it is smooth. The uncertainty is the difference
        from the rule with a node less, which shows kinks and jumps of dashpots and of contacts that yield.
        """
        size = self.polynomial.shape[1]
        totals = np.zeros((len(_RULES), size))
        acts = np.stack([np.abs(self.elastic(np.full(size, s))) for s in border]) > TOUCH
        for panel, (low, high) in enumerate(itertools.pairwise(border.tolist())):
            throughout = acts[panel] & acts[panel + 1]
            for total, rule in zip(totals, _RULES, strict=True):
                for s, w in rule:
                    total += np.where(throughout, w * (high - low) * self(np.full(size, low + s * (high - low))), 0.0)
        panel_of, entry = np.nonzero(acts[:-1] != acts[1:])
        changing = self.of(entry)
        low, high, before = border[panel_of], border[panel_of + 1], acts[panel_of, entry]
        at = hermite.change(lambda s: np.abs(changing.elastic(s)) > TOUCH, before, low, high)
        width = np.sqrt(np.where(before, at - low, high - at))
        direction = np.where(before, -1.0, 1.0)
        for total, rule in zip(totals, _RULES, strict=True):
            for s, w in rule:
                root = width * s
                np.add.at(total, entry, w * width * 2.0 * root * changing(at + direction * root * root))
        return totals[0], np.abs(totals[0] - totals[1])


def _gauss(nodes: int) -> list[tuple[float, float]]:
    """Nodes and weights of a Gauss rule from 0 to 1."""
    node, weight = np.polynomial.legendre.leggauss(nodes)
    return list(zip((0.5 * (node + 1.0)).tolist(), (0.5 * weight).tolist(), strict=True))


_RULES = _gauss(4), _gauss(3)
"""The rule that integrates a force, and that with a node less."""


def borders(spacing: float) -> Floats:
    """Borders of panels, [border] from 0 to 1, for a time between frames in units of T."""
    return np.linspace(0.0, 1.0, max(1, int(np.ceil(spacing / PANEL * (1.0 - 1e-9)))) + 1)


_THIRDS = 45
"""Steps that leave 1e-8 of a stretch, (2/3)^45: nearer to a maximum, values differ by their rounding alone."""


def maximum(value: Callable[[Floats], Floats], low: Floats, high: Floats) -> Floats:
    """Place of the maximum of a function with one maximum between low and high; all of one shape."""
    for _ in range(_THIRDS):
        lower, upper = low + (high - low) / 3.0, high - (high - low) / 3.0
        rising = value(lower) < value(upper)
        low, high = np.where(rising, lower, low), np.where(rising, high, upper)
    return 0.5 * (low + high)


def crossing(time: Floats, values: Floats, k: int, level: float) -> float:
    """Time at which evenly spaced values [sample] cross a level from k - 1 to k, by a cubic through four of them."""
    first = min(max(k - 2, 0), max(len(values) - 4, 0))
    around = values[first : first + 4] - level
    curve = np.polynomial.Polynomial.fit(np.arange(len(around)), around, len(around) - 1, domain=[-1, 1])
    roots = curve.roots()
    within = np.real(roots[(np.abs(np.imag(roots)) < 1e-9) & (np.abs(np.real(roots) - (k - 0.5 - first)) <= 0.5)])
    before, after = values[k - 1] - level, values[k] - level
    place = within[0] if len(within) == 1 else k - 1 - first + before / (before - after)
    return float(time[first] + place * (time[k] - time[k - 1]))


def excursion(time: Floats, values: Floats, at: float, level: float) -> tuple[float, float]:
    """Start and end of the time around ``at`` in which evenly spaced values [sample] exceed a level.

    Infinite where the record has no such end; NaN where no sample near ``at`` exceeds the level.
    """
    first = max(int(np.argmin(np.abs(time - at))) - 1, 0)
    k = first + int(np.argmax(values[first : first + 3]))
    if not values[k] > level:
        return np.nan, np.nan
    before, after = np.flatnonzero(values[:k] <= level), np.flatnonzero(values[k:] <= level)
    start = crossing(time, values, int(before[-1]) + 1, level) if len(before) else -np.inf
    end = crossing(time, values, k + int(after[0]), level) if len(after) else np.inf
    return start, end
