"""Laws whose force is a formula of the user's: one class for each formula, made when it is met.

The formula is that of the scene's own units, and the law is scaled as a whole: with lengths in units of L and forces
in units of m V / T, ``F(s L) / (m V / T)``. So no parameter needs a unit.

A law acts on both sides of rest, or only where its strain is above 0 (`FormulaKind.cut`). It may push at rest: then, as
for a contact under a static load, its force is counted from there, and so is its energy.
"""

import functools
from collections.abc import Callable
from dataclasses import replace
from typing import Annotated, Any, ClassVar, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import engine_limits
from lammps_inputs.deck_lines import BeadLayout, DeckLines, LinksAcross, atoms_by_value, whole_contacts
from lammps_inputs.formulas import expression
from lammps_inputs.formulas.expression import SQUARE, STRAIN, Derived
from lammps_inputs.laws import Law, Parameter, Pure, formula
from lammps_inputs.laws.spring import driven_back
from lammps_inputs.numbers import text
from lammps_inputs.units import Dimension

Floats = NDArray[np.float64]

_OWN = ("strength", "length", "per_force", "at_rest")
"""Fields before the formula's own parameters, which follow with a prefix."""

FARTHEST, FINE = 1e8, 2000
"""Largest strain that is examined, in units of L, and number of steps of a grid."""

_GEOMETRIC = np.geomspace(1.0 / FARTHEST, FARTHEST, 1281)

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(40)

SINCE = formula.SINCE.replace("contacts of any exponent need", "forces by formula need")
"""Earlier releases of LAMMPS have no potentials from formulas."""

COST = "some 0.5 ms a step"
"""What LAMMPS takes for a formula of the distance, however few beads there are."""

_DECADES = np.geomspace(1e-12, 1e6, 181)
"""Strains at which an energy that sympy found is compared with the integral of the force."""

_CLOSE, _ROUNDED = 1e-6, 1e-13
"""Relative difference of energy and integral that is accepted, and the part of it that is rounding of their terms."""


class FormulaKind(NamedTuple):
    """How a formula is read.

    Attributes:
        direction: 1 where its strain is that of the link, -1 where it counts in the opposite direction.
        cut: whether there is no force at negative strain.
    """

    direction: float = 1.0
    cut: bool = False


