"""A bead that is pressed against something at rest: a contact that pushes one way only (Hertz 1882)."""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lammps_inputs.deck_lines import Lines
from lammps_inputs.laws import Parameter
from lammps_inputs.laws.contact import Power
from lammps_inputs.numbers import text

if TYPE_CHECKING:
    from lammps_inputs.layout import Layout


class HertzWall(NamedTuple):
    """``A (s - gap)+^1.5`` against a wall on the right, the mirror image of that against one on the left."""

    strength: Parameter
    """A, in units of the scale's contact constant; 0 for beads that have no wall."""
    side: float
    """1 for a wall towards higher bead numbers, -1 towards lower ones."""
    gap: float
    """Clear distance at rest."""

    @property
    def exponent(self) -> float:
        """Of the overlap, in the force."""
        return 1.5

    @staticmethod
    def force(s: Any, strength: Any, side: Any, gap: Any) -> Any:
        """Repulsion by the wall; none where the bead is off it."""
        closed = np.maximum(side * s - gap, 0.0)
        return side * strength * (closed * np.sqrt(closed))

    @staticmethod
    def energy(s: Any, strength: Any, side: Any, gap: Any) -> Any:
        """2/5 of the force times the overlap."""
        closed = np.maximum(side * s - gap, 0.0)
        return strength * (0.4 * closed * closed * np.sqrt(closed))

    @staticmethod
    def stiffness(s: Any, strength: Any, side: Any, gap: Any) -> Any:
        """3/2 of the force over the overlap."""
        return strength * (1.5 * np.sqrt(np.maximum(side * s - gap, 0.0)))

    @staticmethod
    def reach(energy: Any, strength: Any, side: Any, gap: Any) -> Any:
        """Displacement at which one contact holds the whole energy; 0 where there is none."""
        overlap = (2.5 * energy / np.where(np.asarray(strength) > 0.0, strength, np.inf)) ** 0.4
        return np.where(overlap > 0.0, side * (gap + overlap), 0.0)

    def overlap(self, energy: float) -> Any:
        """The overlap at which one contact holds the whole energy."""
        return np.abs(self.reach(energy, *self)) - self.gap

    def opposite(self) -> "HertzWall":
        """The same on the other side."""
        return self._replace(side=-self.side)

    def ground(self, name: str, layout: "Layout") -> Lines:
        """A wall as far away as the gap."""
        return wall_lines(name, self, layout)


def clearance(law: Any) -> NDArray[np.float64]:
    """Clear distance of walls from their beads at rest, [chain, bead]; below 0 an overlap."""
    return np.broadcast_to(law.gap if hasattr(law, "gap") else -law.rest, law.strength.shape)


def faces(law: Any, layout: "Layout") -> list[tuple[float, float]]:
    """Strength of the wall of every chain, and where it stands in LAMMPS."""
    radius, right = layout.diameter / 2.0, law.side > 0.0
    end = -1 if right else 0
    place, clear = layout.places[:, end], clearance(law)[:, end]
    face = place + radius + clear if right else place - radius - clear
    return list(zip(np.max(law.strength, axis=1).tolist(), face.tolist(), strict=True))


def wall_lines(name: str, law: Any, layout: "Layout") -> Lines:
    """Walls of the ends of the chains, with their dashpots.

    Only the beads that can reach them are asked, for the others cost as much. All have one radius in LAMMPS, so chains
    whose walls are not equally hard, or equally far along, have walls of their own.
    """
    loss = layout.wall_loss(law.side)
    lost, model = ([0.0] * layout.chains, "damping velocity") if loss is None else loss.granular(layout)
    push = _of_spheres if law.exponent == 1.5 else _by_formula
    end = layout.beads if law.side > 0.0 else 1
    walls = [(*face, g) for face, g in zip(faces(law, layout), lost, strict=True)]
    if len(set(walls)) == 1:
        hard, face, g = walls[0]
        strength = f"variable {name} index {text(hard)}   # force over overlap^{text(law.exponent)}"
        dashpot = f"variable {name}_damping index {text(g)}   # {model}"
        coefficient = "0" if loss is None else f"${{{name}_damping}}"
        return Lines(
            variables=(strength,) if loss is None else (strength, dashpot),
            motion=(
                f"group {name} id {end}:{layout.chains * layout.beads}:{layout.beads}",
                *push(name, f"v_{name}", face, coefficient, model, law, layout),
            ),
        )
    lines = []
    for number, wall in enumerate(sorted(set(walls)), 1):
        own, (hard, face, g) = f"{name}{number}", wall
        atoms = " ".join(str(chain * layout.beads + end) for chain, other in enumerate(walls) if other == wall)
        coefficient = "0" if loss is None else text(g)
        lines += [f"group {own} id {atoms}", *push(own, text(hard), face, coefficient, model, law, layout)]
    return Lines(motion=tuple(lines))


