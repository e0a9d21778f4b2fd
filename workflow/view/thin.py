"""What a page holds of a run: some chains, beads and frames of it as they are, so that every number is the run's."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis import motion
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem

MOST_BEADS = 500
"""Of a chain."""

MOST_NUMBERS = 330_000
"""Beads times frames; a page has sixteen bytes for each."""


@dataclass(frozen=True)
class Thinned:
    """Part of a run, in the scene's units.

    Attributes:
        chains, beads: which, counted from 1.
        time: [frame].
        displacement, velocity: [chain, frame, bead].
        overlap, force: of each bead with the next of its chain, [chain, frame, bead]; NaN where that is not known.
        energy: of each chain's beads, [chain, frame]; NaN where not every bead was recorded.
        bead_stride, frame_stride: every how many there are here.
    """

    chains: list[int]
    beads: NDArray[np.int64]
    time: Floats
    displacement: Floats
    velocity: Floats
    overlap: Floats
    force: Floats
    energy: Floats
    bead_stride: int
    frame_stride: int


def thinned(problem: Problem, blocks: Iterable[Trajectory], chains: list[int], *, most: int = MOST_NUMBERS) -> Thinned:
    """Every so-manieth bead and frame of some chains.

    Args:
        problem: what was run.
        blocks: all of its frames.
        chains: which to keep, counted from 0.
        most: numbers that are kept of each kind, about.
    """
    recorded = problem.recorded_beads
    beads = slice(None, None, max(1, -(-len(recorded) // MOST_BEADS)))
    stride = max(1, -(-(problem.frames + 1) * len(recorded[beads]) * len(chains) // most))
    parts: list[tuple[Floats, ...]] = []
    seen = 0
    for block in blocks:
        frames = block[-seen % stride :: stride]
        seen += block.frames
        if problem.window is not None:
            frames = frames.on(1, problem.beads, behind=np.nan)
        parts.append((frames.time, _energy(frames)[:, chains], *(values[:, chains, beads] for values in _of(frames))))
    time, energy, *values = (np.concatenate(kind) for kind in zip(*parts, strict=True))
    scale = problem.scale
    x, v, overlap, force = (np.ascontiguousarray(kind.transpose(1, 0, 2)) for kind in values)
    return Thinned(
        chains=[chain + 1 for chain in chains],
        beads=recorded[beads],
        time=time * scale.time,
        displacement=x * scale.length,
        velocity=v * scale.velocity,
        overlap=overlap * scale.length,
        force=force * scale.force,
        energy=energy.T * scale.energy,
        bead_stride=beads.step,
        frame_stride=stride,
    )


def _of(frames: Trajectory) -> tuple[Floats, Floats, Floats, Floats]:
    """Displacement, velocity, and overlap and force of each bead with the next, all [frame, chain, bead]."""
    problem, x = frames.problem, frames.displacement
    overlap, force = np.full_like(x, np.nan), np.full_like(x, np.nan)
    if problem.recorded is None:
        overlap[..., :-1] = motion.overlaps(problem, x)
        force[..., :-1] = motion.contact_force(problem, overlap[..., :-1])
    return x, frames.velocity, overlap, force


def _energy(frames: Trajectory) -> Floats:
    """Of each chain's beads, [frame, chain]."""
    if not frames.problem.whole:
        return np.full(frames.velocity.shape[:2], np.nan)
    return np.asarray(motion.bead_energy(frames.problem, frames.displacement, frames.velocity).sum(axis=-1))
