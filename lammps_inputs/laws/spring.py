"""Springs between beads of different chains, or from a bead to its place: linear, or also cubic (Duffing 1918).

Linear ones to the ground may have a stiffness that depends on time: a ramp between two times, a modulation, or both.
"""

# ruff: noqa: ARG004  every function of a law takes all of its parameters
from dataclasses import replace
from typing import Annotated, Any

import numpy as np

from lammps_inputs import engine_limits, laws
from lammps_inputs.deck_lines import (
    BeadLayout,
    DeckLines,
    LinksAcross,
    atoms_by_row,
    atoms_by_value,
    bonds_by_value,
    row_formula,
    whole_contacts,
)
from lammps_inputs.laws import Law, Parameter
from lammps_inputs.numbers import text
from lammps_inputs.units import Dimension


class Linear(Law):
    """``k s``."""

    linear = True

    spring: Annotated[Parameter, Dimension("stiffness")]
    """k, in units of m / T**2."""

    @staticmethod
    def force(s: Any, spring: Any) -> Any:
        """Force of the spring, proportional to the strain."""
        return spring * s

    @staticmethod
    def energy(s: Any, spring: Any) -> Any:
        """``k s**2 / 2``."""
        return 0.5 * spring * s * s

    @staticmethod
    def stiffness(s: Any, spring: Any) -> Any:
        """Slope k of the force, independent of the strain."""
        return spring + 0.0 * s  # of the strain's shape; `ones_like` of a number is an array in compiled loops

    @staticmethod
    def max_strain(energy: Any, spring: Any) -> Any:
        """Strain at which one spring holds all of the energy; 0 where there is no spring."""
        # roots apart: the quotient may overflow
        return np.sqrt(2.0 * energy) / np.sqrt(np.where(np.asarray(spring) > 0.0, spring, np.inf))

    def ground(self, name: str, layout: BeadLayout) -> DeckLines:
        """LAMMPS commands that tie each bead to its position at the start (`fix spring/self`)."""
        if not laws.differs(self):
            return DeckLines(
                variables=(f"variable {name} index {text(float(self.spring))}",),
                motion=(f"fix {name} {layout.group} spring/self ${{{name}}} x",),
            )
        lines: list[str] = []
        if (profiles := atoms_by_row(name, self.spring, (layout.chains, layout.beads))) is not None:
            for number, (values, atoms) in enumerate(profiles, 1):
                lines += held_by_variable(f"{name}{number}", atoms, row_formula(name, values, ROW), layout)
            return DeckLines(motion=(row_variable(layout), *lines))
        for number, ((spring,), atoms) in enumerate(atoms_by_value(name, self, (layout.chains, layout.beads)), 1):
            lines += [
                f"group {name}{number} id {atoms}",
                f"fix {name}{number} {name}{number} spring/self {text(spring)} x",
            ]
        return DeckLines(motion=tuple(lines))

    def across(self, link: LinksAcross, layout: BeadLayout) -> DeckLines:
        """Harmonic bonds, whose energy is ``K (r - r0)**2``, with ``K = k / 2`` from a deck variable if all are equal.

        With r0 = 0 the bond is linear in each coordinate, so the force along the chain is exactly ``-k`` times the
        relative displacement at any lateral distance. (With r0 = the distance it would be cubic.)
        """
        values, bonds = bonds_by_value(self, (len(link.edges), layout.beads))
        kind, place = (link.name, f"of the {link.name}") if link.tie else ("kappa", "between chains")
        equal = len(values) == 1 and link.alone
        stiffness = [f"$(v_{kind}/2:%.17g)"] if equal else [text(spring / 2.0) for (spring,) in values]
        return DeckLines(
            bonds=bonds,
            style="harmonic",
            coefficients=tuple(f"{k} 0" for k in stiffness),
            variables=(f"variable {kind} index {text(values[0][0])}",) if equal else (),
            interactions=(
                f"# springs {place}: with r0 = 0 linear along the chain at any lateral distance",
                *whole_contacts(link),
            ),
        )


ROUNDED = 1e-10
"""Stiffness that may be lost where the lateral part of LAMMPS's cubic bond is taken away."""

ROW = "v_row"
"""Number of an atom's row in LAMMPS."""

_SINCE = 20250722
"""Earlier releases of LAMMPS were not tried with springs to the ground whose stiffness is a variable."""


def row_variable(layout: BeadLayout) -> str:
    """The line that defines `ROW`."""
    return f"variable row atom (id-1)%{layout.rows}+1"