def _of_spheres(name: str, hard: str, face: float, g: str, model: str, law: Any, layout: "Layout") -> tuple[str, ...]:
    """LAMMPS's force of a flat wall is ``K * sqrt(radius) * overlap**1.5``."""
    root = text(float(np.sqrt(layout.diameter / 2.0)))
    return (f"fix {name} {name} {_granular(f'hertz $({hard}/{root}:%.17g)', g, model, face, law)}",)


def _by_formula(name: str, hard: str, face: float, g: str, model: str, law: Any, layout: "Layout") -> tuple[str, ...]:
    """A force from outside on the beads of a group: LAMMPS's walls of any potential take ten times as long.

    A dashpot is that of a sphere of no stiffness.
    """
    touched = text(face - law.side * layout.diameter / 2.0)
    sign, overlap = ("-", f"(x-{touched})*(x>{touched})") if law.side > 0.0 else ("", f"({touched}-x)*(x<{touched})")
    push = (
        f"variable {name}_push atom {sign}{hard}*({overlap})^{text(law.exponent)}",
        f"fix {name} {name} addforce v_{name}_push 0.0 0.0",
    )
    return push if g == "0" else (*push, f"fix {name}_damping {name} {_granular('hertz 0', g, model, face, law)}")


def _granular(normal: str, g: str, model: str, face: float, law: Any) -> str:
    faces = f"NULL {text(face)}" if law.side > 0.0 else f"{text(face)} NULL"
    return f"wall/gran granular {normal} {g} tangential linear_nohistory 0 0 {model} xplane {faces}"


class PowerWall(NamedTuple):
    """``A (s - gap)+^p`` against a wall on the right, the mirror image of that against one on the left; p >= 1."""

    strength: Parameter
    """A, in units of the scale's contact constant; 0 for beads that have no wall."""
    exponent: float
    """p."""
    side: float
    """1 for a wall towards higher bead numbers, -1 towards lower ones."""
    gap: float
    """Clear distance at rest."""

    @staticmethod
    def force(s: Any, strength: Any, exponent: Any, side: Any, gap: Any) -> Any:
        """Repulsion by the wall; none where the bead is off it."""
        return side * strength * np.maximum(side * s - gap, 0.0) ** exponent

    @staticmethod
    def energy(s: Any, strength: Any, exponent: Any, side: Any, gap: Any) -> Any:
        """As of `Power`."""
        return Power.energy(side * s - gap, strength, exponent)

    @staticmethod
    def stiffness(s: Any, strength: Any, exponent: Any, side: Any, gap: Any) -> Any:
        """As of `Power`."""
        return Power.stiffness(side * s - gap, strength, exponent)

    @staticmethod
    def reach(energy: Any, strength: Any, exponent: Any, side: Any, gap: Any) -> Any:
        """Displacement at which one contact holds the whole energy; 0 where there is none."""
        overlap = Power.reach(energy, strength, exponent)
        return np.where(overlap > 0.0, side * (gap + overlap), 0.0)

    def overlap(self, energy: float) -> Any:
        """The overlap at which one contact holds the whole energy."""
        return np.abs(self.reach(energy, *self)) - self.gap

    def opposite(self) -> "PowerWall":
        """The same on the other side."""
        return self._replace(side=-self.side)

    def ground(self, name: str, layout: "Layout") -> Lines:
        """A wall as far away as the gap."""
        return wall_lines(name, self, layout)
