"""Laws of force on a link, one a file: plain scalar functions, and how LAMMPS spells them.

A law is a subclass of `Law` that declares its parameters, in order, as a dataclass does. Each parameter is a number, or
an array where it differs from link to link; with all of them 0 a law exerts no force. Each declares its unit
(`Dimension`), by which `dimensionless` converts a law whose parameters are in a scene's units.

Functions of a law take the strain ``s`` of a link and the parameters, as scalars or arrays. They are written without
branches, so that NumPy takes them as they are and the reference's kernel compiles them into vector instructions.
`Law` has all of them, with what they are where a law does not say otherwise. Nothing here depends on scenes or
problems.

Examples:
    >>> contacts = granchain.load("one-chain").problem().system.along[0].law
    >>> contacts.exponent, laws.strength(contacts)
    (1.5, 1.0)
    >>> laws.force(contacts, np.array([0.0, 1.0, 4.0]))
    array([0., 1., 8.])
    >>> contacts.rest, contacts.load  # nothing is loaded at rest
    (0.0, 0.0)
"""

import functools
import inspect
from collections.abc import Hashable, Iterator
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, dataclass_transform, get_args, get_type_hints

import numpy as np
from numpy.typing import NDArray

from lammps_inputs.units import Dimension, dimension_of

if TYPE_CHECKING:
    from lammps_inputs.units import Scale

Parameter = float | NDArray[np.float64]
"""A number, or an array over links: [chain, contact], [edge, row] or [chain, bead]."""


Pure = Annotated[Parameter, Dimension()]
"""A parameter without a unit, or one that is dimensionless from the start: a strength over that of reference beads."""


_ZERO: Any = 0.0
_NONE: Any = None


@dataclass_transform(frozen_default=True, eq_default=False)
class Parameters:
    """Parameters of a law, which are iterated in the order of their declaration.

    Subclasses are frozen dataclasses; two are equal if their classes are, and all parameters to the last number.

    Attributes:
        names: names of the parameters.
        source: function that writes a function of the law as Python for the reference's compiled kernel; None where the
            function itself is compiled.
    """

    names: ClassVar[tuple[str, ...]]
    source = _NONE

    def __init_subclass__(cls) -> None:
        """Make a dataclass, in which a default of `Law` is none of a parameter of that name."""
        for name, hint in inspect.get_annotations(cls).items():
            if name not in vars(cls) and hasattr(cls, name) and "ClassVar" not in str(hint):
                setattr(cls, name, field())
        dataclass(frozen=True, eq=False)(cls)
        cls.names = tuple(each.name for each in fields(cls))  # type: ignore[arg-type]

    def __iter__(self) -> Iterator[Any]:
        """Iterate over the parameters."""
        return (getattr(self, name) for name in self.names)

    @property
    def by_name(self) -> dict[str, Any]:
        """Parameters by their names, in the order of their declaration."""
        return {name: getattr(self, name) for name in self.names}

    def __eq__(self, other: object) -> bool:
        """Whether all parameters are the same, to the last number of every array."""
        return isinstance(other, type(self)) and all(map(np.array_equal, self, other))

    def __hash__(self) -> int:
        return hash(type(self))