class FormulaLaw(Law):
    """Base of the laws of all formulas; each has the parameters of `_OWN` and of its formula.

    Attributes:
        derived: texts of the formula and what follows from it.
        kind: how it is read.
        base: name of the class of this module that it is made from.
    """

    derived: ClassVar[Derived]
    kind: ClassVar[FormulaKind]
    base: ClassVar[str]
    strength: Parameter
    length: float
    per_force: float
    at_rest: float

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the texts of the formula, from which the class is made again on reading."""
        return _again, (self.base, self.derived, self.kind, tuple(cast(Any, self)))

    @property
    def load(self) -> Parameter:
        """Force at rest."""
        return self.strength * self.per_force * self.at_rest

    def form(self, find: Any) -> str:
        """Form of the energy that `energy_form` or `even_form` finds for the law's parameters; empty if none."""
        form: str = find(type(self), tuple(map(float, tuple(cast(Any, self))[len(_OWN) :])))
        return form

    # --- functions of the strain and of the parameters ----------------------------------------------------------------

    @classmethod
    def source(cls, name: str, function: str) -> str:
        """The force or the stiffness as a function of numbers, in Python, for the reference's compiled kernel."""
        arguments = ", ".join(cls.names)
        cut, direction = cls.kind.cut, repr(cls.kind.direction)
        strain, acts = ("max(s, 0.0)", "s > 0.0") if cut else ("s", "s != 0.0")
        names = {field: field for field in _parameters(cls)} | {STRAIN: "u"}
        value = expression.written(getattr(cls.derived, function), names, "python")
        result = f"strength * per_force * ({value} - at_rest)"
        if function == "stiffness":
            strain = f"({strain} if s != 0.0 else 1e-200)"  # formulas such as s^1.5 / s have none exactly at 0
            acts = "s > 0.0" if cut else "True"
            result = f"strength * per_force * length * {direction} * ({value})"
        return (
            f"def {name}(s, {arguments}):\n    u = {direction} * length * {strain}\n"
            f"    return {result} if strength != 0.0 and {acts} else 0.0\n"
        )

    @classmethod
    @np.errstate(all="ignore")
    def force(cls, s: Any, *values: Any) -> Floats:
        """Force above that at rest, dimensionless, an array of the shape of the strain ``s`` and of the parameters."""
        strength, length, per_force, at_rest, *numbers = values
        u = cls._argument(s, length)
        force = strength * per_force * (_value(cls, cls.derived.force)(u, *numbers) - at_rest)
        return np.asarray(np.where(cls._acts(s, strength), force, 0.0))

    @classmethod
    @np.errstate(all="ignore")
    def energy(cls, s: Any, *values: Any) -> Floats:
        """Integral of the force from rest, of the shape of `force`: by sympy's formula, or by Gauss's rule."""
        strength, length, per_force, at_rest, *numbers = values
        u = cls._argument(s, length)
        form = energy_form(cast(Any, cls), tuple(map(float, numbers)))
        integral = _integral(cls, u, numbers) if not form else _value(cls, form)(u, *numbers)
        energy = strength * (per_force / length) * cls.kind.direction * (integral - at_rest * u)
        return np.asarray(np.where(cls._acts(s, strength), energy, 0.0))

    @classmethod
    @np.errstate(all="ignore")
    def stiffness(cls, s: Any, *values: Any) -> Floats:
        """Slope of the force, an array of the shape of the strain ``s`` and of the parameters."""
        strength, length, per_force, _, *numbers = values
        u = cls._argument(s, length)
        slope = _value(cls, cls.derived.stiffness)
        slopes = slope(u, *numbers)
        # formulas such as s^1.5 / s have none exactly at 0
        slopes = np.where(
            np.isfinite(slopes) | (u != 0.0), slopes, slope(cls.kind.direction * np.float64(1e-200), *numbers)
        )
        acts = cls._acts(s, strength) if cls.kind.cut else np.asarray(strength) != 0.0
        return np.asarray(np.where(acts, strength * (per_force * length) * cls.kind.direction * slopes, 0.0))

    @classmethod
    @np.errstate(all="ignore")
    def max_strain(cls, energy: Any, *values: Any) -> Floats:
        """Largest strain of pressed links at an energy, an array of the shape of the strengths; see `reach`."""
        return _of_each(lambda law: reach(law, energy, 1.0), cls, values)

    @classmethod
    @np.errstate(all="ignore")
    def stiffest(cls, energy: Any, *values: Any) -> Floats:
        """Largest stiffness at strains within reach of an energy, an array of the shape of the strengths."""
        return _of_each(lambda law: _stiffest(law, energy), cls, values)

    @classmethod
    def _argument(cls, s: Any, length: Any) -> Floats:
        s = np.asarray(s, dtype=np.float64)
        return np.asarray(cls.kind.direction * length * (np.maximum(s, 0.0) if cls.kind.cut else s))

    @classmethod
    def _acts(cls, s: Any, strength: Any) -> Any:
        """Whether there is a link, and a force at strains, of the shape of both together."""
        strains = np.asarray(s) > 0.0 if cls.kind.cut else np.asarray(s) != 0.0
        return strains & (np.asarray(strength) != 0.0)


def _value(law: type[FormulaLaw], form: str, argument: str = STRAIN) -> Callable[..., Floats]:
    return expression.function(form, (argument, *_parameters(law)))


def _parameters(law: type[FormulaLaw]) -> tuple[str, ...]:
    return law.names[len(_OWN) :]


def _integral(law: type[FormulaLaw], u: Floats, numbers: Any, panels: int = 1) -> Floats:
    """Integral of the force from 0 to u, with nodes that are denser towards 0, where powers begin."""
    value, mean = _value(law, law.derived.force), np.zeros_like(u)
    for panel in range(panels):
        for node, weight in zip((panel + 0.5 + 0.5 * _NODES) / panels, 0.5 * _WEIGHTS / panels, strict=True):
            mean = mean + 2.0 * node * weight * value(u * node * node, *numbers)
    return np.asarray(mean * u)


@functools.lru_cache(maxsize=256)
def energy_form(law: Any, numbers: tuple[float, ...]) -> str:
    """Form of the energy that agrees with the integral of the force, as far as that is finite; empty if none does."""
    signs = (law.kind.direction,) if law.kind.cut else (1.0, -1.0)
    forms = sorted(law.derived.energies, key=len)
    return next((form for form in forms if all(_agrees(law, numbers, form, sign) for sign in signs)), "")


