"""A foundation: every bead is held at its place by a spring, as in a chain that lies in an elastic matrix.

Beats between chains on foundations, and their targeted transfer of energy: Starosvetsky, Hasan, Vakakis & Manevitch,
SIAM J. Appl. Math. 72 (2012); Hasan et al., Granular Matter 15 (2013).
"""

import math
from collections.abc import Iterator
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Discriminator, Field, Tag, field_validator

from lammps_inputs import laws, strict_yaml
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients import base
from lammps_inputs.ingredients.base import Cubic, Phase, Positive, Rows, ScenePart, Setting, Stiffness
from lammps_inputs.ingredients.by_formula import STIFFEST, ByFormula, formulas
from lammps_inputs.laws.spring import Duffing, Linear, Varying
from lammps_inputs.links import Links
from lammps_inputs.numbers import number_or_array
from lammps_inputs.system import System
from lammps_inputs.units import PURE, Label, Unit

Time = Annotated[float, Field(ge=-1e30, le=1e30), Unit("s")]


@base.with_keys(
    base.ends(
        Stiffness, "Stiffness at the start of the ramp, and before.", "Stiffness at the end of the ramp, and after."
    )
)
class GroundRamp(ScenePart):
    """Stiffness that changes evenly along the chains or in time, and is constant before and after."""

    example: ClassVar[str] = "{from: 0, to: 0.2, rows: [1, 60]}"

    rows: Rows | None = None
    """First and last bead of a ramp along the chains; or give `times`."""
    times: Annotated[tuple[Time, Time], BeforeValidator(strict_yaml.as_tuple)] | None = None
    """Start and end of a ramp in time; or give `rows`."""

    def refuse(self, key: str, beads: int) -> None:
        """Refuse a ramp along nothing, along both, and one that does not fit the chains.

        Raises:
            ValueError: naming the key, what was found and what to do.
        """
        if (self.rows is None) == (self.times is None):
            reason = "neither is given" if self.rows is None else "both are given"
            raise ValueError(f"{key}: a ramp is along `rows` or over `times` ({reason}); valid: `{self.example}`")
        base.refuse_range(f"{key}.rows", self.rows, beads, least=1)
        if self.times is not None and not self.times[0] < self.times[1]:
            begin, end = self.times
            raise ValueError(f"{key}.times: {begin:g} to {end:g} given; the end must be later than the start")


class Modulation(ScenePart):
    """A factor ``1 + depth sin(2 pi frequency t + phase)`` on the stiffness."""

    example: ClassVar[str] = "{depth: 0.5, frequency: 0.2}"

    depth: Annotated[float, Field(ge=-1, le=1), PURE]
    """Amplitude of the factor; at most 1, so that no stiffness is negative."""
    frequency: Annotated[Positive, Unit("Hz")]
    """Frequency f, in cycles per unit time."""
    phase: Phase = 0.0
    """Phase; with 90 the factor is a cosine."""


def _kind(value: Any) -> str:
    if isinstance(value, dict | GroundRamp):
        return "<keys>"
    return "<list>" if isinstance(value, tuple | list) else "<plain>"


_One = Annotated[Annotated[Stiffness, Tag("<plain>")] | Annotated[GroundRamp, Tag("<keys>")], Discriminator(_kind)]
_Stiffness = Annotated[
    Annotated[Stiffness, Tag("<plain>")]
    | Annotated[GroundRamp, Tag("<keys>")]
    | Annotated[tuple[_One, ...], Tag("<list>")],
    Discriminator(_kind),
]


