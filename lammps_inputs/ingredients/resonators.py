"""Resonators: a mass on a spring at every bead, or at those of some rows, such as an inner mass or a bending cylinder.

Woodpiles: Kim & Yang, J. Mech. Phys. Solids (2014). Pulses in locally resonant chains: Vorotnikov, Starosvetsky,
Theocharis & Kevrekidis, arXiv 1709.08629.
"""

import math
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import field_validator

from lammps_inputs import laws, strict_yaml
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients import base, unequal
from lammps_inputs.ingredients.base import (
    Coefficient,
    FurtherAtoms,
    Ingredient,
    NotNegative,
    Rows,
    Setting,
    Stiffness,
)
from lammps_inputs.ingredients.damping import MOST
from lammps_inputs.laws.dashpot import Dashpot
from lammps_inputs.laws.spring import Linear
from lammps_inputs.links import Links
from lammps_inputs.numbers import number_or_array
from lammps_inputs.physics import PULSE_RATE
from lammps_inputs.units import Label, Unit

Floats = NDArray[np.float64]
Mass = Annotated[NotNegative, Unit("kg")]

KEY = "resonators"

LIGHTEST, HEAVIEST = 1e-6, unequal.MOST
"""Masses in that of the reference bead: a lighter one is none, a heavier one rests."""

FASTEST = 1e6
"""Dimensionless angular frequency, beyond which it is part of the bead."""


class Resonators(Ingredient):
    """Mass at each bead on a linear spring and a dashpot: ``m_2 y'' = k_2 (x - y) + gamma_2 (x' - y')``."""

    example: ClassVar[str] = "{mass: 0.1, stiffness: 1}"
    several: ClassVar[bool] = True
    sources = ("kim2014", "vorotnikov2017")
    why: ClassVar[dict[Fact, str]] = {
        Fact.FRONT: "resonators behind a window keep oscillating",
        Fact.REVERSIBLE: "suzuki4 has steps backwards in time, in which dashpots would give",
    }

    mass: Annotated[Mass | tuple[Mass, ...], Label("resonator mass", "m_2")]
    """Mass m_2 of a resonator; or a list with one for each chain, 0 for none."""
    stiffness: Annotated[Stiffness | tuple[Stiffness, ...], Label("resonator stiffness", "k_2")]
    """Stiffness k_2 of its spring; or a list with one for each chain."""
    damping: Annotated[Coefficient | tuple[Coefficient, ...], Label("resonator damping", "\\gamma_2")] = 0.0
    """Coefficient gamma_2 of the dashpot parallel to the spring; or a list with one for each chain."""
    rows: Rows | None = None
    """First and last bead with resonators; all beads if omitted."""

    _from_list = field_validator("mass", "stiffness", "damping", mode="before")(strict_yaml.as_tuple)

    def refuse(self, setting: Setting) -> None:
        """Refuse what does not fit the chains, masses that are none, and those beside which a bead is at rest."""
        part = setting.key_of(self)
        for key in ("mass", "stiffness", "damping"):
            base.refuse_other_count(f"{part}.{key}", getattr(self, key), setting.chains)
        base.refuse_range(f"{part}.rows", self.rows, setting.beads)
        mass, stiffness, damping = self._of_chains(setting)
        if np.any((damping > 0.0) & (mass > 0.0) & (stiffness == 0.0)):
            raise ValueError(f"{part}.stiffness: is 0 beside a damping; give a stiffness, or leave the damping out")
        present = (mass > 0.0) & (stiffness > 0.0)
        if np.any(mass[present] < LIGHTEST):
            raise ValueError(
                f"{part}.mass: {np.min(mass[present]):.3g} of the reference bead's; at least {LIGHTEST:g}, or 0 "
                "for none"
            )
        if np.any(mass[present] > HEAVIEST):
            raise ValueError(
                f"{part}.mass: {np.max(mass[present]):.3g} times the reference bead's; at most {HEAVIEST:g}, where "
                "the resonator rests (`foundation`)"
            )
        dragged = float(np.max(damping[present] / mass[present], initial=0.0))
        if dragged > MOST:
            raise ValueError(
                f"{part}.damping: {dragged:.3g} times the mass in dimensionless units; at most {MOST:g}, where the "
                "resonator sticks to its bead"
            )
        fastest = math.sqrt(float(np.max(stiffness[present] / mass[present], initial=0.0)))
        if fastest > FASTEST:
            raise ValueError(
                f"{part}.stiffness: an angular frequency of {fastest:.3g} in dimensionless units; at most "
                f"{FASTEST:g}, where it moves with its bead"
            )

    def further_atoms(self, setting: Setting) -> FurtherAtoms | None:
        """A line of masses for each chain."""
        mass, stiffness, damping = self._of_chains(setting)
        present = (mass > 0.0) & (stiffness > 0.0)
        if not np.any(present):
            return None
        table = self._in_rows(np.where(present, mass, 0.0), setting)
        edges = tuple((chain, setting.chains + chain) for chain in range(setting.chains))
        spring = Linear(number_or_array(self._in_rows(np.where(present, stiffness, 0.0), setting)))
        dashpot: Any = Dashpot(number_or_array(self._in_rows(np.where(present, damping, 0.0), setting)))
        dampers = (Links.across("resonator_damping", dashpot, edges),) if np.any(damping[present]) else ()
        name = setting.key_of(self).replace("[", "_").rstrip("]")
        return FurtherAtoms(table, (Links.across(name, spring, edges),), dampers, ("resonator", "resonators"))

    def lacks(self, setting: Setting) -> frozenset[Fact]:
        """Exact solitary waves; a leading pulse where resonators are too slow; with dashpots what these take."""
        resonators = self.further_atoms(setting)
        if resonators is None:
            return frozenset()
        taken = {Fact.SONIC_VACUUM, Fact.FRONT}
        mass = resonators.mass
        springs = [laws.stiffness(link.law, 0.0) for link in resonators.ties if link.law.linear]
        if np.all(mass > 0.0) and all(np.all(spring < PULSE_RATE**2 * mass) for spring in springs):
            taken.add(Fact.PULSE)
        if resonators.dampers:
            taken |= {Fact.ENERGY, Fact.REVERSIBLE, Fact.SECOND_ORDER}
        return frozenset(taken)

    def _of_chains(self, setting: Setting) -> tuple[Floats, Floats, Floats]:
        """Dimensionless mass, stiffness and damping, each [chain]."""
        scale = setting.scale
        of = [
            np.array(np.broadcast_to(values, setting.chains), dtype=np.float64)
            for values in (self.mass, self.stiffness, self.damping)
        ]
        damping: Floats = np.asarray(laws.dimensionless(Dashpot(of[2]), scale).coefficient)
        return of[0] / scale.mass, of[1] / scale.stiffness, damping

    def _in_rows(self, of_chain: Floats, setting: Setting) -> Floats:
        """[chain, bead], 0 where no resonator is."""
        return base.in_rows(of_chain[:, np.newaxis], self.rows, (setting.chains, setting.beads))
