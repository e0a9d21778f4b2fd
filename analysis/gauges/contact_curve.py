"""Force of a contact between frames: its course, integral and maximum; and where samples of a force cross a level.

Examples:
    >>> from analysis.gauges.gauge import gauges
    >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem()
    >>> (probe,) = gauges(problem.system, contacts=(10,))[0].probes
    >>> frames = contact_curve.ContactFrames.of(engine.run(problem), probe)
    >>> curve = contact_curve.ContactCurve.between(probe, frames, np.array([0]), problem.every)
    >>> impulse, uncertainty = curve.integral(contact_curve.borders(problem.every))
    >>> round(float(impulse.sum() * problem.every), 3)  # of the whole run, in m V
    1.138
"""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from analysis import hermite, motion
from analysis.gauges.gauge import Probe, strain_and_rate
from analysis.trajectory import Floats, Integers, Trajectory

TOUCH = 1e-15
"""Size of a force from which on there is an impulse to add up, of an overlap of 1e-10; rounding of loads is less."""

PANEL = 0.05
"""Largest stretch of time for one Gauss rule of four nodes."""


class ContactFrames(NamedTuple):
    """What frames hold of a contact, from which its force between them follows (`ContactCurve`)."""

    strain: Floats
    """Strain and its derivatives, [derivative, frame, chain], in units of L and T."""
    state: Floats | None
    """[frame, chain]; None where no force depends on one."""

    @classmethod
    def of(cls, block: Trajectory, probe: Probe) -> "ContactFrames":
        """Strain with its second derivative where the frames of a block determine forces, and state of a contact."""
        derivatives = strain_and_rate(block, probe)
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


def _acceleration(block: Trajectory, bead: int) -> Floats:
    frame, chain = np.indices((block.frames, block.problem.chains))
    if bead == 0:
        return np.zeros(frame.shape)
    return motion.acceleration_and_rate(block, frame, chain, np.full(frame.shape, bead - 1))[0]


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
