"""The scales that turn a scene's own units into the dimensionless problem at V = 1, and back.

With mass m, contact constant A (force = A overlap**p, p = 1.5 for spheres) and fastest kick V::

    length  L = (m V**2 / A)**(1 / (p + 1))      time  T = L / V

so that x = L x^, t = T t^, and a spring k becomes kappa = k T**2 / m. Reduced units are the case m = A = 1, where
kappa = k V**-0.4 for spheres. The scaling is exact (Starosvetsky, Hasan & Vakakis: the array has no other scale).

Examples:
    >>> scale = units.make_scale(mass=1e-3, contact_constant=1e10, velocity=1.0, si=True)
    >>> scale.written(1.0, "time"), scale.short(1.0, "time")
    ('6.30957e-06 s', '6.30957 us')
    >>> scale.measured(np.array([0.5, 1.0]), "velocity")  # m/s
    array([0.5, 1. ])
    >>> units.Label("arrival", "t", units.SI["time"]).plain
    'arrival t (s)'
"""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any, get_origin

REDUCED = "reduced"


@dataclass(frozen=True)
class Unit:
    """Unit of a scene's key that holds a number; it stands in the key's type, ``Annotated[float, Unit("m/s")]``.

    Attributes:
        si: symbol in SI units, or a function that finds it from the scene's keys and those beside that one; empty
            for counts and shares.
        always: whether the unit is the same in reduced units.
    """

    si: str | Callable[[Mapping[str, Any]], str]
    always: bool = False

    def symbol(self, keys: Mapping[str, Any], *, si: bool) -> str:
        """Symbol of the unit in a table or a plot: ``m/s``, ``reduced``, or nothing.

        Args:
            keys: plain data of the scene, over them those of the keys around this one.
            si: whether the scene is in SI units.
        """
        name = self.si if isinstance(self.si, str) else self.si(keys)
        return name if si or self.always or not name else REDUCED


@dataclass(frozen=True)
class Dimension:
    """Unit of a law's parameter, in its type: ``Annotated[Parameter, Dimension("stiffness", length=-2)]``.

    Attributes:
        unit: name of a unit of `Scale`; ``one`` for a number without unit.
        over: name of the unit by which that is divided.
        length: power of the length, as a factor.
    """

    unit: str = "one"
    over: str = "one"
    length: float = 0.0

    @property
    def symbol(self) -> str:
        """SI unit, such as ``N/m/m^2``; empty of a pure number."""
        above = "" if self.unit == "one" else SI[self.unit]
        below = "" if self.over == "one" else f"/({SI[self.over]})" if "/" in SI[self.over] else f"/{SI[self.over]}"
        length = "" if not self.length else f"{'/' if self.length < 0.0 else ' '}m^{abs(self.length):g}"
        symbol = f"{above}{below}{length}"
        return f"1{symbol}" if symbol.startswith("/") else symbol.strip()

    def worth(self, scale: "Scale") -> float:
        """Size of one dimensionless unit, in the scene's units."""
        unit = getattr(scale, self.unit) / getattr(scale, self.over)
        length = scale.length ** abs(self.length)
        return float(unit / length if self.length < 0.0 else unit * length)


def in_si(keys: Mapping[str, Any]) -> bool:
    """Whether the numbers of a scene, of which these are the keys, are in SI units."""
    return any(keys.get(key) is not None for key in ("material", "mass"))


def dimension_of(hint: Any) -> Dimension | None:
    """Dimension that the type of a law's parameter declares first (`Annotated`); None where it declares none."""
    declared = hint.__metadata__[0] if get_origin(hint) is Annotated else None
    return declared if isinstance(declared, Dimension) else None


PURE = Unit("")
"""Unit of shares, and of numbers that are the same in all units."""

_GREEK = {"Delta": "Δ", "delta": "δ", "gamma": "γ", "kappa": "κ", "nu": "ν", "omega": "ω", "rho": "ρ", "sigma": "σ"}


