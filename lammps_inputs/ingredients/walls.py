"""Walls at the ends of the chains: from which the last bead of every chain, or the first, is reflected.

How hard a wall is, over a contact of two of the beads (Hertz 1882; Johnson, Contact Mechanics, 1985, 4.2): 1 for a
bead like the others, fixed; sqrt(2) for the flat face of a block of their material, whose curvature is half as
large; 2 sqrt(2) if that is also rigid. Where beads differ, all of this is about the bead that meets the wall. Of
contacts of other laws only the held bead is known, or a stiffness for a power of the overlap.

An end may have a dashpot between the bead and its place instead, which no contact is beside. Of long waves of small
amplitude it reflects the share (Z - c) / (Z + c) of the velocity, where Z = sqrt(k m) is the impedance of the chain.

Examples:
    >>> walls.STRENGTHS["bead"], round(walls.STRENGTHS["rigid"], 3)
    (1.0, 2.828)
"""

import math
from collections.abc import Mapping
from functools import partial
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import laws, materials
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.base import Ingredient, Positive, ScenePart, Setting, Solids
from lammps_inputs.ingredients.contact import HERTZ
from lammps_inputs.ingredients.unequal import BeadKind as Bead
from lammps_inputs.ingredients.unequal import (
    masses_and_strengths,
    modulus,
    neighbours,
    radii,
    softness,
    unlike,
    with_its_like,
)
from lammps_inputs.laws import Parameter
from lammps_inputs.laws.contact import Hertz
from lammps_inputs.laws.dashpot import Dashpot
from lammps_inputs.links import Links
from lammps_inputs.numbers import number_or_array
from lammps_inputs.units import Label, Unit

STRENGTHS = {"bead": 1.0, "flat": math.sqrt(2.0), "rigid": 2.0 * math.sqrt(2.0)}
"""Force over that of two beads at the same overlap."""

MOST, LEAST = 1e6, 1e-6
"""Force over that of two beads; beyond them a wall is practically rigid, or absent."""

MOST_DAMPING = 1e3
"""Dimensionless coefficient of a dashpot, beyond which a bead stays where it is."""


def _of_exponent(setting: Mapping[str, Any]) -> str:
    """Unit of force over ``overlap**p``."""
    return "N/m^1.5" if setting.get("contact") is None else "N/m^p"


class Face(ScenePart):
    """A wall of any strength, the flat face of a block of a material, or a dashpot in place of a wall."""

    example: ClassVar[str] = "{stiffness: 2.0}"

    stiffness: Annotated[Positive, Unit(_of_exponent)] | None = None
    """Constant A_w of the wall's contact: force over overlap^p."""
    material: materials.Name | None = None
    """Material of a block with a flat face, by name (see `material`); with a material only."""
    damping: Annotated[Positive, Unit("kg/s")] | None = None
    """Coefficient c of a dashpot between the bead at the end and its place, without a wall."""


Kind = Literal["bead", "flat", "rigid", "matched"] | Face

ENDS = (("left", -1.0, 0), ("right", 1.0, -1))
"""Key, side of the place behind the end, and bead there, from 0 or the end."""


