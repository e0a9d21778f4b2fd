"""Laws of force on a link, one a file: plain scalar functions, and how LAMMPS spells them.

A law is a `NamedTuple` of its parameters. Each parameter is a number, or an array where it differs from link to link;
with all of them 0 a law exerts no force. Each declares its unit (`Dimension`), by which `dimensionless` converts a law
whose parameters are in a scene's units. Its functions take the strain ``s`` of a link and the parameters, in the order
in which the law has them, as scalars or arrays:

- ``force(s, ...)``: what drives the link's first bead back and its second forward;
- ``energy(s, ...)``: stored by it, whose slope the force is;
- ``stiffness(s, ...)``: slope of the force;
- ``max_strain(energy, ...)``: largest strain to which an energy can bring it;
- ``stiffest(energy, ...)``, only where `stiffest_of_each` would not find it: largest stiffness at such an energy.

A law whose force depends on the past has a parameter ``memory``, the state of each contact: in the law of a system that
at the start, in the law that analyses compute with that of frames. It has three more functions:

- ``remember(s, ...)``: memory after a strain;
- ``permanent(...)``: overlap at which unloading ends;
- ``lost(...)``: energy dissipated since the start.

A law that depends on time takes the time ``t`` after the strain in all of these but the bounds, and has

- ``now(t)``: the law at a time, whose ``change(s, ...)`` is how fast its force changes at a strain that does not;
- ``power(s, t, ...)``: how fast its energy changes at such a strain, which is work from outside;
- ``steady``: the law without what depends on time;
- ``bends``: times between which it depends on time smoothly.

They are written without branches, so that NumPy takes them as they are and the reference's kernel compiles them into
vector instructions. Methods ``along``, ``across`` and ``ground``, where a law has them, spell it in LAMMPS on that kind
of link (`lammps_inputs.links`). They take the link's name, ``across`` the link itself, whose edges become bonds, and
the layout of the beads in LAMMPS. Nothing here depends on scenes or problems.
"""

import functools
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, Protocol, get_type_hints, runtime_checkable

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


@runtime_checkable
class WithOneNumber(Protocol):
    """A law with parameters that are the same for all links, and keep their value where there is no link."""

    one_number: tuple[str, ...]
    """Names of these parameters."""


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


def remembers(law: Any) -> bool:
    """Whether the force of a law depends on the past."""
    return hasattr(law, "remember")


def refuse_incomplete(law: Any) -> None:
    """Refuse a law with a memory that lacks a function which analyses need of it.

    Raises:
        ValueError: naming the law and the function.
    """
    for name in ("permanent", "lost"):
        if remembers(law) and not hasattr(law, name):
            raise ValueError(f"contacts: the law {type(law).__name__} has a memory; it needs a function `{name}`, too")


def with_memory(law: Any, memory: Any) -> Any:
    """The law with another memory, where it has one."""
    return law if memory is None or not remembers(law) else law._replace(memory=memory)


def rest(law: Law) -> Any:
    """Overlap at rest: a number, or an array where it differs; 0 where beads just touch."""
    return getattr(law, "rest", 0.0)


def load(law: Law) -> Any:
    """Force at rest, which `force` leaves out: a number, or an array where it differs; 0 where beads just touch."""
    return getattr(law, "load", 0.0)


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
    return getattr(law, "exponent", None)


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
