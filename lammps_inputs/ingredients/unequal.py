"""Beads that differ: kinds in a pattern, single ones replaced, tapered and disordered chains, and a striker.

Every bead has a mass, a radius and a plane modulus ``E / (1 - nu**2)``, here in those of the reference bead (the
``material``, or 1). A contact of two is ``A = 2 e_i e_j / (e_i + e_j) * sqrt(2 r_i r_j / (r_i + r_j))`` times as strong
as that of two reference beads (Hertz 1882).
"""

import re
from collections.abc import Sequence
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, model_validator

from lammps_inputs import materials
from lammps_inputs.ingredients import plastic
from lammps_inputs.ingredients.base import (
    Count,
    Positive,
    ScenePart,
    Seed,
    Setting,
    Solids,
    Spread,
    refuse_other_count,
    refuse_outside,
)
from lammps_inputs.numbers import number_or_array, random_shares
from lammps_inputs.units import PURE, Label, Unit

Floats = NDArray[np.float64]
Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]{0,31}$")]

KEYS = ("kinds", "pattern", "replace", "taper", "disorder", "striker")
"""Of the scene, all of them here."""

MOST = 1e6
"""Largest mass and strength, and one over the smallest, in those of the reference bead: beyond it bead and wall."""


MOST_KINDS = 10**6
"""Largest length of a pattern."""


class BeadKind(ScenePart):
    """A bead; what it does not name is the reference bead's."""

    example: ClassVar[str] = "{mass: 0.5}"

    mass: Annotated[Positive, Unit("kg")] | None = None
    """Mass; that of a sphere of this radius and density if omitted."""
    radius: Annotated[Positive, Unit("m")] | None = None
    """Radius; the reference bead's if omitted. Not beside the scene's `mass`."""
    material: materials.Name | None = None
    """Material by name (see `material`), whose constants hold where none are given; with a material only."""
    density: Annotated[Positive, Unit("kg/m3")] | None = None
    """Mass density; with a material only."""
    youngs_modulus: Annotated[Positive, Unit("Pa")] | None = None
    """Young's modulus; with a material only."""
    poisson_ratio: Annotated[float, Field(gt=-1, le=0.5), PURE] | None = None
    """Poisson's ratio; with a material only."""
    yield_strength: materials.YieldStrength | None = None
    """Yield strength, or `catalogue`; with that of a material only, which it has if neither material nor modulus is its
    own.
    """
    stiffness: Annotated[Positive, PURE] | None = None
    """Plane modulus E / (1 - nu^2) relative to the reference bead's; without a material only."""

    @model_validator(mode="before")
    @classmethod
    def _completed(cls, keys: Any) -> Any:
        return materials.completed(keys, "material")

    def refuse(self, key: str, setting: Setting) -> None:
        """Refuse what does not go with the scene's units.

        Raises:
            ValueError: naming the key.
        """
        material = setting.material
        if material is None and setting.scale.si and self.radius is not None:
            raise ValueError(f"{key}.radius: beads given by `mass` have no radius; leave it out, or give a `material`")
        wrong = ("stiffness",) if material is not None else ("material", *materials.CONSTANTS)
        for name in wrong:
            if getattr(self, name) is not None:
                word = "youngs_modulus says it in SI units" if material else "is in SI units; give a `material`, too"
                raise ValueError(f"{key}.{name}: {word}")
        if self.mass is not None and self.density is not None:
            raise ValueError(f"{key}.mass: give either mass or density (both are given)")
        yields = material is not None and material.yield_strength is not None
        if self.yield_strength is not None and not yields:
            raise ValueError(f"{key}.yield_strength: needs `material.yield_strength`, too")
        other = self.material is not None or self.youngs_modulus is not None
        if self.yield_strength is None and yields and other:
            raise ValueError(
                f"{key}.yield_strength: is missing beside material.yield_strength; a number (Pa) or catalogue"
            )

    def relative(self, setting: Setting) -> tuple[float, float, float, float]:
        """Mass, radius, plane modulus and yield strength in those of the reference bead."""
        material, reference_mass = setting.material, setting.scale.mass
        if material is None:
            radius = 1.0 if self.radius is None else self.radius
            mass = radius * radius * radius if self.mass is None else self.mass / reference_mass
            return mass, radius, 1.0 if self.stiffness is None else self.stiffness, 1.0

        def of(name: str) -> float:
            value = getattr(self, name)
            return float(getattr(material, name) if value is None else value)

        radius = of("radius") / material.radius
        mass = radius * radius * radius * (of("density") / material.density)
        if self.mass is not None:
            mass = self.mass / reference_mass
        modulus = of("youngs_modulus") / material.youngs_modulus
        modulus *= (1.0 - material.poisson_ratio**2) / (1.0 - of("poisson_ratio") ** 2)
        yields = 1.0 if material.yield_strength is None else of("yield_strength") / material.yield_strength
        return mass, radius, modulus, yields