class Law(Parameters):
    """Force of a link: its functions, and what they are where a law does not say otherwise.

    A law has ``force``, ``energy``, ``stiffness`` and ``max_strain``, and of the others what differs. Methods
    ``along``, ``across`` and ``ground`` spell it in LAMMPS on that kind of link (`lammps_inputs.links`): they take the
    link's name, ``across`` a `LinksAcross` whose edges become bonds, and the `BeadLayout`, both of
    `lammps_inputs.deck_lines`. A kind of link for which a law has none, LAMMPS does not compute.

    A law whose force depends on the past declares one of its parameters as the state of each contact, by a
    `ContactState` in its type: in the law of a system that at the start, in the law that analyses compute with that of
    frames (`at_state`). It has ``next_state``, ``permanent`` and ``dissipated``.

    A law that depends on time (``varies``) takes the time ``t`` after the strain in all functions but the bounds, and
    has ``now``, ``power``, ``steady`` and ``bends``; it is a law of links to the ground alone.

    Attributes:
        rest: overlap at rest; 0 where beads just touch.
        load: force at rest, which ``force`` leaves out.
        exponent: exponent of the overlap in the force of a contact: a number, or [chain, contact]; None where it is no
            power.
        linear: whether the force is proportional to the strain, on both sides of rest.
        constant: whether the force depends on nothing but the link, as a weight.
        omega: angular frequency with which the law changes in time, in units of 1 / T.
        varies: whether the law depends on time.
        steady: the law without what depends on time.
        bends: times between which the law depends on time smoothly.
        one_number: names of parameters that are the same for all links, and keep their value where there is no link.
        overlap_under, pressed_to: methods that give the overlap under a static force, and the law about rest at an
            overlap; None where these are not known.
        damping, impulse: functions of dashpots (`lammps_inputs.laws.dashpot`); None of other laws.
        along, across, ground: methods that spell the law in LAMMPS; None where it has no such link.
        wall: method that spells the force of a wall at an overlap; None where LAMMPS has no such wall.
        at_wall: method that spells walls of this law in another way; None where ``wall`` does.
    """

    rest, load, omega = _ZERO, _ZERO, _ZERO
    linear, varies, constant = False, False, False
    exponent, along, across, ground, at_wall, wall, damping, impulse = (_NONE,) * 8
    overlap_under, pressed_to = _NONE, _NONE
    bends: ClassVar[Any] = ()
    one_number: ClassVar[tuple[str, ...]] = ()

    @staticmethod
    def force(*args: Any, **kwargs: Any) -> Any:
        """Force at a strain, of the strain's shape; it drives the link's first bead back and its second forward."""
        raise NotImplementedError

    @staticmethod
    def energy(*args: Any, **kwargs: Any) -> Any:
        """Energy that is stored at a strain, an array of the strain's shape; the force is its slope."""
        raise NotImplementedError

    @staticmethod
    def stiffness(*args: Any, **kwargs: Any) -> Any:
        """Slope of the force at a strain."""
        raise NotImplementedError

    @staticmethod
    def max_strain(*args: Any, **kwargs: Any) -> Any:
        """Largest strain at which one link holds an energy; 0 where there is no link."""
        raise NotImplementedError

    @classmethod
    def stiffest(cls, energy: Any, *law: Any) -> Any:
        """Largest stiffness to which an energy can bring each link: a number, or an array where the law differs.

        It is the largest at some fractions of the strain at which the link alone holds the energy, which is exact for
        laws that stiffen or soften at all strains.
        """
        farthest = cls.max_strain(energy, *law)
        return functools.reduce(np.fmax, (cls.stiffness(part * farthest, *law) for part in _PARTS))

    def farthest(self, energy: float) -> float:  # noqa: ARG002
        """How much farther apart than at rest an energy brings beads, where the law acts at a distance; else 0."""
        return 0.0

    @staticmethod
    def next_state(*args: Any, **kwargs: Any) -> Any:
        """State of contacts after a strain."""
        raise NotImplementedError

    @staticmethod
    def permanent(*args: Any, **kwargs: Any) -> Any:
        """Overlap at which unloading of contacts ends."""
        raise NotImplementedError

    @staticmethod
    def dissipated(*args: Any, **kwargs: Any) -> Any:
        """Energy that contacts have dissipated since the start."""
        raise NotImplementedError

    def now(self, t: Any) -> "Law":
        """The law at a time, [...], which does not depend on time."""
        raise NotImplementedError

    @staticmethod
    def power(*args: Any, **kwargs: Any) -> Any:
        """How fast the energy changes at a strain that does not, which is work from outside."""
        raise NotImplementedError

    @property
    def steady(self) -> "Law":
        """The law without what depends on time."""
        return self

    @staticmethod
    def change(s: Any, *law: Any) -> Any:  # noqa: ARG004
        """How fast the force changes at a strain that does not, of a law at an instant."""
        return 0.0