def held_by_variable(name: str, atoms: str, formula: str, layout: BeadLayout) -> list[str]:
    """Springs to the ground, of which LAMMPS computes the stiffness at every step; of all atoms where none are named.

    A force from a formula, which older releases have too, takes twice the time.
    """
    group = name if atoms else layout.group
    style = "atom" if ROW in formula else "equal"
    older = f'"variable {name}_force atom -v_{name}_now*(x-{layout.place_formula})" '
    older += f'"fix {name} {group} addforce v_{name}_force 0.0 0.0"'
    return [
        *([f"group {name} id {atoms}"] if atoms else []),
        f"variable {name}_now {style} {formula}",
        f'if "$(version) >= {_SINCE}" then "fix {name} {group} spring/self v_{name}_now x" else {older}',
    ]


def driven_back(name: str, forces: list[tuple[str, str]], layout: BeadLayout) -> DeckLines:
    """Forces towards the places of beads, each a formula of ``v_NAMEstrain`` for some atoms."""
    lines = [f"variable {name}strain atom x-{layout.place_formula}"]
    for number, (force, atoms) in enumerate(forces, 1):
        lines += [
            f"group {name}{number} id {atoms}",
            f"variable {name}{number} atom -{force}",
            f"fix {name}{number} {name}{number} addforce v_{name}{number} 0.0 0.0",
        ]
    return DeckLines(motion=tuple(lines))


def tied(bonded: list[DeckLines]) -> list[str]:
    """Springs between chains; the types of several links are numbered one after the other."""
    styles = list(dict.fromkeys(lines.style for lines in bonded))
    names = [f"{lines.style} " if len(styles) > 1 else "" for lines in bonded]
    coefficients = [
        f"{name}{coefficient}" for lines, name in zip(bonded, names, strict=True) for coefficient in lines.coefficients
    ]
    return [
        *dict.fromkeys(line for lines in bonded for line in lines.interactions),
        f"bond_style {'hybrid ' * (len(styles) > 1)}{' '.join(styles)}",
        *(f"bond_coeff {number} {coefficient}" for number, coefficient in enumerate(coefficients, 1)),
    ]


class Duffing(Law):
    """``k s + c s**3`` with c >= 0."""

    spring: Annotated[Parameter, Dimension("stiffness")]
    """k, in units of m / T**2."""
    cubic: Annotated[Parameter, Dimension("stiffness", length=-2)]
    """c, in units of m / (L T)**2."""

    @staticmethod
    def force(s: Any, spring: Any, cubic: Any) -> Any:
        """Sum of the linear and the cubic part of the force."""
        return spring * s + cubic * (s * s * s)

    @staticmethod
    def energy(s: Any, spring: Any, cubic: Any) -> Any:
        """``k s**2 / 2 + c s**4 / 4``."""
        square = s * s
        return 0.5 * spring * square + 0.25 * cubic * square * square

    @staticmethod
    def stiffness(s: Any, spring: Any, cubic: Any) -> Any:
        """``k + 3 c s**2``."""
        return spring + 3.0 * cubic * (s * s)

    @staticmethod
    def max_strain(energy: Any, spring: Any, cubic: Any) -> Any:
        """Strain at which one spring holds all of the energy; 0 where there is no spring."""
        # s**2 is the root of c q**2 + 2 k q - 4 energy, in the form that has no difference of like numbers
        root = spring + np.sqrt(spring * spring + 4.0 * cubic * energy)
        return np.sqrt(4.0 * energy) / np.sqrt(np.where(root > 0.0, root, np.inf))

    def ground(self, name: str, layout: BeadLayout) -> DeckLines:
        """A force from a formula of the place, for which LAMMPS has no fix of its own."""
        strain, values = f"v_{name}strain", atoms_by_value(name, self, (layout.chains, layout.beads))
        forces = [(f"({text(k)}*{strain}+{text(c)}*{strain}^3)", atoms) for (k, c), atoms in values]
        return driven_back(name, forces, layout)

    def across(self, link: LinksAcross, layout: BeadLayout) -> DeckLines:
        """Bonds of class2, whose energy with r0 = 0 is ``K2 r**2 + K4 r**4``, r**2 = s**2 + (lateral distance)**2.

        With K4 = c / 4 the lateral part adds ``2 K4 distance**2`` to K2, which is taken away; exact but for rounding.

        Raises:
            EngineLimitError: chains so far apart that little is left of K2.
        """
        shape = (len(link.edges), layout.beads)
        apart = np.array([[layout.apart(edge)] for edge in link.edges])
        if np.max(self.cubic * apart**2) * np.finfo(float).eps > ROUNDED:
            raise engine_limits.CUBIC_SPRINGS.error(f"{link.name}.cubic", float(np.max(apart)))
        present = np.broadcast_to((self.spring != 0.0) | (self.cubic != 0.0), shape)
        values, bonds = bonds_by_value((self.spring, self.cubic, np.where(present, apart, 0.0)), shape)
        return DeckLines(
            bonds=bonds,
            style="class2",
            coefficients=tuple(
                f"0 {text(0.5 * spring - 0.5 * cubic * distance * distance)} 0 "
                f"{text(0.25 * cubic)}   # k = {text(spring)}, c = {text(cubic)}, d = {text(distance)}"
                for spring, cubic, distance in values
            ),
            interactions=(
                "# springs between chains, k s + c s^3: K4 = c/4, and K2 = k/2 - 2 K4 d^2 at the lateral distance d",
                *whole_contacts(link),
            ),
        )


