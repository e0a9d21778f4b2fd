"""Trajectories by an integrator that shares no code with the product: scipy's DOP853 at tight tolerances."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from lammps_inputs import Problem, physics

Floats = NDArray[np.float64]


def integrated(
    problem: Problem,
    ground: Any = 0.0,
    ground_cubic: Any = 0.0,
    walls: tuple[Any, Any] = (0.0, 0.0),
    *,
    push: tuple[int, int, float, float] | None = None,
    mass: Any = 1.0,
    strength: Any = 1.0,
    static: Any = 0.0,
    exponent: float = 1.5,
    loss: Callable[[Floats], Any] | None = None,
    wall_loss: Callable[[Floats], Any] | None = None,
    tension: bool = True,
    drag: float = 0.0,
    drag_across: float = 0.0,
    max_step: float = np.inf,
    rtol: float = 1e-12,
    pushed: dict[tuple[int, int], Any] | None = None,
    moved: dict[tuple[int, int], Any] | None = None,
) -> Floats:
    """Velocities [frame, chain, bead] of chains with contacts, springs between neighbours and to the ground, and walls.

    Args:
        problem: what is computed; its chains, coupling, kicks and frames are taken, its laws are not.
        ground, ground_cubic: stiffness of the springs to the ground, [chain, bead] or one number.
        mass: of the beads, likewise.
        strength: of the contacts, [chain, contact] or one number.
        static: forces at rest, [chain, bead + 1] from before the first bead to behind the last, or one number; what
            contacts and walls do not balance of them acts on the beads from outside.
        loss: force of a contact's dashpot over the rate of overlap, from the overlap.
        wall_loss: the same of walls, from their overlap, [chain].
        tension: whether a contact may pull.
        drag: force on a bead over its velocity.
        drag_across: force between beads of a row in neighbouring chains over their relative velocity.
        max_step: of the integrator, which may not see jumps of the force in longer ones.
        walls: force over overlap**exponent of those on the left and on the right, a gap away, [chain] or one number.
        push: chain and bead, from 1, peak and duration of a half-sine of force.
        exponent: of the overlap in the force of contacts and walls.
        rtol: of the integrator.
        pushed, moved: (chain, bead) from 0 -> force from outside, or acceleration whatever the forces, over time.
    """
    gap, kappa = physics.gap(problem.system), physics.kappa(problem.system)
    shape = problem.chains, problem.beads
    size = problem.chains * problem.beads

    load = np.broadcast_to(static, (problem.chains, problem.beads + 1))
    rest = (load[:, 1:-1] / strength) ** (1.0 / exponent)
    there = [np.asarray(wall) > 0.0 for wall in walls]
    left, right = (
        np.where(on, load[:, end] / np.where(on, wall, 1.0), 0.0) ** (1.0 / exponent)
        for wall, on, end in zip(walls, there, (0, -1), strict=True)
    )
    outside = np.diff(np.pad(load[:, 1:-1], ((0, 0), (1, 1))))
    outside[:, 0] -= load[:, 0] * there[0]
    outside[:, -1] += load[:, -1] * there[1]
    grounded, walled = np.any(ground) or np.any(ground_cubic), any(np.any(on) for on in there)

    def at_wall(strength: Any, overlap: Floats, closing: Floats) -> Floats:
        closed = np.maximum(overlap, 0.0)
        push = strength * closed**exponent
        if wall_loss is not None:
            push = push + np.where((closed > 0.0) & (np.asarray(strength) > 0.0), wall_loss(closed) * closing, 0.0)
        return np.asarray(push if tension else np.maximum(push, 0.0))

    def rate(time: float, state: Floats) -> Floats:  # what is not there is left out: it would take most of the time
        x, v = state[:size].reshape(shape), state[size:].reshape(shape)
        closed = np.maximum(x[:, :-1] - x[:, 1:] - gap + rest, 0.0)
        contact = strength * (closed * np.sqrt(closed) if exponent == 1.5 else closed**exponent)
        if loss is not None:
            contact += np.where(closed > 0.0, loss(closed) * (v[:, :-1] - v[:, 1:]), 0.0)
        if not tension:
            contact = np.maximum(contact, 0.0)
        force = outside - drag * v
        if grounded:
            force -= ground * x + ground_cubic * x**3
        if walled:
            force[:, 0] += at_wall(walls[0], left - x[:, 0] - gap, -v[:, 0])
            force[:, -1] -= at_wall(walls[1], right + x[:, -1] - gap, v[:, -1])
        force[:, 1:] += contact
        force[:, :-1] -= contact
        if problem.chains > 1:
            pull = kappa * (x[1:] - x[:-1]) + drag_across * (v[1:] - v[:-1])
            force[:-1] += pull
            force[1:] -= pull
        if push is not None and time < push[3]:
            force[push[0] - 1, push[1] - 1] += push[2] * np.sin(np.pi * time / push[3])
        for place, of_time in (pushed or {}).items():
            force[place] += of_time(time)
        acceleration = force / mass
        for place, of_time in (moved or {}).items():
            acceleration[place] = of_time(time)
        return np.concatenate([v, acceleration], axis=None)

    start = np.concatenate([np.zeros(size), physics.initial_velocity(problem.system).reshape(-1)])
    time = np.arange(problem.frames + 1) * problem.every
    found = solve_ivp(
        rate, (0.0, time[-1]), start, t_eval=time, method="DOP853", rtol=rtol, atol=1e-2 * rtol, max_step=max_step
    )
    return np.asarray(found.y[size:].T.reshape(-1, *shape))