class Walls(Ingredient):
    """Walls that all chains have in common; with a gap they stand as far away as beads do."""

    example: ClassVar[str] = "{right: rigid}"
    sources = ("johnson1985",)

    takes_away = frozenset({Fact.MOMENTUM, Fact.FRONT})
    why: ClassVar[dict[Fact, str]] = {
        Fact.FRONT: "a window lets go of the rows that pulses come back through",
        Fact.REVERSIBLE: "suzuki4 has steps backwards in time, in which dashpots would give",
    }

    left: Annotated[Kind | None, Label("left wall")] = None
    """Wall, or dashpot, before the first beads; none if omitted."""
    right: Annotated[Kind | None, Label("right wall")] = None
    """Wall, or dashpot, behind the last beads; none if omitted."""

    def refuse(self, setting: Setting) -> None:
        """Refuse what is no wall."""
        if self.left is None and self.right is None:
            raise ValueError(
                "walls: name left, right or both: bead, flat, rigid, {stiffness: ...}, {material: ...}, matched or "
                "{damping: ...}"
            )
        contact = setting.contact_law(1.0)
        if contact is not None and laws.has_state(contact) and self._faces:
            raise ValueError("walls: are not available with own contacts that depend on the past; leave them out")
        no_power = contact is not None and contact.exponent is None
        for key in ("left", "right"):
            kind = getattr(self, key)
            block = isinstance(kind, Face) and kind.material is not None
            if isinstance(kind, Face) and [kind.stiffness, kind.material, kind.damping].count(None) != 2:
                raise ValueError(f"walls.{key}: give one of stiffness, material and damping")
            if _is_dashpot(kind):
                self._refuse_dashpot(key, setting)
                continue
            if block and setting.material is None:
                raise ValueError(f"walls.{key}.material: is in SI units; give the beads a `material`, too")
            if isinstance(kind, Face) and not block and not LEAST <= (strength := _strength(kind, setting, 0)) <= MOST:
                raise ValueError(
                    f"walls.{key}.stiffness: {strength:.3g} times that of two beads; from {LEAST:g} to {MOST:g} times"
                )
            if kind not in (None, "bead") and no_power:
                raise ValueError(f"walls.{key}: is known for contacts whose force is a power of the overlap; take bead")
            if (block or kind in ("flat", "rigid")) and (exponent := setting.contact_scale[0]) != HERTZ:
                raise ValueError(
                    f"walls.{key}: the contact constant of such a wall is known for spheres, of exponent {HERTZ:g}, "
                    f"not {exponent:g}; take bead or {{stiffness: ...}}"
                )

    def _refuse_dashpot(self, key: str, setting: Setting) -> None:
        """Refuse a dashpot that stops its bead at once, and one of a chain that has no impedance."""
        if getattr(self, key) == "matched":
            for other in ("resonators", "foundation"):
                if setting.part(other) is not None:
                    raise ValueError(
                        f"walls.{key}: matched is sqrt(k m) of beads alone, not with {other}; give {{damping: ...}}"
                    )
            contact = setting.contact_law(1.0)
            if contact is not None and laws.has_state(contact):
                raise ValueError(
                    f"walls.{key}: matched is sqrt(k m), and the stiffness k of these contacts depends on their past; "
                    "give {damping: ...}"
                )
            if not np.all(_end_stiffness(key, setting) > 0.0):
                raise ValueError(
                    f"walls.{key}: matched is sqrt(k m), and contacts that just touch have no stiffness k at rest; "
                    "give `precompression`, a contact that pulls (`tension: allowed`), or {damping: ...}"
                )
        largest = float(np.max(_coefficient(getattr(self, key), key, setting)))
        if largest > MOST_DAMPING:
            raise ValueError(
                f"walls.{key}: {largest:.3g} in dimensionless units; at most {MOST_DAMPING:g}, where the bead sticks"
            )

    @property
    def _faces(self) -> bool:
        """Whether there is a wall with a contact."""
        return any(kind is not None and not _is_dashpot(kind) for kind in (self.left, self.right))

    def lacks(self, setting: Setting) -> frozenset[Fact]:
        """Momentum and the front; energy, and what goes with it, where there is a dashpot."""
        dampers = self.dampers(setting)
        return self.takes_away | ({Fact.ENERGY, Fact.REVERSIBLE} if dampers else set())

    def cited(self) -> tuple[str, ...]:
        """Publications of the walls, and of the materials of blocks."""
        blocks = (kind.material for kind in (self.left, self.right) if isinstance(kind, Face))
        return (
            *(self.sources if self._faces else ()),
            *dict.fromkeys(materials.CATALOGUE[name].source for name in blocks if name),
        )

    def links(self, setting: Setting) -> tuple[Links, ...]:
        """Links of the beads at the ends with each wall."""
        walls = []
        for key, side, last in ENDS:
            kind = getattr(self, key)
            if kind is not None and not _is_dashpot(kind):
                strength = _of_chains(_strength(kind, setting, last))
                law = setting.law_between(strength, partial(_solids, kind, setting, last)) or Hertz(strength)
                gap = setting.gap_of_walls / setting.scale.length
                walls.append(Links.wall(f"{key}_wall", law, side, gap, curved=kind == "bead"))
        return tuple(walls)

    def dampers(self, setting: Setting) -> tuple[Links, ...]:
        """Dashpots of the beads at the ends with their places."""
        dashpots = []
        for key, _, last in ENDS:
            if _is_dashpot(kind := getattr(self, key)):
                coefficient = np.zeros((setting.chains, setting.beads))
                coefficient[:, last] = _coefficient(kind, key, setting)
                dashpots.append(Links.ground(f"{key}_end", Dashpot(coefficient)))
        return tuple(dashpots)


