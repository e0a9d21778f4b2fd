"""In which units a page shows a run: those of its figures, so that axes need no powers of ten."""

import numpy as np

from analysis.figures.spacetime import largest_afar
from analysis.figures.style import Unit, axis_unit
from lammps_inputs import Problem
from workflow.view.thin import Thinned

Units = dict[str, Unit]


def units_of(problem: Problem, part: Thinned) -> Units:
    """Units of time, velocity, length, force and energy; reduced ones as they are, without a symbol.

    Args:
        problem: what was run.
        part: of its frames, dimensionless.
    """
    largest = {
        "time": float(part.time[-1]),
        "velocity": largest_afar(problem, part.beads, part.velocity),
        "length": _size(part.displacement),
        "force": _size(part.force),
        "energy": _size(part.energy),
    }
    if not problem.scale.si:
        return {name: Unit(float(getattr(problem.scale, name)), "") for name in largest}
    return {name: axis_unit(problem, name, size) for name, size in largest.items()}


def axis_label(name: str, unit: Unit) -> str:
    """Such as ``time (ms)``; the name alone in reduced units."""
    return f"{name} ({unit.symbol})" if unit.symbol else name


def behind(unit: Unit) -> str:
    """What stands behind a number: ``" ms"``, or nothing."""
    return f" {unit.symbol}" if unit.symbol else ""


def _size(values: np.ndarray) -> float:
    return float(np.nanmax(np.abs(values), initial=0.0))
