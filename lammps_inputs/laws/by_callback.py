"""How LAMMPS has contacts that yield of more beads than stock commands are worth while for: forces by `fix external`.

They are computed by a function of the process that hosts LAMMPS (`workflow.engines.lammps.yielding`), on one rank. The
memories are numbers of every bead (`fix property/atom`), so they are in frames and restarts.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import laws
from lammps_inputs.deck_lines import Lines
from lammps_inputs.laws.wall import faces
from lammps_inputs.numbers import text

if TYPE_CHECKING:
    from lammps_inputs.laws.plastic import Thornton
    from lammps_inputs.layout import Layout
    from lammps_inputs.system import System

MOST_STOCK = 4000
"""Beads up to which stock commands are worth while: a step takes 0.7 to 2 us a bead, fifty times elastic ones'."""

FIX = "contacts"

EXTERNAL = f"fix {FIX} all external pf/callback 1 1   # forces of contacts: computed by granchain run, on one rank"
"""The line after which the host gives LAMMPS its function."""

MEMORY, AHEAD = "d_memory", "d_memory_ahead"
"""Largest overlap of the contact behind each bead, and of that between the last bead and a wall."""


def needed(system: "System") -> bool:
    """Whether the forces of a system's contacts in LAMMPS are those of a function of its host."""
    return system.chains * system.beads > MOST_STOCK and any(laws.remembers(link.law) for link in system.links)


def refusal(system: "System", ranks: int | None = None) -> str:
    """Why a deck runs neither in another program nor on several ranks; empty where it does, or it is on one rank."""
    if ranks == 1 or not needed(system):
        return ""
    return (
        f"contacts that yield of more than {MOST_STOCK} beads: their forces are computed by `granchain run`, on one "
        "rank; use that or the reference engine"
    )


def lines(layout: "Layout") -> Lines:
    """Contacts along chains, and with walls, whose forces the host computes."""
    return Lines(
        interactions=(
            "# contacts: no forces of LAMMPS's own; see fix contacts",
            f"pair_style zero {text(layout.diameter)} nocoeff",
            "pair_coeff * *",
        ),
        motion=(
            f"fix memory all property/atom {MEMORY} {AHEAD}",
            f"variable memory atom {MEMORY}",
            f"variable memory_ahead atom {AHEAD}",
            EXTERNAL,
        ),
    )


def table(layout: "Layout") -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """[strength or onset, chain, contact], where the first and the last contacts are with walls; a strength of 0 where
    there is no contact. And [chain, side] the places at which the first bead and the last touch walls.
    """
    system = layout.system
    law: Thornton = system.along[0].law  # type: ignore[assignment]
    found = np.zeros((2, layout.chains, layout.beads + 1))
    found[1] = 1.0
    for row, value in zip(found, (law.strength, law.onset), strict=True):
        row[:, 1:-1] = value
    touched = np.zeros((layout.chains, 2))
    walls: list[Any] = [link for link in system.ground if laws.remembers(link.law)]
    for wall in walls:
        end = -1 if wall.side > 0.0 else 0
        for row, value in zip(found, (wall.law.strength, wall.law.onset), strict=True):
            row[:, end] = np.broadcast_to(value, (layout.chains, layout.beads))[:, end]
        touched[:, end] = [face - wall.side * layout.diameter / 2.0 for _, face in faces(wall, layout)]
    return found, touched
