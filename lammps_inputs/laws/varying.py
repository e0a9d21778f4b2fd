"""Linear springs to the ground whose stiffness depends on time: a ramp between two times, a modulation, or both."""

# ruff: noqa: ARG004  every function of a law takes all of its parameters
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import numpy as np

from lammps_inputs import laws
from lammps_inputs.deck_lines import Lines, atoms_by_row, atoms_by_value, row_formula
from lammps_inputs.laws import Parameter
from lammps_inputs.laws.spring import ROW, Linear, held_by_variable, row_variable
from lammps_inputs.numbers import text
from lammps_inputs.units import Dimension

if TYPE_CHECKING:
    from lammps_inputs.layout import Layout


class Instant(NamedTuple):
    """``k s`` at an instant, in which k changes at a rate."""

    spring: Parameter
    """k, in units of m / T**2."""
    slope: Parameter
    """dk/dt, in units of m / T**3."""

    @staticmethod
    def force(s: Any, spring: Any, slope: Any) -> Any:
        """Proportional to the strain."""
        return spring * s

    @staticmethod
    def energy(s: Any, spring: Any, slope: Any) -> Any:
        """``k s**2 / 2``."""
        return 0.5 * spring * s * s

    @staticmethod
    def stiffness(s: Any, spring: Any, slope: Any) -> Any:
        """The same at any strain."""
        return spring * np.ones_like(s)

    @staticmethod
    def max_strain(energy: Any, spring: Any, slope: Any) -> Any:
        """As of `Linear`."""
        return Linear.max_strain(energy, spring)

    @staticmethod
    def change(s: Any, spring: Any, slope: Any) -> Any:
        """Of the force, at the same strain."""
        return slope * s


class Varying(NamedTuple):
    """``k(t) s``, k(t) = (k0 + rate (t' - begin)) (1 + depth sin(omega t + phase)), t' = t between begin and end."""

    spring: Annotated[Parameter, Dimension("stiffness")]
    """k0, in units of m / T**2."""
    rate: Annotated[Parameter, Dimension("stiffness", over="time")]
    """Of the ramp, in units of m / T**3."""
    begin: Annotated[Parameter, Dimension("time")]
    """Of the ramp."""
    end: Annotated[Parameter, Dimension("time")]
    """Of the ramp."""
    depth: Annotated[float, Dimension()]
    """Of the modulation, at most 1."""
    omega: Annotated[float, Dimension("one", over="time")]
    """Angular frequency of the modulation."""
    phase: Annotated[float, Dimension()]
    """In radians."""

    @staticmethod
    def force(s: Any, t: Any, *law: Any) -> Any:
        """Proportional to the strain."""
        spring, rate, begin, end, depth, omega, phase = law
        level = spring + rate * (np.minimum(np.maximum(t, begin), end) - begin)
        return level * (1.0 + depth * np.sin(omega * t + phase)) * s

    @staticmethod
    def energy(s: Any, t: Any, *law: Any) -> Any:
        """``k s**2 / 2``."""
        return 0.5 * s * Varying.force(s, t, *law)

    @staticmethod
    def stiffness(s: Any, t: Any, *law: Any) -> Any:
        """The same at any strain."""
        return Varying.force(np.ones_like(s), t, *law)

    @staticmethod
    def power(s: Any, t: Any, *law: Any) -> Any:
        """``dk/dt s**2 / 2``."""
        spring, rate, begin, end, depth, omega, phase = law
        level = spring + rate * (np.minimum(np.maximum(t, begin), end) - begin)
        angle = omega * t + phase
        ramp = rate * ((t >= begin) & (t < end)) * (1.0 + depth * np.sin(angle))
        return 0.5 * s * s * (ramp + level * (depth * omega) * np.cos(angle))

    @staticmethod
    def max_strain(energy: Any, *law: Any) -> Any:
        """At the lowest stiffness."""
        return Linear.max_strain(energy, np.minimum(*_ends_of_ramp(*law[:4])) * (1.0 - np.abs(law[4])))

    @staticmethod
    def stiffest(energy: Any, *law: Any) -> Any:
        """The largest over time."""
        return np.maximum(*_ends_of_ramp(*law[:4])) * (1.0 + np.abs(law[4]))

    @property
    def steady(self) -> Linear:
        """The springs without ramp or modulation."""
        return Linear(self.spring)

    @property
    def bends(self) -> tuple[float, ...]:
        """Times at which ramps start and end."""
        both = np.broadcast_arrays(self.rate, self.begin, self.end)
        return tuple(np.unique([one[both[0] != 0.0] for one in both[1:]]).tolist())

    def now(self, t: Any) -> Instant:
        """The spring at a time."""
        one = np.ones(np.broadcast_shapes(np.shape(t), *map(np.shape, self)))
        return Instant(self.force(one, t, *self), 2.0 * self.power(one, t, *self))

    def ground(self, name: str, layout: "Layout") -> Lines:
        """A variable that is the stiffness at every step: one for all, for each value, or for each profile of rows."""
        shape = (layout.chains, layout.beads)
        if not laws.differs(self):
            numbers = {label: value for label, value in zip(self._fields, self, strict=True) if label in _MODULATION}
            variables = [f"variable {name} index {text(float(self.spring))}"]
            if self.depth:
                variables += [f"variable {name}_{label} index {text(float(value))}" for label, value in numbers.items()]
            names = (f"v_{name}_{label}" for label in _MODULATION)
            lines = held_by_variable(name, "", _formula(self, f"v_{name}", *names), layout)
            return Lines(variables=tuple(variables), motion=tuple(lines))
        modulation = [_signed(getattr(self, label)) for label in _MODULATION]
        if (profiles := atoms_by_row(self.spring, shape)) is not None:
            own = [(_formula(self, row_formula(values, ROW), *modulation), atoms) for values, atoms in profiles]
        else:
            found = atoms_by_value(self[:_OF_RAMP], shape)
            each = ((Varying(*values, *self[_OF_RAMP:]), atoms) for values, atoms in found)
            own = [(_formula(law, text(float(law.spring)), *modulation), atoms) for law, atoms in each]
        lines = []
        for number, (formula, atoms) in enumerate(own, 1):
            lines += held_by_variable(f"{name}{number}", atoms, formula, layout)
        return Lines(motion=(*([row_variable(layout)] if profiles is not None else []), *lines))


def _ends_of_ramp(spring: Any, rate: Any, begin: Any, end: Any) -> tuple[Any, Any]:
    """Stiffness before and after a ramp."""
    return spring, spring + rate * (end - begin)


_MODULATION = ("depth", "omega", "phase")
_OF_RAMP = 4
"""Parameters that may differ from bead to bead."""


def _formula(law: Varying, spring: str, depth: str, omega: str, phase: str) -> str:
    """Of the stiffness in LAMMPS."""
    t, level = "step*v_timestep", spring
    if np.any(law.rate):
        begin, end = (f"({t}>{at})*({t}-{at})" for at in (_signed(float(law.begin)), _signed(float(law.end))))
        level = f"({spring}+{_signed(float(law.rate))}*({begin}-{end}))"
    return f"{level}*(1+{depth}*sin({omega}*{t}+{phase}))" if law.depth else level


def _signed(value: float) -> str:
    """In brackets where it is negative."""
    return f"({text(value)})" if value < 0.0 else text(value)
