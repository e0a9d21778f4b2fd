"""Laws of force on a link, one a file: plain scalar functions, and how LAMMPS spells them.

A law is a `NamedTuple` of its parameters. Each parameter is a number, or an array where it differs from link to link;
with all of them 0 a law exerts no force. Each declares its unit (`Dimension`), by which `dimensionless` converts a law
whose parameters are in a scene's units. Its functions take the strain ``s`` of a link and the parameters, in the order
in which the law has them, as scalars or arrays:

- ``force(s, ...)``: what drives the link's first bead back and its second forward;
- ``energy(s, ...)``: stored by it, whose slope the force is;
- ``stiffness(s, ...)``: slope of the force;
- ``max_strain(energy, ...)``: largest strain to which an energy can bring it;
- ``one_number``, only where some parameters are the same for all links, and keep their value where there is no link:
  their names;
- ``stiffest(energy, ...)``, only where `stiffest_of_each` would not find it: largest stiffness at such an energy.

A law whose force depends on the past declares one of its parameters as the state of each contact, by a `ContactState`
in its type: in the law of a system that at the start, in the law that analyses compute with that of frames
(`at_state`). It has three more functions:

- ``next_state(s, ...)``: state after a strain;
- ``permanent(...)``: overlap at which unloading ends;
- ``dissipated(...)``: energy dissipated since the start.

A law that depends on time takes the time ``t`` after the strain in all of these but the bounds, and has

- ``now(t)``: the law at a time, whose ``change(s, ...)`` is how fast its force changes at a strain that does not;
- ``power(s, t, ...)``: how fast its energy changes at such a strain, which is work from outside;
- ``steady``: the law without what depends on time;
- ``bends``: times between which it depends on time smoothly.

They are written without branches, so that NumPy takes them as they are and the reference's kernel compiles them into
vector instructions. Methods ``along``, ``across`` and ``ground``, where a law has them, spell it in LAMMPS on that kind
of link (`lammps_inputs.links`). They take the link's name, ``across`` a `LinksAcross` whose edges become bonds, and the
`BeadLayout`, both of `lammps_inputs.deck_lines`. Nothing here depends on scenes or problems.

Examples:
    >>> contacts = granchain.load("one-chain").problem().system.along[0].law
    >>> laws.exponent(contacts), laws.strength(contacts)
    (1.5, 1.0)
    >>> laws.force(contacts, np.array([0.0, 1.0, 4.0]))
    array([0., 1., 8.])
    >>> laws.rest(contacts), laws.load(contacts)  # nothing is loaded at rest
    (0.0, 0.0)
"""

import functools
from collections.abc import Hashable, Iterator
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Protocol, get_args, get_type_hints

import numpy as np
from numpy.typing import NDArray

from lammps_inputs.units import Dimension, dimension_of

if TYPE_CHECKING:
    from lammps_inputs.units import Scale

Parameter = float | NDArray[np.float64]
"""A number, or an array over links: [chain, contact], [edge, row] or [chain, bead]."""


Pure = Annotated[Parameter, Dimension()]
"""A parameter without a unit, or one that is dimensionless from the start: a strength over that of reference beads."""


class Law(Protocol):
    """Functions that every law has beside its parameters; a law is a tuple of those."""

    def force(self, *args: Any, **kwargs: Any) -> Any:
        """Force at a strain, of the strain's shape; it drives the link's first bead back and its second forward."""

    def energy(self, *args: Any, **kwargs: Any) -> Any:
        """Energy that is stored at a strain, an array of the strain's shape."""

    def stiffness(self, *args: Any, **kwargs: Any) -> Any:
        """Slope of the force at a strain."""

    def max_strain(self, *args: Any, **kwargs: Any) -> Any:
        """Largest strain at which one link holds an energy; 0 where there is no link."""

    def __iter__(self) -> Iterator[Any]:
        """Iterate over the parameters."""


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
    """Largest stiffness that an energy can bring each of the links to: a number, or an array where the law differs.

    A law's ``stiffest`` gives it; else it is the largest at some fractions of the strain at which the link alone holds
    the energy, which is exact for laws that stiffen or soften at all strains.
    """
    if hasattr(law, "stiffest"):
        return law.stiffest(total_energy, *law)
    farthest = law.max_strain(total_energy, *law)
    return functools.reduce(np.fmax, (law.stiffness(part * farthest, *law) for part in _PARTS))


