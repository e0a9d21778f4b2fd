"""Limits of LAMMPS: what it cannot compute, up to which number, and the words that say so, in one table.

A law states its limit where it makes its LAMMPS commands; `lammps_inputs.decks.deck.refusal` makes those of all laws
and loads, and is asked before anything runs. A finished run asks for none: any engine may have computed it.
"""

from dataclasses import dataclass

REFERENCE = "use the reference engine"
"""Engine that has none of these limits."""


class EngineLimitError(ValueError):
    """What LAMMPS cannot compute; the message begins with the part of the scene."""


@dataclass(frozen=True)
class EngineLimit:
    """A limit of LAMMPS.

    Attributes:
        words: what LAMMPS has, with ``{number}`` for what a scene has and ``{bound}`` for the most.
        bound: largest number; None where the limit is no number.
    """

    words: str
    bound: int | None = None

    def error(self, part: str, number: float | str = "") -> EngineLimitError:
        """The refusal of a part of a scene."""
        shown = f"{number:g}" if isinstance(number, float) else number
        return EngineLimitError(f"{part}: {self.words.format(number=shown, bound=self.bound)}; {REFERENCE}")

    def check(self, part: str, number: int) -> None:
        """Refuse a part of a scene that has more than the bound.

        Raises:
            EngineLimitError: it has.
        """
        assert self.bound is not None
        if number > self.bound:
            raise self.error(part, number)


GROUPS = EngineLimit("{number} groups of atoms that differ or are acted on; LAMMPS has {bound} for them", 24)
"""LAMMPS has 32 groups, of which a deck and its continuation use 8 for themselves."""

BENDS = EngineLimit("a profile with {number} bends; LAMMPS takes {bound}", 20)
"""LAMMPS evaluates the formula of a profile for every bead at every step."""

YIELDING_BEADS = EngineLimit("LAMMPS has contacts that yield for at most {bound} beads, {number} given", 4000)
"""A step takes 0.7 to 2 us a bead, a hundred times as long as one of the reference integrator."""

YIELDING_WALLS = EngineLimit("LAMMPS has walls that yield at one place for all chains only")
YIELDING_RINGS = EngineLimit("LAMMPS has contacts that yield in chains with ends only")
RINGS = EngineLimit("LAMMPS has one length for all rings, and the gaps of chains add up to other lengths")
STRENGTHS = EngineLimit(
    "LAMMPS has strengths that differ from contact to contact for the exponents 1 and 1.5, not {number}"
)
EXPONENTS = EngineLimit("LAMMPS has exponents that differ from contact to contact of 1 and 1.5, not {number}")
DASHPOTS = EngineLimit("LAMMPS has dashpots beside contacts that are one pair style, not hybrid")
RESTITUTIONS = EngineLimit("LAMMPS has dashpots of a restitution for contacts of exponent 1, 1.5 and 2, not {number}")
VISCOELASTIC = EngineLimit("LAMMPS's dashpots that grow as overlap^0.5 grow with the beads' masses, too, which differ")
COUPLING_DASHPOTS = EngineLimit("LAMMPS damps every row between each chain and the next, of equal beads, only")
CUBIC_SPRINGS = EngineLimit(
    "LAMMPS's springs have their cube from their length, in which tied chains that are {number} L apart lose digits"
)
FORMULAS = EngineLimit("LAMMPS has one formula for all links of a law")
ENERGY = EngineLimit("no formula of the energy was found, which LAMMPS needs")
REACH = EngineLimit("the energy separates neighbours for good, farther than LAMMPS looks")
EVEN_ENERGY = EngineLimit("LAMMPS's bonds take an energy that is a formula of s^2, smooth at s = 0, and none was found")
FUNCTIONS = EngineLimit("{number}, which its energy needs")
ROWS = EngineLimit(
    "LAMMPS has springs and dashpots between beads that rest side by side, and the gaps of chains differ"
)
FORCES = EngineLimit("LAMMPS has no such force")
