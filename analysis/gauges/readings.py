"""What gauges have read, and as a table."""

import csv
import io
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.gauges.gauge import Gauge
from analysis.trajectory import Floats
from lammps_inputs.units import Scale

PULSE = 0.01
"""Share of its largest value, above the static one, from which a force is that of a pulse."""


@dataclass(frozen=True)
class Readings:
    """What the gauges read, dimensionless.

    Attributes:
        gauges: which.
        time: [frame], in units of T.
        force: [frame, chain, gauge] total: the static force is included.
        static: [chain, gauge] force at rest; 0 without a static load.
        largest, largest_at: [chain, gauge] largest total force, between frames too, and when; at NaN where the force
            never exceeds the static one by more than the numerical noise.
        impulse: [chain, gauge] integral over time of the total force minus the static one.
        dwell: [chain, gauge] how long the contact lasted in which the force was largest; under a static load, for how
            long the force exceeded the static one by more than `PULSE` of its largest excess, around its maximum. So
            far, where that has not ended; NaN under a load where frames are too far apart to show it.
        ended: [chain, gauge] whether that has ended before the last frame.
        contacts: [chain, gauge] how often the contact has closed; one that is closed at the start counts.
    """

    gauges: tuple[Gauge, ...]
    time: Floats
    force: Floats
    static: Floats
    largest: Floats
    largest_at: Floats
    impulse: Floats
    dwell: Floats
    ended: NDArray[np.bool_]
    contacts: NDArray[np.int64]

    @property
    def loaded(self) -> bool:
        """Whether any of them bears a static load."""
        return bool(np.any(self.static))

    @property
    def dynamic(self) -> Floats:
        """[chain, gauge] largest force above the static one; NaN where it never exceeds it."""
        return np.where(np.isfinite(self.largest_at), self.largest - self.static, np.nan)

    @property
    def last(self) -> Floats:
        """[chain, gauge] force above the static one in the last frame, as a share of the largest; NaN likewise."""
        return np.asarray((self.force[-1] - self.static) / self.dynamic)


def to_csv(readings: Readings, scale: Scale) -> str:
    """Force over time in the scene's units: a column for every gauge and chain, such as ``contact 10 chain 1 (N)``.

    Under a static load those are ``contact 10 chain 1 total (N)``, and as many columns ``... dynamic (N)``, without it,
    follow.
    """
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    chains = readings.force.shape[1]
    names = [f"{gauge.name} chain {chain + 1}" for gauge in readings.gauges for chain in range(chains)]
    forces = [readings.force]
    if readings.loaded:
        names = [f"{name} {which}" for which in ("total", "dynamic") for name in names]
        forces.append(readings.force - readings.static)
    columns = (
        np.concatenate([np.moveaxis(f, 2, 1).reshape(len(readings.time), -1) for f in forces], axis=1) * scale.force
    )
    writer.writerow([scale.heading("time", "time"), *(scale.heading(name, "force") for name in names)])
    for time, row in zip((readings.time * scale.time).tolist(), columns.tolist(), strict=True):
        writer.writerow([repr(time), *map(repr, row)])
    return out.getvalue()
