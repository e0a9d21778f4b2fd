"""Contacts of a force that the scene gives as a formula, which may act at a distance, such as between magnets."""

from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import ConfigDict

from lammps_inputs import laws
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.base import Setting
from lammps_inputs.ingredients.by_formula import ByFormula, formulas
from lammps_inputs.ingredients.contact import Contact, Strength, lacking, of_power
from lammps_inputs.laws import Law, Parameter
from lammps_inputs.system import System


class FormulaContact(Contact, ByFormula):
    """Any force that grows as beads come closer, a formula of s with its parameters as keys beside it."""

    model_config = ConfigDict(json_schema_extra=None)

    example: ClassVar[str] = '{force: "A*s^p", A: 2, p: 1.3}'
    sources = ("moleron2014",)

    key: ClassVar[str] = "force"
    noun: ClassVar[str] = "contacts of a force by formula"

    strength: Strength = None
    force: str
    """Force as a formula of s, with its parameters as keys beside it; what s is stands in the scene reference, *Force
    by formula*.
    """
    tension: Literal["allowed", "cut"] | None = None
    """Whether `force` acts at a distance: if omitted, `cut` of forces that are 0 at s = 0, and `allowed` of others."""

    @classmethod
    def is_named(cls, keys: dict[str, Any]) -> bool:
        """Whether there is a formula, or what belongs to it."""
        return any(keys.get(key) is not None for key in ("force", "tension"))

    @classmethod
    def names_with_meaning(cls) -> frozenset[str]:
        """Keys of all laws of contacts."""
        return frozenset(name for law in Contact.laws() for name in law.model_fields)

    def refuse(self, setting: Setting) -> None:
        """Refuse forces at rest that nothing holds, and what pulls beads at rest."""
        force, cut, rest = self.formula, self._cut, self.formula.at_rest
        if cut and rest:
            raise ValueError(f"contact.tension: the force is {rest:.6g} at s = 0, where it would be cut; leave it out")
        damping = setting.part("damping")
        if not cut and damping is not None and damping.contact:
            raise ValueError(
                "damping.contact: is that of contacts that touch, and contact.force acts at a distance; take "
                "damping.beads, or leave it out"
            )
        if rest:
            self._refuse_rest(force.at_rest, setting)
        elif not cut and np.any(setting.gap):
            raise ValueError(
                "gap: contact.force acts at a distance, so that beads a gap apart pull each other at rest; leave "
                "the gap or contact.tension out"
            )
        super().refuse(setting)

    def _refuse_rest(self, rest: float, setting: Setting) -> None:
        """Refuse a force at rest that nothing holds, and other loads beside it."""
        walls = setting.part("walls")
        if walls is None or len(walls.links(setting)) < 2:
            raise ValueError(
                f"contact.force: pushes neighbours apart with {rest:.6g} at rest, and nothing holds the beads at "
                "the ends; give `walls: {left: bead, right: bead}`"
            )
        loads = [key for key in ("gap", "precompression", "gravity") if setting.part(key)]
        loads += ["contact.strength"] * (self.strength is not None)
        if loads:
            raise ValueError(
                f"{loads[0]}: contact.force is {rest:.6g} at s = 0, the force of every contact at rest; leave one "
                "of them out"
            )

    def refuse_system(self, setting: Setting, system: System) -> None:
        """Refuse formulas where they have no value, and what is known of spheres only."""
        for link in system.along:
            if link.law.source is not None:
                formulas().refuse_reach("contact", link.law, system, setting.scale.length, pressed=True)
        super().refuse_system(setting, system)

    def contact_law(self, strength: Parameter) -> Law | None:
        """Law of the contacts; of a formula that is equivalent to a power, that of the power."""
        exponent, _, is_power = self._begins
        if is_power:
            return of_power(strength, exponent)
        law: laws.Law = self.formula.law(formulas().AlongChains, self._kind, strength)
        return law

    def contact_scale(self) -> tuple[float, float | None]:
        """Exponent and constant of small overlaps."""
        return self._begins[:2]

    def cited(self) -> tuple[str, ...]:
        """Publications of strengths that differ, and of magnets, where the force acts at a distance."""
        cited = super().cited()
        return tuple(key for key in cited if key not in self.sources) if self._cut else cited

    def lacks(self, setting: Setting) -> frozenset[Fact]:  # noqa: ARG002
        """Facts that do not hold of small overlaps; what acts at a distance transmits sound."""
        acts_at_a_distance = frozenset({Fact.SONIC_VACUUM, Fact.FRONT, Fact.PULSE})
        return lacking(self._begins[0]) if self._cut else acts_at_a_distance

    @property
    def _kind(self) -> Any:
        """How the formula counts s, and whether it is cut where beads are apart."""
        return formulas().kind_of_contact(self.formula, self.tension)

    @property
    def _begins(self) -> tuple[float, float, bool]:
        """Exponent p and constant A of the force ``A overlap^p`` of small overlaps, and whether it is that of all."""
        begins: tuple[float, float, bool] = formulas().power_of_contact(self.formula, self._kind)
        return begins

    @property
    def _cut(self) -> bool:
        """Whether there is no force where beads are apart."""
        return bool(self._kind.cut)
