"""The forces of any scene, straight from what its keys say: no code is shared with the product.

But for the scene itself, parsed. Everything is dimensionless at V = 1; arrays are [..., chain, bead], contacts
[..., chain, bead - 1], and leading axes such as frames broadcast.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Units:
    """What one dimensionless unit is worth in the scene's."""

    mass: float
    length: float
    velocity: float

    @property
    def time(self) -> float:
        return self.length / self.velocity

    @property
    def force(self) -> float:
        return self.mass * self.velocity / self.time

    @property
    def stiffness(self) -> float:
        return self.mass / self.time**2


@dataclass(frozen=True)
class Wall:
    """On one side: force over overlap**exponent, overlap at rest, and the dashpot's coefficient, each [chain]."""

    bead: int
    side: float
    strength: Floats
    rest: Floats
    loss: Floats


@dataclass(frozen=True)
class Push:
    """A force on a bead (from 0) until ``ends``; of a drive, for ever."""

    chain: int
    bead: int
    ends: float
    of_time: Any
    """Force at a time."""
    kinks: tuple[float, ...]
    """Times at which it, or its slope, jumps."""

    def force(self, time: Any) -> Any:
        """0 after its end."""
        return np.where(np.asarray(time) < self.ends, self.of_time(time), 0.0)


@dataclass(frozen=True)
class Moved:
    """A bead (from 0) whose displacement and velocity are given at any time."""

    chain: int
    bead: int
    displacement: Any
    velocity: Any
    kinks: tuple[float, ...] = ()
    """Times at which the velocity, or its slope, jumps."""


