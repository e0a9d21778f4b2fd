"""Trajectories made of exact solitary waves at known places, and runs of the reference engine, to analyse."""

import itertools
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from analysis.shape.exact_wave import solitary_wave
from analysis.sharing.survey import Survey, survey
from analysis.trajectory import Trajectory
from lammps_inputs import Kick, Output, Problem, Scene, library
from lammps_inputs.ingredients.coupling import Coupling
from workflow.engines.reference import engine


def problem(
    chains: int = 2,
    kappa: float = 0.1,
    beads: int = 120,
    duration: float = 192.0,
    every: float = 0.1,
    recorded: Any = "all",
    kicks: Sequence[Kick] = (Kick(velocity=1.0),),
    gap: float = 0.0,
) -> Problem:
    return Scene(
        name="test",
        chains=chains,
        beads=beads,
        gap=gap,
        coupling=Coupling(stiffness=kappa) if kappa else None,
        kick=tuple(kicks),
        duration=duration,
        output=Output(every=every, beads=recorded),
    ).problem()


def reference(*arguments: Any, **options: Any) -> Trajectory:
    return engine.run(problem(*arguments, **options))


def surveyed(trajectory: Trajectory, **options: Any) -> Survey:
    return survey(trajectory.blocks, trajectory.problem, **options)


def cut(trajectory: Trajectory, places: Iterable[int]) -> list[Trajectory]:
    """A trajectory in pieces that begin at frames, in ascending order; a piece is empty where two begin at one."""
    return [trajectory[start:end] for start, end in itertools.pairwise((0, *places, trajectory.frames))]


def of_keys(**keys: Any) -> Problem:
    """The problem of a scene's keys."""
    return library.from_plain({"name": "test", **keys}, "test").problem()


def exact_waves(
    waves: Sequence[tuple[float, float]],
    *,
    every: float = 0.1,
    beads: int = 40,
    recorded: Any = "all",
    direction: int = 1,
    duration: float | None = None,
) -> Trajectory:
    """One chain with waves (peak velocity, arrival at bead 1) that pass as if each were alone."""
    exact = solitary_wave()
    last = max(arrival + (beads + 6) / float(exact.speed_at(v)) for v, arrival in waves) if waves else 50.0
    what = problem(1, 0.0, beads, duration or last, every, recorded, [Kick(velocity=1.0)])
    time = np.arange(what.frames + 1) * what.every
    x, v = np.zeros((2, len(time), 1, beads))
    for peak, arrival in waves:
        xi = np.arange(beads) - exact.speed_at(peak) * (time[:, np.newaxis] - arrival)
        v[:, 0] += peak * exact.velocity(xi)
        x[:, 0] += peak**0.8 * exact.displacement(xi)
    if direction < 0:
        x, v = -x[..., ::-1], -v[..., ::-1]
    columns = what.rows.numbers - 1
    return Trajectory(what, time, x[..., columns], v[..., columns])


def arrivals(peak: float, arrival: float, beads: np.ndarray[Any, Any], last: int | None = None) -> Any:
    """When an exact wave passes beads; with ``last`` those of a wave that comes from that end."""
    way = beads - 1 if last is None else last - beads
    return arrival + way / float(solitary_wave().speed_at(peak))
