"""Laws that LAMMPS computes from a formula: an energy (along chains, between them) or a force (to the ground).

``s`` in a formula is the strain, names of a law's parameters are these, each one number. `along`, `across` and
`ground` make methods of a law: ``along = formula.along("strength*(0.4*s^2.5+b*s^3.5/3.5)")``.

Examples:
    >>> class Quintic(laws.Law):
    ...     quintic: float
    ...     ground = formula.ground("quintic*s^5")
    >>> for line in Quintic(0.1).ground("bed", granchain.load("one-chain").problem().layout).motion:
    ...     print(line)
    variable bedstrain atom x-((id-1)%120+1)*4
    variable bed atom -(0.1*v_bedstrain^5)
    fix bed all addforce v_bed 0.0 0.0
"""

import re
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import engine_limits
from lammps_inputs.deck_lines import BeadLayout, DeckLines, LinksAcross, whole_contacts
from lammps_inputs.numbers import text

SINCE = (
    'if "$(version) < 20230615" then "print \'contacts of any exponent need LAMMPS of 15Jun2023 or later\'" "quit 1"'
)
"""Earlier releases of LAMMPS have no contacts from a formula of beads' radii."""


def along(energy: str) -> Callable[[Any, str, BeadLayout], DeckLines]:
    """Method of contacts that act while beads overlap, from their energy."""

    def spell(law: Any, name: str, layout: BeadLayout) -> DeckLines:
        return contacts(
            _filled(law, name, energy, f"({text(layout.diameter)}-r)"), "= minus the derivative of an energy", layout
        )

    return spell


def contacts(energy: str, says: str, layout: BeadLayout) -> DeckLines:
    """Contacts whose energy is a formula of the distance ``r``."""
    diameter = text(layout.diameter)
    return DeckLines(
        variables=(SINCE,),
        interactions=(
            f"# contacts: force {says}; no friction, no loss",
            f"pair_style lepton/sphere {diameter}",
            f'pair_coeff * * "{energy}"',
            *beads_alone(layout),
        ),
    )


def beads_alone(layout: BeadLayout) -> tuple[str, ...]:
    """Lines by which atoms that are no beads have no pair force: a formula of the distance knows no diameters."""
    if not layout.others:
        return ()
    return ("group inner subtract all beads", f"neigh_modify exclude group inner all   # {layout.others} touch nothing")


def across(energy: str) -> Callable[[Any, LinksAcross, BeadLayout], DeckLines]:
    """Method of springs between chains, from their energy; it must be even: a formula of ``q``, the strain squared."""

    def spell(law: Any, link: LinksAcross, layout: BeadLayout) -> DeckLines:
        squares, bonds = squares_of_strain(link, layout)
        return DeckLines(
            bonds=bonds,
            style="lepton",
            coefficients=tuple(f'0 "{_filled(law, link.name, energy, square, "q")}"' for square in squares),
            interactions=("# springs between chains, from their energy", *whole_contacts(link)),
        )

    return spell


def squares_of_strain(link: LinksAcross, layout: BeadLayout) -> tuple[list[str], NDArray[np.int64]]:
    """The strain squared of bonds of each length, in LAMMPS's words, and their types from 1, [edge, row]."""
    kinds, bonds = np.unique([layout.apart(edge) for edge in link.edges], return_inverse=True)
    squares = [f"(r^2-{text(distance * distance)})" for distance in kinds.tolist()]
    return squares, np.broadcast_to(bonds.reshape(-1, 1) + 1, (len(link.edges), layout.beads))


def ground(force: str) -> Callable[[Any, str, BeadLayout], DeckLines]:
    """Method of springs to the ground, from the force that drives beads back."""

    def spell(law: Any, name: str, layout: BeadLayout) -> DeckLines:
        return DeckLines(
            motion=(
                f"variable {name}strain atom x-{layout.place_formula}",
                f"variable {name} atom -({_filled(law, name, force, f'v_{name}strain')})",
                f"fix {name} {layout.group} addforce v_{name} 0.0 0.0",
            )
        )

    return spell


def _filled(law: Any, name: str, formula: str, strain: str, variable: str = "s") -> str:
    """A formula with numbers and the strain in place of their names.

    Raises:
        EngineLimitError: a parameter that differs from link to link.
    """
    if any(np.ndim(value) for value in law):
        raise engine_limits.FORMULAS.error(name)
    numbers = {key: text(float(value)) for key, value in law.by_name.items()}
    return re.sub(r"[A-Za-z_]\w*", lambda word: ({variable: strain} | numbers).get(word[0], word[0]), formula)
