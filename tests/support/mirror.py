"""The mirror image of a problem, in which bead 1 is the last one: the equations of motion do not change."""

from dataclasses import replace
from typing import Any

from lammps_inputs import Problem, laws, physics
from lammps_inputs.links import FIRST, LAST

BACK = slice(None, None, -1)

FORCES = {"peak", "amplitude", "value", "slope", "gained", "gone"}
"""Parameters of laws in time that are proportional to the force or motion."""


def opposite(law: Any) -> Any:
    """The law in time of the opposite force or motion."""
    return replace(law, **{name: -getattr(law, name) for name in FORCES & set(law.names)})


def falling_back(law: Any) -> Any:
    """Weights in the opposite direction; any other law as it is."""
    return replace(law, acceleration=-law.acceleration) if law.constant else law


def mirrored_problem(problem: Problem) -> Problem:
    """The problem in which every bead has the number of its mirror image, and moves the other way."""
    system = problem.system

    def turned(links: Any) -> Any:
        def end(beads: Any) -> Any:
            return next((other for this, other in ((FIRST, LAST), (LAST, FIRST)) if beads == this), beads)

        swapped = ({"first": end(x.second), "second": end(x.first)} if x.kind == "wall" else {} for x in links)
        values = ({"law": falling_back(laws.at(x.law, Ellipsis, BACK)), "gap": x.gap_at(Ellipsis, BACK)} for x in links)
        return tuple(replace(x, **of_links, **ends) for x, of_links, ends in zip(links, values, swapped, strict=True))

    def at_other_bead(parts: Any, **changed: Any) -> Any:
        there = ({name: change(getattr(part, name)) for name, change in changed.items()} for part in parts)
        return tuple(
            replace(part, bead=system.beads + 1 - part.bead, **new) for part, new in zip(parts, there, strict=True)
        )

    start = system.start
    image = replace(
        system,
        start=start and replace(start, displacement=-start.displacement[:, BACK], velocity=-start.velocity[:, BACK]),
        kicks=tuple((chain, system.beads + 1 - bead, -velocity) for chain, bead, velocity in system.kicks),
        links=turned(system.links),
        dampers=turned(system.dampers),
        mass=physics.mass_of(system, Ellipsis, BACK),
        further_lines=tuple(line.on(BACK) for line in system.further_lines),
        loads=at_other_bead(system.loads, law=opposite),
        motions=at_other_bead(system.motions, laws=lambda parts: tuple(map(opposite, parts))),
    )
    listed = problem.rows.listed
    rows = problem.rows if listed is None else problem.rows.only(system.beads + 1 - bead for bead in listed[::-1])
    return replace(problem, system=image, rows=rows)