class Replacement(ScenePart):
    """One bead that is of another kind."""

    example: ClassVar[str] = "{bead: 40, kind: heavy}"

    chain: Count = 1
    """Chain of the bead."""
    bead: Annotated[Count, Label("replaced bead")]
    """Number of the bead."""
    kind: Name
    """Its kind, one of `kinds`."""


class Disorder(ScenePart):
    """Every bead differs a little: its numbers are spread evenly within these shares of them, up and down."""

    example: ClassVar[str] = "{mass: 0.01}"

    mass: Annotated[Spread, Label("spread of the masses")] = 0.0
    """Largest relative deviation of the mass."""
    radius: Annotated[Spread, Label("spread of the radii")] = 0.0
    """Largest relative deviation of the radius; the mass follows with its cube."""
    stiffness: Annotated[Spread, Label("spread of the contact constants")] = 0.0
    """Largest relative deviation of the plane modulus."""
    seed: Seed = 1
    """Seed of the random numbers; the same beads on any machine."""

    def factors(self, name: str, shape: tuple[int, int]) -> Floats:
        """Random factors on the mass, radius or stiffness of every bead, [chain, bead]."""
        share = random_shares([self.seed, ("mass", "radius", "stiffness").index(name)], shape[0] * shape[1])
        return np.asarray(1.0 + getattr(self, name) * (2.0 * share - 1.0)).reshape(shape)


class Striker(BeadKind):
    """The first bead of a chain, of its own kind, and the velocity with which it strikes the second."""

    example: ClassVar[str] = "{mass: 2, velocity: 1}"

    chain: Count = 1
    """Chain whose bead 1 is the striker."""
    velocity: Annotated[Positive, Unit("m/s")]
    """Initial velocity of the striker."""


def _kinds_in_order(value: Any) -> Any:
    rows = value if isinstance(value, list | tuple) else ()
    single = bool(rows) and all(isinstance(kind, str) for kind in rows)
    several = bool(rows) and all(
        isinstance(row, list | tuple) and row and all(isinstance(kind, str) for kind in row) for row in rows
    )
    if not (single or several):
        raise ValueError("should be a list of kinds, or a list of such lists, one for each chain")
    return _written_out(rows) if single else tuple(_written_out(row) for row in rows)


def _written_out(row: Sequence[str]) -> tuple[str, ...]:
    """Kinds of a row in which ``20*steel`` stands for twenty of a kind.

    Raises:
        ValueError: naming an entry that is neither a kind nor a number of them, or too many kinds.
    """
    kinds: list[str] = []
    for entry in row:
        repeated = re.fullmatch(r"\s*([0-9]{1,9})\s*\*\s*([^\s*]+)\s*", entry)
        count, name = (int(repeated[1]), repeated[2]) if repeated else (1, entry)
        if count < 1 or (repeated is None and "*" in entry):
            raise ValueError(f"{entry!r} should be the name of a kind, or N*name with a whole number N from 1 on")
        if len(kinds) + count > MOST_KINDS:
            raise ValueError(f"{entry!r} makes it {len(kinds) + count} kinds long; at most {MOST_KINDS}")
        kinds += [name] * count
    return tuple(kinds)


def _one_or_several(value: Any) -> Any:
    return tuple(value) if isinstance(value, list | tuple) else (value,)


Kinds = dict[Name, BeadKind]
"""Beads by name, for a pattern and replacements."""

Pattern = Annotated[tuple[Any, ...], BeforeValidator(_kinds_in_order)]
"""Kinds along every chain, over and over, ``N*name`` for N of a kind; or a list of such lists, one for each chain."""