@functools.lru_cache(maxsize=256)
def even_form(law: Any, numbers: tuple[float, ...]) -> str:
    """Energy as a formula of the strain squared that has a slope at 0; empty if there is none."""
    smooth = (form for form in sorted(law.derived.even, key=len) if not expression.has_root(form, SQUARE))
    return next((form for form in smooth if _agrees(law, numbers, form, 1.0, SQUARE)), "")


@np.errstate(all="ignore")
def _agrees(law: type[FormulaLaw], numbers: tuple[float, ...], form: str, sign: float, argument: str = STRAIN) -> bool:
    """Whether a form is the energy at strains of a sign, to rounding, up to where the force is not finite."""
    u = sign * _DECADES
    right, finer = (_integral(law, u, numbers, panels) for panels in (1, 2))
    rounding = _ROUNDED * np.abs(u) * _value(law, expression.size(law.derived.force))(u, *numbers)
    reliable = np.isfinite(right) & (np.abs(right - finer) <= 1e-3 * _CLOSE * np.abs(finer) + rounding)
    reliable = np.logical_and.accumulate(reliable)
    at = u if argument == STRAIN else u * u
    rounding = rounding + _ROUNDED * _value(law, expression.size(form), argument)(at, *numbers)
    off = np.abs(_value(law, form, argument)(at, *numbers) - right)
    return bool(reliable.any() and np.all((off <= _CLOSE * np.abs(right) + rounding)[reliable]))


# --- how far an energy reaches ----------------------------------------------------------------------------------------


def _of_each(find: Callable[[Any], float], law: type[FormulaLaw], values: tuple[Any, ...]) -> Floats:
    """Number that a function finds for the law of each strength, an array of their shape; 0 where there is no link."""
    different, places = np.unique(np.asarray(values[0], dtype=np.float64), return_inverse=True)
    numbers = [find(law(strength, *values[1:])) if strength else 0.0 for strength in different]
    return np.asarray(np.array(numbers)[places].reshape(np.shape(values[0])))


@np.errstate(all="ignore")
def reach(law: Any, energy: float, side: float) -> float:
    """Strain on a side at which one link holds an energy, or where its formula ends before; inf where neither is."""
    if law.kind.cut and side < 0.0:
        return np.inf
    if not energy > 0.0:
        return 0.0

    def within(size: Any) -> Any:
        held = law.energy(side * size, *law)
        return np.isfinite(law.force(side * size, *law)) & (held < energy) & (held >= -1e-9 * energy)

    inside = within(_GEOMETRIC)
    beyond = int(np.argmin(inside))
    low, high = (_GEOMETRIC[beyond - 1] if beyond else 0.0), _GEOMETRIC[beyond]
    far = np.inf if inside.all() else _bisected(within, low, high)
    grid = _GEOMETRIC if far == np.inf else np.linspace(0.0, far, FINE)
    before, pole = first_pole(law, side, grid)
    return far if pole == np.inf else _bisected(within, before, pole)


def _bisected(within: Callable[[float], Any], low: float, high: float) -> float:
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if within(middle) else (low, middle)
    return low


@np.errstate(all="ignore")
def first_pole(law: Any, side: float, grid: Floats) -> tuple[float, float]:
    """Strain of a grid before the first pole of a law's formula on a side, and that of the pole; inf if there is none.

    At a pole a part of the formula is 0 (`expression.vanishing`), and the force is far larger than around it.

    Args:
        law: dimensionless law.
        side: 1 or -1, the sign of the strains.
        grid: sizes of strains, ascending, [strain], in units of L.
    """
    numbers = [getattr(law, name) for name in _parameters(type(law))]
    poles = [(np.inf, np.inf)]
    for part in expression.vanishing(law.derived.force):
        value = _value(type(law), part)

        def size(strain: Any, value: Callable[..., Floats] = value) -> Floats:
            """Size of the part of the formula at strains, an array of their shape."""
            sizes = np.abs(value(law._argument(side * strain, law.length), *numbers))
            return np.where(np.isnan(sizes), np.inf, sizes)

        sizes = size(grid)
        lowest = np.flatnonzero((sizes[1:-1] <= sizes[:-2]) & (sizes[1:-1] <= sizes[2:])) + 1
        for place in lowest.tolist():
            ends = grid[[place - 1, place + 1]]
            pole = _least(size, *ends)
            near, around = (np.abs(law.force(side * strain, *law)) for strain in (pole * _BESIDE, ends))
            if size(pole) <= _NOTHING * np.max(size(ends)) and not np.all(near <= 2.0 * np.max(around)):
                poles.append((pole, float(ends[0])))
                break
    pole, before = min(poles)
    return before, pole


