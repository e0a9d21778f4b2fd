"""From which bead on do the leading pulses of all chains agree."""

import numpy as np
from numpy.typing import NDArray

from analysis.trajectory import Floats
from analysis.waves import Waves


def leading_peaks(waves: Waves, chains: int) -> tuple[NDArray[np.int64], Floats]:
    """Beads that the pulse reached in every chain, and its peaks there, [bead, chain]."""
    beads = np.unique(waves.bead)
    peaks = np.full((len(beads), chains), np.nan)
    peaks[np.searchsorted(beads, waves.bead), waves.chain - 1] = waves.peak_velocity
    reached = ~np.any(np.isnan(peaks), axis=1)
    return beads[reached], peaks[reached]


def mismatch(peaks: Floats) -> Floats:
    """Spread over the chains relative to the mean, [bead] from [bead, chain]."""
    return np.asarray(np.ptp(peaks, axis=1) / np.mean(peaks, axis=1))


def agrees_from(beads: NDArray[np.int64], peaks: Floats, tolerance: float) -> int | None:
    """First bead from which the mismatch stays within a tolerance to the last bead; None if it does not at the last."""
    outside = np.flatnonzero(mismatch(peaks) > tolerance)
    if len(beads) == 0 or (len(outside) and outside[-1] == len(beads) - 1):
        return None
    return int(beads[outside[-1] + 1]) if len(outside) else int(beads[0])
