"""Headings and labels of what a table or an axis shows: fields of a scene, and its quantities.

Plug-ins take this module for tables and figures over fields or quantities by name: `heading` for a table, `label` for
an axis or a page.

Examples:
    >>> scene = granchain.load("two-chains-steel").plain()
    >>> axes.heading("coupling.stiffness", scene), axes.heading("peak_velocity@50", scene)
    ('coupling.stiffness (N/m)', 'peak_velocity@50 (m/s)')
    >>> axes.label("kick.velocity", scene).plain
    'kick velocity (m/s)'
"""

from typing import Any

from analysis.quantity import Quantity, QuantityColumn
from lammps_inputs.units import REDUCED, Label, in_si
from workflow.quantities.columns import MASS, column_called
from workflow.sweep import fields
from workflow.verdicts.places import CollectColumn, QuantityPlace

_MASS = CollectColumn(
    QuantityPlace("", (MASS,), Quantity("mass of all beads", "mass")), QuantityColumn(MASS, "mass of all beads")
)


def _column(name: str) -> CollectColumn | None:
    return _MASS if name == MASS else column_called(name)


def heading(name: str, scene: dict[str, Any]) -> str:
    """Name of a field or quantity, with its unit if it has one.

    Args:
        name: dotted path of a field, or name of a quantity.
        scene: plain data of the scene.

    Returns:
        The heading.

    Raises:
        InputError: there is no such field or quantity.
    """
    column = _column(name)
    unit = fields.unit(fields.parse(name, scene), scene) if column is None else column.unit(si=in_si(scene))
    return name if unit in ("", REDUCED) else f"{name} ({unit})"


def label(name: str, scene: dict[str, Any]) -> Label:
    """Words, symbol and unit of a field or quantity, for a figure or page.

    Args:
        name: dotted path of a field, or name of a quantity.
        scene: plain data of the scene.

    Returns:
        The label.

    Raises:
        InputError: there is no such field or quantity.
    """
    column = _column(name)
    return fields.label(fields.parse(name, scene), scene) if column is None else column.axis(si=in_si(scene))
