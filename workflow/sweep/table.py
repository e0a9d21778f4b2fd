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
from lammps_inputs.units import REDUCED
from workflow.runs.files import RECORD
from workflow.verdicts.quantities import OWN, collect_columns

QUANTITIES = collect_columns()
"""Columns after the swept fields and the outcome."""

UNCERTAINTIES = {name.removesuffix("_uncertainty"): name for name in QUANTITIES if name.endswith("_uncertainty")}
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
        own = [name for name, found in QUANTITIES.items() if found.file != RECORD]
        names = [*self.fields, "outcome", *own, "reason"]
        names = [name for name in names if any(row[name] not in (None, "") for row in self.rows)]
        rows = [[row[name] for name in names] for row in self.rows]
        return html.table(repr(self)[1:-1], [self.heading(name) for name in names], rows)

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
        words = name.replace("_", " ").replace(".", " ") if name in self.fields else QUANTITIES[name].label
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
