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
        """LAMMPS's force of a flat wall is ``K * sqrt(radius) * overlap**1.5``.

        Only the beads that can reach it are asked, for the others cost as much. All have one radius in LAMMPS, so
        chains whose walls are not equally hard have walls of their own.
        """
        radius = problem.diameter / 2.0
        right = self.side > 0.0
        face = problem.beads * problem.spacing + radius + self.gap if right else problem.spacing - radius - self.gap
        faces = f"NULL {text(face)}" if right else f"{text(face)} NULL"
        root, end = text(float(np.sqrt(radius))), problem.beads if right else 1
        no_loss = f"0 tangential linear_nohistory 0 0 damping velocity xplane {faces}"
        hard = np.max(self.strength, axis=1)
        if np.ptp(hard) == 0.0:
            return Lines(
                variables=(f"variable {name} index {text(float(hard[0]))}   # force over overlap^1.5",),
                motion=(
                    f"group {name} id {end}:{problem.chains * problem.beads}:{problem.beads}",
                    f"fix {name} {name} wall/gran granular hertz $(v_{name}/{root}:%.17g) {no_loss}",
                ),
            )
        lines = []
        for number, strength in enumerate(np.unique(hard).tolist(), 1):
            atoms = " ".join(str(chain * problem.beads + end) for chain in np.flatnonzero(hard == strength).tolist())
            own, stiffness = f"{name}{number}", f"$({text(strength)}/{root}:%.17g)"
            lines += [f"group {own} id {atoms}", f"fix {own} {own} wall/gran granular hertz {stiffness} {no_loss}"]
        return Lines(motion=tuple(lines))