@dataclass(frozen=True)
class Nature:
    """All forces of a scene.

    Attributes:
        exponent: of the overlap in the contacts' force, a number or [chain, bead - 1].
        mass: [chain, bead].
        strength, rest: of contacts, [chain, bead - 1]: force over overlap**exponent, and overlap at rest.
        hold: force from outside at rest, [chain, bead].
        springs: (chain, other chain, stiffness of each row, cubic stiffness), chains from 0.
        ground: stiffness and cubic stiffness of the springs to the ground, [chain, bead].
        bed: 1 where there is a foundation by formula, 0 elsewhere.
        stiffness: over them, the stiffness at a time, where that depends on it.
        bends: times at which it does so abruptly.
        walls: those that there are.
        loss: force of a contact's dashpot over the rate of overlap: a coefficient, and the exponent of the overlap.
        cut: whether a contact never pulls.
        drag, drag_across: force over the velocity of a bead, and over that of two in neighbouring chains.
        inner: (line, other line, stiffness and drag of each row) of resonators, which have lines after the chains in
            all arrays, empty but for their masses.
        pushes, moved: what acts from outside.
        start: velocities at the start.
        displaced: displacements at the start, of the shape of ``mass``.
        closed: whether chains are rings, whose contacts are [chain, bead], the last that of the last and first bead.
        formulas: force of contacts, springs and ground at a strain, by key, where the scene gives it as a formula.
    """

    exponent: float | Floats
    gap: float | Floats
    wall_gap: float
    mass: Floats
    strength: Floats
    rest: Floats
    hold: Floats
    springs: list[tuple[int, int, Any, Any]]
    ground: tuple[Floats, Floats]
    walls: list[Wall]
    loss: tuple[Any, float]
    cut: bool
    drag: Any
    drag_across: float
    pushes: list[Push]
    moved: list[Moved]
    start: Floats
    displaced: Any = 0.0
    bed: Any = 1.0
    stiffness: Any = None
    bends: tuple[float, ...] = ()
    inner: tuple[tuple[int, int, Any, Any], ...] = ()
    closed: bool = False
    formulas: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def _has(self) -> dict[str, bool]:
        """What there is at all: asked at every step."""
        cubic = any(np.any(c) for *_, c in self.springs)
        return {
            "loss": bool(np.any(self.loss[0])),
            "ground": self.stiffness is not None or bool(np.any(self.ground)),
            "cubic": cubic,
        }

    def overlap(self, x: Floats) -> Floats:
        """Of contacts, negative where beads are apart."""
        return np.asarray(self.closing(x) - self.gap + self.rest)

    def closing(self, x: Floats) -> Floats:
        """How much farther than the next a bead has moved."""
        return x - np.roll(x, -1, axis=-1) if self.closed else x[..., :-1] - x[..., 1:]

    def contacts(self, x: Floats, v: Floats) -> Floats:
        """Force of contacts, that at rest and the dashpots' included."""
        closed = np.maximum(self.overlap(x), 0.0)
        shape = self.formulas.get("contact")
        push = self.strength * (_power(closed, self.exponent) if shape is None else shape(self.overlap(x)))
        coefficient, power = self.loss
        if self._has["loss"]:
            push = push + np.where(closed > 0.0, coefficient * closed**power * self.closing(v), 0.0)
        return np.asarray(np.maximum(push, 0.0) if self.cut else push)

    def at_wall(self, wall: Wall, x: Floats, v: Floats) -> Floats:
        """Force of a wall, [..., chain], that at rest and the dashpots' included."""
        closed = np.maximum(wall.rest + wall.side * x[..., wall.bead] - self.wall_gap, 0.0)
        strain, shape = wall.side * x[..., wall.bead] - self.wall_gap, self.formulas.get("contact")
        push = wall.strength * (_power(closed, self.exponent) if shape is None else shape(strain))
        if self._has["loss"]:
            loss = np.where(closed > 0.0, wall.loss * closed ** self.loss[1], 0.0)
            push = push + loss * wall.side * v[..., wall.bead]
        return np.asarray(np.maximum(push, 0.0) if self.cut else push)

    @property
    def most_stored(self) -> float:
        """Largest energy of any link at the start."""
        x, p = self.displaced, self.exponent
        stored = [_stored(self.overlap(x), self.rest, self.strength, p, self.formulas.get("contact"))]
        for wall in self.walls:
            overlap = wall.rest + wall.side * x[..., wall.bead] - self.wall_gap
            stored.append(_stored(overlap, wall.rest, wall.strength, p, self.formulas.get("contact")))
        for one, other, stiffness, cubic in self.springs:
            apart = x[other] - x[one]
            shape = self.formulas.get("coupling")
            spring = 0.5 * stiffness * apart**2 + 0.25 * cubic * apart**4
            stored.append(spring if shape is None else stiffness * _integrals(shape, apart))
        stored += [0.5 * stiffness * (x[other] - x[one]) ** 2 for one, other, stiffness, _ in self.inner]
        stored.append(0.5 * self.ground[0] * x**2 + 0.25 * self.ground[1] * x**4)
        if "foundation" in self.formulas:
            stored.append(self.bed * _integrals(self.formulas["foundation"], x))
        return max(float(np.max(energy)) for energy in stored)

    def acceleration(self, time: float, x: Floats, v: Floats) -> Floats:
        force = self.hold - self.drag * v
        along = self.contacts(x, v)
        if self.closed:
            force += np.roll(along, 1, axis=-1) - along
        else:
            force[..., 1:] += along
            force[..., :-1] -= along
        for one, other, stiffness, cubic in self.springs:
            apart = x[..., other, :] - x[..., one, :]
            pull = stiffness * apart + (cubic * apart**3 if self._has["cubic"] else 0.0)
            if "coupling" in self.formulas:
                pull = stiffness * self.formulas["coupling"](apart)
            if self.drag_across:
                pull = pull + self.drag_across * (v[..., other, :] - v[..., one, :])
            force[..., one, :] += pull
            force[..., other, :] -= pull
        for one, other, stiffness, drag in self.inner:
            pull = stiffness * (x[..., other, :] - x[..., one, :]) + drag * (v[..., other, :] - v[..., one, :])
            force[..., one, :] += pull
            force[..., other, :] -= pull
        if self._has["ground"]:
            stiffness = self.ground[0] if self.stiffness is None else self.stiffness(time)
            force -= stiffness * x + self.ground[1] * x**3
        if "foundation" in self.formulas:
            force -= self.bed * self.formulas["foundation"](x)
        for wall in self.walls:
            force[..., wall.bead] -= wall.side * self.at_wall(wall, x, v)
        for push in self.pushes:
            force[..., push.chain, push.bead] += push.force(time)
        force /= self.mass
        for moved in self.moved:
            force[..., moved.chain, moved.bead] = 0.0
        return force

    def placed(self, time: Any, x: Floats, v: Floats) -> tuple[Floats, Floats]:
        """Displacements and velocities with those that are given."""
        for moved in self.moved:
            x, v = np.array(x), np.array(v)
            x[..., moved.chain, moved.bead] = moved.displacement(time)
            v[..., moved.chain, moved.bead] = moved.velocity(time)
        return x, v


def _stored(overlap: Floats, rest: Any, strength: Any, p: Any, shape: Any) -> Any:
    """Energy at an overlap above that at rest, where the force at rest is held."""
    if shape is not None:
        return _integrals(shape, overlap)
    whole = (np.maximum(overlap, 0.0) ** (p + 1.0) - rest ** (p + 1.0)) / (p + 1.0)
    return strength * (whole - rest**p * (overlap - rest))


def _integrals(force: Any, strain: Floats) -> Floats:
    return np.vectorize(lambda end: quad(force, 0.0, end, epsabs=1e-14, epsrel=1e-13)[0])(strain)


def _power(closed: Floats, exponent: float | Floats) -> Floats:
    return closed * np.sqrt(closed) if np.ndim(exponent) == 0 and exponent == 1.5 else closed**exponent
