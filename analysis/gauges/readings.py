"""What gauges have read, and as a table."""

import csv
import io
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.gauges.gauge import Gauge
from analysis.trajectory import Floats
from lammps_inputs.units import Scale


@dataclass(frozen=True)
class Readings:
    """What the gauges read, dimensionless.

    Attributes:
        gauges: which.
        time: [frame], in units of T.
        force: [frame, chain, gauge].
        largest, largest_at: [chain, gauge] largest force, between frames too, and when; at NaN where there was none.
        impulse: [chain, gauge] integral of the force over time, of all contacts together.
        dwell: [chain, gauge] how long the contact lasted in which the force was largest, so far if it still lasts.
        contacts: [chain, gauge] how many contacts there were.
    """

    gauges: tuple[Gauge, ...]
    time: Floats
    force: Floats
    largest: Floats
    largest_at: Floats
    impulse: Floats
    dwell: Floats
    contacts: NDArray[np.int64]


def to_csv(readings: Readings, scale: Scale) -> str:
    """Force over time in the scene's units: a column for every gauge and chain, such as ``contact 10 chain 1 (N)``."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    chains = readings.force.shape[1]
    names = [f"{gauge.name} chain {chain + 1}" for gauge in readings.gauges for chain in range(chains)]
    writer.writerow([scale.heading("time", "time"), *(scale.heading(name, "force") for name in names)])
    columns = np.moveaxis(readings.force, 2, 1).reshape(len(readings.time), -1) * scale.force
    for time, row in zip((readings.time * scale.time).tolist(), columns.tolist(), strict=True):
        writer.writerow([repr(time), *map(repr, row)])
    return out.getvalue()