Replacements = Annotated[tuple[Replacement, ...], BeforeValidator(_one_or_several)]

Taper = Annotated[float, Field(ge=0, lt=1), PURE]
"""Share by which each bead's radius is smaller than that of the one before; masses follow as the cube."""


def unlike(setting: Setting) -> bool:
    """Whether the scene says how beads differ."""
    return any(setting.part(key) is not None for key in KEYS)


def masses_and_strengths(setting: Setting) -> tuple[float | Floats, float | Floats]:
    """Masses of the beads, [chain, bead], and strengths of the contacts, [chain, contact], in the reference bead's.

    Numbers where all are the same; only masses that are all 1 are.

    Raises:
        ValueError: naming the key, what was found and what to do.
    """
    factors = {part.strength_key: part.strengths(setting) for _, part in setting.named if part.strength_key}
    mass: float | Floats = 1.0
    strength: float | Floats = 1.0
    if unlike(setting):
        _refuse(setting)
        mass, *_ = _beads(setting)
        size, modulus = sizes_and_moduli(setting)
        strength = np.asarray(modulus * np.sqrt(size))
    for factor in factors.values():
        strength = strength * factor
    for name, values in (("mass", mass), ("contact strength", strength)):
        least, largest = float(np.min(values)), float(np.max(values))
        if not (least >= 1.0 / MOST and largest <= MOST):
            keys = [key for key in KEYS if setting.part(key) is not None]
            key = [*keys, *([] if name == "mass" else factors)][-1]
            raise ValueError(
                f"{key}: the {name} goes from {least:.3g} to {largest:.3g} of the reference bead's; at most a million "
                "times, or one in a million"
            )
    alike = np.all(mass == 1.0) and np.ptp(strength) == 0.0 and np.ptp(setting.gap) == 0.0
    if setting.part("window") is not None and not alike:
        which = "beads" if unlike(setting) else "contacts" if factors else "gaps"
        raise ValueError(f"window: its rows represent one row after another, and the {which} differ; leave it out")
    return (
        1.0 if np.all(mass == 1.0) else mass,
        number_or_array(strength),
    )


def sizes_and_moduli(setting: Setting) -> tuple[float | Floats, float | Floats]:
    """Radius and plane modulus of two equal beads whose contact is as that of two neighbours, [chain, contact]."""
    if not unlike(setting):
        return 1.0, 1.0
    _, radius, modulus, _ = _beads(setting)
    behind, ahead = setting.at_contacts(radius)
    size = 2.0 * behind * ahead / (behind + ahead)
    behind, ahead = setting.at_contacts(modulus)
    return size, 2.0 / (1.0 / behind + 1.0 / ahead)


def with_its_like(setting: Setting, bead: int) -> float | Floats:
    """Strength of the contact of a bead (from 0, or the end) of every chain, [chain], with another like it."""
    if not unlike(setting):
        return 1.0
    _, radius, modulus, _ = _beads(setting)
    return np.asarray(modulus[:, bead] * np.sqrt(radius[:, bead]))


def modulus(setting: Setting, bead: int) -> float | Floats:
    """Plane modulus of a bead (from 0, or the end) of every chain, [chain], in the reference bead's."""
    return _beads(setting)[2][:, bead] if unlike(setting) else 1.0


def softness(setting: Setting, bead: int) -> float | Floats:
    """Yield strength of a bead (from 0, or the end) of every chain, [chain], in the reference bead's."""
    return _beads(setting)[3][:, bead] if unlike(setting) else 1.0


def neighbours(setting: Setting) -> Solids:
    """Neighbouring beads of the chains in contact, [chain, contact]; numbers where all beads are the same."""
    soft = _beads(setting)[3] if unlike(setting) else np.ones((1, 2))
    return Solids(*sizes_and_moduli(setting), number_or_array(np.minimum(*setting.at_contacts(soft))))


