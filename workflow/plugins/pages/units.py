"""Units of the numbers on a page: with the prefixes of the run's figures, so that axes need no powers of ten."""

from granchain.parts import Problem, panels, units

Units = dict[str, panels.AxisUnit]


def page_unit(problem: Problem, kind: str, largest: float) -> panels.AxisUnit:
    """Unit of a quantity; reduced units as they are.

    Args:
        problem: what was run.
        kind: of the quantity, such as ``time`` (a key of `lammps_inputs.units.SI`).
        largest: size of the largest number, dimensionless.
    """
    if problem.scale.si:
        return panels.axis_unit(problem, kind, largest)
    return panels.AxisUnit(float(problem.scale.measured(1.0, kind)), units.REDUCED)


def axis_of(name: str, page_units: Units) -> panels.Axis:
    """Axis of a quantity of `panels.FrameContent` in its unit of the page, such as ``time t (ms)``."""
    return page_units[name].axis(panels.FrameContent, name)