_BESIDE = 1.0 + 1e-15 * np.arange(-4.0, 5.0)
"""Factors on the strain of a pole."""

_NOTHING = 1e-6
"""Size that counts as 0, relative to that at the neighbouring points of the grid."""


def _least(size: Callable[[Any], Floats], low: float, high: float) -> float:
    """Strain between two others at which a size is least, from ever finer grids."""
    for _ in range(12):
        grid = np.linspace(low, high, 41)
        place = int(np.argmin(size(grid)))
        low, high = grid[max(place - 1, 0)], grid[min(place + 1, 40)]
    return float(0.5 * (low + high))


def _stiffest(law: Any, energy: float) -> float:
    slopes = [abs(float(law.stiffness(0.0, *law)))]
    for side in (1.0,) if law.kind.cut else (1.0, -1.0):
        far = reach(law, energy, side)
        grid = np.linspace(0.0, far, FINE) if far < np.inf else _GEOMETRIC
        slopes.append(float(np.nanmax(np.abs(law.stiffness(side * grid, *law)))))
    return max(slopes)


# --- LAMMPS -----------------------------------------------------------------------------------------------------------


class AlongChains(FormulaLaw):
    """A contact."""

    def farthest(self, energy: float) -> float:
        """How much farther apart than at rest an energy brings beads, where the law acts at a distance; else 0."""
        return 0.0 if self.kind.cut else max(reach(law, energy, -1.0) for law in _each(self))

    def along(self, name: str, layout: BeadLayout) -> DeckLines:
        """A pair style of the distance, from the energy.

        Raises:
            EngineLimitError: LAMMPS has no such contacts.
        """
        if np.ndim(self.strength):
            raise engine_limits.FORMULAS.error(name)
        form = self.form(energy_form)
        if not form:
            raise engine_limits.ENERGY.error(name)
        if not self.kind.cut and not np.isfinite(layout.farthest):
            raise engine_limits.REACH.error(name)
        u = f"({text(self.kind.direction * float(self.length))}*({text(layout.spacing)}-r))"
        energy = f"{text(self.kind.direction * _factor(self))}*({_spelled(self, form, u, 'lepton', name)})"
        if self.kind.cut:
            touching = f"({text(layout.diameter)}-r)"
            energy = energy.replace(f"({text(layout.spacing)}-r)", touching)
            return formula.contacts(energy, f"from its energy, a formula, which takes {COST}", layout)
        return DeckLines(
            variables=(SINCE,),
            interactions=(
                f"# contacts: force from its energy, a formula, at any distance of neighbours; takes {COST}",
                f"pair_style lepton {text(1.25 * layout.diameter)}",
                f'pair_coeff * * "{energy}"',
                *formula.beads_alone(layout),
            ),
        )

    def wall(self, overlap: str, closed: str, strength: str) -> str:
        """Force of a wall at an overlap, in LAMMPS's variables; while it is touched where there is no tension."""
        acting = f"({overlap}*{closed})" if self.kind.cut else f"({overlap})"
        u = f"({text(self.kind.direction * float(self.length))}*{acting})"
        return (
            f"{strength}*{text(float(self.per_force))}*({_spelled(self, self.derived.force, u, 'variable', 'walls')})"
        )


class ToGround(FormulaLaw):
    """A spring to the ground."""

    def ground(self, name: str, layout: BeadLayout) -> DeckLines:
        """A force on the beads, in LAMMPS's variables."""
        u = f"({text(float(self.length))}*v_{name}strain)"
        value = _spelled(self, self.derived.force, u, "variable", name)
        by_strength = atoms_by_value(name, [self.strength], (layout.chains, layout.beads))
        forces = [(f"{text(strength * float(self.per_force))}*({value})", atoms) for (strength,), atoms in by_strength]
        return driven_back(name, forces, layout)


class AcrossChains(FormulaLaw):
    """A spring between chains; its force is odd."""

    def across(self, link: LinksAcross, layout: BeadLayout) -> DeckLines:
        """Bonds from an energy that is a formula of the strain squared, ``r^2 - d^2`` at the lateral distance d.

        Raises:
            EngineLimitError: no formula of the energy is smooth at rest.
        """
        form = self.form(even_form)
        if not form:
            raise engine_limits.EVEN_ENERGY.error(link.name)
        squares, bonds = formula.squares_of_strain(link, layout)
        scale = text(float(self.length) ** 2)
        energies = (_spelled(self, form, f"({scale}*{square})", "lepton", link.name, SQUARE) for square in squares)
        return DeckLines(
            variables=(SINCE,),
            bonds=np.where(np.asarray(self.strength) != 0.0, bonds, 0),
            style="lepton",
            coefficients=tuple(f'0.0 "{text(_factor(self))}*({energy})"' for energy in energies),
            interactions=(
                f"# springs between chains, from their energy, a formula of r^2 - d^2; takes {COST}",
                *whole_contacts(link),
            ),
        )