@dataclass(frozen=True)
class Label:
    """Words, symbol and unit of a number, for axes, heads of tables and pages.

    That of a scene's key stands in the key's type, beside its `Unit`: ``Annotated[float, Unit("m"), Label("gap")]``;
    that of a result in its `analysis.quantity.QuantityColumn`.

    Attributes:
        words: noun, such as ``peak velocity``.
        symbol: in TeX; may be empty.
        unit: symbol of an SI unit, `REDUCED`, one of `OWN_UNITS`, `ENERGY_INPUT`, or a count such as ``beads``; empty
            where there is none.
    """

    words: str
    symbol: str = ""
    unit: str = ""

    @property
    def mathtext(self) -> str:
        """Text for matplotlib: ``time $t$ (ms)``, ``amplitude $v / V$``, ``residual energy / energy input``."""
        unit = self.unit if "$" in self.unit else re.sub(r"\^?([\d.]+)|\^(p)", r"$^{\1\2}$", self.unit)
        return self._text("$", self.symbol, unit)

    @property
    def plain(self) -> str:
        """Text without TeX, for HTML pages: ``time t (ms)``, ``amplitude v / V``, ``coupling stiffness k (N/m)``."""
        symbol = re.sub(r"\\([A-Za-z]+) ?", lambda name: _GREEK.get(name[1], ""), self.symbol)
        return self._text("", re.sub(r"[{}]", "", symbol), re.sub(r"[${}]", "", self.unit))

    def _text(self, mark: str, symbol: str, unit: str) -> str:
        """Words, symbol and unit; the mark encloses mathematics."""
        named = f"{self.words} {mark}{symbol}{mark}" if symbol else self.words
        if unit in OWN_UNITS:
            return f"{self.words} {mark}{symbol} / {unit}{mark}" if symbol else f"{named} / {mark}{unit}{mark}"
        if unit == ENERGY_INPUT:
            return f"{named} / {unit}"
        return f"{named} ({unit})" if unit else named

    def prefixed(self, largest: float) -> tuple["Label", float]:
        """Label with a prefix before an SI unit that leaves few digits, and the factor for numbers in the plain unit.

        Reduced units have a power of ten in place of a prefix, where numbers are below 1e-3 or above 1e6.

        Args:
            largest: size of the largest number, in the unit.
        """
        power, before = prefix(self.unit, largest) if self.unit else (0, "")
        if self.unit == REDUCED and abs(thousands(largest)) > 1:
            power = thousands(largest)
            before = f"$10^{{{3 * power}}}$ "
        return replace(self, unit=before + self.unit), 10.0 ** (-3 * power)


OWN_UNITS = ("V", "T", "L")
"""A scene's own units of velocity, time and length; a label divides by them, for ``(V)`` would be read as volts."""

ENERGY_INPUT = "energy input"
"""Unit of shares of the energy."""


@dataclass(frozen=True)
class Scale:
    """Sizes of the dimensionless units in the scene's units (SI with a material or a mass, else reduced units)."""

    mass: float
    length: float
    velocity: float
    si: bool

    one = 1.0
    """Unit of numbers without unit."""

    @property
    def time(self) -> float:
        """Unit of time, ``length / velocity``."""
        return self.length / self.velocity

    @property
    def stiffness(self) -> float:
        """Unit of a linear spring, ``mass / time**2``."""
        return self.mass / self.time**2

    @property
    def force(self) -> float:
        """Unit of force, ``mass * length / time**2``."""
        return self.mass * self.velocity / self.time

    @property
    def momentum(self) -> float:
        """Unit of momentum."""
        return self.mass * self.velocity

    @property
    def energy(self) -> float:
        """Unit of energy."""
        return self.mass * self.velocity**2

    def measured(self, value: Any, quantity: str) -> Any:
        """A dimensionless number or array in the scene's units; ``quantity`` is a key of `SI`."""
        return value / self.time if quantity in PER_TIME else value * getattr(self, quantity)

    def symbol(self, quantity: str) -> str:
        """The unit's symbol, for axes: ``m/s`` or ``reduced``."""
        return SI[quantity] if self.si else REDUCED

    def after(self, quantity: str) -> str:
        """The unit's symbol as it follows a number, after a space: `` m/s``, and nothing in reduced units."""
        return f" {SI[quantity]}" if self.si else ""

    def each(self, count: str) -> str:
        """The unit of a rate as it follows a number: `` beads/s``, or `` beads per unit time``."""
        return f" {count}/{SI['time']}" if self.si else f" {count} per unit time"

    def written(self, value: float, quantity: str, digits: str = ".6g") -> str:
        """A dimensionless value in the scene's units, with the symbol of SI units: ``0.000656174 s``, or ``60``.

        Args:
            value: dimensionless number.
            quantity: key of `SI`.
            digits: format of the number.
        """
        return f"{self.measured(value, quantity):{digits}}{self.after(quantity)}"

    def short(self, value: float, quantity: str) -> str:
        """A dimensionless value in the scene's units with a prefix of the SI unit, in ASCII: ``656.174 us``."""
        if not self.si:
            return self.written(value, quantity)
        number = self.measured(value, quantity)
        power, letter = prefix(SI[quantity], number)
        return f"{number / 1000.0**power:.6g} {letter.replace(_PREFIXES[-2], 'u')}{SI[quantity]}"

    def heading(self, name: str, quantity: str) -> str:
        """A column's name in a table: ``arrival (s)``; without a unit in reduced units, and where it has none."""
        return f"{name} ({SI[quantity]})" if self.si and quantity in SI else name


