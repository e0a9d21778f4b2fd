"""The table of a sweep: its columns, their names, units and numbers."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.quantity import to_csv
from analysis.sharing.verdict import State
from analysis.trajectory import Floats
from lammps_inputs import html
from lammps_inputs.numbers import text
from lammps_inputs.units import REDUCED, SI
from workflow.runs.files import RECORD
from workflow.verdicts.analysis_report import REPORT

OWN = ("V", "T")
"""A case's own units: of the fastest kick, and of time (`lammps_inputs.units`)."""


@dataclass(frozen=True)
class Quantity:
    """A column of the table.

    Attributes:
        file: where its value stands.
        path: key by key.
        label: for an axis; of a number only. A quantity of the scene's units ends in one of `lammps_inputs.units.SI`,
            what is measured in the case's own velocity or time in one of `OWN`.
    """

    file: str
    path: tuple[str, ...]
    label: str = ""

    @property
    def words(self) -> str:
        """The label without its quantity."""
        return self.label.partition(" [")[0]

    def unit(self, *, si: bool) -> str:
        """Symbol of what has a unit; empty for anything else."""
        _, bracket, quantity = self.label.rstrip("]").partition(" [")
        if not bracket or quantity in OWN:
            return quantity
        return SI[quantity] if si else REDUCED


def _analysis(path: str, label: str = "") -> Quantity:
    return Quantity(REPORT, tuple(path.split("/")), label)


def _run(path: str, label: str = "") -> Quantity:
    return Quantity(RECORD, tuple(path.split("/")), label)


QUANTITIES = {
    "amplitude": _analysis("equipartition/final/value", "asymptotic amplitude [V]"),
    "amplitude_uncertainty": _analysis(
        "equipartition/final/uncertainty", "uncertainty of the asymptotic amplitude [V]"
    ),
    "agree_10": _analysis("equipartition/amplitudes/0.1", "bead from which the chains agree to 10%"),
    "agree_1": _analysis("equipartition/amplitudes/0.01", "bead from which the chains agree to 1%"),
    "in_step_1": _analysis("equipartition/arrivals/0.01", "bead from which arrivals agree to 1%"),
    "beat_length": _analysis("equipartition/beat_length/value", "beat length (beads)"),
    "beat_length_uncertainty": _analysis(
        "equipartition/beat_length/uncertainty", "uncertainty of the beat length (beads)"
    ),
    "energy_share": _analysis("equipartition/energy_share/measured", "share of the energy in the leading waves"),
    "state": _analysis("equipartition/state"),
    "bead": _analysis("hit/bead", "last clear bead"),
    "arrival": _analysis("hit/arrival", "arrival at the last clear bead [time]"),
    "peak_velocity": _analysis("hit/peak_velocity", "peak velocity at the last clear bead [velocity]"),
    "speed": _analysis("hit/speed", "speed at the last clear bead [speed]"),
    "left_behind": _analysis("cells/left_behind", "residual energy per cell / energy input"),
    "transmissibility": _analysis("spectra/transmissibility", "velocity at the drive's frequency, last bead / first"),
    "wall_force": _analysis("far_end/wall_force", "largest force on the far wall [force]"),
    "wall_force_chain": _analysis("far_end/wall_force_chain", "largest force of a chain on the far wall [force]"),
    "delay": _analysis("far_end/delay", "delay until the far end [time]"),
    "transmitted_energy": _analysis("far_end/transmitted_energy", "largest energy at the far end / energy input"),
    "front": _analysis("front", "largest number of a bead that moved"),
    "energy_drift": _analysis("energy_drift", "relative drift of the energy"),
    "error_velocity": _run("check/velocity", "error of velocities [V]"),
    "error_amplitude": _run("check/amplitude", "error of peak velocities [V]"),
    "error_arrival": _run("check/arrival", "error of arrivals [T]"),
    "engine": _run("engine"),
    "steps": _run("steps", "time steps"),
    "engine_seconds": _run("engine_seconds", "time of the engine (s)"),
    "wall_seconds": _run("wall_seconds", "wall time (s)"),
    "verdict": _analysis("equipartition/verdict"),
}
"""Columns after the swept fields and the outcome; `hit` is the chain that was hit hardest."""

UNCERTAINTIES = {"amplitude": "amplitude_uncertainty", "beat_length": "beat_length_uncertainty"}
"""Column -> the one that holds its uncertainty, in the same unit."""

