"""The leading pulse at every bead: the first passage above the threshold, its peak, and its local speed."""

import csv
import io
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.peaks import Peaks
from analysis.trajectory import Floats
from lammps_inputs.units import Scale


@dataclass(frozen=True)
class Waves:
    """Leading pulse of each chain at each bead that it reached, sorted by chain, then bead.

    Attributes:
        chain, bead: counted from 1.
        arrival: time at which the bead is fastest, in units of T.
        peak_velocity: that velocity, in units of V.
        speed: beads per unit time from the arrivals at the recorded beads on either side (at an end: one side);
            NaN where only one bead of the chain was reached.
    """

    chain: NDArray[np.int64]
    bead: NDArray[np.int64]
    arrival: Floats
    peak_velocity: Floats
    speed: Floats

    def __len__(self) -> int:
        return len(self.bead)

    def at(self, bead: int) -> "Waves":
        """The chains' leading pulses at one bead."""
        return self.where(self.bead == bead)

    def of_chain(self, chain: int) -> "Waves":
        """One chain's leading pulse at all beads."""
        return self.where(self.chain == chain)

    def where(self, chosen: NDArray[np.bool_] | NDArray[np.int64]) -> "Waves":
        """The entries that a mask or positions choose."""
        return Waves(*(column[chosen] for column in self._columns()))  # type: ignore[arg-type]

    def _columns(self) -> tuple[NDArray[np.int64] | Floats, ...]:
        return self.chain, self.bead, self.arrival, self.peak_velocity, self.speed


def leading_waves(peaks: Peaks) -> Waves:
    """The first peak of every bead, which is the pulse that runs ahead of all others."""
    place = np.stack([peaks.chain, peaks.bead])
    first = np.ones(len(peaks), dtype=bool)
    first[1:] = np.any(place[:, 1:] != place[:, :-1], axis=0)
    return with_speeds(peaks.chain[first], peaks.bead[first], peaks.time[first], peaks.velocity[first])


def with_speeds(chain: NDArray[np.int64], bead: NDArray[np.int64], arrival: Floats, peak_velocity: Floats) -> Waves:
    """Waves whose local speeds follow from their arrivals; entries are sorted by chain, then bead."""
    speed = np.full(len(chain), np.nan)
    for number in np.unique(chain):
        row = np.flatnonzero(chain == number)
        if len(row) > 1:
            ahead, behind = np.minimum(np.arange(len(row)) + 1, len(row) - 1), np.maximum(np.arange(len(row)) - 1, 0)
            beads, times = bead[row], arrival[row]
            with np.errstate(divide="ignore"):
                speed[row] = (beads[ahead] - beads[behind]) / (times[ahead] - times[behind])
    return Waves(chain, bead, arrival, peak_velocity, speed)


COLUMNS = ("chain", "bead", "arrival", "peak_velocity", "speed")


def to_csv(waves: Waves, scale: Scale, more: Mapping[str, Floats] | None = None) -> str:
    """A table in the scene's units (speed in beads per unit time); numbers round-trip, an unknown one is left empty.

    SI units are named in the header, such as ``arrival (s)``.

    Args:
        waves: a row each, with the columns `COLUMNS`.
        scale: of the scene.
        more: further columns by heading, in the scene's units, [wave].
    """
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    numbers = {
        scale.heading("arrival", "time"): waves.arrival * scale.time,
        scale.heading("peak_velocity", "velocity"): waves.peak_velocity * scale.velocity,
        scale.heading("speed", "speed"): waves.speed / scale.time,
        **(more or {}),
    }
    writer.writerow(["chain", "bead", *numbers])
    for chain, bead, *row in zip(waves.chain, waves.bead, *numbers.values(), strict=True):
        writer.writerow([int(chain), int(bead), *("" if np.isnan(number) else repr(float(number)) for number in row)])
    return out.getvalue()