def force(law: Law, strain: Any) -> Any:
    """Force of a law on links at a strain."""
    return law.force(strain, *law)


def energy(law: Law, strain: Any) -> Any:
    """Energy that a law stores in links at a strain."""
    return law.energy(strain, *law)


def stiffness(law: Law, strain: Any) -> Any:
    """Slope of the force of a law on links at a strain."""
    return law.stiffness(strain, *law)


def max_strain(law: Law, total_energy: float) -> float:
    """Largest strain that an energy can bring any of the links to."""
    return float(np.max(law.max_strain(total_energy, *law)))


def stiffest(law: Law, total_energy: float) -> float:
    """Largest stiffness that an energy can bring any of the links to."""
    return float(np.max(stiffest_of_each(law, total_energy)))


def stiffest_of_each(law: Law, total_energy: float) -> Any:
    """Largest stiffness that an energy can bring each of the links to: a number, or an array where the law differs."""
    return law.stiffest(total_energy, *law)


_PARTS = (1.0, 0.75, 0.5, 0.25, 0.0, -0.25, -0.5, -0.75, -1.0)


class ContactState:
    """State of a contact, on which its force depends beside the strain; base of what declares a parameter as one.

    States, overlaps and closing velocities are arrays of one shape, [...], or numbers. Overlaps include that at rest.
    """

    heading: ClassVar[str]
    """Variable of LAMMPS that holds the state of the contact behind each bead, and the heading of its column."""
    meaning: ClassVar[str] = "state"
    """What the state is, in words."""

    def turning_overlap(self, state: Any) -> Any:
        """Overlap, [...], at which unloading began, and beyond which first loading continues."""
        raise NotImplementedError

    def loading(self, state: Any, overlap: Any, closing: Any) -> Any:
        """Whether contacts are in first loading, [...], at their overlaps and closing velocities."""
        raise NotImplementedError

    def on_branch(self, state: Any, closing: Any) -> Any:
        """State, [...], that gives the stiffness of loading where contacts at their turning overlap close.

        Elsewhere it gives that of unloading.
        """
        raise NotImplementedError


@functools.lru_cache(maxsize=256)
def _declared(kind: Hashable) -> tuple[str, ContactState] | None:
    """Name of the parameter of a class of laws that is the state of contacts, and its kind; None without one."""
    for name, hint in get_type_hints(kind, include_extras=True).items():
        for declaration in get_args(hint)[1:]:  # of `Annotated`
            if isinstance(declaration, ContactState):
                return name, declaration
    return None


def _state_of(law: Any) -> tuple[str, ContactState] | None:
    kind: Any = type(law)
    return _declared(kind)


def _kind_of_state(law: Any) -> ContactState:
    declaration = _state_of(law)
    assert declaration is not None
    return declaration[1]


def has_state(law: Any) -> bool:
    """Whether the force of a law depends on a state of each contact."""
    return _state_of(law) is not None


def refuse_incomplete(law: Any) -> None:
    """Refuse a law with a state of each contact that lacks its declaration, or a function which analyses need of it.

    Raises:
        ValueError: naming the law, and the function or the declaration.
    """
    kind = type(law)
    if kind.next_state is not Law.next_state and not has_state(law):
        raise ValueError(
            f"contacts: the law {kind.__name__} has a function `next_state`; it needs a parameter declared as the "
            "state, such as `largest: LargestOverlap = 0.0`, too"
        )
    for name in ("next_state", "permanent", "dissipated"):
        if has_state(law) and getattr(kind, name) is getattr(Law, name):
            raise ValueError(f"contacts: the law {kind.__name__} has a memory; it needs a function `{name}`, too")


def state_name(law: Any) -> str:
    """Name of the parameter that is the state of each contact; empty for a law without one."""
    declaration = _state_of(law)
    return "" if declaration is None else declaration[0]


def contact_state(law: Any) -> Any:
    """State of the contacts of a law that has one: a number, or an array where it differs."""
    return getattr(law, state_name(law))


