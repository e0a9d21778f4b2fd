"""Damping: of contacts, of beads against what surrounds them, and of the springs between chains.

What it does to weakly damped pulses: Rosas, Romero, Nesterenko & Lindenberg, Phys. Rev. Lett. 98 (2007); Herrmann &
Seitz (1982) for the restitution of beads in a row.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from lammps_inputs import laws, physics
from lammps_inputs.chains import contacts
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.base import Coefficient, Ingredient, NotNegative, Setting
from lammps_inputs.ingredients.contact import HERTZ
from lammps_inputs.ingredients.unequal import masses_and_strengths
from lammps_inputs.laws import Parameter
from lammps_inputs.laws.dashpot import (
    NO_LIMIT,
    ContactDashpot,
    ContactLoss,
    Dashpot,
    LinearRestitution,
    PowerRestitution,
    Restitution,
    Viscoelastic,
    alpha,
)
from lammps_inputs.links import Links
from lammps_inputs.numbers import number_or_array
from lammps_inputs.system import System
from lammps_inputs.units import Label, Unit

MOST = 1e3
"""Dimensionless coefficient; beyond it beads stick where they are, and a step would take for ever."""


RESTITUTIONS: dict[float, Callable[[Parameter, float], ContactLoss]] = {
    1.0: lambda coefficient, share: (
        LinearRestitution(coefficient, share) if np.ndim(coefficient) else ContactDashpot(coefficient)
    ),
    HERTZ: Restitution,
    2.0: lambda coefficient, _: Viscoelastic(coefficient),
}
"""Exponent p of contacts -> the dashpot that grows as overlap**((p - 1) / 2), from its coefficient and restitution."""


def _of_law(damping: Mapping[str, Any]) -> str:
    """Unit of the coefficient of contacts."""
    return {"viscoelastic": "kg/(s m^0.5)", "restitution": ""}.get(damping.get("law"), "kg/s")  # type: ignore[arg-type]


SOURCES = {
    "linear": ("rosas2007",),
    "viscoelastic": ("kuwabara1987", "brilliantov1996"),
    "restitution": ("tsuji1992", "antypov2011"),
}
"""Publications of the laws of contacts."""


class Damping(Ingredient):
    """Forces against velocities, each absent if its coefficient is 0 or not given."""

    example: ClassVar[str] = "{contact: 0.01}"

    why: ClassVar[dict[Fact, str]] = {
        Fact.FRONT: "a window restarts with forces from velocities other than those of half a step before",
        Fact.REVERSIBLE: "suzuki4 has steps backwards in time, in which dashpots would give",
    }
    sources_of_laws: ClassVar[dict[str, dict[str, tuple[str, ...]]]] = {"damping.contact": SOURCES}

    contact: Annotated[Annotated[NotNegative, Unit(_of_law)] | None, Label("contact damping")] = None
    """Coefficient gamma of the contacts; of the law `restitution` the coefficient of restitution e, 0 to 1."""
    law: Literal["linear", "viscoelastic", "restitution"] | None = None
    """Law of the contacts' dashpots; `linear` if omitted."""
    tension: Literal["allowed", "cut"] | None = None
    """Whether the sum of elastic and dashpot force may be tensile while a contact opens; `allowed` if omitted."""
    beads: Annotated[Coefficient | None, Label("drag coefficient of the beads", "\\gamma_b")] = None
    """Coefficient gamma_b of the drag force on every bead."""
    coupling: Annotated[Coefficient | None, Label("damping coefficient of the coupling", "\\gamma_{12}")] = None
    """Coefficient gamma_12 of a dashpot parallel to every spring between chains."""

    def refuse(self, setting: Setting) -> None:
        """Refuse what says nothing, or more than there is, and what runs in pieces that start again."""
        if self.contact is None:
            for key in ("law", "tension"):
                if getattr(self, key) is not None:
                    raise ValueError(f"damping.{key}: belongs to damping.contact; give that, too, or leave it out")
            if self.beads is None and self.coupling is None:
                raise ValueError("damping: give contact, beads or coupling")
        elif self.law == "restitution":
            if not 0.0 < self.contact <= 1.0:
                raise ValueError(f"damping.contact: {self.contact:g} is no restitution; above 0, and at most 1")
            if self.tension == "cut":
                raise ValueError("damping.tension: the law restitution needs tensile forces; leave `cut` out")
        elif self.tension == "cut" and setting.contact_scale[0] != HERTZ:
            raise ValueError(
                "damping.tension: is cut where dashpots pull harder than contacts of spheres push, of exponent 1.5, "
                f"not {setting.contact_scale[0]:g}; leave it out"
            )
        if self.coupling and not _springs(setting):
            raise ValueError("damping.coupling: there is no coupling between chains that it could damp")
        for link in self.dampers(setting):
            largest = float(np.max(link.law.coefficient))  # type: ignore[attr-defined]
            if largest > MOST:
                where = f" at the {link.name.split('_')[0]} wall" if link.kind == "wall" else ""
                raise ValueError(
                    f"damping: {largest:.3g} in dimensionless units{where}; at most {MOST:g}, where beads stick"
                )

    def refuse_system(self, setting: Setting, system: System) -> None:  # noqa: ARG002
        """Refuse laws that are known for other contacts."""
        if self.contact and physics.exponent(system) is None and (self.law == "restitution" or self.tension == "cut"):
            key = "law" if self.law == "restitution" else "tension"
            raise ValueError(
                f"damping.{key}: {getattr(self, key)} is known for contacts whose force is a power of the overlap, "
                "which those of this scene are not; take linear or viscoelastic, and leave tension out"
            )
        if (
            self.contact
            and physics.contact_loss(system) is not None
            and self.tension == "cut"
            and not physics.one_kind(system)
        ):
            raise ValueError("damping.tension: is cut at the force of equal contacts only; leave it out")

    def cited(self) -> tuple[str, ...]:
        """Publications of the law of the contacts' dashpots."""
        return () if self.contact is None else SOURCES[self.law or "linear"]

    def dampers(self, setting: Setting) -> tuple[Links, ...]:
        """Dashpots of contacts, springs and beads."""
        dampers: list[Links] = []
        if not self._undamped():
            gap = setting.gap / setting.scale.length
            dampers += contacts(gap, law=self._of_contacts(setting), name="contact_damping", closed=setting.closed)
            for wall in _walls(setting):
                dampers.append(replace(wall, name=f"{wall.name}_damping", law=self._at_wall(wall, setting)))
        if self.coupling:
            coefficient = laws.dimensionless(Dashpot(self.coupling), setting.scale).coefficient
            for link in _springs(setting):
                acts = link.acts(setting.beads)
                law = Dashpot(coefficient if np.all(acts) else np.where(acts, coefficient, 0.0))
                dampers.append(replace(link, name="coupling_damping", law=law))
        if self.beads:
            dampers.append(Links.ground("bead_damping", laws.dimensionless(Dashpot(self.beads), setting.scale)))
        return tuple(dampers)

    def lacks(self, setting: Setting) -> frozenset[Fact]:
        """Energy, and what goes with it; momentum by drag on beads; order 2 by all other dashpots."""
        dampers = self.dampers(setting)
        taken = {Fact.ENERGY, Fact.FRONT, Fact.REVERSIBLE} if dampers else set()
        if any(len(link.ends) == 1 for link in dampers):
            taken.add(Fact.MOMENTUM)
        if any(link.kind != "ground" for link in dampers):
            taken.add(Fact.SECOND_ORDER)
        return frozenset(taken)

    def _undamped(self) -> bool:
        """Whether contacts have no dashpots."""
        return not self.contact or (self.law == "restitution" and self.contact >= 1.0)

    def _loss(
        self, strength: Parameter, reduced: Parameter, setting: Setting, *, share: Parameter = 1.0
    ) -> ContactLoss:
        """Dimensionless dashpot law of contacts or of a wall.

        Args:
            strength: strength of the contacts.
            reduced: reduced mass of the two that touch, of one bead and a place the bead's.
            setting: the scene.
            share: of the coefficient of viscoelastic contacts.
        """
        assert self.contact is not None
        scale, exponent = setting.scale, setting.contact_scale[0]
        if self.law == "restitution":
            coefficient = alpha(self.contact, exponent) * np.sqrt(reduced * strength)
            if exponent in RESTITUTIONS:
                return RESTITUTIONS[exponent](coefficient, self.contact)
            return PowerRestitution(coefficient, exponent, self.contact)
        unit = scale.force / scale.velocity
        tensile_limit = strength if self.tension == "cut" else NO_LIMIT
        if self.law == "viscoelastic":
            return Viscoelastic(self.contact / unit * scale.length**0.5 * share, tensile_limit)
        return ContactDashpot(self.contact / unit, tensile_limit)

    def _of_contacts(self, setting: Setting) -> ContactLoss:
        """Dashpot of the contacts of beads."""
        mass, strength = masses_and_strengths(setting)
        reduced = 0.5 if isinstance(mass, float) else 1.0 / sum(1.0 / each for each in setting.at_contacts(mass))
        return self._loss(strength, reduced, setting)

    def _at_wall(self, wall: Links, setting: Setting) -> ContactLoss:
        """Dashpot of a wall: it dissipates the share of the speed, or has the share of the force, that contacts do.

        The dashpot of a viscoelastic contact is in proportion to its stiffness (Brilliantov et al. 1996).
        """
        mass, strength = masses_and_strengths(setting)[0], laws.strength(wall.law)
        (beads, _), *_ = wall.ends
        met = mass if isinstance(mass, float) else number_or_array(mass[:, beads.rows])
        return self._loss(strength, met, setting, share=strength)


def _walls(setting: Setting) -> tuple[Links, ...]:
    walls = setting.part("walls")
    return () if walls is None else walls.links(setting)


def _springs(setting: Setting) -> tuple[Links, ...]:
    coupling = setting.part("coupling")
    links = () if coupling is None else coupling.links(setting)
    return tuple(link for link in links if link.edges)