def _is_dashpot(kind: Any) -> bool:
    """Whether an end has a dashpot in place of a wall."""
    return kind == "matched" or (isinstance(kind, Face) and kind.damping is not None)


def _coefficient(kind: Any, key: str, setting: Setting) -> Any:
    """Dimensionless coefficient of the dashpot at an end, a number or [chain]."""
    if isinstance(kind, Face):
        return laws.dimensionless(Dashpot(kind.damping), setting.scale).coefficient
    mass = masses_and_strengths(setting)[0]
    return np.sqrt(_end_stiffness(key, setting) * (mass if isinstance(mass, float) else mass[:, _bead(key)]))


def _bead(key: str) -> int:
    return next(last for name, _, last in ENDS if name == key)


def _end_stiffness(key: str, setting: Setting) -> NDArray[np.float64]:
    """Stiffness at rest of the contact next to an end, [chain], dimensionless; 0 across a gap."""
    mass, strength = masses_and_strengths(setting)
    law = setting.law_between(strength, partial(neighbours, setting)) or Hertz(strength)
    zero = np.zeros(setting.contacts)
    static = sum((np.asarray(part.static(setting, mass)) for _, part in setting.named), np.float64(0.0))
    force = np.broadcast_to(static, (setting.chains, setting.beads + 1))[:, 1:-1]
    rest = law.overlap_under(force) if np.any(force) and law.overlap_under is not None else zero
    if law.exponent is not None and np.all(law.exponent == 1.0):
        rest = np.maximum(rest, 1.0)  # of the same stiffness at any overlap, also where contacts just touch
    stiffness = np.broadcast_to(laws.stiffness(law, rest), setting.contacts)[:, _bead(key)]
    return np.where(np.broadcast_to(setting.gap, setting.contacts)[:, _bead(key)] > 0.0, 0.0, stiffness)


def _of_chains(values: Any) -> Parameter:
    """A number, or [chain, 1] where values of chains differ."""
    return number_or_array(np.reshape(values, (-1, 1)))


def _solids(kind: Kind, setting: Setting, bead: int) -> Solids:
    """A wall and a bead (from 0, or the end) of each chain in contact, numbers or [chain, 1]."""
    plane_modulus = np.asarray(modulus(setting, bead))
    radius = (2.0 if kind != "bead" else 1.0) * (radii(setting)[:, bead] if unlike(setting) else np.ones(1))
    if kind == "rigid":
        plane_modulus = 2.0 * plane_modulus
    elif isinstance(kind, Face) and kind.material is not None:
        block = Bead(material=kind.material).relative(setting)[2]
        plane_modulus = plane_modulus * (2.0 * block / (block + plane_modulus))
    return Solids(*map(_of_chains, (radius, plane_modulus, softness(setting, bead))))


def _strength(kind: Kind, setting: Setting, bead: int) -> float | NDArray[np.float64]:
    """Dimensionless strength of a wall beside a bead (from 0, or the end), [chain] where the beads there differ."""
    if not isinstance(kind, Face):
        return STRENGTHS[kind] * with_its_like(setting, bead)
    if kind.stiffness is not None:
        return kind.stiffness / float(setting.scale.force / setting.scale.length ** setting.contact_scale[0])
    block, bead_modulus = Bead(material=kind.material).relative(setting)[2], modulus(setting, bead)
    return STRENGTHS["rigid"] * block / (block + bead_modulus) * with_its_like(setting, bead)