def cited(setting: Setting) -> dict[str, list[str]]:
    """Publications of the constants and of the yield strengths of the beads: subject -> keys of `references.bib`."""
    ball, striker = setting.material, setting.part("striker")
    beads = [*(setting.part("kinds") or {}).values(), *([] if striker is None else [striker])]
    named = [(bead.material, bead.yield_strength) for bead in beads]
    named += [] if ball is None else [(ball.name, ball.yield_strength)]
    solids = [(materials.CATALOGUE[name], strength) for name, strength in named if name]
    sources = {"material": list(dict.fromkeys(solid.source for solid, _ in solids))} if solids else {}
    if ball is not None and ball.yield_strength is not None:
        listed = any(strength and strength == solid.yield_strength for solid, strength in solids)
        sources["yield strength"] = [*plastic.SOURCES["thornton"], *([materials.YIELD_SOURCE] if listed else [])]
    return sources


def _refuse(setting: Setting) -> None:
    kinds, pattern, striker = setting.part("kinds") or {}, setting.part("pattern"), setting.part("striker")
    replacements = _replacements(setting)
    for kind_name, kind in kinds.items():
        kind.refuse(f"kinds.{kind_name}", setting)
    if striker is not None:
        striker.refuse("striker", setting)
    if kinds and not pattern and not replacements:
        raise ValueError("kinds: neither pattern nor replace names any of them")
    if pattern and isinstance(pattern[0], tuple):
        refuse_other_count("pattern", pattern, setting.chains, noun="lists")
    used = [("pattern", name) for row in _rows(setting) for name in row]
    used += [(key, change.kind) for key, change in replacements]
    for key, name in used:
        if name not in kinds:
            names = ", ".join(kinds) or "none"
            raise ValueError(f"{key}: {name!r} is not among the kinds ({names})")
    for key, change in replacements:
        refuse_outside(key, change, setting.chains, setting.beads)
    places = [(change.chain, change.bead) for _, change in replacements]
    if striker is not None:
        places.append((striker.chain, 1))
    if len(set(places)) < len(places):
        raise ValueError("replace: one bead is replaced twice (a striker is bead 1 of its chain)")


def _replacements(setting: Setting) -> list[tuple[str, Replacement]]:
    """Replacements, each with its key in messages, which has a number where there is a list of several."""
    changes = setting.part("replace") or ()
    keys = (f"replace[{number}]" for number in range(1, len(changes) + 1)) if len(changes) > 1 else ("replace",)
    return list(zip(keys, changes, strict=False))


def _rows(setting: Setting) -> tuple[tuple[str, ...], ...]:
    """The pattern of each chain; none without."""
    pattern = setting.part("pattern")
    if not pattern:
        return ()
    return pattern if isinstance(pattern[0], tuple) else (pattern,) * setting.chains


def radii(setting: Setting) -> Floats:
    """Radius of each bead, [chain, bead], over that of the reference bead; dimensionless.

    Examples:
        >>> radii(granchain.load("tapered-chain").setting)[0, [0, -1]].round(3)
        array([1.   , 0.681])
    """
    return _beads(setting)[1]


def moduli(setting: Setting) -> Floats:
    """Plane modulus of each bead, [chain, bead], over that of the reference bead."""
    return _beads(setting)[2]


def _beads(setting: Setting) -> tuple[Floats, Floats, Floats, Floats]:
    """Masses, radii, plane moduli and yield strengths, each [chain, bead]."""
    shape = (setting.chains, setting.beads)
    taper, disorder, striker = (setting.part(key) for key in ("taper", "disorder", "striker"))
    numbers = np.ones((4, *shape))
    relative = {name: kind.relative(setting) for name, kind in (setting.part("kinds") or {}).items()}
    for chain, row in enumerate(_rows(setting)):
        for place, name in enumerate(row):
            numbers[:, chain, place :: len(row)] = np.array(relative[name])[:, np.newaxis]
    for _, change in _replacements(setting):
        numbers[:, change.chain - 1, change.bead - 1] = relative[change.kind]
    mass, radius, modulus, yields = numbers
    if taper:
        # factor by factor: a power may be rounded otherwise on another machine
        size = np.cumprod(np.r_[1.0, np.full(setting.beads - 1, 1.0 - taper)])
        radius *= size
        mass *= size * size * size
    if disorder is not None:
        factor = disorder.factors("radius", shape)
        radius *= factor
        mass *= factor * factor * factor * disorder.factors("mass", shape)
        modulus *= disorder.factors("stiffness", shape)
    if striker is not None:
        numbers[:, striker.chain - 1, 0] = striker.relative(setting)
    return mass, radius, modulus, yields
