"""A train of pulses: those that follow each other past a bead, as when several beads are hit or one is for long."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.tracking.pulses import Pulse
from analysis.trajectory import Floats


@dataclass(frozen=True)
class Train:
    """Pulses at one bead of one chain, in the order of their arrival.

    Attributes:
        chain, bead: counted from 1.
        arrival: [pulse], in units of T.
        peak_velocity: [pulse] along their way, in units of V.
    """

    chain: int
    bead: int
    arrival: Floats
    peak_velocity: Floats

    def __len__(self) -> int:
        return len(self.arrival)

    @property
    def ratio(self) -> Floats:
        """[pulse] amplitude in that of the first."""
        return np.asarray(self.peak_velocity / self.peak_velocity[0])

    @property
    def spacing(self) -> Floats:
        """[pulse after the first] time since the one before."""
        return np.diff(self.arrival)


def train_of(pulses: Iterable[Pulse], chain: int, direction: int, bead: int) -> Train:
    """Those pulses of a chain, running one way, that were seen at a bead."""
    found: list[tuple[float, float]] = []
    for pulse in pulses:
        at: NDArray[np.int64] = np.flatnonzero(pulse.bead == bead)
        if (pulse.chain, pulse.direction) == (chain, direction) and len(at):
            found.append((float(pulse.arrival[at[0]]), float(pulse.peak_velocity[at[0]])))
    arrival, peak = np.array(sorted(found)).reshape(-1, 2).T
    return Train(chain, bead, arrival, peak)
