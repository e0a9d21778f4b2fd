"""A train of pulses: those that follow each other past a bead, as when several beads are hit or one is for long."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.shape.exact_wave import SolitaryWave, solitary_wave
from analysis.tracking.pulses import Pulse
from analysis.trajectory import Floats


@dataclass(frozen=True)
class Train:
    """Pulses at one bead of one chain, in the order of their arrival.

    Attributes:
        chain, bead: counted from 1.
        arrival: [pulse], in units of T.
        peak_velocity: [pulse] along their way, in units of V.
        uncertainty: [pulse] largest difference from that over the ten beads before; NaN where it passed none of them.
    """

    chain: int
    bead: int
    arrival: Floats
    peak_velocity: Floats
    uncertainty: Floats

    def __len__(self) -> int:
        return len(self.arrival)

    def until(self, count: int) -> "Train":
        """The first pulses of it."""
        return Train(self.chain, self.bead, self.arrival[:count], self.peak_velocity[:count], self.uncertainty[:count])

    @property
    def ratio(self) -> Floats:
        """[pulse] amplitude in that of the first."""
        return np.asarray(self.peak_velocity / self.peak_velocity[0])

    @property
    def spacing(self) -> Floats:
        """[pulse after the first] time since the one before."""
        return np.diff(self.arrival)


def train_of(
    pulses: Iterable[Pulse], chain: int, direction: int, bead: int, exact: SolitaryWave | None = None
) -> Train:
    """Those pulses of a chain, running one way, that were seen at a bead.

    Of those that are nearer to each other than the exact wave passes at half its height, as light and heavy beads see
    one and the same, the highest counts.
    """
    found: list[tuple[float, float, float]] = []
    for pulse in pulses:
        at: NDArray[np.int64] = np.flatnonzero(pulse.bead == bead)
        if (pulse.chain, pulse.direction) == (chain, direction) and len(at):
            arrival, peak = float(pulse.arrival[at[0]]), float(pulse.peak_velocity[at[0]])
            found.append((arrival, peak, pulse.variation(int(at[0]))))
    exact = exact or solitary_wave()
    apart: list[tuple[float, float, float]] = []
    for pulse_at in sorted(found):
        if apart and pulse_at[0] - apart[-1][0] < float(exact.width / exact.speed_at(pulse_at[1])):
            apart[-1] = max(apart[-1], pulse_at, key=lambda one: one[1])
        else:
            apart.append(pulse_at)
    return Train(chain, bead, *np.array(apart).reshape(-1, 3).T)
