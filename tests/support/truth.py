"""The motion of a scene by an integrator of its own, scipy's DOP853; no code is shared with the product."""

from itertools import pairwise
from typing import Any

import numpy as np
from scene_keys import nature
from scenes_nature import Floats, Nature
from scipy.integrate import OdeSolution, solve_ivp

from lammps_inputs import Scene


class Truth:
    """A scene's own trajectory until a time."""

    def __init__(self, scene: Scene, duration: float, rtol: float = 1e-8) -> None:
        self.scene, self.nature = scene, nature(scene)
        self.solution = _solved(self.nature, duration, rtol)

    def states(self, time: Any) -> tuple[Floats, Floats]:
        """Displacements and velocities, [..., chain, bead]."""
        shape = np.shape(time)
        found = self.solution(np.ravel(time)).T
        found = found.reshape(*shape, 2, *self.nature.mass.shape)[..., : self.scene.chains, :]
        return self.nature.placed(time, found[..., 0, :, :], found[..., 1, :, :])


def _solved(own: Nature, end: float, rtol: float) -> OdeSolution:
    """Displacements and velocities over time; from kink to kink of what comes from outside."""

    def rates(time: float, state: Floats) -> Floats:
        x, v = own.placed(time, *state.reshape(2, *own.mass.shape))
        return np.concatenate([v, own.acceleration(time, x, v)], axis=None)

    kinks = [*own.bends, *(kink for each in (*own.pushes, *own.moved) for kink in each.kinks)]
    state = np.concatenate([own.displaced, own.start], axis=None)
    edges = sorted({0.0, end, *(kink for kink in kinks if 0.0 < kink < end)})
    pieces = []
    for since, until in pairwise(edges):
        # no stage of a step is at its end, where the push is over
        found = solve_ivp(
            rates, (since, np.nextafter(until, 0.0) if until < end else until), state, "DOP853",
            rtol=rtol, atol=1e-2 * rtol, max_step=0.4, dense_output=True,
        )  # fmt: skip
        if not found.success:
            raise ArithmeticError(found.message)
        state = found.y[:, -1]
        pieces.append(found.sol)
    return OdeSolution(
        np.concatenate([pieces[0].ts[:1], *(piece.ts[1:] for piece in pieces)]),
        [step for piece in pieces for step in piece.interpolants],
    )


def force_of(own: Nature, kind: str, chain: int, bead: int) -> Any:
    """What a gauge reads, (x, v) -> [...]: chain and bead from 1, the bead of a wall 1 or the last."""
    if kind == "wall":
        wall = next(wall for wall in own.walls if wall.bead == bead - 1)
        return lambda x, v: own.at_wall(wall, x, v)[..., chain - 1]
    if kind == "contact":
        return lambda x, v: own.contacts(x, v)[..., chain - 1, bead - 1]
    return lambda x, v: own.contacts(x, v)[..., chain - 1, [bead - 2, bead - 1]].mean(axis=-1)