_PARTS = (1.0, 0.75, 0.5, 0.25, 0.0, -0.25, -0.5, -0.75, -1.0)


class ContactState:
    """State of a contact, on which its force depends beside the strain; base of what declares a parameter as one.

    States, overlaps and closing velocities are arrays of one shape, [...], or numbers. Overlaps include that at rest.
    """

    heading: ClassVar[str]
    """Variable of LAMMPS that holds the state of the contact behind each bead, and the heading of its column."""

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
    if hasattr(law, "next_state") and not has_state(law):
        raise ValueError(
            f"contacts: the law {type(law).__name__} has a function `next_state`; it needs a parameter declared as the "
            "state, such as `largest: LargestOverlap = 0.0`, too"
        )
    for name in ("next_state", "permanent", "dissipated"):
        if has_state(law) and not hasattr(law, name):
            raise ValueError(f"contacts: the law {type(law).__name__} has a memory; it needs a function `{name}`, too")


def state_name(law: Any) -> str:
    """Name of the parameter that is the state of each contact; empty for a law without one."""
    declaration = _state_of(law)
    return "" if declaration is None else declaration[0]


def contact_state(law: Any) -> Any:
    """State of the contacts of a law that has one: a number, or an array where it differs."""
    return getattr(law, state_name(law))


def at_state(law: Any, state: Any) -> Any:
    """The law at another state of its contacts; unchanged for a law without one."""
    return law._replace(**{state_name(law): state}) if has_state(law) else law


def state_heading(law: Any) -> str:
    """Heading of the column of frames that holds the state of the contact behind each bead, of a law that has one."""
    return _kind_of_state(law).heading


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


def rest(law: Law) -> Any:
    """Overlap at rest: a number, or an array where it differs; 0 where beads just touch."""
    return law.rest if hasattr(law, "rest") else 0.0


def load(law: Law) -> Any:
    """Force at rest, which `force` leaves out: a number, or an array where it differs; 0 where beads just touch."""
    return law.load if hasattr(law, "load") else 0.0


def whole_force(law: Law, overlap: Any) -> Any:
    """Force of a law on links at an overlap, that at rest included, where the strain counts from there."""
    if not hasattr(law, "rest"):
        return law.force(overlap, *law)
    return law.force(overlap - rest(law), *law) + load(law)


def strength(law: Law) -> Any:
    """Strength of a contact's law, its first parameter: 1 for two reference beads."""
    return next(iter(law))


def exponent(law: Law) -> Any:
    """Exponent of the overlap in the force of a contact: a number, or [chain, contact]; None where it is no power."""
    return law.exponent if hasattr(law, "exponent") else None


def dimensionless(law: Any, scale: "Scale") -> Any:
    """A law whose parameters are in a scene's units, as one of dimensionless strain, rate and force.

    Raises:
        TypeError: a parameter declares no `Dimension`.
    """
    kind = type(law)
    hints = get_type_hints(kind, include_extras=True)
    units = []
    for name in kind._fields:
        if (dimension := dimension_of(hints[name])) is None:
            raise TypeError(
                f"{kind.__name__}.{name}: declares no unit; valid: `{name}: Annotated[Parameter, "
                f"Dimension('stiffness')]`, or `{name}: Pure` for one without"
            )
        units.append(dimension.worth(scale))
    return kind(*(value / unit for value, unit in zip(law, units, strict=True)))


def varies(law: Law) -> bool:
    """Whether a law depends on time."""
    return hasattr(law, "now")


def differs(law: Law) -> bool:
    """Whether a law differs from link to link."""
    return any(np.ndim(parameter) > 0 for parameter in law)


def for_all(law: Any, shape: tuple[int, int]) -> Any:
    """Law whose parameters that differ are arrays of a shape; those of a single chain are repeated for every chain."""
    return type(law)(*(np.array(np.broadcast_to(values, shape)) if np.ndim(values) > 0 else values for values in law))


def at(law: Law, *index: Any) -> Any:
    """The law of chosen links: parameters that differ are taken at an index of the arrays."""
    return type(law)(*(parameter[index] if np.ndim(parameter) > 0 else parameter for parameter in law))