DIMENSIONLESS = Scale(1.0, 1.0, 1.0, si=False)
"""Scale of numbers in units of V, T, L and the mass of a bead."""

SI = {
    "mass": "kg",
    "length": "m",
    "velocity": "m/s",
    "time": "s",
    "stiffness": "N/m",
    "force": "N",
    "momentum": "kg m/s",
    "energy": "J",
    "speed": "beads/s",
    "frequency": "rad/s",
    "cycles": "Hz",
    "rate": "1/s",
}
"""Symbols of what is measured: the units of `Scale`, and those of `PER_TIME`."""

PER_TIME = ("speed", "frequency", "cycles", "rate")
"""What is measured in beads, radians, cycles and factors of e a unit of time."""

_PREFIXES = {3: "G", 2: "M", 1: "k", 0: "", -1: "m", -2: "µ", -3: "n", -4: "p"}


def prefix(symbol: str, largest: float) -> tuple[int, str]:
    """Power of 1000 and prefix of an SI unit that leave one to three digits before the point of the largest number.

    Seconds have no prefix above 1; units that take none (beads/s, kg and products of it) are as they are.
    """
    power = min(max(thousands(largest), min(_PREFIXES)), 0 if symbol == "s" else max(_PREFIXES))
    if symbol not in (*SI.values(), "Pa") or symbol.startswith(("kg", "beads")):
        power = 0
    return power, _PREFIXES[power]


def thousands(size: float) -> int:
    """Power of 1000 just below a size; 0 for 0."""
    return math.floor(math.log10(abs(size)) / 3.0) if 0.0 < abs(size) < math.inf else 0


def make_scale(mass: float, contact_constant: float, velocity: float, *, si: bool, exponent: float = 1.5) -> Scale:
    """Scale of a chain of beads of this mass whose fastest bead starts with this velocity (> 0).

    Args:
        mass: bead mass (kg, or 1).
        contact_constant: A in ``force = A overlap**p`` (N/m^p, or 1).
        velocity: velocity V of the largest excitation (m/s, or reduced).
        si: whether the three are in SI units.
        exponent: p.
    """
    return Scale(mass, (mass * velocity**2 / contact_constant) ** (1.0 / (exponent + 1.0)), velocity, si)


def sphere_mass(radius: float, density: float) -> float:
    """Mass of a solid sphere (kg) of a radius (m) and density (kg/m3)."""
    return 4.0 / 3.0 * math.pi * radius**3 * density


def sphere_density(diameter: float) -> float:
    """Density that gives a sphere of this diameter the mass 1."""
    return 6.0 / (math.pi * diameter**3)


def hertz_constant(radius: float, youngs_modulus: float, poisson_ratio: float) -> float:
    """A = E sqrt(2 R) / (3 (1 - nu**2)) for two equal spheres (N/m^1.5; Hertz 1882, eq. 1 of the paper)."""
    return youngs_modulus * math.sqrt(2.0 * radius) / (3.0 * (1.0 - poisson_ratio**2))
