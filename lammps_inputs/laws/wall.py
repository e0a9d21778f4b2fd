"""A bead that is pressed against something at rest: a Hertzian contact that pushes one way only (Hertz 1882)."""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lammps_inputs.laws import Parameter
from lammps_inputs.lines import Lines
from lammps_inputs.numbers import text

if TYPE_CHECKING:
    from lammps_inputs.problem import System


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

    def ground(self, name: str, problem: "System") -> Lines:
        """A wall as far away as the gap."""
        return wall_lines(name, self, problem)


def faces(law: Any, problem: "System") -> list[tuple[float, float]]:
    """Strength of the wall of every chain, and where it stands in LAMMPS."""
    radius, right = problem.diameter / 2.0, law.side > 0.0
    end = -1 if right else 0
    away = law.gap if hasattr(law, "gap") else -np.broadcast_to(law.rest, law.strength.shape)[:, end]
    place = problem.places[:, end]
    face = place + radius + away if right else place - radius - away
    return list(zip(np.max(law.strength, axis=1).tolist(), face.tolist(), strict=True))


def wall_lines(name: str, law: Any, problem: "System") -> Lines:
    """Walls of the ends of the chains.

    Only the beads that can reach them are asked, for the others cost as much. All have one radius in LAMMPS, so chains
    whose walls are not equally hard, or equally far along, have walls of their own.
    """
    push = _of_spheres if law.exponent == 1.5 else _by_formula
    end = problem.beads if law.side > 0.0 else 1
    walls = faces(law, problem)
    if len(set(walls)) == 1:
        hard, face = walls[0]
        return Lines(
            variables=(f"variable {name} index {text(hard)}   # force over overlap^{text(law.exponent)}",),
            motion=(
                f"group {name} id {end}:{problem.chains * problem.beads}:{problem.beads}",
                *push(name, f"v_{name}", face, law, problem),
            ),
        )
    lines = []
    for number, (hard, face) in enumerate(sorted(set(walls)), 1):
        own = f"{name}{number}"
        atoms = " ".join(str(chain * problem.beads + end) for chain, wall in enumerate(walls) if wall == (hard, face))
        lines += [f"group {own} id {atoms}", *push(own, text(hard), face, law, problem)]
    return Lines(motion=tuple(lines))


def _of_spheres(name: str, hard: str, face: float, law: Any, problem: "System") -> tuple[str, ...]:
    """LAMMPS's force of a flat wall is ``K * sqrt(radius) * overlap**1.5``."""
    root = text(float(np.sqrt(problem.diameter / 2.0)))
    faces = f"NULL {text(face)}" if law.side > 0.0 else f"{text(face)} NULL"
    no_loss = f"0 tangential linear_nohistory 0 0 damping velocity xplane {faces}"
    return (f"fix {name} {name} wall/gran granular hertz $({hard}/{root}:%.17g) {no_loss}",)


def _by_formula(name: str, hard: str, face: float, law: Any, problem: "System") -> tuple[str, ...]:
    """A force from outside on the beads of a group: LAMMPS's walls of any potential take ten times as long."""
    touched = text(face - law.side * problem.diameter / 2.0)
    sign, overlap = ("-", f"(x-{touched})*(x>{touched})") if law.side > 0.0 else ("", f"({touched}-x)*(x<{touched})")
    return (
        f"variable {name}_push atom {sign}{hard}*({overlap})^{text(law.exponent)}",
        f"fix {name} {name} addforce v_{name}_push 0.0 0.0",
    )