class Instant(Law):
    """``k s`` at an instant, in which k changes at a rate."""

    linear = True

    spring: Parameter
    """k, in units of m / T**2."""
    slope: Parameter
    """dk/dt, in units of m / T**3."""

    @staticmethod
    def force(s: Any, spring: Any, slope: Any) -> Any:
        """Force of the spring, proportional to the strain."""
        return spring * s

    @staticmethod
    def energy(s: Any, spring: Any, slope: Any) -> Any:
        """``k s**2 / 2``."""
        return 0.5 * spring * s * s

    @staticmethod
    def stiffness(s: Any, spring: Any, slope: Any) -> Any:
        """Slope k of the force, independent of the strain."""
        return spring + 0.0 * s  # of the strain's shape; `ones_like` of a number is an array in compiled loops

    @staticmethod
    def max_strain(energy: Any, spring: Any, slope: Any) -> Any:
        """Strain at which one spring holds the energy; 0 where there is no spring."""
        return Linear.max_strain(energy, spring)

    @staticmethod
    def change(s: Any, spring: Any, slope: Any) -> Any:
        """Rate of change of the force at a constant strain, ``dk/dt s``."""
        return slope * s


class Varying(Law):
    """``k(t) s``, k(t) = (k0 + rate (t' - begin)) (1 + depth sin(omega t + phase)), t' = t between begin and end."""

    linear, varies = True, True

    spring: Annotated[Parameter, Dimension("stiffness")]
    """k0, in units of m / T**2."""
    rate: Annotated[Parameter, Dimension("stiffness", over="time")]
    """Slope of the ramp, dk/dt, in units of m / T**3."""
    begin: Annotated[Parameter, Dimension("time")]
    """Start of the ramp, in units of T."""
    end: Annotated[Parameter, Dimension("time")]
    """End of the ramp, in units of T."""
    depth: Annotated[float, Dimension()]
    """Depth of the modulation, at most 1."""
    omega: Annotated[float, Dimension("one", over="time")]
    """Angular frequency of the modulation, in units of 1 / T."""
    phase: Annotated[float, Dimension()]
    """Phase of the modulation, in radians."""

    @staticmethod
    def force(s: Any, t: Any, *law: Any) -> Any:
        """Force of the spring, proportional to the strain."""
        spring, rate, begin, end, depth, omega, phase = law
        level = spring + rate * (np.minimum(np.maximum(t, begin), end) - begin)
        return level * (1.0 + depth * np.sin(omega * t + phase)) * s

    @staticmethod
    def energy(s: Any, t: Any, *law: Any) -> Any:
        """``k s**2 / 2``."""
        return 0.5 * s * Varying.force(s, t, *law)

    @staticmethod
    def stiffness(s: Any, t: Any, *law: Any) -> Any:
        """Slope k(t) of the force, independent of the strain."""
        spring, rate, begin, end, depth, omega, phase = law
        level = spring + rate * (np.minimum(np.maximum(t, begin), end) - begin)
        return level * (1.0 + depth * np.sin(omega * t + phase)) + 0.0 * s

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
        """Strain at which one spring of the lowest stiffness over time holds the energy."""
        return Linear.max_strain(energy, np.minimum(*_ends_of_ramp(*law[:4])) * (1.0 - np.abs(law[4])))

    @staticmethod
    def stiffest(energy: Any, *law: Any) -> Any:
        """Largest stiffness over time."""
        return np.maximum(*_ends_of_ramp(*law[:4])) * (1.0 + np.abs(law[4]))

    @property
    def steady(self) -> Linear:
        """The springs without ramp or modulation."""
        return Linear(self.spring)

    @property
    def bends(self) -> tuple[float, ...]:
        """Times at which ramps start and end."""
        rate, begin, end = np.broadcast_arrays(self.rate, self.begin, self.end)
        return tuple(np.unique([times[rate != 0.0] for times in (begin, end)]).tolist())

    def now(self, t: Any) -> Instant:
        """The spring at a time."""
        unit = np.ones(np.broadcast_shapes(np.shape(t), *map(np.shape, self)))
        return Instant(self.force(unit, t, *self), 2.0 * self.power(unit, t, *self))

    def ground(self, name: str, layout: BeadLayout) -> DeckLines:
        """A variable that is the stiffness at every step: one for all, for each value, or for each profile of rows."""
        if not laws.differs(self):
            comment = "   # at the end of its ramp" if self.from_its_end else ""
            variables = [f"variable {name} index {text(self.counted_from)}{comment}"]
            if self.depth:
                variables += [f"variable {name}_{label} index {text(getattr(self, label))}" for label in _MODULATION]
            names = (f"v_{name}_{label}" for label in _MODULATION)
            lines = held_by_variable(name, "", _formula(self, f"v_{name}", *names), layout)
            return DeckLines(variables=tuple(variables), motion=tuple(lines))
        formulas = self._formulas(name, (layout.chains, layout.beads))
        lines = [row_variable(layout)] if any(ROW in formula for formula, _ in formulas) else []
        for number, (formula, atoms) in enumerate(formulas, 1):
            lines += held_by_variable(f"{name}{number}", atoms, formula, layout)
        return DeckLines(motion=tuple(lines))

    def _formulas(self, name: str, shape: tuple[int, int]) -> list[tuple[str, str]]:
        """Stiffness over time of springs that differ: formulas of LAMMPS, each with its atoms.

        One formula holds a profile along chains; a chain whose springs ramp in time has one for each value.
        """
        modulation = [_signed(getattr(self, label)) for label in _MODULATION]
        ramps = np.any(np.broadcast_to(self.rate, shape) != 0.0, axis=1)
        profiles = atoms_by_row(name, self.spring, shape, ~ramps)
        by_value = ramps[:, np.newaxis] | (profiles is None)
        values = atoms_by_value(name, [np.where(by_value, parameter, 0.0) for parameter in (*self,)[:_OF_RAMP]], shape)
        formulas = []
        for profile, atoms in profiles or []:
            steady = replace(self, rate=0.0)
            formulas.append((_formula(steady, row_formula(name, profile, ROW), *modulation), atoms))
        for parameters, atoms in values:
            law = Varying(*parameters, *(*self,)[_OF_RAMP:])
            formulas.append((_formula(law, text(law.counted_from), *modulation), atoms))
        return formulas

    @property
    def counted_from(self) -> float:
        """Stiffness of equal springs at the end of the ramp from which its formula counts, in units of m / T**2."""
        return self.lowest if self.from_its_end else float(self.spring)

    @property
    def lowest(self) -> float:
        """Stiffness after a falling ramp of equal springs, in units of m / T**2; 0 where rounding leaves no more."""
        _, after = _ends_of_ramp(*(*self,)[:_OF_RAMP])
        return float(after) if after > 2.0 * np.spacing(self.spring) else 0.0

    @property
    def from_its_end(self) -> bool:
        """Whether the formula of a ramp of equal springs counts from its end in LAMMPS.

        Counted from its start, a stiffness that falls to nearly 0 would be negative by rounding of the times, which
        `fix spring/self` refuses.
        """
        if not self.rate < 0.0:
            return False
        rounding = np.spacing(_LATEST + np.maximum(np.abs(self.begin), np.abs(self.end)))
        return bool(self.lowest <= -self.rate * rounding)


