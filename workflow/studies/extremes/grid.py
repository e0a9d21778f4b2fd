"""The grid: all cells, in parts."""

from collections.abc import Callable, Sequence

from workflow.studies.extremes.cells import Cell
from workflow.studies.extremes.ingredients import drives, exponents, loads, losses, masses
from workflow.studies.extremes.numbers import corners, numbers

PARTS: dict[str, Callable[[], list[Cell]]] = {
    "numbers": numbers,
    "loads": loads,
    "losses": losses,
    "masses": masses,
    "exponents": exponents,
    "drives": drives,
    "corners": corners,
}


def grid(parts: Sequence[str] = ()) -> list[Cell]:
    """Cells of these parts, or of all, axis by axis."""
    return [cell for name, cells in PARTS.items() if not parts or name in parts for cell in cells()]
