"""Where LAMMPS has the beads of a system: their diameter, and their places at rest.

The dynamics do not depend on any of it.
"""

import numpy as np

from lammps_inputs import engine_limits, laws, physics
from lammps_inputs.deck_lines import BeadLayout, LinksAcross, WallLinks
from lammps_inputs.links import Links
from lammps_inputs.numbers import power_of_two_at_least
from lammps_inputs.system import System


@physics.once
def layout_of(system: System) -> BeadLayout:
    """Layout of all rows of a system."""
    return BeadLayout(
        chains=system.chains,
        beads=system.beads,
        rows=system.beads,
        gap=physics.gap(system),
        diameter=_diameter(system),
        closer=system.along[0].law.rest if physics.one_gap(system) else physics.gap(system) - system.along[0].gap,
        even=physics.even(system),
        farthest=physics.farthest(system),
        others=system.others,
        alike=physics.one_kind(system),
        lightest=float(np.min(system.mass)),
        heaviest=float(np.max(system.mass)),
        contact_loss=physics.contact_loss(system),
        walls=tuple(wall_of(wall, system) for wall in system.walls),
        closed=bool(system.closing),
        velocity_at_full_steps=physics.velocity_at_full_steps(system),
    )


def ends_of_box(system: System) -> tuple[float, float]:
    """Ends of LAMMPS's periodic box, whose length is that of rings, in units of L.

    Raises:
        EngineLimitError: chains of other lengths.
    """
    [closing], layout = system.closing, layout_of(system)
    apart = layout.diameter + np.broadcast_to(closing.gap, (system.chains, 1))[:, 0]
    first, last = layout.places[:, 0], layout.places[:, -1]
    length = last - first + apart
    if np.ptp(length) > _EQUAL * np.max(length):
        raise engine_limits.RINGS.error("gap")
    low = float(first[0] - 0.5 * apart[0])
    return low, low + float(length[0])


_EQUAL = 1e-13
"""Relative difference of lengths that is rounding."""


def wall_of(wall: Links, system: System) -> WallLinks:
    """A wall of a system with its dashpot, for the deck."""
    return WallLinks(wall.name, wall.law, wall.side, float(wall.gap), physics.loss_beside(system, wall))


def across_of(link: Links, system: System) -> LinksAcross:
    """Links across the lines of a system, for the deck."""
    return LinksAcross(
        link.name,
        link.edges,
        open_row=link.open_row,
        tie=system.is_tie(link),
        alone=(link,) in (system.couplings, system.ties),
        number=next((number for number, damper in enumerate(system.dampers, 1) if damper is link), 0),
    )


def _diameter(system: System) -> float:
    """Bead diameter: a power of two, so that touching is exact, and never small enough for second neighbours to meet or
    for one overlap to reach half of it.
    """
    total, farthest = physics.energy(system), physics.farthest(system)
    rest = float(np.max(system.along[0].law.rest))
    alone, shared = (
        rest + max(laws.max_strain(link.law, energy) for link in system.contacts) for energy in (total, total / 2.0)
    )
    held = (link.law for link in system.walls)
    walls = (2.0 * float(np.max(law.rest + law.max_strain(total, *law))) for law in held)
    # dashpots between chains act by the distance of two beads
    damped = any(link.kind == "across" and not system.is_tie(link) for link in system.dampers)
    rows = (rest + 2.0 * laws.max_strain(link.law, total) for link in system.couplings if damped)
    # a bead that starts outside a periodic box would be moved to its other end
    inside = [4.0 * float(np.max(np.abs(system.start.displacement)))] if system.closing and system.start else []
    least = max(4.0, 2.0 * alone, 2.0 * shared, *walls, *rows, *inside)
    return power_of_two_at_least(max(2.0 * least, 4.0 * farthest) if 0.0 < farthest < np.inf else least)