def _factor(law: Any) -> float:
    return float(np.max(law.strength)) * float(law.per_force) / float(law.length)


def _spelled(law: Any, form: str, strain: str, style: str, name: str, variable: str = STRAIN) -> str:
    """A form with the numbers of a law.

    Raises:
        EngineLimitError: LAMMPS has no such function.
    """
    numbers = {field: text(float(getattr(law, field))) for field in _parameters(type(law))}
    numbers = {field: f"({number})" if number.startswith("-") else number for field, number in numbers.items()}
    try:
        return expression.written(form, numbers | {variable: strain}, style)
    except expression.FormulaError as error:
        raise engine_limits.FUNCTIONS.error(name, str(error)) from None


def _each(law: Any) -> list[Any]:
    """The law with each of its strengths."""
    return [replace(law, strength=float(strength)) for strength in np.unique(law.strength) if strength]


# --- classes ----------------------------------------------------------------------------------------------------------


@functools.lru_cache(maxsize=256)
def law_class(base: Any, derived: Derived, kind: FormulaKind) -> Any:
    """The class of the laws of a formula, with the parameters of `_OWN` and of the formula."""
    parameters = sorted(set(expression.names(derived.force)) - {STRAIN})
    fields = (*_OWN, *parameters)
    hints: dict[str, Any] = dict.fromkeys(fields, Pure)
    hints["length"] = Annotated[Parameter, Dimension(length=-1)]
    hints["per_force"] = Annotated[Parameter, Dimension("force")]
    parts = {
        "derived": derived,
        "kind": kind,
        "one_number": fields[1:],
        "base": base.__name__,
        "__annotations__": hints,
        "__module__": __name__,
    }
    return type(base.__name__, (base,), parts)


def _again(base: str, derived: Derived, kind: FormulaKind, values: tuple[Any, ...]) -> Any:
    return law_class(globals()[base], derived, kind)(*values)


class Force(NamedTuple):
    """A formula and the numbers of its parameters, in a scene's units.

    Attributes:
        text: of the formula, of ``s`` and its parameters.
        numbers: of the parameters, in the order of their names.
    """

    text: str
    numbers: tuple[tuple[str, float], ...]

    @property
    def derived(self) -> Derived:
        """Texts that follow from the formula; its parameters get a prefix, so that none is a name of sympy's."""
        return _derived(self)

    def law(self, base: Any, kind: FormulaKind = FormulaKind(), strength: Parameter = 1.0) -> Any:  # noqa: B008
        """Law of the formula in the scene's units, for `laws.dimensionless`; its force counts from that at s = 0."""
        formula_law = law_class(base, self.derived, kind)
        return formula_law(strength, 1.0, 1.0, self.at_rest, *(number for _, number in sorted(self.numbers)))

    @property
    def at_rest(self) -> float:
        """Force at s = 0, where beads rest; 0 where it is below the rounding of the formula's terms."""
        rest = float(self.at(0.0))
        rounding = _ROUNDED * float(self._value(expression.size(self.text), 0.0))
        return 0.0 if abs(rest) <= rounding < np.inf else rest

    def at(self, s: Any) -> Floats:
        """Force at strains, an array of their shape, in the scene's units; NaN or inf where it has no real value."""
        return self._value(self.text, s)

    def _value(self, text: str, s: Any) -> Floats:
        """Value of a formula of the same parameters."""
        ordered = [name for name, _ in self.numbers]
        return expression.function(text, (STRAIN, *ordered))(s, *(number for _, number in self.numbers))


@functools.lru_cache(maxsize=256)
def _derived(force: Force) -> Derived:
    numbers = dict(force.numbers)
    names = {name: f"p_{name}" for name in numbers} | {STRAIN: STRAIN}
    exponents = expression.in_exponents(force.text)
    return expression.derived(
        expression.written(force.text, names, "plain"),
        tuple((f"p_{name}", int(np.sign(number))) for name, number in force.numbers if name not in exponents),
        tuple((f"p_{name}", repr(numbers[name])) for name in sorted(exponents)),
    )