class Foundation(ByFormula):
    """Springs from the beads to the ground: a force ``-stiffness x - cubic x**3``, or any against the displacement."""

    example: ClassVar[str] = "{stiffness: 0.1}"
    sources = ("starosvetsky2012",)

    takes_away = frozenset({Fact.MOMENTUM, Fact.PULSE, Fact.FRONT})
    why: ClassVar[dict[Fact, str]] = {
        Fact.FRONT: "beads behind a window keep oscillating",
        Fact.REVERSIBLE: "its stiffness depends on time, and suzuki4 steps back in time within each cycle",
    }

    stiffness: Annotated[_Stiffness, Label("foundation stiffness")] = 0.0
    """Linear stiffness k_f of all chains: a number or a ramp `{from, to, rows}` or `{from, to, times}`; or a list with
    one for each chain."""
    modulation: Modulation | None = None
    """Factor on the linear stiffness that oscillates in time; none if omitted."""
    cubic: Annotated[Cubic | tuple[Cubic, ...], Label("cubic foundation stiffness", "k_{f3}")] = 0.0
    """Cubic stiffness k_f3 of all chains, or a list with one for each chain."""
    rows: Rows | None = None
    """First and last bead with springs; all beads if omitted."""
    force: str | None = None
    """Force as a formula of s, the displacement, against which it acts; its parameters are keys beside it. In place of
    `stiffness` and `cubic`.
    """

    _from_list = field_validator("stiffness", "cubic", mode="before")(strict_yaml.as_tuple)

    def cited(self) -> tuple[str, ...]:
        """Publications of the foundation, and of ramps and modulation in time."""
        ramps = any(ramp.times is not None for _, ramp in self._ramps())
        parametric = ("landau1976",) if self.modulation is not None else ()
        return (*self.sources, *(("zener1932", "novotny2010") if ramps else ()), *parametric)

    def refuse(self, setting: Setting) -> None:
        """Refuse what does not fit the chains."""
        if self.formula is not None:
            self.refuse_beside("foundation", "stiffness", "cubic", "modulation")
            formulas().refuse_unrest("foundation", self.formula)
        for key in ("stiffness", "cubic"):
            values = getattr(self, key)
            base.refuse_other_count(f"foundation.{key}", values, setting.chains)
        if self.modulation is not None and "stiffness" not in self.model_fields_set:
            raise ValueError("foundation.stiffness: is missing beside modulation")
        for key, ramp in self._ramps():
            ramp.refuse(key, setting.beads)
        if self.modulation is not None and self.modulation.frequency * setting.scale.time > STIFFEST:
            raise ValueError("foundation.modulation.frequency: at most 1e12, dimensionless")
        for link in self.links(setting):
            if link.law.source is not None:
                continue
            largest = {
                "stiffness": laws.stiffest(link.law, 0.0),
                "cubic": np.max(link.law.by_name.get("cubic", 0.0)),
            }
            for key in (key for key, value in largest.items() if value > STIFFEST):
                raise ValueError(f"foundation.{key}: so stiff that the beads do not move; at most 1e12, dimensionless")
        base.refuse_range("foundation.rows", self.rows, setting.beads)

    @property
    def _of_chains(self) -> tuple[float | GroundRamp, ...]:
        """Stiffness of all chains, or of each."""
        return self.stiffness if isinstance(self.stiffness, tuple) else (self.stiffness,)

    def _ramps(self) -> Iterator[tuple[str, GroundRamp]]:
        """Ramps, and their keys."""
        several = isinstance(self.stiffness, tuple)
        for number, stiffness in enumerate(self._of_chains, 1):
            if isinstance(stiffness, GroundRamp):
                yield f"foundation.stiffness{f'[{number}]' * several}", stiffness

    def links(self, setting: Setting) -> tuple[Links, ...]:
        """Springs of the beads to the ground; cubic ones are separate from those that ramp or are modulated."""
        cubic = self._values(self.cubic, setting)
        named: dict[str, Any]
        k = None if self.formula is None else formulas().multiple_of_strain(self.formula)
        if self.formula is not None and k is None:
            named = {"foundation": self.formula.law(formulas().ToGround, strength=self._values(1.0, setting))}
        elif self.modulation is not None or any(self._ramps()):
            named = {"foundation": self._in_space_and_time(setting), "cubic_foundation": Duffing(0.0 * cubic, cubic)}
        else:
            stiffness = self._values(self.stiffness if k is None else k, setting)
            named = {"foundation": Duffing(stiffness, cubic) if np.any(cubic) else Linear(stiffness)}
        # the first two parameters of each law, all that Linear and Duffing have, are 0 where there are no springs
        present = {name: law for name, law in named.items() if any(map(np.any, (*law,)[:2]))}
        return tuple(Links.ground(name, laws.dimensionless(law, setting.scale)) for name, law in present.items())

    def refuse_system(self, setting: Setting, system: System) -> None:
        """Refuse formulas where they have no value."""
        for link in system.ground if self.formula is not None else ():
            if link.law.source is not None:
                formulas().refuse_reach("foundation", link.law, system, setting.scale.length)

    def lacks(self, setting: Setting) -> frozenset[Fact]:
        """Facts of `takes_away`, and that a scheme may step back in time, where the stiffness depends on time."""
        varies = any(link.law.varies for link in self.links(setting))
        return super().lacks(setting) | (frozenset({Fact.REVERSIBLE}) if varies else frozenset())

    def _in_space_and_time(self, setting: Setting) -> Linear | Varying:
        """Linear springs that ramp or are modulated, in the scene's units."""
        of_chains = np.stack([_start_of_ramp(stiffness, setting.beads) for stiffness in self._of_chains], axis=1)
        table = base.in_rows(of_chains, self.rows, (4, setting.chains, setting.beads))
        spring, rate, begin, end = map(number_or_array, table)
        depth = self.modulation.depth if self.modulation is not None else 0.0
        if not np.any(rate) and not depth:
            return Linear(spring)
        omega = 2.0 * math.pi * self.modulation.frequency if self.modulation is not None and depth else 0.0
        phase = math.radians(self.modulation.phase) if self.modulation is not None and depth else 0.0
        return Varying(spring, rate, begin, end, depth, omega, phase)

    def _values(self, stiffness: Any, setting: Setting) -> float | NDArray[np.float64]:
        """A number, or [chain, bead] where it differs, in the scene's units."""
        if self.rows is None and (not isinstance(stiffness, tuple) or len(set(stiffness)) == 1):
            return float(np.max(stiffness))
        return base.in_rows(np.reshape(stiffness, (-1, 1)), self.rows, (setting.chains, setting.beads))


def _start_of_ramp(stiffness: float | GroundRamp, beads: int) -> NDArray[np.float64]:
    """[4, bead]: stiffness at the start, or before a ramp in time, whose rate, begin and end follow."""
    table = np.zeros((4, beads))
    if not isinstance(stiffness, GroundRamp):
        table[0] = stiffness
        return table
    ends = [getattr(stiffness, end) for end in ("from", "to")]
    if stiffness.rows is not None:
        table[0] = np.interp(np.arange(1, beads + 1), stiffness.rows, ends)
    elif stiffness.times is not None and ends[0] != ends[1]:
        begin, end = stiffness.times
        table[:] = np.array([ends[0], (ends[1] - ends[0]) / (end - begin), begin, end])[:, np.newaxis]
    else:
        table[0] = ends[0]
    return table
