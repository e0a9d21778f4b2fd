"""Dimensionless problems and trajectories without a scene around them."""

import math
from collections.abc import Callable
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.trajectory import Trajectory
from lammps_inputs import Problem, System
from lammps_inputs.chains import coupled_chains
from lammps_inputs.rows import Rows
from lammps_inputs.units import Scale

Floats = NDArray[np.float64]

REDUCED = Scale(1.0, 1.0, 1.0, si=False)


def problem(**changes: Any) -> Problem:
    """Two chains of eight beads, kappa = 0.1, bead 1 of chain 1 hit; 100 frames of 0.1, ten steps each."""
    chains = changes.get("chains", 2)
    system: dict[str, Any] = {
        "chains": chains,
        "beads": 8,
        "kicks": ((1, 1, 1.0),),
        "links": coupled_chains(chains, changes.pop("kappa", 0.1), changes.pop("gap", 0.0)),
    }
    system |= {field.name: changes.pop(field.name) for field in fields(System) if field.name in changes}
    options: dict[str, Any] = {
        "name": "test",
        "timestep": 0.01,
        "steps_per_frame": 10,
        "frames": 100,
        "scale": REDUCED,
    }
    rows = Rows(system["beads"]).only(changes.pop("recorded", None)).near_front(changes.pop("window", None))
    return Problem(system=System(**system), **{"rows": rows, **options, **changes})


def rigid_problem(
    chains: int = 2,
    beads: int = 10,
    kicks: Any = ((1, 1, 1.0),),
    kappa: float = 0.5,
    gap: float = 1.0,
    duration: float = 100.0,
    **others: Any,
) -> Problem:
    """Rigid beads a gap apart; a hundred frames."""
    times = {"timestep": duration / 100, "steps_per_frame": 1}
    return problem(chains=chains, beads=beads, kicks=tuple(kicks), kappa=kappa, gap=gap, **times, **others)


def written_down(problem: Problem, motion: Callable[[Floats], tuple[Floats, Floats]]) -> Trajectory:
    """The frames of a motion given as time [frame, 1, 1] -> displacement and velocity [frame, chain, bead]."""
    time = np.arange(problem.frames + 1) * problem.every
    displacement, velocity = motion(time[:, np.newaxis, np.newaxis])
    shape = (len(time), problem.chains, len(problem.rows.numbers))
    return Trajectory(
        problem, time, np.broadcast_to(displacement, shape).copy(), np.broadcast_to(velocity, shape).copy()
    )


def system(energy: float, kappa: float = 0.0, chains: int = 1) -> System:
    """Chains of two beads whose kick has this energy."""
    kicks = ((1, 1, math.sqrt(2.0 * energy)),)
    return System(chains=chains, beads=2, kicks=kicks, links=coupled_chains(chains, kappa))