def _ends_of_ramp(spring: Any, rate: Any, begin: Any, end: Any) -> tuple[Any, Any]:
    """Stiffness before and after a ramp."""
    return spring, spring + rate * (end - begin)


_MODULATION = ("depth", "omega", "phase")
_OF_RAMP = 4
"""Parameters that may differ from bead to bead."""

_LATEST = 1e12
"""Time that no run passes, in units of T."""


def _formula(law: Varying, spring: str, depth: str, omega: str, phase: str) -> str:
    """Formula of the stiffness over time in LAMMPS."""
    t, level = "step*v_timestep", spring
    if np.any(law.rate):
        rate, begin, end = (float(parameter) for parameter in (law.rate, law.begin, law.end))
        if law.from_its_end:
            rate = -rate
            before, after = (f"({t}<{_signed(at)})*({_signed(at)}-{t})" for at in (end, begin))
        else:
            before, after = (f"({t}>{_signed(at)})*({t}-{_signed(at)})" for at in (begin, end))
        level = f"({spring}+{_signed(rate)}*({before}-{after}))"
    return f"{level}*(1+{depth}*sin({omega}*{t}+{phase}))" if law.depth else level


def _signed(value: float) -> str:
    """Number as text, in brackets where it is negative."""
    return f"({text(value)})" if value < 0.0 else text(value)
