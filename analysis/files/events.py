"""Collisions of rigid beads as a list, and as the table ``events.csv``."""

import csv
import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analysis.trajectory import Floats
from lammps_inputs import InputError
from lammps_inputs.units import Scale

COLUMNS = ("time", "chain", "row", "striker", "target")


@dataclass(frozen=True)
class Events:
    """Collisions in the order in which they happen; bead ``row`` of a chain strikes bead ``row + 1``.

    Attributes:
        time: [collision], in units of T.
        chain, row: [collision], counted from 1.
        striker: [collision], velocity of bead ``row`` before and of bead ``row + 1`` after it, in units of V.
        target: [collision], velocity of bead ``row + 1`` before and of bead ``row`` after it.
    """

    time: Floats
    chain: NDArray[np.int64]
    row: NDArray[np.int64]
    striker: Floats
    target: Floats

    def __len__(self) -> int:
        return len(self.time)

    @property
    def impulse(self) -> Floats:
        """[collision] momentum handed on, in units of m V; positive."""
        return self.striker - self.target


def to_csv(events: Events, scale: Scale) -> str:
    """A table with the columns `COLUMNS` in the scene's units, which the header names if SI; numbers round-trip."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(_header(scale))
    columns = (
        (events.time * scale.time).tolist(),
        events.chain.tolist(),
        events.row.tolist(),
        (events.striker * scale.velocity).tolist(),
        (events.target * scale.velocity).tolist(),
    )
    writer.writerows(zip(*columns, strict=True))
    return out.getvalue()


def _header(scale: Scale) -> list[str]:
    quantities = {"time": "time", "striker": "velocity", "target": "velocity"}
    return [scale.heading(name, quantities[name]) if name in quantities else name for name in COLUMNS]


def from_csv(path: Path, scale: Scale) -> Events:
    """The collisions that a table in the scene's units holds.

    Raises:
        InputError: it cannot be read, or is not such a table.
    """
    try:
        with path.open(encoding="utf-8") as file:
            head = file.readline().strip()
            # tables of before units were named have bare names
            if head not in (",".join(_header(scale)), ",".join(COLUMNS)):
                raise InputError(f"{path}: is not a table of collisions; its columns should be {', '.join(COLUMNS)}")
            lines = [line for line in file if line.strip()]
        values = np.loadtxt(lines, delimiter=",", ndmin=2) if lines else np.empty((0, len(COLUMNS)))
        time, chain, row, striker, target = values.T
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: is not a table of collisions ({error})") from None
    velocity = scale.velocity
    return Events(
        time / scale.time, chain.astype(np.int64), row.astype(np.int64), striker / velocity, target / velocity
    )
