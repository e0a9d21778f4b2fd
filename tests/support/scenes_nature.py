"""The motion of any scene, straight from what its keys say, by scipy's DOP853: no code is shared with the product.

But for the scene itself, and its units, whose exact scaling has tests of its own.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import OdeSolution, solve_ivp

from lammps_inputs import Scene

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Nature:
    """The forces of a scene as its keys say them, dimensionless: arrays are [chain, bead] or broadcast to it.

    Attributes:
        exponent: of the overlap in the contacts' force.
        springs: (chain, other chain, stiffness of each row, cubic stiffness), chains from 0.
        ground: stiffness and cubic stiffness of the springs to the ground.
        walls: force over that of two beads, left and right.
        load: force at rest, from before the first bead to behind the last, [bead + 1].
        loss: force of a contact's dashpot over the rate of overlap: a coefficient, and the exponent of the overlap.
        wall_loss: the coefficients of those of the walls.
        drag, drag_across: force over the velocity of a bead, and over that of two in neighbouring chains.
        pushes: (chain, bead, peak, duration, whether a half-sine), counted from 0.
        shaken: (chain, bead, amplitude, angular frequency, phase) of forces, counted from 0.
        moved: the same of displacements.
    """

    exponent: float
    gap: float
    springs: list[tuple[int, int, Any, float]]
    ground: tuple[Any, Any]
    walls: tuple[float, float]
    mass: Any
    strength: Any
    load: Any
    loss: tuple[Any, float]
    wall_loss: tuple[float, float]
    drag: float
    drag_across: float
    pushes: list[tuple[int, int, float, float, bool]]
    shaken: list[tuple[int, int, float, float, float]]
    moved: list[tuple[int, int, float, float, float]]

    def acceleration(self) -> Callable[[float, Floats, Floats], Floats]:
        """From a time, displacements and velocities, [chain, bead]."""
        p, rest = self.exponent, (self.load[1:-1] / self.strength) ** (1.0 / self.exponent)
        outside = np.diff(np.pad(self.load[1:-1], 1))
        held = []
        for bead, side, wall, lost in zip((0, -1), (-1.0, 1.0), self.walls, self.wall_loss, strict=True):
            if wall:
                outside[bead] += side * self.load[bead]
                held.append((bead, side, wall, lost, (self.load[bead] / wall) ** (1.0 / p)))
        coefficient, power = self.loss
        grounded, lossy = any(np.any(part) for part in self.ground), np.any(coefficient)

        def at(time: float, x: Floats, v: Floats) -> Floats:
            closed = np.maximum(x[:, :-1] - x[:, 1:] - self.gap + rest, 0.0)
            push = self.strength * closed**p
            if lossy:
                push += np.where(closed > 0.0, coefficient * closed**power * (v[:, :-1] - v[:, 1:]), 0.0)
            force = outside - self.drag * v
            force[:, 1:] += push
            force[:, :-1] -= push
            for one, other, stiffness, cubic in self.springs:
                apart = x[other] - x[one]
                pull = stiffness * apart + (cubic * apart**3 if cubic else 0.0)
                pull += self.drag_across * (v[other] - v[one])
                force[one] += pull
                force[other] -= pull
            if grounded:
                force -= self.ground[0] * x + self.ground[1] * x**3
            for bead, side, wall, lost, overlap in held:
                closed = np.maximum(overlap + side * x[:, bead] - self.gap, 0.0)
                force[:, bead] -= side * wall * closed**p
                if lost:
                    force[:, bead] -= np.where(closed > 0.0, lost * closed**power * v[:, bead], 0.0)
            for chain, bead, peak, lasts, sine in self.pushes:
                if time < lasts:
                    force[chain, bead] += peak * (math.sin(math.pi * time / lasts) if sine else 1.0)
            for chain, bead, size, omega, phase in self.shaken:
                force[chain, bead] += size * math.sin(omega * time + phase)
            force /= self.mass
            for chain, bead, size, omega, phase in self.moved:
                force[chain, bead] = -size * omega**2 * math.sin(omega * time + phase)
            return force

        return at

    def start(self, scene: Scene) -> Floats:
        """Displacements and velocities, [2, chain, bead]."""
        found = np.zeros((2, scene.chains, scene.beads))
        for kick in scene.kick:
            found[1, kick.chain - 1, kick.bead - 1] = kick.velocity / scene.scale.velocity
        for chain, bead, size, omega, phase in self.moved:
            found[1, chain, bead] = size * omega * math.cos(phase)
        return found


def nature(scene: Scene) -> Nature:
    """Of a scene that `random_scenes.draw` makes."""
    unit, beads = scene.scale, scene.beads
    rows = np.arange(1, beads + 1)

    def within(ends: Any) -> Floats:
        return np.ones(beads) if ends is None else ((rows >= ends[0]) & (rows <= ends[1])) * 1.0

    exponent = 1.5 if scene.contact is None else scene.contact.exponent
    springs, ground, walls = [], (0.0, 0.0), (0.0, 0.0)
    tied = scene.coupling
    if tied is not None:
        pairs = [(chain, chain + 1) for chain in range(scene.chains - 1)]
        pairs += [(0, scene.chains - 1)] if tied.topology == "ring" else []
        cubic = (tied.cubic or 0.0) * unit.length**2 / unit.stiffness
        springs = [(a, b, tied.stiffness / unit.stiffness * within(tied.rows), cubic) for a, b in pairs]
    if scene.foundation is not None:
        soft = scene.foundation
        hard = soft.cubic * unit.length**2 / unit.stiffness
        ground = (soft.stiffness / unit.stiffness * within(soft.rows), hard * within(soft.rows))
    if scene.walls is not None:
        strength = {None: 0.0, "bead": 1.0, "flat": 2.0**0.5, "rigid": 2.0**1.5}
        walls = (strength[scene.walls.left], strength[scene.walls.right])
    radius, mass = np.ones(beads), np.ones(beads)
    if scene.pattern is not None:
        kinds = [scene.kinds[scene.pattern[k % len(scene.pattern)]] for k in range(beads)]
        radius, mass = np.array([kind.radius or 1.0 for kind in kinds]), np.array([kind.mass for kind in kinds])
    if scene.taper is not None:
        shrink = (1.0 - scene.taper) ** np.arange(beads)
        radius, mass = radius * shrink, mass * shrink**3
    between = np.sqrt(2.0 * radius[1:] * radius[:-1] / (radius[1:] + radius[:-1]))
    load = np.zeros(beads + 1)
    if scene.precompression is not None:
        load += scene.precompression.force / unit.force
    if scene.gravity is not None:
        load[1:] += np.cumsum(mass) * scene.gravity.acceleration * unit.time**2 / unit.length
    dashpot, loss, wall_loss = unit.force / unit.velocity, (0.0, 0.0), (0.0, 0.0)
    damping = scene.damping
    if damping is not None and damping.contact:
        loss = (damping.contact / dashpot, 0.0)
        wall_loss = (loss[0], loss[0])
        if damping.law == "viscoelastic":
            loss = (damping.contact / dashpot * unit.length**0.5, 0.5)
            wall_loss = (loss[0] * walls[0], loss[0] * walls[1])
        elif damping.law == "restitution":  # Antypov & Elliott 2011
            log, reduced = math.log(damping.contact), mass[1:] * mass[:-1] / (mass[1:] + mass[:-1])
            alpha = -log * math.sqrt(5.0) / math.hypot(log, math.pi)
            loss = (alpha * np.sqrt(reduced * between), 0.25)
            wall_loss = (alpha * math.sqrt(mass[0] * walls[0]), alpha * math.sqrt(mass[-1] * walls[1]))
    drives = [
        (one, one.chain - 1, one.bead - 1, 2.0 * math.pi * one.frequency * unit.time, math.radians(one.phase))
        for one in scene.drive or ()
    ]
    return Nature(
        exponent=exponent,
        gap=scene.gap / unit.length,
        springs=springs,
        ground=ground,
        walls=walls,
        mass=mass,
        strength=between,
        load=load,
        loss=loss,
        wall_loss=wall_loss,
        drag=(damping.beads or 0.0) / dashpot if damping is not None else 0.0,
        drag_across=(damping.coupling or 0.0) / dashpot if damping is not None else 0.0,
        pushes=[
            (p.chain - 1, p.bead - 1, p.peak / unit.force, p.duration / unit.time, p.shape != "rectangular")
            for p in scene.push or ()
        ],
        shaken=[(c, b, one.force / unit.force, *how) for one, c, b, *how in drives if one.force is not None],
        moved=[(c, b, one.displacement / unit.length, *how) for one, c, b, *how in drives if one.force is None],
    )


def solution(scene: Scene, rtol: float) -> Any:
    """Displacements and velocities of a scene at any time until its end, by DOP853, from push to push."""
    what, (chains, beads) = nature(scene), (scene.chains, scene.beads)
    end, accelerate = scene.problem().duration, what.acceleration()

    def rates(time: float, state: Floats) -> Floats:
        x, v = state.reshape(2, chains, beads)
        return np.concatenate([v, accelerate(time, x, v)], axis=None)

    state, edges, pieces = what.start(scene).ravel(), [0.0, end], []
    edges[1:1] = sorted({lasts for *_, lasts, _ in what.pushes if lasts < end})
    for since, until in pairwise(edges):
        # no stage of a step is at its end, where the push is over
        found = solve_ivp(
            rates, (since, np.nextafter(until, 0.0) if until < end else until), state, "DOP853",
            rtol=rtol, atol=1e-2 * rtol, max_step=0.4, dense_output=True,
        )  # fmt: skip
        state = found.y[:, -1]
        pieces.append(found.sol)
    whole = OdeSolution(
        np.concatenate([pieces[0].ts[:1], *(piece.ts[1:] for piece in pieces)]),
        [step for piece in pieces for step in piece.interpolants],
    )
    return lambda time: (
        np.moveaxis(whole(time).reshape(2, chains, beads, *np.shape(time)), -1, 0)
        if np.ndim(time)
        else whole(time).reshape(2, chains, beads)
    )
