"""Trajectories by an integrator that shares no code with the product: scipy's DOP853 at tight tolerances."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from lammps_inputs import Problem

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
) -> Floats:
    """Velocities [frame, chain, bead] of chains with contacts, springs between neighbours and to the ground, and walls.

    Args:
        problem: what is computed; its chains, coupling, kicks and frames are taken, its laws are not.
        ground, ground_cubic: stiffness of the springs to the ground, [chain, bead] or one number.
        mass: of the beads, likewise.
        strength: of the contacts, [chain, contact] or one number.
        walls: force over overlap**1.5 of the walls on the left and on the right, a gap away, [chain] or one number.
        push: chain and bead, from 1, peak and duration of a half-sine of force.
    """
    shape = problem.chains, problem.beads
    size = problem.chains * problem.beads

    def rate(time: float, state: Floats) -> Floats:
        x = state[:size].reshape(shape)
        contact = strength * np.maximum(x[:, :-1] - x[:, 1:] - problem.gap, 0.0) ** 1.5
        force = -ground * x - ground_cubic * x**3
        force[:, 0] += walls[0] * np.maximum(-x[:, 0] - problem.gap, 0.0) ** 1.5
        force[:, -1] -= walls[1] * np.maximum(x[:, -1] - problem.gap, 0.0) ** 1.5
        force[:, 1:] += contact
        force[:, :-1] -= contact
        pull = problem.kappa * np.diff(x, axis=0)
        force[:-1] += pull
        force[1:] -= pull
        if push is not None and time < push[3]:
            force[push[0] - 1, push[1] - 1] += push[2] * np.sin(np.pi * time / push[3])
        return np.concatenate([state[size:], (force / mass).reshape(-1)])

    start = np.concatenate([np.zeros(size), problem.initial_velocity().reshape(-1)])
    time = np.arange(problem.frames + 1) * problem.every
    found = solve_ivp(rate, (0.0, time[-1]), start, t_eval=time, method="DOP853", rtol=1e-12, atol=1e-14)
    return np.asarray(found.y[size:].T.reshape(-1, *shape))
