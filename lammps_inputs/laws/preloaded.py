"""Hertzian contacts that bear a static load, in incremental form: rest is exactly rest, and its energy exactly 0.

The strain counts from the static state, in which the overlap is ``rest`` and the force ``load``. Whatever holds the
beads there (forces on the ends, walls, gravity) is constant, and so part of the law: what a link adds to it is all that
moves the beads. Nesterenko, Dynamics of Heterogeneous Materials (2001), chapter 1.
"""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lammps_inputs.laws import Law, Parameter
from lammps_inputs.laws.hertz import Hertz
from lammps_inputs.laws.wall import HertzWall, wall_lines
from lammps_inputs.lines import Lines

if TYPE_CHECKING:
    from lammps_inputs.problem import System

_NEWTON = 60


class Preloaded(NamedTuple):
    """``A (d0 + s)+^1.5 - F0`` with ``F0 = A d0^1.5``."""

    strength: Parameter
    """A, in units of the scale's contact constant."""
    rest: Parameter
    """d0, the overlap at rest."""
    load: Parameter
    """F0, to the last bit what the first term is at s = 0."""

    @staticmethod
    def force(s: Any, strength: Any, rest: Any, load: Any) -> Any:
        """Repulsion above that at rest; below it where the beads are farther apart."""
        closed = np.maximum(rest + s, 0.0)
        return strength * (closed * np.sqrt(closed)) - load

    @staticmethod
    def energy(s: Any, strength: Any, rest: Any, load: Any) -> Any:
        """``U(d0 + s) - U(d0) - F0 s`` with ``U = 2/5 A d^2.5``, written without a difference of like numbers."""
        closed = np.maximum(rest + s, 0.0)
        root, base = np.sqrt(closed), np.sqrt(rest)
        both = root + base
        e = np.maximum(s, -rest) / np.where(both > 0.0, both, 1.0)  # root - base
        bent = strength * (e * e * (base * (base * (3.0 * base + 4.0 * e) + 2.0 * e * e) + 0.4 * e * e * e))
        return bent + load * np.maximum(-(rest + s), 0.0)

    @staticmethod
    def stiffness(s: Any, strength: Any, rest: Any, load: Any) -> Any:  # noqa: ARG004
        """``3/2 A (d0 + s)+^0.5``."""
        return strength * (1.5 * np.sqrt(np.maximum(rest + s, 0.0)))

    @staticmethod
    def reach(energy: Any, strength: Any, rest: Any, load: Any) -> Any:
        """Strain at which one contact holds the whole energy; 0 where there is no contact."""
        there = np.asarray(strength) > 0.0
        a = np.where(there, strength, 1.0)
        # from above, where the energy is convex: what it would be without load, and as a linear spring
        s = (2.5 * energy / a) ** 0.4
        stiff = 1.5 * a * np.sqrt(rest)
        s = np.minimum(s, np.sqrt(2.0 * energy / np.where(stiff > 0.0, stiff, np.inf)) + np.where(stiff > 0.0, 0.0, s))
        for _ in range(_NEWTON):
            slope = Preloaded.force(s, a, rest, load)
            more = Preloaded.energy(s, a, rest, load) - energy
            s = s - np.where(slope > 0.0, np.maximum(more, 0.0) / np.where(slope > 0.0, slope, 1.0), 0.0)
        return np.where(there, s, 0.0)

    def along(self, name: str, problem: "System") -> Lines:
        """The contact itself; the load is what it does at rest, see `lammps_inputs.decks.at_rest`."""
        return Hertz(self.strength).along(name, problem)


class PreloadedWall(NamedTuple):
    """The same of a bead and a wall on its right, the mirror image of that of one on its left."""

    strength: Parameter
    """A; 0 for beads that have no wall."""
    side: float
    """1 for a wall towards higher bead numbers, -1 towards lower ones."""
    rest: Parameter
    """d0, the overlap at rest."""
    load: Parameter
    """F0."""

    @staticmethod
    def force(s: Any, strength: Any, side: Any, rest: Any, load: Any) -> Any:
        """Repulsion by the wall above that at rest."""
        closed = np.maximum(rest + side * s, 0.0)
        return side * (strength * (closed * np.sqrt(closed)) - load)

    @staticmethod
    def energy(s: Any, strength: Any, side: Any, rest: Any, load: Any) -> Any:
        """As of `Preloaded`."""
        return Preloaded.energy(side * s, strength, rest, load)

    @staticmethod
    def stiffness(s: Any, strength: Any, side: Any, rest: Any, load: Any) -> Any:
        """As of `Preloaded`."""
        return Preloaded.stiffness(side * s, strength, rest, load)

    @staticmethod
    def reach(energy: Any, strength: Any, side: Any, rest: Any, load: Any) -> Any:
        """Displacement at which one contact holds the whole energy; 0 where there is none."""
        return side * Preloaded.reach(energy, strength, rest, load)

    def overlap(self, energy: float) -> Any:
        """The overlap, that at rest included, at which one contact holds the whole energy."""
        return self.rest + np.abs(self.reach(energy, *self))

    def opposite(self) -> "PreloadedWall":
        """The same on the other side."""
        return self._replace(side=-self.side)

    def ground(self, name: str, problem: "System") -> Lines:
        """A wall that is nearer by the overlap at rest."""
        return wall_lines(name, self, problem)


def bears(law: Law) -> bool:
    """Whether it is known how contacts of a law bear a load."""
    return isinstance(law, Hertz)


def under(law: Hertz, load: Parameter, grid: float) -> Preloaded:
    """The contact that bears a load at rest, as nearly as places that are multiples of ``grid`` allow.

    Args:
        law: of the contact without load.
        load: at rest, a number or an array of the law's shape; 0 where there is none.
        grid: what LAMMPS can tell apart; overlaps at rest are multiples of it, and loads follow from them.
    """
    return Preloaded(law.strength, *_at_rest(law.strength, load, grid))


def wall_under(law: HertzWall, load: Parameter, grid: float) -> PreloadedWall:
    """The same of a wall."""
    return PreloadedWall(law.strength, law.side, *_at_rest(law.strength, load, grid))


def _at_rest(strength: Parameter, load: Parameter, grid: float) -> tuple[Parameter, Parameter]:
    """Overlap, and the force that belongs to it as the laws compute it."""
    there = np.asarray(strength) > 0.0
    bare = np.where(there, np.asarray(load) / np.where(there, strength, 1.0), 0.0)
    rounded = np.round(np.cbrt(bare) ** 2 / grid) * grid
    rest: Parameter = rounded if np.ndim(rounded) else float(rounded)
    held = strength * (rest * np.sqrt(rest))
    return rest, held if np.ndim(held) else float(held)
