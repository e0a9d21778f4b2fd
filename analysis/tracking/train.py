"""A train of pulses: those that follow each other past a bead, as when several beads are hit or one is for long."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from analysis.quantity import declare, derived, result
from analysis.shape.exact_wave import SolitaryWave, solitary_wave
from analysis.tracking.pulses import Pulse
from analysis.trajectory import Floats


@result
class Train:
    """Pulses at one bead of one chain, in the order of their arrival."""

    chain: int = declare("number of the chain")
    bead: int = declare("bead at which the pulses were measured")
    arrival: Floats = declare("arrival of each pulse", "time", symbol="t")
    peak_velocity: Floats = declare("peak velocity of each pulse, positive along its way", "velocity", symbol="v")
    uncertainty: Floats = declare(
        "of each peak velocity: largest difference from it over the ten beads before",
        "velocity",
        "none of them was recorded",
    )

    @property
    @derived()
    def pulses(self) -> int:
        """Number of pulses, from the first on, that are steady there: clear of the ends of the chain and of other
        pulses, and of an amplitude that is constant to 1 % over the ten beads before.
        """
        return len(self)

    def __len__(self) -> int:
        return len(self.arrival)

    def until(self, count: int) -> "Train":
        """The first pulses of it."""
        return Train(self.chain, self.bead, self.arrival[:count], self.peak_velocity[:count], self.uncertainty[:count])

    @property
    @derived()
    def ratio(self) -> Floats:
        """Peak velocity of each over that of the first."""
        return np.asarray(self.peak_velocity / self.peak_velocity[0])

    @property
    @derived("time")
    def spacing(self) -> Floats:
        """Time from each to the next."""
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
