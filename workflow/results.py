"""What a run came to, in a few numbers: enough to tell whether another one is the same, and how far it is from it."""

import hashlib
from typing import Any

import numpy as np

from analysis.trajectory import Floats, Trajectory
from workflow.run_directory import RunDirectory

SAMPLES = 32
"""Beads whose state at the end is kept."""


def results(directory: RunDirectory) -> dict[str, Any]:
    """For ``run.json``: the number of frames, a fingerprint of them, and the last state of some beads, dimensionless.

    The fingerprint is the SHA-256 of displacement and velocity [chain, bead] (of a window, after the number of its
    first row) as little-endian float64, frame after frame: neither ranks nor interruptions change it.

    Raises:
        InputError: there are no frames.
    """
    digest, frames, last = hashlib.sha256(), 0, None
    for block in directory.blocks():
        found = states(block)
        if block.problem.window is None:
            digest.update(found.data)
        else:
            for state in found:
                digest.update(np.int64(block.first).tobytes() + state.tobytes())
        frames += block.frames
        last = block
    assert last is not None
    return {"frames": frames, "sha256": digest.hexdigest(), "samples": samples(last)}


def states(block: Trajectory) -> Floats:
    """[frame, displacement or velocity, chain, bead]; zeros have no sign."""
    found = np.stack([block.displacement, block.velocity], axis=1)
    found += 0.0
    return found


def samples(block: Trajectory) -> list[dict[str, float]]:
    """State of some beads in the last frame of a block."""
    chains, beads = block.velocity.shape[1:]
    chosen = np.unique(np.linspace(0, chains * beads - 1, min(SAMPLES, chains * beads)).astype(int))
    return [
        {
            "time": float(block.time[-1]),
            "chain": int(place // beads) + 1,
            "bead": int(block.beads[place % beads]),
            "displacement": float(block.displacement[-1].flat[place]),
            "velocity": float(block.velocity[-1].flat[place]),
        }
        for place in chosen
    ]