def at_state(law: Any, state: Any) -> Any:
    """The law at another state of its contacts; unchanged without a state, or for a law that has none."""
    return replace(law, **{state_name(law): state}) if state is not None and has_state(law) else law


def state_heading(law: Any) -> str:
    """Heading of the column of frames that holds the state of the contact behind each bead, of a law that has one."""
    return _kind_of_state(law).heading


def state_meaning(law: Any) -> tuple[str, str]:
    """What the state of contacts is, in words, and its unit of `Scale`: ``one`` for a number; of a law that has one."""
    kind = type(law)
    dimension = dimension_of(get_type_hints(kind, include_extras=True)[state_name(law)])
    assert dimension is not None
    return _kind_of_state(law).meaning, dimension.unit


def turning_overlap(law: Any) -> Any:
    """Overlap at which unloading began, and beyond which first loading continues, of a law that has a state."""
    return _kind_of_state(law).turning_overlap(contact_state(law))


def loading(law: Any, overlap: Any, closing: Any) -> Any:
    """Whether contacts of a law that has a state are in first loading, [...], at overlaps and closing velocities."""
    return _kind_of_state(law).loading(contact_state(law), overlap, closing)


def on_branch(law: Any, closing: Any) -> Any:
    """A law with the stiffness of loading where contacts at their turning overlap close, else of unloading.

    Args:
        law: any law; unchanged if it has no state.
        closing: [...] closing velocities, or their signs.
    """
    return at_state(law, _kind_of_state(law).on_branch(contact_state(law), closing)) if has_state(law) else law


def whole_force(law: Law, overlap: Any) -> Any:
    """Force of a law on links at an overlap, that at rest included, where the strain counts from there."""
    return law.force(overlap - law.rest, *law) + law.load


def strength(law: Law) -> Any:
    """Strength of a contact's law, its first parameter: 1 for two reference beads."""
    return next(iter(law))


def dimensionless(law: Any, scale: "Scale") -> Any:
    """A law whose parameters are in a scene's units, as one of dimensionless strain, rate and force.

    Raises:
        TypeError: it is no `Law`, or a parameter declares no `Dimension`.
    """
    kind = type(law)
    if not isinstance(law, Law):
        raise TypeError(f"{kind.__name__}: is no law; valid: a subclass of `laws.Law` that declares its parameters")
    hints = get_type_hints(kind, include_extras=True)
    units = []
    for name in kind.names:
        if (dimension := dimension_of(hints[name])) is None:
            raise TypeError(
                f"{kind.__name__}.{name}: declares no unit; valid: `{name}: Annotated[Parameter, "
                f"Dimension('stiffness')]`, or `{name}: Pure` for one without"
            )
        units.append(dimension.worth(scale))
    return kind(*(value / unit for value, unit in zip(law, units, strict=True)))


def differs(law: Law) -> bool:
    """Whether a law differs from link to link."""
    return any(np.ndim(parameter) > 0 for parameter in law)


def for_all(law: Any, shape: tuple[int, int]) -> Any:
    """Law whose parameters that differ are arrays of a shape; those of a single chain are repeated for every chain."""
    return type(law)(*(np.array(np.broadcast_to(values, shape)) if np.ndim(values) > 0 else values for values in law))


def joined(law: Any, last: Any, shape: tuple[int, int]) -> Any:
    """Law whose parameters that differ are those of a law of a shape, [chain, contact], and one more of each chain.

    Args:
        law: law of all links but the last of each chain.
        last: law of these, of parameters that are numbers or [chain, 1].
        shape: number of chains, and of links of each but the last.
    """

    def both(values: Any, more: Any) -> Any:
        if np.ndim(values) == 0 and np.ndim(more) == 0:
            return values
        return np.concatenate([np.broadcast_to(values, shape), np.broadcast_to(more, (shape[0], 1))], axis=1)

    return type(law)(*map(both, law, last))


def at(law: Law, *index: Any) -> Any:
    """The law of chosen links: parameters that differ are taken at an index of the arrays."""
    return type(law)(*(parameter[index] if np.ndim(parameter) > 0 else parameter for parameter in law))