UNSETTLED = (State.BEATING.value, State.SHORT.value, State.UNSURE.value)
"""States of a case whose chains have not come to share equally, so that its numbers may yet change."""


@dataclass(frozen=True)
class Table:
    """All cases.

    Attributes:
        fields: what is varied in any of them.
        rows: one a case: its name as ``case``, fields, ``outcome``, quantities, ``reason``; None is unknown.
        si: whether the scenes are in SI units; None if some are and some are not.
        scene: name of the scenes; empty if they have several.
        units: of the fields: a symbol, "reduced", or empty for none.
        bands: case -> lowest and highest frequencies at which small waves pass, [[low, high], ...]; where known.
    """

    fields: list[str]
    rows: list[dict[str, Any]]
    si: bool | None
    scene: str = ""
    units: dict[str, str] = field(default_factory=dict)
    bands: dict[str, list[list[float]]] = field(default_factory=dict)

    @property
    def columns(self) -> list[str]:
        """Names of the columns, in order."""
        return ["case", *self.fields, "outcome", *QUANTITIES, "reason"]

    def __repr__(self) -> str:
        return f"<table of {len(self.rows)} cases over {', '.join(self.fields)}>"

    def _repr_html_(self) -> str:
        rows = [["" if row[name] is None else _written(row[name]) for name in self.columns] for row in self.rows]
        return html.table(repr(self)[1:-1], [self.heading(name) for name in self.columns], rows)

    def array(self) -> NDArray[Any]:
        """The table as a structured array: a field per column, text or float64; NaN is unknown."""
        columns: dict[str, NDArray[Any]] = {}
        for name in self.columns:
            if any(isinstance(row[name], str | list | dict) for row in self.rows):
                columns[name] = np.array(["" if row[name] is None else str(row[name]) for row in self.rows])
            else:
                columns[name] = self.numbers(name)
        made = np.zeros(len(self.rows), dtype=[(name, column.dtype) for name, column in columns.items()])
        for name, column in columns.items():
            made[name] = column
        return made

    def pandas(self) -> Any:
        """The table as a ``pandas.DataFrame``, headed with units.

        Raises:
            ImportError: pandas is not installed; `array` needs nothing.
        """
        import pandas as pd

        return pd.DataFrame(self.array()).rename(columns={name: self.heading(name) for name in self.columns})

    def to_csv(self) -> str:
        """One line a case; numbers read back exactly, and what is unknown is empty."""
        return to_csv({self.heading(name): [_written(row[name]) for row in self.rows] for name in self.columns})

    def numbers(self, name: str) -> Floats:
        """A column as numbers; NaN where it holds none."""
        values = (row[name] for row in self.rows)
        return np.array(
            [math.nan if value is None or isinstance(value, str) else float(value) for value in values],
            dtype=np.float64,
        )

    def passed(self, name: str) -> Floats | None:
        """Frequencies at which small waves pass, [band, 2], if a field is one and all cases have the same."""
        if name.rpartition(".")[2] != "frequency":
            return None
        found = [np.array(self.bands.get(row["case"], []), dtype=np.float64) for row in self.rows]
        if not found or any(bands.ndim != 2 or bands.shape != found[0].shape for bands in found):
            return None
        # a load is rounded a little differently in each case
        same = 1e-3 * np.max(np.abs(found[0]), initial=0.0)
        return found[0] if all(np.all(np.abs(bands - found[0]) <= same) for bands in found) else None

    def heading(self, name: str) -> str:
        """The name of a column in the table; with its unit where the scenes are in SI."""
        unit = self._unit(name)
        return name if unit in ("", REDUCED) or (unit in OWN and not self.si) else f"{name} ({unit})"

    def label(self, name: str) -> str:
        """What to write at an axis that shows a column."""
        words = name.replace("_", " ").replace(".", " ") if name in self.fields else QUANTITIES[name].words
        unit = self._unit(name)
        if unit in OWN:
            return f"{words} / ${unit}$"
        return f"{words} ({unit})" if unit else words

    def _unit(self, name: str) -> str:
        """Of a column; empty where it has none, or the scenes do not agree on one."""
        if name in self.fields:
            return self.units.get(name, "")
        unit = "" if name not in QUANTITIES else QUANTITIES[name].unit(si=self.si is True)
        return unit if self.si is not None or unit in OWN else ""


def _written(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return text(value)
    return str(value)
