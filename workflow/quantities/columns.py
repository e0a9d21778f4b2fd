"""Quantities by name, as the table of a sweep, studies and derivatives call them: words, units, and where they stand.

A quantity joins by its declaration (`analysis.quantity`) with a column. That of a column of ``waves.csv`` is a quantity
at a bead: of the kicked chain's leading wave at the last clear bead, and with ``@100`` behind its name at bead 100.

Plug-ins take this module for names that users give: `refuse_unknown` refuses what is no quantity, `column_called` has
the label and unit of one, `KNOWN` are those that `evaluate` computes in memory.

Examples:
    >>> column = columns.column_called("peak_velocity@100")
    >>> column.label, column.unit(si=True)
    ('peak velocity at bead 100', 'm/s')
    >>> columns.refuse_unknown("peak_velocty", "--quantity", "quantity")
    Traceback (most recent call last):
        ...
    lammps_inputs.errors.InputError: --quantity: 'peak_velocty' is no quantity (did you mean `peak_velocity`?)
"""

from dataclasses import replace
from typing import Any

from analysis.quantity import QuantityColumn
from lammps_inputs import InputError, complaints
from workflow.measures.registry import MEASUREMENTS
from workflow.verdicts.analysis_report import REPORT, WAVES
from workflow.verdicts.places import CollectColumn, collect_columns

QUANTITIES = collect_columns()
"""Columns of the table of a sweep after the swept fields and the outcome."""

UNCERTAINTIES = {name.removesuffix("_uncertainty"): name for name in QUANTITIES if name.endswith("_uncertainty")}
"""Column -> the one that holds its uncertainty, in the same unit."""

AT_BEAD = tuple(
    name
    for name, column in QUANTITIES.items()
    if (column.path[0] == "kicked" and name != "bead") or column.file == WAVES
)
"""Quantities of the kicked chain's leading wave; ``peak_velocity@100`` is that at bead 100."""

MASS = "mass"
"""Of all beads, in the scene's units: known before anything runs."""

MEASURED = {kind.key: kind for kind in MEASUREMENTS}
"""Key of a measurement that only some runs have -> its type."""

AT_THE_END = tuple(
    name for name, column in QUANTITIES.items() if column.path[0] in MEASURED and MEASURED[column.path[0]].at_the_end
)
"""Quantities for which a run that ends at a bead goes on until the pulse has come to the end of the chains."""

KNOWN = (
    MASS,
    *AT_THE_END,
    *(
        name
        for name, column in QUANTITIES.items()
        if column.file in (REPORT, WAVES)
        and column.label
        and name not in AT_THE_END
        and (column.path[0] not in MEASURED or MEASURED[column.path[0]].of_frames())
    ),
)
"""Quantities of a scene that is run in memory: numbers that follow from its frames."""


def at_bead(name: str) -> tuple[str, int]:
    """Quantity and bead of ``peak_velocity@100``; empty without a bead, and 0 where that is no number."""
    base, at, bead = name.partition("@")
    plain = bead.isascii() and bead.isdecimal() and len(bead) < 10
    return (base, int(bead) if plain else 0) if at and base in AT_BEAD else ("", 0)


def column_called(name: str) -> CollectColumn | None:
    """What a column holds, also one such as ``peak_velocity@100``; None for any other name."""
    base, bead = at_bead(name)
    if not bead:
        return QUANTITIES.get(name)
    column = QUANTITIES[base]
    words = column.label.replace("the last clear bead", f"bead {bead}")
    return replace(column, column=QuantityColumn(name, words, column.column.key, column.column.symbol))


def refuse_unknown(name: str, where: str, kind: str) -> None:
    """See that a quantity is one of `KNOWN`, or one of `AT_BEAD` at a bead.

    Args:
        name: name of the quantity, as the user wrote it.
        where: file and key, or option, for the message.
        kind: what it should be, such as "quantity".

    Raises:
        InputError: it is not; says where it was given and what it is not.
    """
    base, bead = at_bead(name)
    if base in AT_BEAD and not bead:
        raise InputError(f"{where}: {name[:60]!r} should end in the number of a bead, such as {base}@100")
    if not base and name not in KNOWN:
        hint = complaints.suggestion(name, KNOWN) or f"; known are {', '.join(KNOWN)}"
        raise InputError(f"{where}: {name[:60]!r} is no {kind}{hint}")


def kicked_chain(scene: dict[str, Any]) -> Any:
    """Number of the chain with the largest excitation, from 1, of plain data of a scene."""
    kicks = [scene.get(key) for key in ("kick", "push", "striker")]
    each = [kick for kick in kicks for kick in (kick if isinstance(kick, list | tuple) else [kick])]
    return max((kick for kick in each if isinstance(kick, dict)), key=_size, default={}).get("chain", 1)


def _size(kick: dict[str, Any]) -> float:
    velocity = kick.get("velocity", kick.get("peak"))
    return abs(velocity) if isinstance(velocity, int | float) else 0.0
